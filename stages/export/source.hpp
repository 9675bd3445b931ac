// SPDX-License-Identifier: BSD-3-Clause
// What export takes from the document, cell by cell, checked.
#pragma once

#include "cells.hpp"
#include "tile.hpp"
#include "tree.hpp"
#include "vtk.hpp"

#include <memory>
#include <string>
#include <vector>

namespace conceg::exporting {

struct Cell : CellInfo {
  std::string layer;
};

// A cell's surfaces joined into one, with the columns of its faces.
struct CellSurface {
  Surface surface;
  std::vector<std::uint8_t> compartment;
  std::vector<std::uint32_t> component, section;
};

// Of a cell's closed surfaces: as they are; all whole triangle images that meet the box; all images cut at
// the periodic sides, and left open or closed by lids. `extracellular`: one surface of what is left of the
// box.
enum class Form { closed, images, open, capped, extracellular };

// The box repeated along its periodic axes.
struct Tiles {
  int count[3] = {1, 1, 1};
  bool one() const { return count[0] * count[1] * count[2] == 1; }
  conceg_box of(conceg_box box) const {
    for (int axis = 0; axis < 3; axis++)
      box.hi[axis] = box.lo[axis] + count[axis] * conceg_box_side(&box, axis);
    return box;
  }
};

class Source {
public:
  // `level`: of detail of the surfaces; 0 = the full ones.
  explicit Source(conceg_doc *doc, int level = 0);
  const conceg_box &box() const { return box_; }
  const conceg_substrate *substrate() const { return substrate_.get(); }
  std::uint64_t seed() const { return seed_; }
  bool has_skeleton() const { return has_skeleton_; }
  bool has_meshes() const { return !surfaces_of_.empty(); }
  bool has_volumes() const;
  std::vector<Cell> select(const std::string &cells) const;
  Tree tree(std::uint64_t cell) const;
  // In `tiles` the cell stands once per tile, and is cut or brought in at the sides of all tiles together.
  CellSurface surface(std::uint64_t cell, Form form, const Tiles &tiles = {}) const;
  // /volumes as a full grid; its size in bytes before that.
  double volume_bytes() const;
  Volume volume() const;

private:
  void find_surfaces();
  conceg_mesh_view mesh(std::uint64_t row) const;
  conceg_doc *doc_;
  std::shared_ptr<conceg_substrate> substrate_;
  conceg_box box_;
  int level_;
  std::uint64_t seed_ = 0;
  bool has_skeleton_ = false;
  std::vector<std::string> layers_;                     // per type
  std::vector<std::vector<std::uint64_t>> surfaces_of_; // per cell: rows of /meshes; empty without any
};

} // namespace conceg::exporting
