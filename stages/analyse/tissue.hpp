// SPDX-License-Identifier: BSD-3-Clause
// What analyse measures, as plain arrays, and the checks that make the arrays safe to index. Lengths in um.
#pragma once

#include "wrap.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::analyse {

struct Cells {
  std::vector<std::string> type_name, type_class; // per type
  std::vector<std::uint64_t> id;                  // per cell
  std::vector<std::uint32_t> type;
  std::vector<glm::dvec3> soma;
  std::vector<float> soma_radius; // 0 = no soma
  glm::dvec3 pia = glm::dvec3(0, 0, 1);
};

struct Skeletons {
  std::vector<std::uint64_t> cell_offset; // empty when there is no skeleton
  std::vector<glm::dvec3> position;       // unwrapped
  std::vector<float> radius;
  std::vector<std::int64_t> parent; // row within the cell, -1 = soma
  std::vector<std::uint8_t> kind;   // SWC code
};

// Closed surfaces in unwrapped coordinates.
struct Meshes {
  std::vector<std::uint32_t> cell;                       // per surface
  std::vector<std::uint64_t> vertex_offset, face_offset; // per surface + 1; empty when there are no meshes
  std::vector<glm::dvec3> vertex;
  std::vector<std::uint32_t> face; // 3 a face, local to the surface, outward
};

struct Bars {
  std::vector<std::uint64_t> cell_offset; // empty when there are no bars
  std::vector<double> asked_start, asked_end, achieved_start, achieved_end;
  std::vector<std::uint8_t> state; // 0 waiting 1 done 2 short 3 lost 4 handed to another bar
};

// Each throws E_FORMAT or E_RANGE with dataset[index] when an array is not what its group promises.
void check(const Cells &cells);
void check(const Skeletons &skeletons, const Cells &cells);
void check(const Meshes &meshes, const Cells &cells);
void check(const Bars &bars, const Cells &cells);

} // namespace conceg::analyse
