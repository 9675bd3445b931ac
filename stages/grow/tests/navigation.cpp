// SPDX-License-Identifier: BSD-3-Clause
// Network navigation: the costs by hand, and the candidates of a tip in a network of six nodes.
#include "check.h"
#include "navigate.hpp"
#include "occupancy.hpp"

#include <glm/geometric.hpp>

using namespace conceg::grow;

namespace {

void costs() {
  const glm::dvec3 s(0, 0, 0), t(10, 0, 0);
  // Straight on, square, back: 1 - cos = 0, 1, 2.
  CHECK_NEAR(attractor_cost(s, {1, 0, 0}, t, true), 0.0, 1e-15);
  CHECK_NEAR(attractor_cost(s, {0, 1, 0}, t, true), 0.25, 1e-15);
  CHECK_NEAR(attractor_cost(s, {-3, 0, 0}, t, true), 0.75, 1e-15);
  CHECK_NEAR(attractor_cost(s, {0, 1, 0}, t, false), 0.5, 1e-15);
  CHECK_NEAR(attractor_cost(s, {-3, 0, 0}, t, false), 1.0, 1e-15);
  // 45 degrees, |s-c| = 2: 1/2 * 2/3 * (1 - sqrt(1/2)).
  CHECK_NEAR(attractor_cost(s, {std::sqrt(2.0), std::sqrt(2.0), 0}, t, true), (1.0 - std::sqrt(0.5)) / 3.0,
             1e-15);
  CHECK_NEAR(radius_cost(0.5, 0.2), 0.6, 1e-15);
  CHECK_NEAR(radius_cost(0.5, 0.5), 0.0, 0.0);
  CHECK_NEAR(radius_cost(0.5, 2.0), 0.0, 0.0);
}

// Node 0 is the tip; 1 straight on, 2 aside, 3 behind, 4 too far, 5 across the periodic face.
struct Star {
  std::vector<double> position = {1, 5, 5, 2, 5, 5, 1, 6, 5, 0.2, 5, 5, 1, 5, 8, 9.5, 5, 5.2};
  std::vector<float> radius = {2, 2, 2, 2, 2, 2};
  std::vector<std::uint64_t> offset = {0, 5, 5, 5, 5, 5, 5};
  std::vector<std::uint32_t> edge = {1, 2, 3, 4, 5};
  std::vector<std::int8_t> shift = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, 0, 0};
  std::vector<std::uint64_t> id = {1, 2}, cell_offset = {0, 1, 1};
  std::vector<double> soma = {5, 5, 9, 5, 5, 1};
  std::vector<float> soma_radius = {0, 0};
  std::vector<std::uint32_t> tree = {0};
  std::vector<std::int64_t> parent = {-1};
  std::vector<std::uint8_t> neurite = {3};
  std::vector<double> start = {0}, end = {20}, attractor = {20, 5, 5}, angle = {0}, r = {0.5}, taper = {0},
                      floor = {0.1};
  State state;

  Star() {
    Input &in = state.input;
    for (int a = 0; a < 3; a++)
      in.box.hi[a] = 10.0, in.box.periodic[a] = 1;
    in.network = {6, position.data(), radius.data(), offset.data(), edge.data(), shift.data()};
    in.cells = {2, id.data(), soma.data(), soma_radius.data()};
    in.bars = {1,          cell_offset.data(), tree.data(),  parent.data(), neurite.data(), start.data(),
               end.data(), attractor.data(),   angle.data(), r.data(),      taper.data(),   floor.data(),
               {}};
    state.projections.resize(1);
    state.projections[0].attractor = {20, 5, 5};
    make_space(state);
  }
  std::vector<Candidate> candidates() {
    std::vector<Candidate> found;
    find_candidates(state, state.projections[0], {{1, 5, 5}, 0, {0, 0, 0}}, 0.5, {20, 5, 5}, found);
    return found;
  }
};

void star() {
  Star star;
  std::vector<Candidate> found = star.candidates();
  CHECK_EQUAL(found.size(), 4); // node 4 is 3 um away
  CHECK_EQUAL(found[0].node, 1);
  CHECK_NEAR(found[0].cost, 0.0, 1e-15);
  CHECK_EQUAL(found[1].node, 2);
  CHECK_NEAR(found[1].cost, 0.5, 1e-15);
  CHECK_EQUAL(found[3].node, 3);
  for (const Candidate &candidate : found) {
    if (candidate.node != 5) continue;
    CHECK_NEAR(candidate.position.x, -0.5, 1e-15); // unwrapped through the face
    CHECK_EQUAL(candidate.lift[0], -1);
  }

  // Another cell leaves 0.2 um at node 1: l = 0 + f (0.5 - 0.2) / 0.5 = 0.6 f; with f = 1 the side step wins.
  star.state.space.site(1).field = {0.2f, 0.5f, 1, none};
  found = star.candidates();
  CHECK_EQUAL(found[0].node, 2);
  CHECK_NEAR(found[1].cost, 0.6, 1e-7);
  star.state.parameters.f = 0.5;
  CHECK_EQUAL(star.candidates()[0].node, 1);
  CHECK_NEAR(star.candidates()[0].cost, 0.3, 1e-7);
  star.state.parameters.f = 1.0;
  // The same distance to the cell's own process does not count: the nearest other one does.
  star.state.space.site(1).field = {-0.3f, 0.45f, 0, 1};
  CHECK_EQUAL(star.candidates()[0].node, 1);
  CHECK_NEAR(star.candidates()[0].cost, 0.1, 1e-6);

  // Not viable: narrower than r_min, used by the cell itself, banned.
  star.state.space.site(1).field = {0.1f, 0.5f, 1, none};
  CHECK_EQUAL(star.candidates().size(), 3);
  star.state.space.site(2).user = 0;
  CHECK_EQUAL(star.candidates().size(), 2);
  star.state.projections[0].banned = {3};
  CHECK_EQUAL(star.candidates().size(), 1);
  star.state.space.site(2).user = 1;
  CHECK_EQUAL(star.candidates().size(), 2);
}

void attractors() {
  const glm::dvec3 attractor(20, 0, 0), ahead(1, 0, 0);
  CHECK(!attractor_reached(attractor, {10, 0, 0}, ahead));
  CHECK(attractor_reached(attractor, {16, 2, 0}, ahead));
  CHECK(attractor_reached(attractor, {24, 8, 0}, ahead));   // missed, and behind the tip
  CHECK(!attractor_reached(attractor, {24, 8, 0}, -ahead)); // still ahead of the tip
  CHECK(!attractor_reached(attractor, {40, 8, 0},
                           ahead)); // so far behind that something else turned the tip away
  Projection projection;
  projection.attractor = attractor;
  for (int i = 0; i <= 8; i++) {
    Vertex vertex;
    vertex.position = {i < 3 ? 0.0 : i - 3.0, i < 3 ? i : 3.0, 0.0}; // up for 3 um, then along x for 5 um
    vertex.path = i;
    projection.chain.push_back(vertex);
  }
  CHECK_NEAR(chain_heading(projection).x, 1.0, 1e-12);
  projection.chain.resize(1);
  CHECK_NEAR(chain_heading(projection).x, 1.0, 1e-12);
}

} // namespace

int main() {
  costs();
  star();
  attractors();
  return check_done();
}
