// SPDX-License-Identifier: BSD-3-Clause
// A preconditioner for conjugate gradients on a graph of voxels: a W-cycle over groups of ever more voxels
// that hang together (aggregation; the coarse correction is enlarged as in Braess, Computing 55, 1995).
#pragma once

#include "parallel.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace conceg::analyse {

// (A u)_i = sum over neighbours of weight (u_i - u_j) + boundary_i u_i. Symmetric: every edge stands at both
// ends.
struct WeightedGraph {
  std::vector<std::uint64_t> offset; // of the edges of node i: offset[i] .. offset[i + 1]
  std::vector<std::uint32_t> neighbour;
  std::vector<float> weight;
  std::vector<double> boundary; // conductance to u = 0
  std::size_t size() const { return offset.size() - 1; }
};

class Multigrid {
public:
  using Place = std::array<std::uint32_t, 3>; // of a voxel
  // Groups are the connected nodes in blocks of 2 x 2 x 2 places, then in blocks of those. Runs in one
  // thread.
  Multigrid(WeightedGraph graph, std::vector<Place> place, Workers &workers);

  void set_boundary(std::vector<double> boundary); // of all levels, from that of the voxels
  // out = A u on the voxels.
  void apply(const std::vector<double> &u, std::vector<double> &out) const { apply(levels_.front(), u, out); }
  // out = about A^-1 residual; symmetric, the same for any number of threads.
  void precondition(const std::vector<double> &residual, std::vector<double> &out);

private:
  struct Level {
    WeightedGraph graph;
    std::vector<std::uint32_t> group, first,
        member;                                 // of each node, and nodes of each; empty on the last level
    std::vector<double> inverse;                // damping / diagonal, 0 where there is none
    std::vector<double> left, rest, out, again; // A u of a cycle; what is left to the groups, their answer
  };

  // Levels of a few chunks are not worth waking the others for: a cycle visits them often.
  template <class Body> void loop(std::size_t size, const Body &body) const {
    constexpr std::size_t chunk = 8192;
    if (size > 2 * chunk) return workers_.loop(size, chunk, [&](std::size_t i, unsigned) { body(i); });
    for (std::size_t i = 0; i < size; i++)
      body(i);
  }
  void apply(const Level &level, const std::vector<double> &u, std::vector<double> &out) const;
  void cycle(std::size_t at, const std::vector<double> &residual, std::vector<double> &out);
  void sweep_last(const Level &level, const std::vector<double> &residual, std::vector<double> &out) const;

  std::vector<Level> levels_;
  Workers &workers_;
};

} // namespace conceg::analyse
