// SPDX-License-Identifier: BSD-3-Clause
#include "draws.hpp"

#include <cmath>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

// Wider registers where the machine has them; the same bits, as nothing is contracted.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&     \
    !defined(__SANITIZE_THREAD__)
#define WIDE __attribute__((target_clones("avx2", "default"), optimize("O3")))
#else
#define WIDE
#endif

namespace conceg::simulate {

namespace {

constexpr double half_pi = 1.57079632679489661923;

// Sine and cosine for |x| <= pi/2, absolute error below 1e-13 (Taylor).
inline void sine_cosine(double x, double &sine, double &cosine) {
  const double y = x * x;
  sine = x * (1.0 + y * (-1.0 / 6 +
                         y * (1.0 / 120 +
                              y * (-1.0 / 5040 +
                                   y * (1.0 / 362880 + y * (-1.0 / 39916800 +
                                                            y * (1.0 / 6227020800.0 +
                                                                 y * (-1.0 / 1307674368000.0 +
                                                                      y * (1.0 / 355687428096000.0)))))))));
  cosine =
      1.0 +
      y * (-0.5 + y * (1.0 / 24 +
                       y * (-1.0 / 720 +
                            y * (1.0 / 40320 +
                                 y * (-1.0 / 3628800 + y * (1.0 / 479001600 +
                                                            y * (-1.0 / 87178291200.0 +
                                                                 y * (1.0 / 20922789888000.0 +
                                                                      y * (-1.0 / 6402373705728000.0)))))))));
}

// Low and high half of a draw as integers below 2^31, so that the conversion to double is a signed one.
inline double low_half(std::uint64_t bits) {
  return static_cast<double>(
      static_cast<std::int32_t>(static_cast<std::uint32_t>(bits))); // -2^31 .. 2^31 - 1
}
inline double high_half(std::uint64_t bits) {
  return static_cast<double>(static_cast<std::int32_t>(static_cast<std::uint32_t>(bits >> 32)));
}

typedef std::uint64_t TwoWords __attribute__((vector_size(16)));
// Of the low 32 bits of each, the upper being zero.
inline TwoWords product(const TwoWords &words, std::uint32_t factor) {
#if defined(__SSE2__)
  return reinterpret_cast<TwoWords>(
      _mm_mul_epu32(reinterpret_cast<__m128i>(words), _mm_set1_epi64x(static_cast<long long>(factor))));
#else
  return words * TwoWords{factor, factor};
#endif
}

} // namespace

// Philox4x32-10. Two blocks in a register, each word in 64 bits, so that a product is one instruction;
// several registers at a time hide its latency.
void fill_bits(conceg_rng &rng, std::uint64_t bits[draw_block]) {
  constexpr std::size_t registers = 2, blocks = 2 * registers;
  const TwoWords low = {0xffffffffu, 0xffffffffu};
  for (std::size_t at = 0; at < draw_block / 2; at += blocks) {
    TwoWords c0[registers], c1[registers], c2[registers], c3[registers];
    for (std::size_t r = 0; r < registers; r++) {
      const std::uint64_t first = rng.counter + at + 2 * r;
      c0[r] = TwoWords{first, first + 1} & low, c1[r] = TwoWords{first, first + 1} >> 32;
      c2[r] = TwoWords{rng.id[0], rng.id[0]}, c3[r] = TwoWords{rng.id[1], rng.id[1]};
    }
    std::uint32_t k0 = rng.key[0], k1 = rng.key[1];
    for (int round = 0; round < 10; round++) {
      const TwoWords key0 = {k0, k0}, key1 = {k1, k1};
      for (std::size_t r = 0; r < registers; r++) {
        const TwoWords p0 = product(c0[r], 0xD2511F53u), p1 = product(c2[r], 0xCD9E8D57u);
        c0[r] = (p1 >> 32) ^ c1[r] ^ key0, c1[r] = p1 & low;
        c2[r] = (p0 >> 32) ^ c3[r] ^ key1, c3[r] = p0 & low;
      }
      k0 += 0x9E3779B9u, k1 += 0xBB67AE85u;
    }
    for (std::size_t r = 0; r < registers; r++) {
      const TwoWords first = c1[r] << 32 | c0[r], second = c3[r] << 32 | c2[r];
      for (std::size_t lane = 0; lane < 2; lane++)
        bits[2 * (at + 2 * r + lane)] = first[lane], bits[2 * (at + 2 * r + lane) + 1] = second[lane];
    }
  }
  rng.counter += draw_block / 2;
}

WIDE void fill_directions(const std::uint64_t bits[draw_block], double x[draw_block], double y[draw_block],
                          double z[draw_block]) {
  for (std::size_t i = 0; i < draw_block; i++) {
    const double height = (low_half(bits[i]) + 0.5) * 0x1p-31,
                 half_angle = (high_half(bits[i]) + 0.5) * (0x1p-31 * half_pi);
    double s = 0.0, c = 0.0;
    sine_cosine(half_angle, s, c);
    const double radius = std::sqrt((1.0 - height) * (1.0 + height));
    x[i] = radius * (1.0 - 2.0 * s * s), y[i] = radius * (2.0 * s * c), z[i] = height;
  }
}

// Box-Muller: sqrt(-2 ln u) (cos a, sin a), u in (0, 1], a in (-pi, pi).
WIDE void fill_normals(const std::uint64_t bits[draw_block], double normal[2 * draw_block]) {
  double length[draw_block];
  for (std::size_t i = 0; i < draw_block; i++)
    length[i] = std::sqrt(-2.0 * conceg_log((low_half(bits[i]) + (2147483648.0 + 0.5)) * 0x1p-32));
  for (std::size_t i = 0; i < draw_block; i++) {
    double s = 0.0, c = 0.0;
    sine_cosine((high_half(bits[i]) + 0.5) * (0x1p-31 * half_pi), s, c);
    normal[2 * i] = length[i] * (1.0 - 2.0 * s * s), normal[2 * i + 1] = length[i] * (2.0 * s * c);
  }
}

} // namespace conceg::simulate
