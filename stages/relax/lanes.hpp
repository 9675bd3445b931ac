// SPDX-License-Identifier: BSD-3-Clause
// Elements in single precision, four at a time: what the forces are worked out with. The exact tests at the
// end know nothing of it.
#pragma once

#include "chains.hpp"
#include "parallel.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::relax {

using Lanes = float __attribute__((vector_size(16)));
using Mask = std::int32_t __attribute__((vector_size(16))); // -1 = yes

inline Lanes all(float x) {
  return Lanes{x, x, x, x};
}
inline Lanes choose(Mask yes, Lanes x, Lanes y) {
  return reinterpret_cast<Lanes>((yes & reinterpret_cast<Mask>(x)) | (~yes & reinterpret_cast<Mask>(y)));
}
inline Lanes least(Lanes x, Lanes y) {
  return choose(x < y, x, y);
}
inline Lanes most(Lanes x, Lanes y) {
  return choose(x > y, x, y);
}
inline Lanes clamp01(Lanes x) {
  return least(most(x, all(0)), all(1));
}
inline Lanes root(Lanes x) {
  return __builtin_ia32_sqrtps(x);
}
struct Vec {
  Lanes x, y, z;
};
inline Vec operator+(const Vec &p, const Vec &q) {
  return {p.x + q.x, p.y + q.y, p.z + q.z};
}
inline Vec operator-(const Vec &p, const Vec &q) {
  return {p.x - q.x, p.y - q.y, p.z - q.z};
}
inline Vec operator*(Lanes k, const Vec &p) {
  return {k * p.x, k * p.y, k * p.z};
}
inline Lanes dot(const Vec &p, const Vec &q) {
  return p.x * q.x + p.y * q.y + p.z * q.z;
}
inline Vec cross(const Vec &p, const Vec &q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

// Four capsules: axis a + s u, radius r + s dr, and 1 where both ends are pinned.
struct Four {
  Vec a, u;
  Lanes r, dr, pinned;
};

// Balls around four capsules.
struct FourBalls {
  Vec middle;
  Lanes radius;
};

inline Lanes spread(Lanes x, std::uint32_t lane) {
  return all(x[lane]);
}

// All elements by chunks, seen from the corner of the box with each chunk lifted into it. Lanes beyond a
// chunk's count are 0.
class LaneBodies {
public:
  void fill(const Bodies &bodies, const std::vector<glm::ivec3> &chunk_lift, const conceg_box &box,
            Workers &workers);
  const Four &run(std::uint32_t chunk) const { return four_[chunk]; }
  const FourBalls &balls(std::uint32_t chunk) const { return balls_[chunk]; }
  // One element, four times.
  Four one(std::uint32_t chunk, std::uint32_t lane) const {
    const Four &f = four_[chunk];
    const auto x = [lane](Lanes v) { return spread(v, lane); };
    return {{x(f.a.x), x(f.a.y), x(f.a.z)}, {x(f.u.x), x(f.u.y), x(f.u.z)}, x(f.r), x(f.dr), x(f.pinned)};
  }
  FourBalls ball(std::uint32_t chunk, std::uint32_t lane) const {
    const FourBalls &f = balls_[chunk];
    const auto x = [lane](Lanes v) { return spread(v, lane); };
    return {{x(f.middle.x), x(f.middle.y), x(f.middle.z)}, x(f.radius)};
  }

private:
  std::vector<Four> four_;
  std::vector<FourBalls> balls_;
};

// Closest points of the axes, the vector between them (second to first), its length and the gap there.
struct FourClosest {
  Lanes s, t, distance, gap, radius_first, radius_second;
  Vec apart;
};

// The second one lifted by `shift`. Swapping the two negates the result bit by bit when shift is 0.
inline FourClosest closest(const Four &first, const Four &second, const Vec &shift) {
  const Lanes tiny = all(1e-20f);
  const Vec w = (first.a - second.a) - shift;
  const Lanes uu = most(dot(first.u, first.u), tiny), vv = most(dot(second.u, second.u), tiny);
  const Lanes uv = dot(first.u, second.u), uw = dot(first.u, w), vw = dot(second.u, w);
  const Lanes determinant = uu * vv - uv * uv;
  // For (nearly) parallel axes any s will do: take the one that faces the middle of the other axis.
  const Mask skew = determinant > all(1e-5f) * uu * vv;
  const Lanes above = choose(skew, uv * vw - vv * uw, all(0.5f) * uv - uw);
  FourClosest out;
  out.s = clamp01(above / choose(skew, determinant, uu));
  out.t = clamp01((uv * out.s + vw) / vv);
  out.s = clamp01((uv * out.t - uw) / uu);
  out.apart = (w + out.s * first.u) - out.t * second.u;
  out.distance = root(dot(out.apart, out.apart));
  out.radius_first = first.r + out.s * first.dr;
  out.radius_second = second.r + out.t * second.dr;
  out.gap = out.distance - out.radius_first - out.radius_second;
  return out;
}

} // namespace conceg::relax
