// SPDX-License-Identifier: BSD-3-Clause
// The neighbours of each element as runs of up to four consecutive elements, those of a chunk: a Verlet list
// whose entries are worked out four at a time. Each pair stands in the list of both of its elements, so that
// each element sums its forces by itself.
#pragma once

#include "collide.hpp"
#include "lanes.hpp"

namespace conceg::relax {

struct Run {
  std::uint32_t chunk;
  std::uint16_t shift; // of the pair's second element; index into Runs::shift
  std::uint8_t lanes;  // bits: which elements of the chunk
  std::uint8_t flags;
};
constexpr std::uint8_t owner_is_second = 1; // the pair's first element is the run's, not the owner's
constexpr std::uint8_t one_body = 2;        // same copy of the same cell: repels, does not attract

// The runs of the chunks first .. last - 1; those of their k-th element are run[offset[k]] .. run[offset[k +
// 1]].
struct RunBlock {
  std::uint32_t first = 0, last = 0;
  std::vector<std::uint32_t> offset;
  std::vector<Run> run;
};

struct Runs {
  std::vector<RunBlock> block;
  std::vector<Vec> shift;
  std::uint64_t count() const;
};

// All runs with a gap that can be below `reach`, from what Embree found.
Runs make_runs(const Bodies &bodies, const ChunkSearch &chunks, const LaneBodies &lanes,
               const conceg_box &box, double reach, Workers &workers);

// Those of them that are closer than `reach` now.
void prune_runs(const Bodies &bodies, const Runs &from, const LaneBodies &lanes, double reach,
                Workers &workers, Runs &out);

inline Mask mask_of(const Run &run) {
  const Mask bit = {1, 2, 4, 8};
  const std::int32_t lanes = run.lanes;
  return (Mask{lanes, lanes, lanes, lanes} & bit) != Mask{0, 0, 0, 0};
}
inline FourClosest closest_of(const Four &owner, const Four &others, const Runs &runs, const Run &run) {
  return run.flags & owner_is_second ? closest(others, owner, runs.shift[run.shift])
                                     : closest(owner, others, runs.shift[run.shift]);
}

} // namespace conceg::relax
