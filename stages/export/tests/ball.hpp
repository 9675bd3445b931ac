// SPDX-License-Identifier: BSD-3-Clause
// A closed surface for the tests of cut and extracellular forms.
#pragma once

#include "cut.hpp"

#include <glm/common.hpp>

#include <cmath>

namespace conceg::exporting::testing {

// A ball of rings and sectors, its vertices on the lattice of meshes; its radius varies by `uneven`.
inline Surface ball(const glm::dvec3 &centre, double radius, int rings, int sectors, double uneven = 0) {
  Surface s;
  const auto add = [&](double polar, double angle) {
    const glm::dvec3 p = centre + radius * (1 + uneven * std::sin(3 * angle) * std::sin(polar)) *
                                      glm::dvec3(std::sin(polar) * std::cos(angle),
                                                 std::sin(polar) * std::sin(angle), std::cos(polar));
    s.vertex.push_back(glm::floor(p * 0x1p24 + 0.5) * 0x1p-24);
  };
  add(0, 0);
  for (int i = 1; i < rings; i++)
    for (int j = 0; j < sectors; j++)
      add(3.14159265 * i / rings, 6.28318531 * (j + 0.3 * i) / sectors);
  add(3.14159265, 0);
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>(1 + (i - 1) * sectors + j % sectors);
  };
  const auto last = static_cast<std::uint32_t>(s.vertex.size() - 1);
  for (int j = 0; j < sectors; j++) {
    s.face.emplace_back(0u, at(1, j), at(1, j + 1));
    s.face.emplace_back(last, at(rings - 1, j + 1), at(rings - 1, j));
    for (int i = 1; i + 1 < rings; i++) {
      s.face.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      s.face.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return s;
}

} // namespace conceg::exporting::testing
