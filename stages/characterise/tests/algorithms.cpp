// SPDX-License-Identifier: BSD-3-Clause
// Hand-made trees with known answers: sections, barcode, angles, straightness, calibre, frame, cleaning.
#include "check.h"

#include "calibre.hpp"
#include "dictionary.hpp"
#include "frame.hpp"
#include "preprocess.hpp"
#include "sections.hpp"
#include "tests/trees.hpp"

#include "conceg/rng.h"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace conceg;
using namespace conceg::characterise;

namespace {

Tree tree_of(const std::vector<glm::dvec3> &position, const std::vector<std::int64_t> &parent,
             double radius = 0.5) {
  Tree tree;
  tree.position = position, tree.parent = parent, tree.radius.assign(position.size(), radius);
  return tree;
}

// Path 0 to 10 um at a fork: a side branch to 13 um, and on to 30 um, where it forks into tips at 40 and 35
// um.
Tree small_tree() {
  return tree_of({{0, 0, 0}, {10, 0, 0}, {30, 0, 0}, {10, 3, 0}, {40, 0, 0}, {30, -3, -4}},
                 {-1, 0, 1, 1, 2, 2});
}

void check_sections() {
  const std::vector<Section> s = find_sections(small_tree());
  CHECK_EQUAL(s.size(), 5);
  CHECK_EQUAL(s[0].order, 1);
  CHECK_NEAR(s[0].length, 10, 1e-12);
  CHECK_EQUAL(s[0].parent, -1);
  CHECK_NEAR(s[1].length, 20, 1e-12);
  CHECK_EQUAL(s[1].order, 2);
  CHECK_NEAR(s[2].length, 10, 1e-12);
  CHECK_EQUAL(s[2].order, 3);
  CHECK_EQUAL(s[2].parent, 1);
  CHECK_NEAR(s[3].length, 5, 1e-12);
  CHECK_NEAR(s[4].length, 3, 1e-12);
  CHECK_EQUAL(s[4].order, 2);
  const std::vector<double> angles = fork_angles(small_tree());
  CHECK_EQUAL(angles.size(), 2);
  CHECK_NEAR(angles[0], 1.5707963267948966, 1e-12);
  CHECK_NEAR(angles[1], 1.5707963267948966, 1e-12);
  CHECK(find_sections(Tree{}).empty());
  CHECK_EQUAL(fork_angles(tree_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {-1, 0, 0, 0})).size(),
              0); // three daughters
}

void check_bars() {
  const std::vector<Bar> bars = find_bars(small_tree());
  CHECK_EQUAL(bars.size(), 3);
  CHECK_NEAR(bars[0].birth, 0, 0);
  CHECK_NEAR(bars[0].death, 40, 1e-12);
  CHECK_EQUAL(bars[0].parent, -1);
  CHECK_NEAR(bars[1].birth, 10, 1e-12);
  CHECK_NEAR(bars[1].death, 13, 1e-12);
  CHECK_EQUAL(bars[1].parent, 0);
  CHECK_EQUAL(bars[1].rival, 2);
  CHECK_NEAR(bars[2].birth, 30, 1e-12);
  CHECK_NEAR(bars[2].death, 35, 1e-12);
  // Ties: the first child survives. Three daughters give two bars at one place.
  const std::vector<Bar> tie =
      find_bars(tree_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {-1, 0, 0, 0}));
  CHECK_EQUAL(tie.size(), 3);
  CHECK_EQUAL(tie[0].nodes.back(), 1);
  CHECK_EQUAL(tie[1].nodes.back(), 2);
  CHECK_EQUAL(tie[2].parent, 0);
  CHECK_EQUAL(find_bars(tree_of({{0, 0, 0}}, {-1})).size(), 1);
  CHECK(find_bars(Tree{}).empty());
}

Tree random_tree(std::uint64_t id, std::size_t nodes) {
  conceg_rng rng = conceg_rng_stream(7, "test", id);
  Tree tree;
  for (std::size_t i = 0; i < nodes; i++) {
    // Mostly long runs: a node hangs on its forerunner nine times out of ten.
    const std::int64_t up =
        i == 0 ? -1
               : static_cast<std::int64_t>(conceg_rng_below(&rng, 10) ? i - 1 : conceg_rng_below(&rng, i));
    const glm::dvec3 from = up < 0 ? glm::dvec3(0.0) : tree.position[static_cast<std::size_t>(up)];
    tree.position.push_back(
        from + glm::dvec3{conceg_rng_normal(&rng), conceg_rng_normal(&rng), conceg_rng_normal(&rng)});
    tree.radius.push_back(0.2 + conceg_rng_uniform(&rng));
    tree.parent.push_back(up);
  }
  return tree;
}

void check_invariants() {
  for (std::uint64_t id = 0; id < 200; id++) {
    const Tree tree = random_tree(id, 1 + 3 * id);
    std::vector<Bar> bars = find_bars(tree);
    CHECK(invariants_hold(tree, bars));
    double sections = 0.0;
    for (const Section &s : find_sections(tree))
      sections += s.length;
    CHECK_NEAR(sections, cable_length(tree), 1e-9 * (1.0 + sections));
    if (bars.size() < 3) continue;
    bars.back().birth += 1e-3; // planted defects must be seen
    CHECK(!invariants_hold(tree, bars));
    bars.pop_back();
    CHECK(!invariants_hold(tree, bars));
  }
}

void check_straightness() {
  CHECK_NEAR(straightness({{0, 0, 0}, {5, 0, 0}, {9.5, 0, 0}}, 1.0), 1.0, 1e-12);
  CHECK_NEAR(straightness({{0, 0, 0}, {3, 0, 0}, {3, 4, 0}}, 1.0), 5.0 / 7.0, 1e-12);
  CHECK_NEAR(straightness({{1, 1, 1}}, 1.0), 1.0, 0);
  CHECK_NEAR(straightness({{1, 1, 1}, {1, 1, 1}}, 1.0), 1.0, 0);
  // A zig-zag below the step is smoothed away by resampling.
  std::vector<glm::dvec3> zigzag;
  for (int i = 0; i <= 200; i++)
    zigzag.emplace_back(0.1 * i, i % 2 ? 0.05 : 0.0, 0.0);
  CHECK(straightness(zigzag, 0.01) < 0.91);
  CHECK(straightness(zigzag, 1.0) > 0.99);
}

void check_calibre() {
  std::vector<double> path, radius;
  for (int i = 0; i <= 40; i++)
    path.push_back(7.0 + i), radius.push_back(1.0 - 0.01 * i);
  Calibre c = measure_calibre(path, radius);
  CHECK_NEAR(c.radius, 0.8, 1e-12);
  CHECK_NEAR(c.taper, -0.01, 1e-12);
  CHECK_NEAR(c.cv, 0.0, 1e-12);
  // r = exp(0.3 sin(2 pi x / 20)): the residual of ln r has sd 0.3 / sqrt 2; the autocorrelation cos(2 pi x /
  // 20) meets 1/e at 3.80 um.
  path.clear(), radius.clear();
  for (int i = 0; i <= 2000; i++)
    path.push_back(0.5 * i), radius.push_back(std::exp(0.3 * std::sin(0.31415926535897931 * 0.5 * i)));
  c = measure_calibre(path, radius);
  CHECK_NEAR(c.cv, 0.3 / std::sqrt(2.0), 2e-3);
  CHECK_NEAR(c.correlation_length, 3.80, 0.1);
  CHECK_NEAR(c.taper, 0.0, 1e-4);
  c = measure_calibre({0.0, 1.5}, {0.4, 0.2}); // too short for a taper
  CHECK_NEAR(c.radius, 0.3, 1e-12);
  CHECK_NEAR(c.taper, 0.0, 0);
  CHECK_NEAR(measure_calibre({3.0}, {0.7}).radius, 0.7, 0);
  CHECK_NEAR(measure_calibre({3.0, 3.0}, {0.7, 0.6}).radius, 0.6, 0);
}

void check_frame() {
  Cell cell;
  cell.soma = {1, 1, 1};
  cell.trees = {tree_of({{1, 1, 1}, {1, -99, 1}}, {-1, 0}), tree_of({{1, 1, 1}, {500, 1, 1}}, {-1, 0})};
  CHECK(apical_axis(cell) == glm::dvec3(0.0));
  cell.trees[0].neurite = neurite_apical;
  const glm::dvec3 axis = apical_axis(cell);
  CHECK_NEAR(axis.y, -1.0, 1e-12);
  CHECK_NEAR(rotate(rotation_to_z(axis), axis).z, 1.0, 1e-12);
  conceg_rng rng = conceg_rng_stream(1, "frame", 0);
  for (int i = 0; i < 100; i++) {
    const glm::dvec3 a =
        glm::normalize(glm::dvec3{conceg_rng_normal(&rng), conceg_rng_normal(&rng), conceg_rng_normal(&rng)});
    CHECK_NEAR(glm::length(rotate(rotation_to_z(a), a) - glm::dvec3(0, 0, 1)), 0.0, 1e-12);
  }
  CHECK_NEAR(rotate(rotation_to_z({0, 0, -1}), {0, 0, -1}).z, 1.0, 1e-12);
}

void check_twigs() {
  // A dendrite of 40 um with a spine of 2 um at 10 um, a real branch of 5 um at 20 um, and a fat stub of 2 um
  // at 30 um.
  Tree tree =
      tree_of({{0, 0, 0}, {10, 0, 0}, {10, 2, 0}, {20, 0, 0}, {20, 5, 0}, {30, 0, 0}, {30, 2, 0}, {40, 0, 0}},
              {-1, 0, 1, 1, 3, 3, 5, 5}, 0.2);
  tree.radius[6] = 0.6;
  CHECK_EQUAL(remove_twigs(tree, 3.0, 0.3), 1);
  CHECK_EQUAL(tree.size(), 7);
  CHECK_NEAR(cable_length(tree), 47, 1e-12);
  CHECK_EQUAL(find_sections(tree).size(), 5);
  CHECK_EQUAL(remove_twigs(tree, 3.0, 0.3), 0);
  // Both daughters are short: the longer one stays.
  Tree fork = tree_of({{0, 0, 0}, {10, 0, 0}, {11, 0, 0}, {10, 2, 0}}, {-1, 0, 1, 1}, 0.2);
  CHECK_EQUAL(remove_twigs(fork, 3.0, 0.3), 1);
  CHECK_NEAR(cable_length(fork), 12, 1e-12);
}

void check_cleaning() {
  Samples s;
  const auto add = [&](double x, double y, int kind, std::int64_t parent, bool on_soma) {
    s.position.emplace_back(x, y, 0.0), s.radius.push_back(0.01), s.kind.push_back(kind),
        s.parent.push_back(parent), s.on_soma.push_back(on_soma);
  };
  add(5, 0, 3, -1, true); // 0: a dendrite of 40 um ...
  add(20, 0, 3, 0, false);
  add(45, 0, 3, 1, false);
  add(20, 10, 2, 1, false); // 3: ... that carries an axon of 30 um
  add(20, 40, 2, 3, false);
  add(0, -5, 4, -1, true); // 5: apical
  add(0, -50, 4, 5, false);
  add(90, 0, 2, -1, false); // 7: a loose piece of axon, longer
  add(190, 0, 2, 7, false);
  add(90, 9, 3, -1, false); // 9: a loose dendrite
  add(99, 9, 3, 9, false);
  add(0, 5, 3, -1, true); // 11: a stub
  Cleaning rules;
  rules.tree_length_um = 3.0, rules.lowest_radius_um = 0.05;
  Cleaned left_out;
  std::vector<Tree> trees = clean_trees(s, glm::dvec3(0.0), 5.0, rules, left_out);
  CHECK_EQUAL(trees.size(), 2);
  CHECK_EQUAL(trees[0].neurite, neurite_basal);
  CHECK_NEAR(cable_length(trees[0]), 40, 1e-12);
  CHECK_EQUAL(trees[1].neurite, neurite_apical);
  CHECK_NEAR(trees[1].radius[0], 0.05, 0);
  CHECK_EQUAL(left_out.axon_pieces, 2);
  CHECK_EQUAL(left_out.floating, 1);
  CHECK_EQUAL(left_out.short_trees, 1);
  CHECK_EQUAL(left_out.raised_radii, 12);
  rules.axons = true, left_out = Cleaned{};
  trees = clean_trees(s, glm::dvec3(0.0), 5.0, rules, left_out);
  CHECK_EQUAL(trees.size(), 3);
  CHECK_EQUAL(trees[1].neurite, neurite_axon);
  CHECK_NEAR(cable_length(trees[1]), 30, 1e-12);
  CHECK_EQUAL(left_out.axon_pieces, 1);
  rules.glia = true;
  CHECK_EQUAL(clean_trees(s, glm::dvec3(0.0), 5.0, rules, left_out)[0].neurite, neurite_glia);
}

void check_clip() {
  // A fork inside the sphere becomes two trees; one that comes back stays whole.
  const Tree tree =
      tree_of({{0, 0, 0}, {2, 0, 0}, {9, 0, 0}, {2, 6, 0}, {2, 1, 0}, {2, 9, 0}}, {-1, 0, 1, 1, 3, 4});
  const std::vector<Tree> out = clip_at_sphere(tree, glm::dvec3(0.0), 5.0);
  CHECK_EQUAL(out.size(), 2);
  CHECK_NEAR(glm::length(out[0].position[0]), 5.0, 1e-9);
  CHECK_NEAR(glm::length(out[1].position[0]), 5.0, 1e-9);
  CHECK_NEAR(cable_length(out[0]), 4.0, 1e-9);
  CHECK_EQUAL(out[1].size(), 4);
  CHECK(clip_at_sphere(tree, glm::dvec3(0.0), 50.0).empty());
}

void check_donor() {
  Dictionary d;
  EntrySums sums;
  Cell cell;
  cell.soma = {-5, 0, 0}, cell.soma_radius = 5.0, cell.trees = {small_tree()};
  open_entry(d, "test", "pyramidal", "");
  Donor donor;
  donor.frame = rotation_to_z({1, 0, 0}), donor.frame_kind = "axis";
  const CellFigures f = add_cell(d, sums, donor, cell);
  close_entry(d, sums);
  CHECK_EQUAL(d.bar_birth.size(), 3);
  CHECK_EQUAL(f.bars, 3);
  CHECK_NEAR(f.cable, 48.0, 1e-12);
  CHECK_NEAR(d.bar_tip_direction[0].z, 1.0, 1e-12);
  CHECK_NEAR(d.bar_tip_distance[0], 45.0, 1e-12);
  CHECK_NEAR(d.bar_angle[0], 0.0, 0);
  CHECK_NEAR(d.bar_angle[2], 1.5707963267948966, 1e-12);
  CHECK_NEAR(d.tree_trunk_direction[0].z, 1.0, 1e-12);
  CHECK_NEAR(d.entry_straightness[0], 1.0, 1e-12);
  CHECK_EQUAL(d.entry_angle_offset[1], 2);
}

} // namespace

int main() {
  check_sections();
  check_bars();
  check_invariants();
  check_straightness();
  check_calibre();
  check_frame();
  check_twigs();
  check_cleaning();
  check_clip();
  check_donor();
  return check_done();
}
