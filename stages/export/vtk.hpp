// SPDX-License-Identifier: BSD-3-Clause
// VTK's XML files for ParaView, written with VTK's data model and XML writers; no rendering module is used.
#pragma once

#include "output.hpp"
#include "tile.hpp"
#include "tree.hpp"

#include <string>
#include <vector>

namespace conceg::exporting {

// A cell's skeleton and soma; soma_radius 0 = none.
struct SkeletonPiece {
  const Tree *tree;
  glm::dvec3 soma;
  double soma_radius;
  std::uint32_t cell, type;
};
// .vtp: a polyline per unbranched run and a point per soma, with radius, kind, cell and type of each point.
void write_skeletons_vtp(const std::string &path, const std::vector<SkeletonPiece> &pieces);

// A cell's surface; the columns are per face and may be empty.
struct SurfacePiece {
  const Surface *surface;
  std::vector<std::uint8_t> compartment;
  std::vector<std::uint32_t> component, section;
  std::uint32_t cell, type;
};
void write_surface_vtp(const std::string &path, const SurfacePiece &piece);

// .vtm: names the block files (relative paths) with their block names.
struct Block {
  std::string file, name;
};
void write_blocks_vtm(const std::string &path, const std::vector<Block> &blocks);

// .vti: labels (cell row + 1, 0 = ECS) and distances on a full grid, x fastest. A column may be empty.
struct Volume {
  glm::dvec3 origin, spacing;
  glm::ivec3 shape;
  std::vector<std::uint32_t> label;
  std::vector<float> distance;
};
void write_volume_vti(const std::string &path, const Volume &volume);

} // namespace conceg::exporting
