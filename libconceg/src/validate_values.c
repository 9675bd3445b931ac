/* SPDX-License-Identifier: BSD-3-Clause
 * The validator: rules about the values of one array, in one pass over it. */
#define _POSIX_C_SOURCE 200809L
#include "texts.h"
#include "validate.h"
#include "validate_count.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TESTS = 8 };
static const double unit_tolerance = 1e-6;

/* One rule, and what it has found so far. */
struct finding {
  const char *rule;
  char expected[160];
  struct value_test test;
  uint64_t broken, first;
  char got[64];
};

struct values_check {
  const struct entry *entry;
  struct finding finding[TESTS];
  uint32_t findings;
  int offsets, unit_vectors;
  struct finding start, ascending, unit; /* outside the table: they look at neighbours */
  uint64_t last, width;
};

void format_number(conceg_dtype dtype, const void *values, uint64_t index, char text[64]) {
  switch (dtype) {
  case CONCEG_U8:
    snprintf(text, 64, "%u", ((const uint8_t *)values)[index]);
    break;
  case CONCEG_I8:
    snprintf(text, 64, "%d", ((const int8_t *)values)[index]);
    break;
  case CONCEG_U32:
    snprintf(text, 64, "%u", ((const uint32_t *)values)[index]);
    break;
  case CONCEG_I32:
    snprintf(text, 64, "%d", ((const int32_t *)values)[index]);
    break;
  case CONCEG_U64:
    snprintf(text, 64, "%llu", (unsigned long long)((const uint64_t *)values)[index]);
    break;
  case CONCEG_I64:
    snprintf(text, 64, "%lld", (long long)((const int64_t *)values)[index]);
    break;
  case CONCEG_F32:
    snprintf(text, 64, "%.9g", (double)((const float *)values)[index]);
    break;
  case CONCEG_F64:
    snprintf(text, 64, "%.17g", ((const double *)values)[index]);
    break;
  default:
    snprintf(text, 64, "text");
    break;
  }
}

static void note(struct finding *finding, uint64_t index, uint64_t broken, conceg_dtype dtype,
                 const void *values, uint64_t at) {
  if (!finding->broken) {
    finding->first = index;
    format_number(dtype, values, at, finding->got);
  }
  finding->broken += broken;
}

static void run_test(struct finding *finding, conceg_dtype dtype, uint64_t first, uint64_t count,
                     const void *values) {
  const uint64_t broken = count_broken(dtype, values, count, &finding->test);
  if (!broken) return;
  uint64_t at = 0;
  const size_t size = conceg_dtype_bytes(dtype);
  if (!finding->broken)
    while (!count_broken(dtype, (const char *)values + at * size, 1, &finding->test))
      at++;
  note(finding, first + at, broken, dtype, values, at);
}

static void test_offsets(struct values_check *check, uint64_t first, uint64_t count, const uint64_t *values) {
  if (first == 0 && values[0] != 0) note(&check->start, 0, 1, CONCEG_U64, values, 0);
  uint64_t before = first ? check->last : values[0];
  for (uint64_t i = 0; i < count; i++) {
    if (values[i] < before) note(&check->ascending, first + i, 1, CONCEG_U64, values, i);
    before = values[i];
  }
  check->last = before;
}

static double squared(conceg_dtype dtype, const void *values, uint64_t index) {
  const double x =
      dtype == CONCEG_F32 ? (double)((const float *)values)[index] : ((const double *)values)[index];
  return x * x;
}

static void test_unit_vectors(struct values_check *check, uint64_t first, uint64_t count,
                              const void *values) {
  const conceg_dtype dtype = check->entry->dtype;
  for (uint64_t i = 0; i + check->width <= count; i += check->width) {
    double sum = 0;
    for (uint64_t k = 0; k < check->width; k++)
      sum += squared(dtype, values, i + k);
    if (fabs(sqrt(sum) - 1) <= unit_tolerance) continue;
    if (!check->unit.broken) {
      check->unit.first = first + i;
      snprintf(check->unit.got, sizeof check->unit.got, "length %.9g", sqrt(sum));
    }
    check->unit.broken++;
  }
}

static conceg_status test_block(void *user, uint64_t first, uint64_t count, const void *values) {
  struct values_check *check = user;
  for (uint32_t i = 0; i < check->findings; i++)
    run_test(&check->finding[i], check->entry->dtype, first, count, values);
  if (check->offsets) test_offsets(check, first, count, values);
  if (check->unit_vectors) test_unit_vectors(check, first, count, values);
  return CONCEG_OK;
}

static struct finding *add_test(struct values_check *check, const char *rule, enum value_rule value_rule,
                                const char *expected) {
  struct finding *finding = &check->finding[check->findings++];
  finding->rule = rule;
  finding->test.rule = value_rule;
  snprintf(finding->expected, sizeof finding->expected, "%s", expected);
  return finding;
}

static void plan_index(struct values_check *check, const struct validator *validator,
                       const struct schema_group *group, const struct schema_item *item) {
  uint64_t limit = 0;
  char expected[160];
  if (!find_extent(validator, group, item->rule_extent, &limit)) return;
  const int or_none = (item->rules & RULE_INDEX_OR_NONE) != 0;
  snprintf(expected, sizeof expected, "an index below %s = %llu%s", item->rule_extent,
           (unsigned long long)limit, or_none ? ", or none" : "");
  struct finding *finding =
      add_test(check, or_none ? "CGX-035" : "CGX-034", or_none ? VALUE_INDEX_OR_NONE : VALUE_INDEX, expected);
  finding->test.limit = limit;
}

static void list_choices(const struct schema_item *item, char *text, size_t size) {
  int length = snprintf(text, size, "one of");
  for (uint32_t c = 0; c < item->choices && length > 0 && (size_t)length < size; c++)
    length += snprintf(text + length, size - (size_t)length, "%s %s", c ? "," : "", item->choice[c]);
}

static void report_findings(struct validator *validator, const struct values_check *check) {
  for (uint32_t i = 0; i < check->findings; i++) {
    const struct finding *finding = &check->finding[i];
    if (finding->broken)
      report_value(validator, finding->rule, MUST, check->entry, finding->first, finding->broken - 1,
                   finding->expected, finding->got);
  }
  if (check->start.broken)
    report_value(validator, "CGX-040", MUST, check->entry, 0, 0, "0 as the first offset", check->start.got);
  if (check->ascending.broken)
    report_value(validator, "CGX-041", MUST, check->entry, check->ascending.first,
                 check->ascending.broken - 1, "offsets that never fall", check->ascending.got);
  if (check->unit.broken)
    report_value(validator, "CGX-033", MUST, check->entry, check->unit.first, check->unit.broken - 1,
                 "a vector of length 1 (within 1e-6)", check->unit.got);
}

static void check_end(struct validator *validator, const struct schema_group *group,
                      const struct schema_item *item, const struct values_check *check) {
  uint64_t length = 0;
  char expected[160], got[64];
  if (!find_extent(validator, group, item->rule_extent, &length) || length == check->last) return;
  snprintf(expected, sizeof expected, "%s = %llu as the last offset", item->rule_extent,
           (unsigned long long)length);
  snprintf(got, sizeof got, "%llu", (unsigned long long)check->last);
  report_value(validator, "CGX-042", MUST, check->entry, entry_count(check->entry) - 1, 0, expected, got);
}

static int compare_numbers(const void *a, const void *b) {
  const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

static int compare_texts(const void *a, const void *b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* The place of the second of two equal values; the values are 64-bit numbers or texts. */
static conceg_status check_unique(struct validator *validator, struct entry *entry) {
  const uint64_t count = entry_count(entry);
  const int is_text = entry->dtype == CONCEG_TEXT;
  if (count < 2 || (!is_text && entry->dtype != CONCEG_U64)) return CONCEG_OK;
  conceg_status status = doc_load(validator->doc, entry);
  if (status != CONCEG_OK) return status;
  uint64_t *copy = malloc(count * sizeof *copy);
  if (!copy) return conceg_ctx_fail(validator->ctx, CONCEG_E_NOMEM, "%s: out of memory", entry->path);
  memcpy(copy, entry->store.data, count * sizeof *copy);
  int (*const compare)(const void *, const void *) = is_text ? compare_texts : compare_numbers;
  qsort(copy, count, sizeof *copy, compare);
  uint64_t twin = 1;
  while (twin < count && compare(&copy[twin], &copy[twin - 1]) != 0)
    twin++;
  if (twin < count) {
    const uint64_t *values = entry->store.data;
    uint64_t place = count;
    char got[160];
    while (place-- > 0 && compare(&values[place], &copy[twin]) != 0) {
    }
    if (is_text)
      snprintf(got, sizeof got, "\"%s\" twice", ((const char *const *)entry->store.data)[place]);
    else
      snprintf(got, sizeof got, "%llu twice", (unsigned long long)copy[twin]);
    report_value(validator, "CGX-037", MUST, entry, place, 0, "values that are all different", got);
  }
  free(copy);
  return CONCEG_OK;
}

static conceg_status check_texts(struct validator *validator, const struct schema_item *item,
                                 struct entry *entry) {
  const conceg_status status = doc_load(validator->doc, entry);
  if (status != CONCEG_OK) return status;
  const char *const *strings = entry->store.data;
  char expected[256], got[160];
  list_choices(item, expected, sizeof expected);
  uint64_t first[2] = {0}, broken[2] = {0}; /* encoding, choice */
  for (uint64_t i = 0; i < entry_count(entry); i++) {
    uint32_t c = 0;
    while (c < item->choices && strcmp(strings[i], item->choice[c]) != 0)
      c++;
    const int wrong[2] = {!text_is_utf8(strings[i]), item->choices && c == item->choices};
    for (int kind = 0; kind < 2; kind++)
      if (wrong[kind] && broken[kind]++ == 0) first[kind] = i;
  }
  if (broken[0])
    report_value(validator, "CGX-038", MUST, entry, first[0], broken[0] - 1, "UTF-8", "other bytes");
  if (broken[1]) {
    snprintf(got, sizeof got, "\"%.150s\"", strings[first[1]]);
    report_value(validator, "CGX-036", MUST, entry, first[1], broken[1] - 1, expected, got);
  }
  return item->rules & RULE_UNIQUE ? check_unique(validator, entry) : CONCEG_OK;
}

conceg_status check_values(struct validator *validator, const struct schema_group *group,
                           const struct schema_item *item, struct entry *entry) {
  if (!entry_count(entry)) return CONCEG_OK;
  if (entry->dtype == CONCEG_TEXT) return check_texts(validator, item, entry);
  struct values_check check = {.entry = entry};
  int64_t choice[64];
  if (item->rules & RULE_FINITE) add_test(&check, "CGX-030", VALUE_FINITE, "a finite number");
  if (item->rules & RULE_POSITIVE) add_test(&check, "CGX-031", VALUE_POSITIVE, "a finite number above 0");
  if (item->rules & RULE_NONNEGATIVE)
    add_test(&check, "CGX-032", VALUE_NONNEGATIVE, "a finite number not below 0");
  if (item->rules & (RULE_INDEX_OF | RULE_INDEX_OR_NONE)) plan_index(&check, validator, group, item);
  if (item->choices && item->choices <= 64) {
    char expected[160];
    list_choices(item, expected, sizeof expected);
    struct finding *finding = add_test(&check, "CGX-036", VALUE_CHOICE, expected);
    for (uint32_t c = 0; c < item->choices; c++)
      choice[c] = strtoll(item->choice[c], NULL, 10);
    finding->test.choice = choice;
    finding->test.choices = item->choices;
  }
  check.offsets = (item->rules & RULE_CSR_OF) && entry->dtype == CONCEG_U64;
  check.width = entry->rank ? entry->shape[entry->rank - 1] : 1;
  check.unit_vectors =
      (item->rules & RULE_UNIT_VECTOR) && (entry->dtype == CONCEG_F32 || entry->dtype == CONCEG_F64);
  /* An array of floats without a stated rule must still be finite. */
  const int is_float = entry->dtype == CONCEG_F32 || entry->dtype == CONCEG_F64;
  if (is_float && !(item->rules & (RULE_FINITE | RULE_POSITIVE | RULE_NONNEGATIVE)))
    add_test(&check, "CGX-030", VALUE_FINITE, "a finite number");
  conceg_status status = CONCEG_OK;
  if (check.findings || check.offsets || check.unit_vectors)
    status = doc_each_block(validator->doc, entry, test_block, &check);
  if (status == CONCEG_OK) report_findings(validator, &check);
  if (status == CONCEG_OK && check.offsets) check_end(validator, group, item, &check);
  if (status == CONCEG_OK && (item->rules & RULE_UNIQUE)) status = check_unique(validator, entry);
  return status;
}
