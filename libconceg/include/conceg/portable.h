/* SPDX-License-Identifier: BSD-3-Clause
 * Elementary functions with the same bits on every CPU. The C library picks variants with and without fused
 * multiply-add at run time, which differ in the last bit; anything that decides about the tissue uses these
 * instead. Relative error below 1e-15 in the ranges stated. Header-only; any thread. */
#ifndef CONCEG_PORTABLE_H
#define CONCEG_PORTABLE_H

#include <stdint.h>
#include <string.h>

/* 2 to the power of `exponent`, which must be from -1022 to 1023. */
static inline double conceg_pow2i(int exponent) {
  const uint64_t bits = (uint64_t)(exponent + 1023) << 52;
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/* e^x; 0 below -700 and capped above 700. */
static inline double conceg_exp(double x) {
  double k, r, sum = 1.0;
  int i;
  if (!(x > -700.0)) return x == x ? 0.0 : x;
  if (x > 700.0) x = 700.0;
  k = __builtin_floor(x * 1.44269504088896340736 + 0.5);
  r = (x - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
  for (i = 14; i > 0; i--)
    sum = 1.0 + sum * r / i;
  return sum * conceg_pow2i((int)k);
}

/* Natural logarithm of a normal number x > 0; -745 for 0 or below. */
static inline double conceg_log(double x) {
  uint64_t bits;
  double m, s, s2, sum = 0.0;
  int exponent, i;
  if (!(x > 0.0)) return x == x ? -745.0 : x;
  memcpy(&bits, &x, sizeof bits);
  exponent = (int)(bits >> 52) - 1023;
  bits = (bits & 0xfffffffffffffull) | 0x3ff0000000000000ull;
  memcpy(&m, &bits, sizeof m);
  if (m > 1.41421356237309504880) m *= 0.5, exponent++;
  s = (m - 1.0) / (m + 1.0), s2 = s * s;
  for (i = 23; i > 1; i -= 2)
    sum = (sum + 1.0 / i) * s2;
  return exponent * 6.93147180369123816490e-01 +
         (2.0 * s * (1.0 + sum) + exponent * 1.90821492927058770002e-10);
}

/* Sine and cosine for |x| < 1e5. */
static inline void conceg_sincos(double x, double *sine, double *cosine) {
  const double n = __builtin_floor(x * 0.63661977236758134308 + 0.5);
  const double r = ((x - n * 1.57079632673412561417e+00) - n * 6.07710050630396597660e-11) -
                   n * 2.02226624879595063154e-21;
  const double r2 = r * r;
  double s = 1.0, c = 1.0;
  int i;
  for (i = 18; i > 1; i -= 2)
    s = 1.0 - s * r2 / (double)(i * (i + 1));
  for (i = 19; i > 0; i -= 2)
    c = 1.0 - c * r2 / (double)(i * (i + 1));
  s *= r;
  switch ((int)((int64_t)n & 3)) {
  case 0:
    *sine = s, *cosine = c;
    break;
  case 1:
    *sine = c, *cosine = -s;
    break;
  case 2:
    *sine = -s, *cosine = -c;
    break;
  default:
    *sine = -c, *cosine = s;
    break;
  }
}
static inline double conceg_sin(double x) {
  double s, c;
  conceg_sincos(x, &s, &c);
  return s;
}
static inline double conceg_cos(double x) {
  double s, c;
  conceg_sincos(x, &s, &c);
  return c;
}

/* Arc tangent in radians, from -pi/2 to pi/2. */
static inline double conceg_atan(double x) {
  double y = x < 0.0 ? -x : x, y2, sum = 0.0, value;
  const int inverted = y > 1.0;
  int i;
  if (inverted) y = 1.0 / y;
  y = y / (1.0 + __builtin_sqrt(1.0 + y * y));
  y = y / (1.0 + __builtin_sqrt(1.0 + y * y));
  y2 = y * y;
  for (i = 27; i > 1; i -= 2)
    sum = -y2 * (1.0 / i + sum);
  value = 4.0 * y * (1.0 + sum);
  if (inverted) value = 1.57079632679489661923 - value;
  return x < 0.0 ? -value : value;
}

/* Angle of (x, y) in (-pi, pi]; 0 for (0, 0). */
static inline double conceg_atan2(double y, double x) {
  if (x > 0.0) return conceg_atan(y / x);
  if (x < 0.0) return conceg_atan(y / x) + (y < 0.0 ? -3.14159265358979323846 : 3.14159265358979323846);
  return y > 0.0 ? 1.57079632679489661923 : y < 0.0 ? -1.57079632679489661923 : 0.0;
}

/* Arc cosine; the argument is clamped to [-1, 1]. */
static inline double conceg_acos(double x) {
  if (x > 1.0) x = 1.0;
  if (x < -1.0) x = -1.0;
  return conceg_atan2(__builtin_sqrt((1.0 - x) * (1.0 + x)), x);
}

/* x^y for x > 0. */
static inline double conceg_pow(double x, double y) {
  return conceg_exp(y * conceg_log(x));
}

#endif
