/* SPDX-License-Identifier: BSD-3-Clause
 * How many values of a block break a rule. Plain loops without branches, which compilers turn into wide
 * instructions. */
#ifndef CONCEG_VALIDATE_COUNT_H
#define CONCEG_VALIDATE_COUNT_H

#include "conceg/array.h"

enum value_rule {
  VALUE_FINITE,
  VALUE_POSITIVE,
  VALUE_NONNEGATIVE,
  VALUE_INDEX,
  VALUE_INDEX_OR_NONE,
  VALUE_CHOICE
};

struct value_test {
  enum value_rule rule;
  uint64_t limit; /* index: values are below it */
  const int64_t *choice;
  uint32_t choices;
};

/* Number of values that break the rule. */
uint64_t count_broken(conceg_dtype dtype, const void *values, uint64_t count, const struct value_test *test);

#endif
