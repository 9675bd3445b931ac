/* SPDX-License-Identifier: BSD-3-Clause
 * Numbers of SWC files: independent of the locale and correctly rounded. */
#define _GNU_SOURCE
#include "swc_internal.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST_NUMBER 255

__extension__ typedef unsigned __int128 wide;

static const double power_of_ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
static const uint64_t whole_power_of_ten[] = {1ull,
                                              10ull,
                                              100ull,
                                              1000ull,
                                              10000ull,
                                              100000ull,
                                              1000000ull,
                                              10000000ull,
                                              100000000ull,
                                              1000000000ull,
                                              10000000000ull,
                                              100000000000ull,
                                              1000000000000ull,
                                              10000000000000ull,
                                              100000000000000ull,
                                              1000000000000000ull,
                                              10000000000000000ull,
                                              100000000000000000ull,
                                              1000000000000000000ull,
                                              10000000000000000000ull};

/* The C library's conversion in the C locale, for what the exact fast path cannot do. */
static const char *read_slowly(const char *text, const char *last, double *out) {
  char copy[LONGEST_NUMBER + 1], *stop;
  const size_t length = (size_t)(last - text);
  const locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  if (!c || length > LONGEST_NUMBER) {
    if (c) freelocale(c);
    return NULL;
  }
  memcpy(copy, text, length), copy[length] = 0;
  *out = strtod_l(copy, &stop, c);
  freelocale(c);
  return stop == copy + length ? last : NULL;
}

/* Value of a hexadecimal digit plus 1; 0 = none. */
static const uint8_t hex_digit[256] = {
    ['0'] = 1,  ['1'] = 2,  ['2'] = 3,  ['3'] = 4,  ['4'] = 5,  ['5'] = 6,  ['6'] = 7,  ['7'] = 8,
    ['8'] = 9,  ['9'] = 10, ['a'] = 11, ['b'] = 12, ['c'] = 13, ['d'] = 14, ['e'] = 15, ['f'] = 16,
    ['A'] = 11, ['B'] = 12, ['C'] = 13, ['D'] = 14, ['E'] = 15, ['F'] = 16};

/* 2^exponent for -1022 to 1023. */
static double power_of_two(int exponent) {
  const uint64_t bits = (uint64_t)(exponent + 1023) << 52;
  double out;
  memcpy(&out, &bits, sizeof out);
  return out;
}

/* Exponent digits after 'e' or 'p'; saturates, so that it never overflows. */
static const char *read_exponent(const char *p, const char *end, int *out) {
  int negative = 0, value = 0;
  if (p < end && (*p == '+' || *p == '-')) negative = *p++ == '-';
  if (p == end || *p < '0' || *p > '9') return NULL;
  for (; p < end && *p >= '0' && *p <= '9'; p++)
    if (value < 100000) value = value * 10 + (*p - '0');
  *out = negative ? -value : value;
  return p;
}

static const char *read_hex(const char *text, const char *p, const char *end, int negative, double *out) {
  uint64_t mantissa = 0;
  int digits = 0, exponent = 0, scale = 0, point = 0, exact = 1;
  for (; p < end; p++) {
    const unsigned digit = hex_digit[(unsigned char)*p];
    if (!digit) {
      if (*p != '.' || point) break;
      point = 1;
      continue;
    }
    if (mantissa >> 49) exact = 0;
    mantissa = mantissa * 16 + (digit - 1), digits = 1;
    if (point && scale > -4000000) scale -= 4; /* far beyond what an exponent can make up for */
  }
  if (!digits) return NULL;
  if (p < end && (*p == 'p' || *p == 'P')) {
    p = read_exponent(p + 1, end, &exponent);
    if (!p) return NULL;
  }
  exponent += scale;
  if (!exact || exponent < -1000 || exponent > 900) return read_slowly(text, p, out);
  *out = (double)mantissa * power_of_two(exponent); /* below 2^53 and far from the ends: exact */
  if (negative) *out = -*out;
  return p;
}

/* m * 2^shift for any m: rounds to nearest, ties to even; `more` = the true value is a little above m. */
static double round_wide(wide m, int more, int shift) {
  const uint64_t high = (uint64_t)(m >> 64), low = (uint64_t)m;
  const int bits = high ? 128 - __builtin_clzll(high) : 64 - __builtin_clzll(low), drop = bits - 53;
  uint64_t kept;
  if (drop <= 0) return ldexp((double)low, shift);
  kept = (uint64_t)(m >> drop);
  if (m >> (drop - 1) & 1) {
    const wide below = m & (((wide)1 << (drop - 1)) - 1);
    if (below || more || (kept & 1)) kept++;
  }
  return ldexp((double)kept, shift + drop);
}

/* digits * 10^exponent by whole numbers of 128 bits: exact for up to 19 digits and |exponent| <= 19. */
static double scale_exactly(uint64_t digits, int exponent) {
  const uint64_t power = whole_power_of_ten[exponent < 0 ? -exponent : exponent];
  int shift;
  wide numerator;
  if (exponent >= 0) return round_wide((wide)digits * power, 0, 0);
  shift = __builtin_clzll(digits) + 64;
  numerator = (wide)digits << shift;
  return round_wide(numerator / power, numerator % power != 0, -shift);
}

const char *swc_read_double(const char *text, const char *end, double *out) {
  const char *p = text, *start, *first, *point = NULL;
  uint64_t mantissa = 0;
  ptrdiff_t significant;
  int64_t scale = 0;
  int exponent = 0, negative = 0;
  if (p < end && (*p == '+' || *p == '-')) negative = *p++ == '-';
  if (end - p > 2 && p[0] == '0' && (p[1] == 'x' || p[1] == 'X'))
    return read_hex(text, p + 2, end, negative, out);
  /* All digits as one whole number; it overflows harmlessly when there are more than 19. */
  for (start = p; p < end && (unsigned)(*p - '0') < 10; p++)
    mantissa = mantissa * 10 + (unsigned)(*p - '0');
  significant = p - start;
  if (p < end && *p == '.') {
    for (point = ++p; p < end && (unsigned)(*p - '0') < 10; p++)
      mantissa = mantissa * 10 + (unsigned)(*p - '0');
    scale = point - p;
    significant += p - point;
  }
  if (!significant) return NULL;
  if (significant > 19) {
    for (first = start; first < p && (*first == '0' || *first == '.'); first++)
      significant -= *first == '0';
  }
  if (p < end && (*p == 'e' || *p == 'E')) {
    p = read_exponent(p + 1, end, &exponent);
    if (!p) return NULL;
  }
  scale += exponent;
  if (significant > 19 || (mantissa && (scale < -22 || scale > 22))) return read_slowly(text, p, out);
  /* One rounding when both the digits and the power of ten are exact doubles (Clinger 1990). */
  if (!mantissa)
    *out = 0.0;
  else if (mantissa <= 1ull << 53)
    *out = scale < 0 ? (double)mantissa / power_of_ten[-scale] : (double)mantissa * power_of_ten[scale];
  else if (scale >= -19 && scale <= 19)
    *out = scale_exactly(mantissa, (int)scale);
  else
    return read_slowly(text, p, out);
  if (negative) *out = -*out;
  return p;
}

const char *swc_read_integer(const char *text, const char *end, int64_t *out) {
  const char *p = text, *start;
  uint64_t value = 0;
  int negative = 0;
  if (p < end && (*p == '+' || *p == '-')) negative = *p++ == '-';
  for (start = p; p < end && (unsigned)(*p - '0') < 10; p++) {
    const unsigned digit = (unsigned)(*p - '0');
    if (value > ((uint64_t)INT64_MAX - digit) / 10) return NULL;
    value = value * 10 + digit;
  }
  if (p == start) return NULL;
  *out = negative ? -(int64_t)value : (int64_t)value;
  return p;
}

size_t swc_write_fixed6(char *out, double value) {
  const double size = fabs(value);
  uint64_t whole = (uint64_t)size;
  const uint64_t fraction = (uint64_t)ldexp(size - (double)whole, 64 - 1); /* in units of 2^-63 */
  uint64_t micro = (uint64_t)(((wide)fraction * 1000000u + ((wide)1 << 62)) >> 63);
  char digits[24];
  size_t length = 0, count = 0;
  int place;
  if (micro >= 1000000u) micro -= 1000000u, whole++;
  if (value < 0.0 && (whole || micro)) out[length++] = '-';
  do
    digits[count++] = (char)('0' + whole % 10), whole /= 10;
  while (whole);
  while (count)
    out[length++] = digits[--count];
  out[length++] = '.';
  for (place = 5; place >= 0; place--)
    out[length + (size_t)place] = (char)('0' + micro % 10), micro /= 10;
  return length + 6;
}

size_t swc_write_hex(char *out, double value) {
  static const char hex[] = "0123456789abcdef";
  uint64_t bits, fraction;
  int exponent, started = 0, divisor;
  size_t length = 0;
  memcpy(&bits, &value, sizeof bits);
  fraction = bits & 0xfffffffffffffull;
  exponent = (int)(bits >> 52 & 0x7ff);
  if (bits >> 63) out[length++] = '-';
  out[length++] = '0', out[length++] = 'x';
  out[length++] = exponent ? '1' : '0';
  if (fraction) {
    out[length++] = '.';
    for (; fraction; fraction = fraction << 4 & 0xfffffffffffffull)
      out[length++] = hex[fraction >> 48];
  }
  exponent = exponent ? exponent - 1023 : bits << 1 ? -1022 : 0;
  out[length++] = 'p';
  out[length++] = exponent < 0 ? '-' : '+';
  if (exponent < 0) exponent = -exponent;
  for (divisor = 1000; divisor; divisor /= 10)
    if (started || exponent / divisor || divisor == 1)
      out[length++] = (char)('0' + exponent / divisor % 10), started = 1;
  return length;
}
