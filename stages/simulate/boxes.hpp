// SPDX-License-Identifier: BSD-3-Clause
// Boxes around faces, in bytes, eight at a time: which of them does a move meet?
#pragma once

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

#if defined(__SSE4_1__)
#include <smmintrin.h>
#endif

namespace conceg::simulate {

// Coordinates from a voxel's centre as bytes below 255: all within `span` of it, rounded down. Two intervals
// that meet do so in bytes as well, as rounding keeps order; what lies beyond the span is taken to its end.
struct ByteScale {
  glm::dvec3 span{1.0}, steps{1.0}; // um; bytes per um
  explicit ByteScale(const glm::dvec3 &span_um) : span(span_um), steps(254.99 / (2.0 * span_um)) {}
  ByteScale() = default;
  int byte(int axis, double from_centre) const {
    return static_cast<int>(std::clamp((from_centre + span[axis]) * steps[axis], 0.0, 254.0));
  }
};

// What a move is asked about: the box of its two ends.
struct ByteMove {
#if defined(__SSE4_1__)
  __m128i end[3]; // per axis, eight times: the upper end, then 255 - the lower one
  ByteMove(const ByteScale &scale, const glm::dvec3 &from, const glm::dvec3 &to) {
    const auto bytes = [&scale](const glm::dvec3 &p) {
      const __m128d xy = _mm_mul_pd(_mm_set_pd(p.y + scale.span.y, p.x + scale.span.x),
                                    _mm_set_pd(scale.steps.y, scale.steps.x)),
                    z = _mm_set_sd((p.z + scale.span.z) * scale.steps.z);
      return _mm_unpacklo_epi64(_mm_cvttpd_epi32(xy), _mm_cvttpd_epi32(z));
    };
    const __m128i a = bytes(from), b = bytes(to);
    // x y z of the upper end, then of the lower one, which is turned; packing clamps.
    const __m128i words = _mm_packs_epi32(_mm_max_epi32(a, b), _mm_min_epi32(a, b));
    const __m128i both = _mm_xor_si128(_mm_min_epu8(_mm_packus_epi16(words, words), _mm_set1_epi8(-2)),
                                       _mm_set_epi32(0, 0, -1, 0));
    const __m128i eight = _mm_set_epi64x(0x0404040404040404, 0);
    for (int axis = 0; axis < 3; axis++)
      end[axis] = _mm_shuffle_epi8(both, _mm_add_epi8(eight, _mm_set1_epi8(static_cast<char>(axis))));
  }
#else
  std::uint8_t end[3][16];
  ByteMove(const ByteScale &scale, const glm::dvec3 &from, const glm::dvec3 &to) {
    for (int axis = 0; axis < 3; axis++) {
      const int low = scale.byte(axis, std::min(from[axis], to[axis])),
                high = scale.byte(axis, std::max(from[axis], to[axis]));
      for (int k = 0; k < 8; k++)
        end[axis][k] = static_cast<std::uint8_t>(high),
        end[axis][8 + k] = static_cast<std::uint8_t>(255 - low);
    }
  }
#endif
};

// Boxes of eight faces. Cleared, their lower ends are above all others: no move meets them.
struct alignas(16) EightBoxes {
  std::uint8_t end[3][16]; // per axis: lower ends, then 255 - upper ends
  static constexpr std::uint32_t none = ~0u;
  std::uint32_t face[8];
  void clear() {
    std::fill(&end[0][0], &end[0][0] + sizeof end, std::uint8_t{255});
    std::fill(face, face + 8, none);
  }
  void set(int k, std::uint32_t f, const ByteScale &scale, const glm::dvec3 &low, const glm::dvec3 &high) {
    face[k] = f;
    for (int axis = 0; axis < 3; axis++)
      end[axis][k] = static_cast<std::uint8_t>(scale.byte(axis, low[axis])),
      end[axis][8 + k] = static_cast<std::uint8_t>(255 - scale.byte(axis, high[axis]));
  }
  // Bit k: the move's box meets that of face k.
  unsigned met(const ByteMove &move) const {
#if defined(__SSE4_1__)
    __m128i all = _mm_set1_epi8(-1);
    for (int axis = 0; axis < 3; axis++) {
      const __m128i box = _mm_load_si128(reinterpret_cast<const __m128i *>(end[axis]));
      all = _mm_and_si128(all, _mm_cmpeq_epi8(_mm_min_epu8(box, move.end[axis]), box));
    }
    const unsigned bits = static_cast<unsigned>(_mm_movemask_epi8(all));
    return bits & bits >> 8;
#else
    unsigned bits = 0;
    for (int k = 0; k < 8; k++) {
      bool meets = true;
      for (int axis = 0; axis < 3; axis++)
        meets = meets && end[axis][k] <= move.end[axis][k] && end[axis][8 + k] <= move.end[axis][8 + k];
      bits |= meets ? 1u << k : 0u;
    }
    return bits;
#endif
  }
};

} // namespace conceg::simulate
