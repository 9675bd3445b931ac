/* SPDX-License-Identifier: BSD-3-Clause
 * Checks for test programs in C11 and C++17. A failed check prints both values and the program ends with 1
 * after all checks. Use:  int main(void) { CHECK(a == b); CHECK_NEAR(x, 1.0, 1e-9); return check_done(); }
 * Exit 77 = skipped, with a reason. */
#ifndef CONCEG_TESTS_CHECK_H
#define CONCEG_TESTS_CHECK_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int check_failed_ = 0, check_count_ = 0;

#define CHECK(condition)                                                                                     \
  do {                                                                                                       \
    check_count_++;                                                                                          \
    if (!(condition))                                                                                        \
      check_failed_++, fprintf(stderr, "%s:%d: failed: %s\n", __FILE__, __LINE__, #condition);               \
  } while (0)

#define CHECK_EQUAL(got, expected)                                                                           \
  do {                                                                                                       \
    const long long check_got_ = (long long)(got), check_expected_ = (long long)(expected);                  \
    check_count_++;                                                                                          \
    if (check_got_ != check_expected_)                                                                       \
      check_failed_++, fprintf(stderr, "%s:%d: %s: expected %lld, got %lld\n", __FILE__, __LINE__, #got,     \
                               check_expected_, check_got_);                                                 \
  } while (0)

#define CHECK_NEAR(got, expected, tolerance)                                                                 \
  do {                                                                                                       \
    const double check_got_ = (got), check_expected_ = (expected), check_tolerance_ = (tolerance);           \
    check_count_++;                                                                                          \
    if (!(fabs(check_got_ - check_expected_) <= check_tolerance_))                                           \
      check_failed_++, fprintf(stderr, "%s:%d: %s: expected %.17g +- %g, got %.17g\n", __FILE__, __LINE__,   \
                               #got, check_expected_, check_tolerance_, check_got_);                         \
  } while (0)

#define CHECK_TEXT(got, expected)                                                                            \
  do {                                                                                                       \
    const char *check_got_ = (got), *check_expected_ = (expected);                                           \
    check_count_++;                                                                                          \
    if (!check_got_ || strcmp(check_got_, check_expected_))                                                  \
      check_failed_++, fprintf(stderr, "%s:%d: %s: expected \"%s\", got \"%s\"\n", __FILE__, __LINE__, #got, \
                               check_expected_, check_got_ ? check_got_ : "(null)");                         \
  } while (0)

#define SKIP(reason)                                                                                         \
  do {                                                                                                       \
    printf("SKIPPED: %s\n", reason);                                                                         \
    exit(77);                                                                                                \
  } while (0)

/* A program that checked nothing fails too. */
static inline int check_done(void) {
  printf("%d checks, %d failed\n", check_count_, check_failed_);
  return check_failed_ || !check_count_;
}

/* The folder of real cells and goldens: CONCEG_SHARED, else ../shared beside the checkout. NULL when absent.
 */
static inline const char *check_shared(void) {
  const char *path = getenv("CONCEG_SHARED");
  return path && *path ? path : NULL;
}

#endif
