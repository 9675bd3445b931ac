// SPDX-License-Identifier: BSD-3-Clause
// From cells to primitives: every cell is a soma ball and round cones, one per skeleton segment, in fixed
// point on the common grid. Coordinates are multiples of 2^-8 voxel, so that node minus centre is exact in
// single precision and a node has the same bits in every block and in every periodic image.
#pragma once

#include "conceg/geom.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::mesh {

constexpr int kFixedBits = 8;
constexpr int kFixed = 1 << kFixedBits;           // fixed-point units in a voxel
constexpr int kBlock = 16;                        // cubes along the edge of a block
constexpr std::uint32_t kNoSection = 0xffffffffu; // section of a face on the soma ball
constexpr std::uint8_t kSomaKind = 1;
constexpr float kSnap = 0.05f; // node values nearer to zero than this (in voxels) are moved to it

// The tissue as the mesher sees it: lengths in um, coordinates unwrapped. Points of cell i are offset[i] ..
// offset[i+1].
struct Tissue {
  conceg_box box = {};
  std::vector<glm::dvec3> soma;
  std::vector<float> soma_radius; // 0 = no soma
  std::vector<std::uint64_t> offset;
  std::vector<glm::dvec3> point;
  std::vector<float> radius;
  std::vector<std::int64_t> parent; // within the cell, -1 = on the soma
  std::vector<std::uint8_t> kind;
  std::vector<std::uint32_t> branch; // empty: derived from `parent`
  std::size_t cells() const { return soma.size(); }
};

// The common grid. A periodic axis has size cubes, which fill the side exactly; an open axis goes as far as
// the cells do.
struct Grid {
  glm::dvec3 origin{};      // position of node (0, 0, 0), um
  glm::dvec3 step{};        // um
  double unit = 0;          // um in one unit of distance: the smallest step
  glm::vec3 scale{};        // step / unit
  glm::ivec3 size{};        // cubes in the box
  glm::ivec3 low{}, high{}; // nodes low .. high are evaluated
  bool periodic[3] = {};
  glm::ivec3 blocks() const {
    return {(high.x - low.x + kBlock - 1) / kBlock, (high.y - low.y + kBlock - 1) / kBlock,
            (high.z - low.z + kBlock - 1) / kBlock};
  }
  glm::dvec3 voxel_of(const glm::dvec3 &position) const { return (position - origin) / step; }
};

struct Cone {
  glm::ivec3 a, b;     // fixed-point voxels, unwrapped
  std::int32_t ra, rb; // fixed-point units of distance
  std::uint32_t cell;
  std::uint32_t section; // over all cells
  std::uint8_t kind;     // SWC code, 1 = soma
};

struct Section {
  float blend;          // k of the smooth minimum, in units
  float reach;          // distances from here on do not count, in units
  std::uint32_t branch; // of the skeleton; kNoSection = soma ball
};

struct Scene {
  Grid grid;
  double gap = 0;         // g in units
  float snap = kSnap;     // 0 for volumes
  std::vector<Cone> cone; // sorted by cell, section
  std::vector<Section> section;
  std::size_t cells = 0;
  std::vector<std::uint32_t> thin_points; // per cell: skeleton points too thin for this grid
};

struct SceneOptions {
  double h = 0.25;      // largest step, um
  double gap = 0.06;    // um
  double inflate = 0;   // c, um; a cone of radius r grows by min(c, 0.25 r)
  double smooth = 0.3;  // k / r
  bool cluster = true;  // for the light mesh, which loses more volume than the base mesh
  bool centred = false; // nodes at the centres of the voxels, for volumes
};

// Radius below which a free tube may break on the grid: (sqrt(3)/2 + snap) steps.
constexpr double kThinnestTube = 0.92;

// Throws E_RANGE when the tissue does not fit the fixed point (a cell wider than 2^19 voxels).
Scene make_scene(const Tissue &tissue, const SceneOptions &options);

// Lateral area of all primitives, in squared units of distance.
double primitive_area(const Scene &scene);

// Numbers the runs between soma, forks and tips when the document does not.
std::vector<std::uint32_t> derive_branches(const std::int64_t *parent, std::size_t count);

} // namespace conceg::mesh
