// SPDX-License-Identifier: BSD-3-Clause
#include "distance.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace conceg::relax {

namespace {

double clamp01(double x) {
  return x < 0 ? 0 : x > 1 ? 1 : x;
}

// The parameter t of the cone at which |p - q(t)| - r(t) is smallest.
double nearest_on_cone(const glm::dvec3 &p, const RoundCone &cone) {
  const glm::dvec3 axis = cone.b - cone.a, from = p - cone.a;
  const double length2 = glm::dot(axis, axis), slope = cone.radius_b - cone.radius_a;
  if (length2 <= slope * slope) return slope > 0 ? 1 : 0; // one end ball holds the other
  const double along = glm::dot(from, axis);              // X l
  const double across2 = std::max(0.0, glm::dot(from, from) - along * along / length2);
  // t = (X + Y s / sqrt(1 - s^2)) / l with s = slope / l
  return clamp01((along + slope * std::sqrt(across2 * length2 / (length2 - slope * slope))) / length2);
}

double gap_at(const RoundCone &first, const RoundCone &second, double s, double t) {
  const glm::dvec3 p = first.a + s * (first.b - first.a), q = second.a + t * (second.b - second.a);
  return glm::distance(p, q) - (first.radius_a + s * (first.radius_b - first.radius_a)) -
         (second.radius_a + t * (second.radius_b - second.radius_a));
}

// Slope in s of the gap that remains when t is chosen best.
double slope_at(const RoundCone &first, const RoundCone &second, double s) {
  const glm::dvec3 axis = first.b - first.a, p = first.a + s * axis;
  const double t = nearest_on_cone(p, second);
  const glm::dvec3 difference = p - (second.a + t * (second.b - second.a));
  const double distance = glm::length(difference);
  return (distance > 0 ? glm::dot(difference, axis) / distance : 0.0) - (first.radius_b - first.radius_a);
}

} // namespace

Closest closest_axes(const RoundCone &first, const RoundCone &second) {
  const glm::dvec3 u = first.b - first.a, v = second.b - second.a, w = first.a - second.a;
  const double uu = glm::dot(u, u), vv = glm::dot(v, v), uv = glm::dot(u, v), uw = glm::dot(u, w),
               vw = glm::dot(v, w);
  double s = 0, t = 0;
  if (uu > 0 && vv > 0) {
    const double determinant = uu * vv - uv * uv;
    // For (nearly) parallel axes any s will do: take the one that faces the middle of the other axis.
    s = determinant > 1e-9 * uu * vv ? clamp01((uv * vw - vv * uw) / determinant)
                                     : clamp01((0.5 * uv - uw) / uu);
    t = (uv * s + vw) / vv;
    if (t < 0)
      t = 0, s = clamp01(-uw / uu);
    else if (t > 1)
      t = 1, s = clamp01((uv - uw) / uu);
  } else if (uu > 0) {
    s = clamp01(-uw / uu);
  } else if (vv > 0) {
    t = clamp01(vw / vv);
  }
  return {s, t, gap_at(first, second, s, t)};
}

namespace {

// How far below the gap at (s, t) the smallest gap can be: the gap is convex, so no less than its tangent
// plane.
double most_below(const RoundCone &first, const RoundCone &second, double s, double t) {
  const glm::dvec3 u = first.b - first.a, v = second.b - second.a;
  const glm::dvec3 apart = first.a + s * u - (second.a + t * v);
  const double distance = glm::length(apart);
  if (!(distance > 0)) return std::numeric_limits<double>::infinity();
  const double in_s = glm::dot(apart, u) / distance - (first.radius_b - first.radius_a);
  const double in_t = -glm::dot(apart, v) / distance - (second.radius_b - second.radius_a);
  return std::max(in_s * s, in_s * (s - 1)) + std::max(in_t * t, in_t * (t - 1));
}

// False position on the slope in s, t chosen best for each s.
Closest by_false_position(const RoundCone &first, const RoundCone &second) {
  double low = 0, high = 1, s;
  double slope_low = slope_at(first, second, 0), slope_high = slope_at(first, second, 1);
  if (slope_low >= 0)
    s = 0;
  else if (slope_high <= 0)
    s = 1;
  else {
    // Illinois false position on the monotone slope, with halving when it stalls.
    for (int round = 0; round < 60 && high - low > 1e-10; round++) {
      s = round % 3 == 2 ? 0.5 * (low + high)
                         : (low * slope_high - high * slope_low) / (slope_high - slope_low);
      if (!(s > low && s < high)) s = 0.5 * (low + high);
      const double slope = slope_at(first, second, s);
      if (slope == 0) {
        low = high = s;
      } else if (slope < 0) {
        low = s, slope_low = slope, slope_high *= 0.5;
      } else {
        high = s, slope_high = slope, slope_low *= 0.5;
      }
    }
    s = 0.5 * (low + high);
  }
  const double t = nearest_on_cone(first.a + s * (first.b - first.a), second);
  Closest best = {s, t, gap_at(first, second, s, t)};
  const Closest axes = closest_axes(first, second);
  return axes.gap < best.gap ? axes : best;
}

} // namespace

Closest closest_cones(const RoundCone &first, const RoundCone &second) {
  constexpr double enough = 1e-10; // um
  constexpr int rounds = 6;
  // From the closest points of the axes, each parameter in turn: most pairs are done in two rounds.
  Closest at = closest_axes(first, second);
  for (int round = 0; round < rounds; round++) {
    if (most_below(first, second, at.s, at.t) <= enough) return at;
    at.t = nearest_on_cone(first.a + at.s * (first.b - first.a), second);
    at.s = nearest_on_cone(second.a + at.t * (second.b - second.a), first);
    at.gap = gap_at(first, second, at.s, at.t);
  }
  return by_false_position(first, second);
}

} // namespace conceg::relax
