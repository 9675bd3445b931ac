// SPDX-License-Identifier: BSD-3-Clause
// The paper's rules on a network of twelve nodes, worked out by hand: l_t, l_r, l, P, and the node that a
// step takes.
#include "branch.hpp"
#include "check.h"
#include "navigate.hpp"
#include "occupancy.hpp"
#include "step.hpp"

using namespace conceg::grow;

namespace {

// The tip s stands on node 0 at (5, 5, 5), its attractor t at (15, 5, 5); r_0 = 0.5, f = 1. Per node: its
// place, r_c, and by hand l_t = 1/2 d / (1 + d) (1 - cos) and l_r = max(0, (r_0 - r_c) / r_0).
struct Row {
  double x, y, z, r_c, l_t, l_r;
  bool viable;
};
constexpr Row rows[12] = {
    {5.0, 5.0, 5.0, 0.50, 0.0, 0.0, false},        // the tip
    {6.0, 5.0, 5.0, 0.20, 0.0, 0.6, true},         // d = 1, cos = 1
    {5.0, 6.0, 5.0, 0.50, 1.0 / 4.0, 0.0, true},   // d = 1, cos = 0: 1/2 1/2
    {5.6, 5.8, 5.0, 0.40, 1.0 / 10.0, 0.2, true},  // d = 1, cos = 0.6: 1/2 1/2 0.4
    {5.3, 5.0, 5.4, 0.45, 1.0 / 15.0, 0.1, true},  // d = 0.5, cos = 0.6: 1/2 1/3 0.4
    {6.6, 5.0, 6.2, 0.50, 1.0 / 15.0, 0.0, true},  // d = 2, cos = 0.8: 1/2 2/3 0.2
    {4.0, 5.0, 5.0, 0.50, 1.0 / 2.0, 0.0, true},   // d = 1, cos = -1: 1/2 1/2 2
    {5.0, 5.0, 3.0, 0.35, 1.0 / 3.0, 0.3, true},   // d = 2, cos = 0: 1/2 2/3
    {6.5, 7.0, 5.0, 0.50, 1.0 / 7.0, 0.0, true},   // d = 2.5, cos = 0.6: 1/2 5/7 0.4
    {5.8, 4.4, 5.0, 0.10, 1.0 / 20.0, 0.8, false}, // r_c < r_min = 0.15
    {5.0, 3.5, 7.0, 0.50, 5.0 / 14.0, 0.0, true},  // d = 2.5, cos = 0: 1/2 5/7
    {8.2, 5.0, 7.4, 0.50, 2.0 / 25.0, 0.0, false}, // d = 4 > 3: longer than an edge may be; 1/2 4/5 0.2
};

struct Twelve {
  std::vector<double> position;
  std::vector<float> radius;
  std::vector<std::uint64_t> offset = {0};
  std::vector<std::uint32_t> edge;
  std::vector<std::uint64_t> id = {1}, cell_offset = {0, 1};
  std::vector<double> soma = {1, 1, 1};
  std::vector<float> soma_radius = {0};
  std::vector<std::uint32_t> tree = {0};
  std::vector<std::int64_t> parent = {-1};
  std::vector<std::uint8_t> neurite = {3};
  std::vector<double> start = {0}, end = {20}, attractor = {15, 5, 5}, angle = {0}, r = {0.5}, taper = {0},
                      floor = {0.1};
  State state;

  Twelve() {
    for (std::uint32_t node = 0; node < 12; node++) {
      position.insert(position.end(), {rows[node].x, rows[node].y, rows[node].z});
      radius.push_back(static_cast<float>(rows[node].r_c));
      if (node > 0) edge.push_back(node);
    }
    offset.resize(13, edge.size());
    Input &in = state.input;
    for (int a = 0; a < 3; a++)
      in.box.hi[a] = 20.0, in.box.periodic[a] = 1;
    in.network = {12, position.data(), radius.data(), offset.data(), edge.data(), nullptr};
    in.cells = {1, id.data(), soma.data(), soma_radius.data()};
    in.bars = {1,          cell_offset.data(), tree.data(),  parent.data(), neurite.data(), start.data(),
               end.data(), attractor.data(),   angle.data(), r.data(),      taper.data(),   floor.data(),
               {}};
    Parameters &paper = state.parameters; // as paper.yaml
    paper.length_factor = true, paper.hazard = Hazard::per_step, paper.occupancy = Occupancy::nodes;
    paper.smoothing = 0.0, paper.radius_fraction = 1.0, paper.max_edge_um = 3.0, paper.lambda_per_um = 1.0;
    state.projections.resize(1);
    Projection &projection = state.projections[0];
    projection.phase = Phase::growing, projection.attractor = {15, 5, 5};
    Vertex tip;
    tip.position = {5, 5, 5}, tip.node = 0, tip.path = 4.0;
    projection.chain = {tip}, projection.settled = 1;
    make_space(state);
  }
  std::vector<Candidate> candidates() const {
    std::vector<Candidate> found;
    find_candidates(state, state.projections[0], {{5, 5, 5}, 0, {0, 0, 0}}, 0.5, {15, 5, 5}, found);
    return found;
  }
  Vertex step() const {
    Edit edit;
    propose(state, 0, edit);
    CHECK_EQUAL(edit.tail.size(), 1);
    return edit.tail.empty() ? Vertex() : edit.tail[0];
  }
};

void costs() {
  const Twelve twelve;
  for (const Row &row : rows) {
    if (&row == rows) continue;
    CHECK_NEAR(attractor_cost({5, 5, 5}, {row.x, row.y, row.z}, {15, 5, 5}, true), row.l_t, 1e-12);
    CHECK_NEAR(radius_cost(0.5, row.r_c), row.l_r, 1e-12);
  }
  const std::vector<Candidate> found = twelve.candidates();
  const std::uint32_t order[] = {5, 8, 4, 2, 3, 10, 6, 1, 7}; // .067 .143 .167 .25 .3 .357 .5 .6 .633
  CHECK_EQUAL(found.size(), 9);
  for (std::size_t i = 0; i < found.size(); i++) {
    CHECK_EQUAL(found[i].node, order[i]);
    CHECK(rows[found[i].node].viable);
    CHECK_NEAR(found[i].cost, rows[found[i].node].l_t + rows[found[i].node].l_r, 1e-6); // r_c is a float
  }
}

void chosen() {
  Twelve twelve;
  CHECK_EQUAL(twelve.step().node, 5);
  CHECK_NEAR(twelve.step().path, 6.0, 1e-12);
  CHECK_NEAR(twelve.step().radius, 0.5, 1e-7);
  twelve.state.parameters.f = 0.1; // node 1: 0 + 0.1 0.6 = 0.06 < 1/15
  CHECK_EQUAL(twelve.step().node, 1);
  CHECK_NEAR(twelve.step().radius, 0.2, 1e-7); // all that the node has
  twelve.state.parameters.f = 1.0;
  twelve.state.space.site(5).user = 0; // used by the cell itself
  CHECK_EQUAL(twelve.step().node, 8);
  twelve.state.projections[0].banned = {8};
  CHECK_EQUAL(twelve.step().node, 4);
  twelve.state.parameters.length_factor = false; // node 4 without the bracket: 1/2 0.4 + 0.1
  CHECK_NEAR(twelve.candidates()[0].cost, 0.3, 1e-6);
}

// P = e^{lambda (pl - il)}, 1 from il on.
void branching() {
  CHECK_NEAR(step_probability(1.0, 8.0, 10.0), 0.1353352832366127, 1e-15);
  CHECK_NEAR(step_probability(0.2, 8.0, 10.0), 0.6703200460356393, 1e-15);
  CHECK_NEAR(step_probability(1.0, 10.0, 10.0), 1.0, 0.0);
  CHECK_NEAR(step_probability(1.0, 11.0, 10.0), 1.0, 0.0);
}

} // namespace

int main() {
  costs();
  chosen();
  branching();
  return check_done();
}
