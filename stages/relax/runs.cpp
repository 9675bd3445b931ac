// SPDX-License-Identifier: BSD-3-Clause
#include "runs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conceg::relax {

namespace {

constexpr std::size_t block_chunks = 128;

// A chunk pair as one of its chunks sees it.
struct Meeting {
  std::uint32_t other;
  std::uint16_t shift;
  bool second, same_copy;
};

struct Meetings {
  std::vector<std::uint64_t> offset;
  std::vector<Meeting> meeting; // CSR by chunk
  std::vector<Vec> shift;
};

std::uint16_t shift_number(std::vector<glm::ivec3> &known, const glm::ivec3 &image) {
  const auto at = std::find(known.begin(), known.end(), image);
  if (at != known.end()) return static_cast<std::uint16_t>(at - known.begin());
  if (known.size() >= std::numeric_limits<std::uint16_t>::max())
    fail(CONCEG_E_RANGE, "/skeleton: cells meet each other over more than 65534 images; use a larger box");
  known.push_back(image);
  return static_cast<std::uint16_t>(known.size() - 1);
}

Meetings meetings_of(const Bodies &bodies, const ChunkSearch &chunks, const glm::dvec3 &sides) {
  Meetings out;
  const std::size_t count = bodies.chunks.size();
  out.offset.assign(count + 1, 0);
  for (const ChunkPair &p : chunks.pairs)
    out.offset[p.i + 1]++, out.offset[p.j + 1]++;
  for (std::size_t c = 0; c < count; c++)
    out.offset[c + 1] += out.offset[c];
  out.meeting.resize(out.offset[count]);
  std::vector<std::uint64_t> next(out.offset.begin(), out.offset.end() - 1);
  std::vector<glm::ivec3> images;
  for (const ChunkPair &p : chunks.pairs) {
    const glm::ivec3 up(p.up[0], p.up[1], p.up[2]);
    const std::uint16_t shift = shift_number(images, up + chunks.lift[p.i] - chunks.lift[p.j]);
    const bool same = up == glm::ivec3(0);
    out.meeting[next[p.i]++] = {p.j, shift, false, same};
    out.meeting[next[p.j]++] = {p.i, shift, true, same};
  }
  for (const glm::ivec3 &image : images) {
    const glm::dvec3 shift = sides * glm::dvec3(image);
    out.shift.push_back({all(static_cast<float>(shift.x)), all(static_cast<float>(shift.y)),
                         all(static_cast<float>(shift.z))});
  }
  return out;
}

// Lanes of the run that are close to the owner: the distance of the axes less the larger radius of each.
std::uint8_t close_lanes(const FourClosest &at, const Four &first, const Four &second, float reach) {
  const Lanes thick = first.r + most(first.dr, all(0)) + second.r + most(second.dr, all(0));
  const Mask close = at.distance - thick < all(reach);
  return static_cast<std::uint8_t>((close[0] & 1) | (close[1] & 2) | (close[2] & 4) | (close[3] & 8));
}

// Cheap test of all four: balls around the bodies.
bool may_meet(const FourBalls &owner, const FourBalls &others, const Vec &shift, bool second, float reach) {
  const Vec apart = owner.middle - others.middle, lifted = second ? apart + shift : apart - shift;
  const Lanes most_apart = owner.radius + others.radius + all(reach + 1e-3f);
  const Mask near = dot(lifted, lifted) < most_apart * most_apart;
  return (near[0] | near[1] | near[2] | near[3]) != 0;
}

void add_runs(const Bodies &bodies, const Meeting &meeting, std::uint32_t e, const LaneBodies &lanes,
              const Runs &runs, const Four &owner, const FourBalls &ball, float reach,
              std::vector<Run> &out) {
  const Chunk &chunk = bodies.chunks[meeting.other];
  Run run = {meeting.other, meeting.shift, static_cast<std::uint8_t>((1u << chunk.count) - 1),
             static_cast<std::uint8_t>(meeting.second ? owner_is_second : 0)};
  if (!may_meet(ball, lanes.balls(meeting.other), runs.shift[run.shift], meeting.second, reach)) return;
  const Four &others = lanes.run(meeting.other);
  const FourClosest at = closest_of(owner, others, runs, run);
  run.lanes &= meeting.second ? close_lanes(at, others, owner, reach) : close_lanes(at, owner, others, reach);
  if (!meeting.same_copy || bodies.elements[e].cell != bodies.elements[chunk.first].cell) {
    if (run.lanes) out.push_back(run);
    return;
  }
  run.flags |= one_body;
  // A chunk meets itself twice: once the owner is the first of the pair, once the second.
  const bool itself = e >= chunk.first && e < chunk.first + chunk.count;
  for (std::uint32_t k = 0; k < chunk.count; k++)
    if (run.lanes >> k & 1 && ((itself && (meeting.second ? chunk.first + k >= e : chunk.first + k <= e)) ||
                               near_in_tree(bodies, e, chunk.first + k)))
      run.lanes &= static_cast<std::uint8_t>(~(1u << k));
  if (run.lanes) out.push_back(run);
}

} // namespace

std::uint64_t Runs::count() const {
  std::uint64_t sum = 0;
  for (const RunBlock &b : block)
    sum += b.run.size();
  return sum;
}

Runs make_runs(const Bodies &bodies, const ChunkSearch &chunks, const LaneBodies &lanes,
               const conceg_box &box, double reach, Workers &workers) {
  const Meetings meetings = meetings_of(bodies, chunks, side(box));
  Runs runs;
  runs.shift = meetings.shift;
  runs.block.resize((bodies.chunks.size() + block_chunks - 1) / block_chunks);
  workers.loop(runs.block.size(), 1, [&](std::size_t b, unsigned) {
    RunBlock &block = runs.block[b];
    block.first = static_cast<std::uint32_t>(b * block_chunks);
    block.last = static_cast<std::uint32_t>(std::min(bodies.chunks.size(), (b + 1) * block_chunks));
    block.offset.assign(1, 0);
    for (std::uint32_t c = block.first; c < block.last; c++)
      for (std::uint32_t lane = 0; lane < bodies.chunks[c].count; lane++) {
        const Four owner = lanes.one(c, lane);
        const FourBalls ball = lanes.ball(c, lane);
        for (std::uint64_t m = meetings.offset[c]; m < meetings.offset[c + 1]; m++)
          add_runs(bodies, meetings.meeting[m], bodies.chunks[c].first + lane, lanes, runs, owner, ball,
                   static_cast<float>(reach), block.run);
        block.offset.push_back(static_cast<std::uint32_t>(block.run.size()));
      }
  });
  return runs;
}

void prune_runs(const Bodies &bodies, const Runs &from, const LaneBodies &lanes, double reach,
                Workers &workers, Runs &out) {
  const auto limit = static_cast<float>(reach);
  out.shift = from.shift;
  out.block.resize(from.block.size());
  workers.loop(from.block.size(), 1, [&](std::size_t b, unsigned) {
    const RunBlock &block = from.block[b];
    RunBlock &kept = out.block[b];
    kept.first = block.first, kept.last = block.last, kept.run.clear(), kept.offset.assign(1, 0);
    std::size_t k = 0;
    for (std::uint32_t c = block.first; c < block.last; c++)
      for (std::uint32_t lane = 0; lane < bodies.chunks[c].count; lane++, k++) {
        const Four owner = lanes.one(c, lane);
        const FourBalls ball = lanes.ball(c, lane);
        for (std::uint32_t n = block.offset[k]; n < block.offset[k + 1]; n++) {
          Run run = block.run[n];
          const bool second = run.flags & owner_is_second;
          if (!may_meet(ball, lanes.balls(run.chunk), from.shift[run.shift], second, limit)) continue;
          const Four &others = lanes.run(run.chunk);
          const FourClosest at = closest_of(owner, others, from, run);
          run.lanes &= second ? close_lanes(at, others, owner, limit) : close_lanes(at, owner, others, limit);
          if (run.lanes) kept.run.push_back(run);
        }
        kept.offset.push_back(static_cast<std::uint32_t>(kept.run.size()));
      }
  });
}

} // namespace conceg::relax
