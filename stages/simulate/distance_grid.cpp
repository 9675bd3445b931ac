// SPDX-License-Identifier: BSD-3-Clause
#include "distance_grid.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::simulate {

namespace {

// Lower envelope of the parabolas value[q] + (p - q)^2 at the integers p, in squared edges; of those below
// the limit only, and cut there.
struct Envelope {
  std::vector<double> value, out, bound, half_inverse;
  std::vector<int> root;
  explicit Envelope(std::size_t n) : value(n), out(n), bound(n + 1), half_inverse(n), root(n) {
    for (std::size_t d = 1; d < n; d++)
      half_inverse[d] = 0.5 / static_cast<double>(d);
  }
  void transform(double limit) {
    const std::size_t n = value.size();
    std::size_t roots = 0;
    for (std::size_t q = 0; q < n; q++) {
      if (!(value[q] < limit)) continue;
      const double mine = value[q] + static_cast<double>(q) * static_cast<double>(q);
      double s = -INFINITY;
      for (; roots > 0; roots--) {
        const auto r = static_cast<std::size_t>(root[roots - 1]);
        s = (mine - value[r] - static_cast<double>(r) * static_cast<double>(r)) * half_inverse[q - r];
        if (s > bound[roots - 1]) break;
      }
      if (roots == 0) s = -INFINITY;
      bound[roots] = s, root[roots++] = static_cast<int>(q);
    }
    bound[roots] = INFINITY;
    for (std::size_t p = 0, k = 0; p < n; p++) {
      if (roots == 0) {
        out[p] = limit;
        continue;
      }
      while (bound[k + 1] < static_cast<double>(p))
        k++;
      const double d = static_cast<double>(p) - root[k];
      out[p] = std::min(limit, d * d + value[static_cast<std::size_t>(root[k])]);
    }
  }
};

} // namespace

std::vector<float> distance_between_centres(const DistanceGrid &grid, const std::vector<std::uint8_t> &marked,
                                            double farthest_um, Workers &workers) {
  const std::size_t n[3] = {static_cast<std::size_t>(grid.count[0]), static_cast<std::size_t>(grid.count[1]),
                            static_cast<std::size_t>(grid.count[2])};
  const auto limit = static_cast<float>(farthest_um * farthest_um);
  std::vector<float> squared(marked.size());
  for (std::size_t v = 0; v < marked.size(); v++)
    squared[v] = marked[v] ? 0.0f : limit;
  const std::size_t stride[3] = {1, n[0], n[0] * n[1]};
  for (int axis = 0; axis < 3; axis++) {
    const int u = axis == 0 ? 1 : 0, w = axis == 2 ? 1 : 2; // what is near in memory one after the other
    // A periodic line goes on at both ends as far as it can matter.
    const std::size_t far = static_cast<std::size_t>(farthest_um / grid.edge[axis]) + 1;
    const std::size_t more = grid.periodic[axis] ? std::min(n[axis], far) : 0, first_at = n[axis] - more;
    const double square = grid.edge[axis] * grid.edge[axis], to_edges = 1.0 / square;
    std::vector<Envelope> lines(workers.threads(), Envelope(n[axis] + 2 * more));
    workers.loop(n[w], 1, [&](std::size_t j, unsigned worker) {
      Envelope &line = lines[worker];
      for (std::size_t i = 0; i < n[u]; i++) {
        float *first = &squared[i * stride[u] + j * stride[w]];
        for (std::size_t p = 0, at = first_at % n[axis]; p < line.value.size(); p++) {
          line.value[p] = to_edges * static_cast<double>(first[at * stride[axis]]);
          if (++at == n[axis]) at = 0;
        }
        line.transform(to_edges * static_cast<double>(limit));
        for (std::size_t p = 0; p < n[axis]; p++)
          first[p * stride[axis]] = static_cast<float>(square * line.out[more + p]);
      }
    });
  }
  for (float &d : squared)
    d = std::sqrt(d);
  return squared;
}

// By the region of the triangle's plane that the point lies over (Ericson, Real-Time Collision
// Detection, 5.1.5).
glm::dvec3 nearest_point(const glm::dvec3 &p, const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const double ab_a = glm::dot(ab, ap), ac_a = glm::dot(ac, ap);
  if (ab_a <= 0.0 && ac_a <= 0.0) return a;
  const glm::dvec3 bp = p - b;
  const double ab_b = glm::dot(ab, bp), ac_b = glm::dot(ac, bp);
  if (ab_b >= 0.0 && ac_b <= ab_b) return b;
  const double over_ab = ab_a * ac_b - ab_b * ac_a;
  if (over_ab <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0 && ab_a > ab_b) return a + ab_a / (ab_a - ab_b) * ab;
  const glm::dvec3 cp = p - c;
  const double ab_c = glm::dot(ab, cp), ac_c = glm::dot(ac, cp);
  if (ac_c >= 0.0 && ab_c <= ac_c) return c;
  const double over_ac = ab_c * ac_a - ab_a * ac_c;
  if (over_ac <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0 && ac_a > ac_c) return a + ac_a / (ac_a - ac_c) * ac;
  const double over_bc = ab_b * ac_c - ab_c * ac_b, to_c = ac_b - ab_b, to_b = ab_c - ac_c;
  if (over_bc <= 0.0 && to_c >= 0.0 && to_b >= 0.0 && to_c + to_b > 0.0)
    return b + to_c / (to_c + to_b) * (c - b);
  const double whole = over_ab + over_ac + over_bc;
  return whole > 0.0 ? a + (over_ac / whole) * ab + (over_ab / whole) * ac : a;
}

double squared_distance(const glm::dvec3 &p, const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c) {
  const glm::dvec3 way = p - nearest_point(p, a, b, c);
  return glm::dot(way, way);
}

} // namespace conceg::simulate
