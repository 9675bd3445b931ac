// SPDX-License-Identifier: GPL-3.0-or-later
// The edges of the growth network: the Delaunay triangulation of the nodes on the torus. Lengths in um.
#pragma once

#include "conceg/geom.h"
#include "parallel.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace conceg::triangulate {

struct DelaunayOptions {
  double tile_um = 50.0; // largest side of a tile
  double halo_um = 3.0;  // first width of the halo; a tile whose certificate fails is redone with a wider one
  bool mirrored_faces =
      false; // the paper's: plain Delaunay of the closed box, twins on opposing faces made one
  std::uint64_t tile_nodes = 400000; // most nodes of a tile where it can be halved: about 0.3 GB a thread
};

// Edges of the nodes of one tile: neighbours of node[i] follow one another, degree[i] of them.
struct TileEdges {
  std::vector<std::uint32_t> node, degree, neighbour;
  std::vector<std::array<std::int8_t, 3>> shift;
};

struct Edges {
  std::vector<TileEdges> tiles;
  std::uint64_t count = 0;         // directed edges
  std::uint64_t widened = 0;       // times that a tile was redone with a wider halo
  double largest_circumradius = 0; // um, over all cells at core nodes
};

// Every tile holds the rows of its own nodes, sorted by neighbour and then by shift, where the neighbour
// stands at position + shift * side. Independent of tiles and threads. Open sides are padded with the nodes'
// reflections: nodes are joined there when their Voronoi regions meet inside the box.
Edges delaunay_edges(const conceg_box &box, const std::vector<glm::dvec3> &nodes,
                     const DelaunayOptions &options, Workers &workers, const Progress &progress);

// Puts the rows in the order of the nodes: offset[nodes + 1], neighbour[count], shift[count][3]. Frees the
// tiles on the way.
void merge_tiles(Edges &&edges, std::size_t nodes, std::uint64_t *offset, std::uint32_t *neighbour,
                 std::int8_t *shift);

} // namespace conceg::triangulate
