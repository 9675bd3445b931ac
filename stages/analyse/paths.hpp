// SPDX-License-Identifier: BSD-3-Clause
// Straightness of the shortest paths through the open voxels of a periodic box: Euclidean distance over path
// length, at most 1 (the paper's tortuosity of the extracellular space). Not lambda: that is transport.hpp.
#pragma once

#include "pore_space.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace conceg::analyse {

// Path length, um, from the middle of one open voxel to that of every other one: fast marching (Sethian 1999)
// with differences of second order where two known neighbours lie behind one another, and straight lines
// within 3 voxels of the start. Infinity in closed voxels and where no path leads.
std::vector<float> marched_lengths(const OpenVoxels &voxels, std::size_t start);

// The same along steps from voxel to voxel, as searches on a grid (A*) give them: `neighbours` 6, 18 or 26
// (in a section 4 or 8 of them lie in its plane). A diagonal step needs all voxels that it touches to be
// open. Even in empty space such paths are longer than straight lines, by up to 73 %.
std::vector<float> stepped_lengths(const OpenVoxels &voxels, std::size_t start, int neighbours);

struct PathSettings {
  std::uint64_t starts = 16, ends = 64; // pairs = starts x ends
  double least = 10;                    // um between start and end, less than half of the shortest side
  std::uint64_t seed = 1;
};

struct PathStraightness {
  Distribution marched, stepped; // of the pairs that are joined; stepped: 26 neighbours, or 8 in a section
  std::uint64_t pairs = 0, apart = 0; // looked at; without a path
};

// Random pairs of open voxels, `least` apart or more over the faces of the box. Empty when the box is too
// small for that, or nothing is open. The result does not depend on the number of threads.
PathStraightness path_straightness(const OpenVoxels &voxels, const PathSettings &settings, Workers &workers,
                                   const Progress &progress);

} // namespace conceg::analyse
