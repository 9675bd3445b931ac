// SPDX-License-Identifier: BSD-3-Clause
// From blocks to finished surfaces on disk: march, and as soon as the last block of a cell is done join and
// simplify it and put it into a file; check all of them, and where the check finds something move the faces
// apart, or go back to the base mesh around that place, until the check finds nothing. A gap below half of
// the wanted one counts as a find: the base mesh keeps gap / 1.91.
#pragma once

#include "check.hpp"
#include "components.hpp"
#include "extract.hpp"
#include "surface_file.hpp"

#include <memory>

namespace conceg::mesh {

constexpr double kLeastGap = 0.5; // of the gap that is asked: what the written meshes keep at least

struct FinishOptions {
  double tolerance = 0.05; // um, where neighbours are far; 0 = no simplification
  double gap = 0.06;       // um
  bool cluster = true;     // false: the base mesh is simplified
  bool nudge = true;       // false: go back to the base mesh at once
  int rounds = 5;          // the last ones take the whole base mesh of every cell that still crosses
  std::size_t check_memory = 512u << 20; // bytes that the check may take
  std::string folder = "/tmp";           // for files without a name
  std::string side_file, key;            // keeps finished surfaces for a later run; empty: none
  double least_gap() const { return kLeastGap * gap; }
};

struct Finished {
  std::unique_ptr<SurfaceFile> file; // what the views look at
  Views surfaces;                    // of the cells that have one, in the order of cells
  std::vector<Pieces> pieces;        // per cell
  CheckResult check;                 // of the surfaces returned
  int rounds = 0;                    // how often surfaces were made again
  std::uint64_t repaired_pairs = 0;  // crossings, folds and narrow gaps for which surfaces were made again
  std::uint64_t moved_vertices = 0;  // that were moved out of crossings and narrow gaps
  std::uint64_t base_faces = 0;      // before simplification
  std::size_t taken_over = 0;        // cells that an earlier run had finished
};

// Surface of cell i relative to origin[i], its soma at soma[i] (um, unwrapped).
struct Origins {
  const std::vector<glm::dvec3> &origin, &soma;
  const std::vector<float> &soma_radius;
};

Finished finish(const Scene &scene, const Index &index, const Origins &origins, const conceg_box &box,
                const FinishOptions &options, Workers &workers, const Progress &progress);

} // namespace conceg::mesh
