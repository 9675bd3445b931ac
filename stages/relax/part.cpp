// SPDX-License-Identifier: BSD-3-Clause
#include "part.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace conceg::relax {

namespace {

constexpr double path_um = 3;     // of a cable that bends aside
constexpr double most_move = 0.4; // um
constexpr double more = 1e-4;     // um, aimed at beyond the gap, so that sweeps end
constexpr double bending = 0.1;   // share of a change of bend that a sweep takes back, in the first half
constexpr int most_turns = 3, most_rounds = 10, sweeps = 60;

// Closest points of a pair at the least radii, and the four nodes with their weights.
struct Contact {
  double missing; // um to the gap
  glm::dvec3 apart;
  std::array<std::uint32_t, 4> node;
  std::array<double, 4> weight; // negative for the second body
};

Contact contact_of(const Bodies &bodies, const Pair &pair, const glm::dvec3 &side, double gap) {
  RoundCone first, second;
  cones_of(bodies, pair, bodies.floor, side, first, second);
  const Closest at = closest_cones(first, second);
  const Element &e = bodies.elements[pair.e], &f = bodies.elements[pair.f];
  Contact out = {gap - at.gap,
                 glm::mix(first.a, first.b, at.s) - glm::mix(second.a, second.b, at.t),
                 {e.a, e.b, f.a, f.b},
                 {1 - at.s, at.s, at.t - 1, -at.t}};
  if (e.a == e.b) out.weight[0] = 0, out.weight[1] = 1; // a ball
  if (f.a == f.b) out.weight[2] = 0, out.weight[3] = -1;
  double length = glm::length(out.apart);
  if (length < 1e-9) { // the axes cross: across both of them
    out.apart = glm::cross(first.b - first.a, second.b - second.a);
    length = glm::length(out.apart);
  }
  out.apart = length > 0 ? out.apart / length : glm::dvec3(1, 0, 0);
  return out;
}

// What moves, and what it may meet.
class Places {
public:
  Places(Bodies &bodies, const conceg_box &box, std::vector<Pair> pairs, double gap)
      : bodies_(bodies), box_(box), side_(side(box)), pairs_(std::move(pairs)), gap_(gap),
        start_(bodies.position), free_(bodies.position.size(), 0), length_(bodies.points, 0),
        bend_(bodies.points) {}

  // Pairs that do not keep the gap.
  std::vector<std::uint32_t> tight(Workers &workers, double &deepest) const {
    std::vector<double> missing(pairs_.size());
    workers.loop(pairs_.size(), 512, [&](std::size_t k, unsigned) {
      missing[k] = contact_of(bodies_, pairs_[k], side_, gap_).missing;
    });
    std::vector<std::uint32_t> out;
    deepest = 0;
    for (std::uint32_t k = 0; k < pairs_.size(); k++)
      if (missing[k] > 0) out.push_back(k), deepest = std::max(deepest, missing[k]);
    return out;
  }

  void release(const std::vector<std::uint32_t> &pairs) {
    for (const std::uint32_t k : pairs)
      for (const std::uint32_t e : {pairs_[k].e, pairs_[k].f})
        if (e < bodies_.points) release_near(e);
    near_.clear();
    for (std::uint32_t k = 0; k < pairs_.size(); k++) {
      const Element &e = bodies_.elements[pairs_[k].e], &f = bodies_.elements[pairs_[k].f];
      if (free_[e.a] || free_[e.b] || free_[f.a] || free_[f.b]) near_.push_back(k);
    }
  }

  // Shape first and contacts last: what is left over then is a gap, not an overlap. Returns whether any
  // contact pushed.
  bool sweep(double stiffness, bool lengths) {
    if (stiffness > 0)
      for (const std::uint32_t i : points_)
        if (free_[i]) {
          bodies_.position[i] += stiffness * (bend_[i] - bend_of(bodies_, i));
          hold(i);
        }
    if (lengths)
      for (const std::uint32_t i : points_)
        keep_length(i);
    bool pushed = false;
    for (const std::uint32_t k : near_) {
      const Contact c = contact_of(bodies_, pairs_[k], side_, gap_ + more);
      if (c.missing > 0) push(c), pushed = true;
    }
    return pushed;
  }

  double largest_move() const {
    double largest = 0;
    for (const std::uint32_t i : points_)
      largest = std::max(largest, glm::distance(bodies_.position[i], start_[i]));
    return largest;
  }

private:
  // Frees the points within path_um of a point and notes the shape of the cable there.
  void release_near(std::uint32_t from) {
    std::vector<std::pair<std::uint32_t, double>> open = {{from, 0.0}};
    std::vector<std::uint32_t> seen = {from};
    const auto visit = [&](std::uint32_t to, double path) {
      if (path > path_um || std::find(seen.begin(), seen.end(), to) != seen.end()) return;
      seen.push_back(to), open.push_back({to, path});
    };
    while (!open.empty()) {
      const auto [i, path] = open.back();
      open.pop_back();
      note(i);
      if (!bodies_.pinned[i]) free_[i] = 1;
      if (bodies_.parent[i] >= 0) visit(static_cast<std::uint32_t>(bodies_.parent[i]), path + segment(i));
      for (std::uint32_t c = bodies_.child_offset[i]; c < bodies_.child_offset[i + 1]; c++) {
        note(bodies_.child[c]);
        visit(bodies_.child[c], path + segment(bodies_.child[c]));
      }
    }
  }

  double segment(std::uint32_t i) const {
    return glm::distance(start_[i], start_[static_cast<std::size_t>(bodies_.parent[i])]);
  }

  void note(std::uint32_t i) {
    if (length_[i] > 0) return;
    length_[i] = bodies_.parent[i] >= 0 ? segment(i) : 1;
    bend_[i] = bend_of(bodies_, i);
    points_.push_back(i);
  }

  void push(const Contact &c) {
    double whole = 0;
    for (std::size_t j = 0; j < 4; j++)
      if (free_[c.node[j]]) whole += c.weight[j] * c.weight[j];
    if (whole < 1e-6) return;
    for (std::size_t j = 0; j < 4; j++)
      if (free_[c.node[j]]) {
        bodies_.position[c.node[j]] += (c.missing * c.weight[j] / whole) * c.apart;
        hold(c.node[j]);
      }
  }

  void keep_length(std::uint32_t i) {
    if (bodies_.parent[i] < 0) return;
    const auto p = static_cast<std::uint32_t>(bodies_.parent[i]);
    const int moving = free_[i] + free_[p];
    const glm::dvec3 along = bodies_.position[i] - bodies_.position[p];
    const double now = glm::length(along);
    if (!moving || !(now > 0)) return;
    const glm::dvec3 change = (0.5 * (length_[i] - now) / (now * moving)) * along;
    if (free_[i]) bodies_.position[i] += change, hold(i);
    if (free_[p]) bodies_.position[p] -= change, hold(p);
  }

  // Keeps a point near its start, and in the box on open axes.
  void hold(std::uint32_t i) {
    glm::dvec3 &p = bodies_.position[i];
    const glm::dvec3 moved = p - start_[i];
    const double length = glm::length(moved);
    if (length > most_move) p = start_[i] + (most_move / length) * moved;
    for (int a = 0; a < 3; a++)
      if (!box_.periodic[a])
        p[a] =
            std::min(std::max(p[a], std::min(box_.lo[a], start_[i][a])), std::max(box_.hi[a], start_[i][a]));
  }

  Bodies &bodies_;
  const conceg_box &box_;
  glm::dvec3 side_;
  std::vector<Pair> pairs_;
  double gap_;
  std::vector<glm::dvec3> start_;
  std::vector<std::uint8_t> free_;    // per node
  std::vector<double> length_;        // per point, of the segment that ends there; 0 = not noted
  std::vector<glm::dvec3> bend_;      // per point
  std::vector<std::uint32_t> points_; // that are noted
  std::vector<std::uint32_t> near_;   // pairs of which something moves
};

} // namespace

Parted part(Bodies &bodies, const conceg_box &box, double gap, Collider &collider, Workers &workers) {
  Parted parted;
  // Points that are held by most_move may go on from where they are, against a list that is made anew.
  for (int turn = 0; turn < most_turns; turn++) {
    // Two points that move by most_move each can meet only when they are in this list.
    Places places(bodies, box, collider.find(bodies, bodies.floor, box, gap + 2 * most_move, workers).pairs,
                  gap);
    std::vector<std::uint32_t> tight = places.tight(workers, parted.deepest_after);
    if (turn == 0) parted.before = tight.size(), parted.deepest_before = parted.deepest_after;
    parted.after = tight.size();
    if (tight.empty()) break;
    for (int round = 0; round < most_rounds && !tight.empty(); round++) {
      places.release(tight);
      for (int n = 0; n < sweeps; n++) {
        const bool lengths = n < 3 * sweeps / 4;
        if (!places.sweep(n < sweeps / 2 ? bending : 0, lengths) && !lengths) break;
      }
      tight = places.tight(workers, parted.deepest_after);
      parted.after = tight.size();
    }
    parted.largest_move = std::max(parted.largest_move, places.largest_move());
    if (tight.empty()) break;
  }
  return parted;
}

} // namespace conceg::relax
