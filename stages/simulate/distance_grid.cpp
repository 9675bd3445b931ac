// SPDX-License-Identifier: BSD-3-Clause
#include "distance_grid.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::simulate {

namespace {

constexpr double farthest_um = 1000.0;

// Lower envelope of the parabolas value[q] + ((p - q) edge)^2 at the integers p.
struct Envelope {
  std::vector<double> value, out, bound;
  std::vector<int> root;
  explicit Envelope(std::size_t n) : value(n), out(n), bound(n + 1), root(n) {}
  void transform(double edge) {
    const int n = static_cast<int>(value.size());
    const double e2 = edge * edge;
    const auto at = [&](int i) { return value[static_cast<std::size_t>(i)]; };
    int k = 0;
    root[0] = 0, bound[0] = -INFINITY, bound[1] = INFINITY;
    for (int q = 1; q < n; q++) {
      double s = 0.0;
      for (;; k--) {
        const int r = root[static_cast<std::size_t>(k)];
        s = ((at(q) - at(r)) / e2 + static_cast<double>(q) * q - static_cast<double>(r) * r) /
            (2.0 * (q - r));
        if (s > bound[static_cast<std::size_t>(k)]) break;
      }
      k++;
      root[static_cast<std::size_t>(k)] = q;
      bound[static_cast<std::size_t>(k)] = s, bound[static_cast<std::size_t>(k) + 1] = INFINITY;
    }
    k = 0;
    for (int p = 0; p < n; p++) {
      while (bound[static_cast<std::size_t>(k) + 1] < p)
        k++;
      const double d = p - root[static_cast<std::size_t>(k)];
      out[static_cast<std::size_t>(p)] = d * d * e2 + at(root[static_cast<std::size_t>(k)]);
    }
  }
};

} // namespace

std::vector<float> distance_between_centres(const DistanceGrid &grid, const std::vector<std::uint8_t> &marked,
                                            Workers &workers) {
  const std::size_t n[3] = {static_cast<std::size_t>(grid.count[0]), static_cast<std::size_t>(grid.count[1]),
                            static_cast<std::size_t>(grid.count[2])};
  std::vector<float> squared(marked.size());
  for (std::size_t v = 0; v < marked.size(); v++)
    squared[v] = marked[v] ? 0.0f : static_cast<float>(farthest_um * farthest_um);
  const std::size_t stride[3] = {1, n[0], n[0] * n[1]};
  for (int axis = 0; axis < 3; axis++) {
    const int u = (axis + 1) % 3, w = (axis + 2) % 3;
    // A periodic line stands three times in a row: its middle sees both neighbours.
    const std::size_t copies = grid.periodic[axis] ? 3 : 1, middle = grid.periodic[axis] ? n[axis] : 0;
    std::vector<Envelope> lines(workers.threads(), Envelope(n[axis] * copies));
    workers.loop(n[w], 1, [&](std::size_t j, unsigned worker) {
      Envelope &line = lines[worker];
      for (std::size_t i = 0; i < n[u]; i++) {
        float *first = &squared[i * stride[u] + j * stride[w]];
        for (std::size_t p = 0; p < n[axis] * copies; p++)
          line.value[p] = static_cast<double>(first[p % n[axis] * stride[axis]]);
        line.transform(grid.edge[axis]);
        for (std::size_t p = 0; p < n[axis]; p++)
          first[p * stride[axis]] = static_cast<float>(line.out[middle + p]);
      }
    });
  }
  for (float &d : squared)
    d = std::sqrt(d);
  return squared;
}

double squared_distance(const glm::dvec3 &p, const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c) {
  const auto to_segment = [&p](const glm::dvec3 &from, const glm::dvec3 &to) {
    const glm::dvec3 edge = to - from, at = p - from;
    const double length2 = glm::dot(edge, edge);
    const double share = length2 > 0.0 ? std::clamp(glm::dot(at, edge) / length2, 0.0, 1.0) : 0.0;
    const glm::dvec3 rest = at - share * edge;
    return glm::dot(rest, rest);
  };
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double area2 = glm::dot(normal, normal);
  if (area2 > 0.0 && glm::dot(glm::cross(b - a, p - a), normal) >= 0.0 &&
      glm::dot(glm::cross(c - b, p - b), normal) >= 0.0 &&
      glm::dot(glm::cross(a - c, p - c), normal) >= 0.0) {
    const double height = glm::dot(p - a, normal);
    return height * height / area2;
  }
  return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

} // namespace conceg::simulate
