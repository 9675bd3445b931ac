/* SPDX-License-Identifier: BSD-3-Clause
 * How many values of a block break a rule. */
#include "validate_count.h"

#include <string.h>

static uint64_t count_not_finite_f64(const double *values, uint64_t count) {
  uint64_t broken = 0;
  for (uint64_t i = 0; i < count; i++)
    broken += !(values[i] - values[i] == 0);
  return broken;
}

static uint64_t count_not_finite_f32(const float *values, uint64_t count) {
  uint64_t broken = 0;
  for (uint64_t i = 0; i < count; i++)
    broken += !(values[i] - values[i] == 0);
  return broken;
}

#define COUNT_WHERE(condition)                                                                               \
  do {                                                                                                       \
    for (uint64_t i = 0; i < count; i++)                                                                     \
      broken += (condition);                                                                                 \
  } while (0)

static int is_choice(int64_t value, const struct value_test *test) {
  int found = 0;
  for (uint32_t c = 0; c < test->choices; c++)
    found |= value == test->choice[c];
  return found;
}

/* `none`: -1, or all bits one in a type without sign. */
#define DEFINE_COUNT(suffix, type, none)                                                                     \
  static uint64_t count_##suffix(const type *values, uint64_t count, const struct value_test *test) {        \
    uint64_t broken = 0;                                                                                     \
    switch (test->rule) {                                                                                    \
    case VALUE_POSITIVE:                                                                                     \
      COUNT_WHERE(!(values[i] > 0));                                                                         \
      break;                                                                                                 \
    case VALUE_NONNEGATIVE:                                                                                  \
      COUNT_WHERE(!(values[i] >= 0));                                                                        \
      break;                                                                                                 \
    case VALUE_INDEX:                                                                                        \
      COUNT_WHERE((uint64_t)values[i] >= test->limit);                                                       \
      break;                                                                                                 \
    case VALUE_INDEX_OR_NONE:                                                                                \
      COUNT_WHERE((uint64_t)values[i] >= test->limit && !(none));                                            \
      break;                                                                                                 \
    case VALUE_CHOICE:                                                                                       \
      COUNT_WHERE(!is_choice((int64_t)values[i], test));                                                     \
      break;                                                                                                 \
    case VALUE_FINITE:                                                                                       \
      break; /* whole numbers are */                                                                         \
    }                                                                                                        \
    return broken;                                                                                           \
  }

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wtype-limits" /* "not negative" is always true of types without sign */
#endif
DEFINE_COUNT(u8, uint8_t, values[i] == UINT8_MAX)
DEFINE_COUNT(i8, int8_t, values[i] == -1)
DEFINE_COUNT(u32, uint32_t, values[i] == UINT32_MAX)
DEFINE_COUNT(i32, int32_t, values[i] == -1)
DEFINE_COUNT(u64, uint64_t, values[i] == UINT64_MAX)
DEFINE_COUNT(i64, int64_t, values[i] == -1)

/* Index and choice rules are for whole numbers alone. */
#define DEFINE_FLOAT_COUNT(suffix, type)                                                                     \
  static uint64_t count_##suffix(const type *values, uint64_t count, const struct value_test *test) {        \
    uint64_t broken = 0;                                                                                     \
    if (test->rule == VALUE_FINITE) return count_not_finite_##suffix(values, count);                         \
    if (test->rule == VALUE_POSITIVE) COUNT_WHERE(!(values[i] > 0 && values[i] - values[i] == 0));           \
    if (test->rule == VALUE_NONNEGATIVE) COUNT_WHERE(!(values[i] >= 0 && values[i] - values[i] == 0));       \
    return broken;                                                                                           \
  }
DEFINE_FLOAT_COUNT(f32, float)
DEFINE_FLOAT_COUNT(f64, double)

uint64_t count_broken(conceg_dtype dtype, const void *values, uint64_t count, const struct value_test *test) {
  switch (dtype) {
  case CONCEG_U8:
    return count_u8(values, count, test);
  case CONCEG_I8:
    return count_i8(values, count, test);
  case CONCEG_U32:
    return count_u32(values, count, test);
  case CONCEG_I32:
    return count_i32(values, count, test);
  case CONCEG_U64:
    return count_u64(values, count, test);
  case CONCEG_I64:
    return count_i64(values, count, test);
  case CONCEG_F32:
    return count_f32(values, count, test);
  case CONCEG_F64:
    return count_f64(values, count, test);
  default:
    return 0;
  }
}
