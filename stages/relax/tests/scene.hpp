// SPDX-License-Identifier: BSD-3-Clause
// Small scenes for the tests of relax.
#pragma once

#include "../separate.hpp"

#include "conceg/rng.h"

#include <glm/geometric.hpp>

namespace scene {

inline conceg_box box_of(double size, bool periodic = true) {
  conceg_box box = {};
  for (int a = 0; a < 3; a++)
    box.hi[a] = size, box.periodic[a] = periodic;
  return box;
}

// A cell without a soma (radius 0): a straight chain of `count` points.
inline void add_cable(conceg::relax::Skeletons &s, const glm::dvec3 &start, const glm::dvec3 &step, int count,
                      float radius) {
  if (s.cell_offset.empty()) s.cell_offset.push_back(0);
  for (int i = 0; i < count; i++) {
    s.position.push_back(start + static_cast<double>(i) * step);
    s.radius.push_back(0.6f * radius), s.target_radius.push_back(radius), s.parent.push_back(i - 1);
  }
  s.cell_offset.push_back(s.position.size());
  s.soma.push_back(start), s.soma_radius.push_back(0);
}

inline glm::dvec3 direction(conceg_rng &rng) {
  glm::dvec3 d(0);
  do
    d = 2.0 * glm::dvec3{conceg_rng_uniform(&rng), conceg_rng_uniform(&rng), conceg_rng_uniform(&rng)} - 1.0;
  while (glm::length(d) > 1 || glm::length(d) < 0.1);
  return glm::normalize(d);
}

// Cells with a soma and random branching trees that pay no heed to each other and leave the box.
inline conceg::relax::Skeletons random_cells(std::uint64_t seed, int cells, int points, double size,
                                             float soma_radius, float radius) {
  conceg::relax::Skeletons s;
  s.cell_offset.push_back(0);
  for (int cell = 0; cell < cells; cell++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.relax", static_cast<std::uint64_t>(cell));
    const glm::dvec3 soma =
        size * glm::dvec3{conceg_rng_uniform(&rng), conceg_rng_uniform(&rng), conceg_rng_uniform(&rng)};
    s.soma.push_back(soma), s.soma_radius.push_back(soma_radius);
    const std::size_t first = s.position.size();
    glm::dvec3 heading = direction(rng);
    for (int i = 0; i < points; i++) {
      std::int64_t parent = i - 1;
      if (i % 40 == 0)
        parent = i % 120 == 0
                     ? -1
                     : static_cast<std::int64_t>(conceg_rng_below(&rng, static_cast<std::uint64_t>(i)));
      if (i % 40 == 0) heading = direction(rng);
      heading = glm::normalize(heading + 0.3 * direction(rng));
      const glm::dvec3 from = parent < 0
                                  ? soma + static_cast<double>(soma_radius) * heading
                                  : s.position[first + static_cast<std::size_t>(parent)] + 0.7 * heading;
      s.position.push_back(from), s.parent.push_back(parent);
      const auto target = static_cast<float>(radius * (0.7 + 0.6 * conceg_rng_uniform(&rng)));
      s.target_radius.push_back(target), s.radius.push_back(0.6f * target);
    }
    s.cell_offset.push_back(s.position.size());
  }
  return s;
}

inline std::vector<conceg::relax::Pair> find(const conceg::relax::Bodies &bodies, const conceg_box &box,
                                             double reach, unsigned threads = 2) {
  conceg::Workers workers(threads);
  conceg::relax::Collider collider(threads);
  return collider.find(bodies, bodies.radius, box, reach, workers).pairs;
}

} // namespace scene
