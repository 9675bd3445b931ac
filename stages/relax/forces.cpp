// SPDX-License-Identifier: BSD-3-Clause
#include "forces.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::relax {

namespace {

// Unit vectors from the second body to the first; when the axes meet, across both of them.
Vec direction_of(const Four &first, const Four &second, const FourClosest &at) {
  const Lanes small = all(1e-6f);
  const Mask apart = at.distance > small;
  Vec out = (all(1) / most(at.distance, small)) * at.apart;
  if (!(apart[0] & apart[1] & apart[2] & apart[3])) {
    Vec across = cross(first.u, second.u);
    const Mask parallel = dot(across, across) < all(1e-9f);
    const Vec other = cross(first.u + second.u, Vec{all(0.36f), all(0.48f), all(0.8f)});
    across = {choose(parallel, other.x, across.x), choose(parallel, other.y, across.y),
              choose(parallel, other.z, across.z)};
    across.x = choose(dot(across, across) < all(1e-18f), all(1), across.x);
    across = (all(1) / root(dot(across, across))) * across;
    out = {choose(apart, out.x, across.x), choose(apart, out.y, across.y), choose(apart, out.z, across.z)};
  }
  return out;
}

// The constants of equation (1), four times each.
struct Law {
  Lanes gap, repulsion, attraction, range, bottom; // bottom: energy of touching bodies that attract
  bool attracts;
  explicit Law(const Strength &k)
      : gap(all(static_cast<float>(k.gap))), repulsion(all(static_cast<float>(k.repulsion))),
        attraction(all(static_cast<float>(k.attraction))),
        range(all(static_cast<float>(k.attraction_range > 0 ? k.attraction_range : 1))),
        bottom(all(-1.0f / 6) * attraction * range * range), attracts(k.attraction * k.attraction_range > 0) {
  }

  // Push (positive apart, negative together) and energy.
  void operator()(const Lanes &room, bool attract, Lanes &push, Lanes &energy) const {
    const Mask overlap = room < all(0);
    push = choose(overlap, -repulsion * room, all(0));
    energy = choose(overlap, all(0.5f) * repulsion * room * room, all(0));
    if (!attract || !attracts) return;
    const Mask near = (room >= all(0)) & (room < range);
    const Lanes part = room / range;
    push = choose(near, -attraction * room * (all(1) - part), push);
    energy = choose(near, attraction * room * room * (all(0.5f) - part * all(1.0f / 3)), energy);
    energy += choose(near | overlap, bottom, all(0));
  }
};

double sum(const Lanes &x) {
  return (static_cast<double>(x[0]) + static_cast<double>(x[1])) +
         (static_cast<double>(x[2]) + static_cast<double>(x[3]));
}

// What is pinned does not yield to what presses from the other side: it pushes that much harder.
constexpr float wall = 3;
// The least share of a push that a body takes, however large it is: what lies between two large bodies must
// be able to part them.
constexpr float least_share = 0.15f;

Lanes bounded(const Lanes &share) {
  return least(all(1 - least_share), most(all(least_share), share));
}

// Adds up what the neighbours of one element do to it.
struct Owner {
  Four body;
  Vec on_a = {all(0), all(0), all(0)}, on_b = on_a;
  Lanes energy = all(0), overlap = all(0), deepest = all(0);
  std::uint64_t overlapping = 0;

  template <bool second> void meet(const Four &others, const Vec &shift, const Run &run, const Law &law) {
    const Four &f = second ? others : body, &g = second ? body : others;
    const FourClosest at = closest(f, g, shift);
    const Lanes room = at.gap - law.gap;
    const Mask counts = mask_of(run) & (room < law.range);
    if (!(counts[0] | counts[1] | counts[2] | counts[3])) return;
    Lanes push, stored;
    law(room, !(run.flags & one_body), push, stored);
    push = choose(counts, push, all(0));
    energy += choose(counts, stored, all(0));
    const Lanes depth = choose(counts & (at.gap < all(0)), -at.gap, all(0));
    const Mask deep = depth > all(0);
    overlap += depth, deepest = most(deepest, depth);
    overlapping += static_cast<std::uint64_t>(-(deep[0] + deep[1] + deep[2] + deep[3]));
    // Small structures yield to large ones: shares in proportion to the other's volume, all of it beside what
    // is pinned.
    const Lanes volume = at.radius_first * at.radius_first * at.radius_first,
                other = at.radius_second * at.radius_second * at.radius_second;
    const Lanes share = second ? choose(f.pinned > all(0), all(wall), bounded(volume / (volume + other)))
                               : choose(g.pinned > all(0), all(wall), bounded(other / (volume + other)));
    const Lanes along = second ? at.t : at.s, size = (second ? -push : push) * share;
    const Vec force = size * direction_of(f, g, at);
    on_a = on_a + (all(1) - along) * force;
    on_b = on_b + along * force;
  }
};

} // namespace

void ContactForces::add(const Bodies &bodies, const LaneBodies &lanes, const Runs &runs,
                        const Strength &strength, Workers &workers, std::vector<glm::dvec3> &force,
                        State &state) {
  ends_.assign(bodies.elements.size(), {});
  states_.assign(runs.block.size(), {});
  const Law law(strength);
  workers.loop(runs.block.size(), 1, [&](std::size_t b, unsigned) {
    const RunBlock &block = runs.block[b];
    State &mine = states_[b];
    const auto end = [](const Vec &f) {
      return glm::vec3(static_cast<float>(sum(f.x)), static_cast<float>(sum(f.y)),
                       static_cast<float>(sum(f.z)));
    };
    std::size_t k = 0;
    for (std::uint32_t c = block.first; c < block.last; c++)
      for (std::uint32_t lane = 0; lane < bodies.chunks[c].count; lane++, k++) {
        if (block.offset[k] == block.offset[k + 1]) continue;
        Owner owner = {lanes.one(c, lane)};
        for (std::uint32_t n = block.offset[k]; n < block.offset[k + 1]; n++) {
          const Run &run = block.run[n];
          if (run.flags & owner_is_second)
            owner.meet<true>(lanes.run(run.chunk), runs.shift[run.shift], run, law);
          else
            owner.meet<false>(lanes.run(run.chunk), runs.shift[run.shift], run, law);
        }
        ends_[bodies.chunks[c].first + lane] = {end(owner.on_a), end(owner.on_b)};
        mine.contact_energy += sum(owner.energy), mine.overlap_sum += sum(owner.overlap);
        mine.overlapping += owner.overlapping;
        for (int i = 0; i < 4; i++)
          mine.largest_overlap = std::max(mine.largest_overlap, static_cast<double>(owner.deepest[i]));
      }
  });
  // Each pair was met from both sides.
  std::uint64_t overlapping = 0;
  for (const State &s : states_) {
    state.contact_energy += 0.5 * s.contact_energy, state.overlap_sum += 0.5 * s.overlap_sum;
    state.largest_overlap = std::max(state.largest_overlap, s.largest_overlap);
    overlapping += s.overlapping;
  }
  state.overlapping += overlapping / 2;
  workers.loop(bodies.points, 512, [&](std::size_t i, unsigned) {
    if (bodies.pinned[i]) return;
    glm::dvec3 sum = glm::dvec3(ends_[i].b);
    if (bodies.elements[i].a == i) sum += glm::dvec3(ends_[i].a); // a root without a stub
    for (std::uint32_t c = bodies.child_offset[i]; c < bodies.child_offset[i + 1]; c++)
      sum += glm::dvec3(ends_[bodies.child[c]].a);
    force[i] += sum;
  });
}

void add_shape_forces(const Bodies &bodies, const std::vector<double> &rest_length, const Strength &strength,
                      Workers &workers, std::vector<glm::dvec3> &force, State &state) {
  // Force along the segment that ends at point i, on its end; `change` of its length.
  const auto tension = [&](std::size_t i, double &change) {
    const glm::dvec3 along = bodies.position[i] - bodies.position[static_cast<std::size_t>(bodies.parent[i])];
    const double length = glm::length(along);
    change = rest_length[i] - length;
    return length > 0 ? along * (strength.stretch * change / length) : glm::dvec3(0);
  };
  constexpr std::size_t block = 512;
  std::vector<double> energy((bodies.points + block - 1) / block, 0);
  workers.loop(energy.size(), 1, [&](std::size_t b, unsigned) {
    for (std::size_t i = b * block; i < std::min(bodies.points, (b + 1) * block); i++) {
      if (bodies.pinned[i]) continue;
      double change = 0, other = 0;
      glm::dvec3 sum = tension(i, change);
      for (std::uint32_t c = bodies.child_offset[i]; c < bodies.child_offset[i + 1]; c++)
        sum -= tension(bodies.child[c], other);
      const glm::dvec3 bent = bodies.rest_bend[i] - bend_of(bodies, i);
      force[i] += sum + strength.bending * bent;
      energy[b] += 0.5 * strength.stretch * change * change + 0.5 * strength.bending * glm::dot(bent, bent);
    }
  });
  for (const double e : energy)
    state.shape_energy += e;
}

} // namespace conceg::relax
