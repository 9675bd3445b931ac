// SPDX-License-Identifier: BSD-3-Clause
#include "distance.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::mesh {
namespace {

double clamp01(double t) {
  return t < 0 ? 0 : t > 1 ? 1 : t;
}

NearestPoints of_segments(const glm::dvec3 &p, const glm::dvec3 &p1, const glm::dvec3 &q,
                          const glm::dvec3 &q1) {
  const glm::dvec3 u = p1 - p, v = q1 - q, w = p - q;
  const double a = glm::dot(u, u), b = glm::dot(u, v), c = glm::dot(v, v), d = glm::dot(u, w),
               e = glm::dot(v, w);
  const double denominator = a * c - b * b;
  double s = denominator > 1e-14 * a * c ? clamp01((b * e - c * d) / denominator) : 0;
  double t = c > 0 ? (b * s + e) / c : 0;
  if (t < 0 || t > 1) {
    t = clamp01(t);
    s = a > 0 ? clamp01((b * t - d) / a) : 0;
  }
  return {p + s * u, q + t * v};
}

double distance2(const NearestPoints &n) {
  return glm::dot(n.on_a - n.on_b, n.on_a - n.on_b);
}

// Ericson, Real-Time Collision Detection, section 5.1.5.
glm::dvec3 nearest_point(const glm::dvec3 &p, const Corners &t) {
  const glm::dvec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return t[0];
  const glm::dvec3 bp = p - t[1];
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return t[0] + ab * (d1 / (d1 - d3));
  const glm::dvec3 cp = p - t[2];
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return t[0] + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return t[1] + (t[2] - t[1]) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double scale = 1 / (va + vb + vc);
  return t[0] + ab * (vb * scale) + ac * (vc * scale);
}

} // namespace

double point_triangle_distance2(const glm::dvec3 &p, const Corners &t) {
  const glm::dvec3 gap = p - nearest_point(p, t);
  return glm::dot(gap, gap);
}

double triangle_distance2(const Corners &a, const Corners &b) {
  double least = point_triangle_distance2(a[0], b);
  for (int i = 1; i < 3; i++)
    least = std::min(least, point_triangle_distance2(a[i], b));
  for (int i = 0; i < 3; i++)
    least = std::min(least, point_triangle_distance2(b[i], a));
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      least = std::min(least, distance2(of_segments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3])));
  return least;
}

NearestPoints nearest_points(const Corners &a, const Corners &b) {
  NearestPoints best{a[0], nearest_point(a[0], b)};
  const auto look = [&](const NearestPoints &n) {
    if (distance2(n) < distance2(best)) best = n;
  };
  for (int i = 0; i < 3; i++) {
    look({a[i], nearest_point(a[i], b)}), look({nearest_point(b[i], a), b[i]});
    for (int j = 0; j < 3; j++)
      look(of_segments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return best;
}

} // namespace conceg::mesh
