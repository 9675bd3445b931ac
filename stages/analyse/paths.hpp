// SPDX-License-Identifier: BSD-3-Clause
// Straightness of the shortest paths through the open voxels of a box: Euclidean distance over path
// length, at most 1 (the paper's tortuosity of the extracellular space). Not lambda: that is transport.hpp.
#pragma once

#include "pore_space.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace conceg::analyse {

// Shortest paths from one open voxel; made once for a medium. Its voxels must outlive it.
class PathFinder {
public:
  // `neighbours` of the steps: 6, 18 or 26 (in a section 4 or 8 of them lie in its plane).
  PathFinder(const OpenVoxels &voxels, Workers &workers, int neighbours = 26);

  // Path length, um, from the middle of one open voxel to that of the others: fast marching (Sethian 1999)
  // with differences of second order where two known neighbours lie behind one another, and straight lines
  // within 3 voxels of the start. Infinity in closed voxels and where no path leads. With goals the search
  // ends when all of them are reached, and is infinite beyond. Any thread.
  std::vector<float> marched(std::size_t start, const std::vector<std::size_t> &goals) const;

  // The same along steps from voxel to voxel, as searches on a grid (A*) give them. A diagonal step needs all
  // voxels that it touches to be open. Even in empty space such paths are longer than straight lines, by up
  // to 73 %. Beyond goals lengths are not final.
  std::vector<float> stepped(std::size_t start, const std::vector<std::size_t> &goals) const;

private:
  double length_at(const std::vector<float> &settled, std::size_t i) const;
  const OpenVoxels &voxels_;
  Steps march_, near_, straight_;
  std::vector<std::uint32_t> allowed_; // per voxel: bits of the steps that it may take
};

// Of one start alone, to all voxels.
std::vector<float> marched_lengths(const OpenVoxels &voxels, std::size_t start);
std::vector<float> stepped_lengths(const OpenVoxels &voxels, std::size_t start, int neighbours);

struct PathSettings {
  std::uint64_t starts = 16, ends = 64; // pairs = starts x ends
  double least = 10; // um between start and end; less than half of a periodic side, and than an open one
  std::uint64_t seed = 1;
};

struct PathStraightness {
  Distribution marched, stepped; // of the pairs that are joined; stepped: 26 neighbours, or 8 in a section
  std::uint64_t pairs = 0, apart = 0; // looked at; without a path
};

// Random pairs of open voxels, `least` apart or more over the faces of the box, each pair within one of the
// media, such as the sections of one. Empty when they are too small for that, or nothing is open. The result
// does not depend on the number of threads.
PathStraightness path_straightness(const std::vector<OpenVoxels> &media, const PathSettings &settings,
                                   Workers &workers, const Progress &progress);

} // namespace conceg::analyse
