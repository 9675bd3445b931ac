// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes of the growth network: where cellular projections may step. Lengths in um.
#pragma once

#include "conceg/geom.h"
#include "parallel.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::triangulate {

enum class NodeSet {
  bcc,    // body-centred cubic lattice with a random shift of each node
  uniform // independent uniform nodes, as in the paper
};

struct NodeOptions {
  NodeSet set = NodeSet::bcc;
  double density_per_um3 = 2.0;
  double jitter = 0.2; // bcc: largest shift along each axis, in units of the cubic cell's side; below 0.25
  bool mirrored_faces = false; // the paper's: nodes on the faces of the box, the same ones on opposing sides
  std::uint64_t seed = 1;
  std::vector<std::uint8_t> levels =
      {}; // bcc: how fine each cell of the lattice is (levels.hpp); none = all 0
};

// Fails when the box is too small for nodes, or too large for the ids of that many.
void check_nodes(const conceg_box &box, const NodeOptions &options);

// Halo around a tile at which its certificate holds: always with bcc in a periodic box, nearly always else.
double first_halo_um(const conceg_box &box, const NodeOptions &options);

// Nodes in the box on the lattice of geom.h, no two at one place, ordered along a space-filling curve so that
// neighbours in space are near in memory. They depend on the box and the options only, never on the threads.
// A node on the upper side of a periodic axis is left out: it is the image of its twin on the lower side.
std::vector<glm::dvec3> make_nodes(const conceg_box &box, const NodeOptions &options, Workers &workers,
                                   const Progress &progress);

} // namespace conceg::triangulate
