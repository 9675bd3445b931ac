// SPDX-License-Identifier: BSD-3-Clause
// Morphometrics: a tree whose figures follow from its drawing, real cells against NeuroM, and what must not
// matter (frame, row order, ids).
#include "golden.hpp"

#include "metrics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace conceg::metrics;
using golden::Json;

namespace {

constexpr double degree = 57.29577951308232;

Samples samples_of(const conceg_swc *swc) {
  Samples s;
  const double *position = conceg_swc_position(swc);
  for (std::size_t i = 0; i < conceg_swc_count(swc); i++) {
    s.position.emplace_back(position[3 * i], position[3 * i + 1], position[3 * i + 2]);
    s.radius.push_back(conceg_swc_radius(swc)[i]), s.kind.push_back(conceg_swc_kind(swc)[i]);
    s.parent.push_back(conceg_swc_parent(swc)[i]);
  }
  double center[3];
  conceg_swc_soma(swc, center, &s.soma_radius);
  s.soma = {center[0], center[1], center[2]};
  return s;
}

// A trunk of 10 um along x, then a fork: 3-4-5 daughter up and left-hand one straight on, whose end forks
// into three.
void check_drawing() {
  Samples s;
  const auto add = [&](double x, double y, double z, double r, std::int64_t parent, int kind = 3) {
    s.position.emplace_back(x, y, z), s.radius.push_back(r), s.parent.push_back(parent),
        s.kind.push_back(kind);
  };
  add(0, 0, 0, 1.0, -1);
  add(6, 0, 0, 1.0, 0), add(10, 0, 0, 1.0, 1);  // 2: fork of two
  add(10, 3, 0, 0.5, 2), add(14, 3, 0, 0.5, 3); // 4: tip; 3 um up, then 4 um along x
  add(20, 0, 0, 0.25, 2);                       // 5: fork of three
  add(20, 1, 0, 0.25, 5), add(20, -1, 0, 0.25, 5), add(21, 0, 0, 0.25, 5);
  s.soma = {-2, 0, 0};
  const Metrics m = measure(s, 5.0);
  CHECK_EQUAL(m.sections.size(), 6);
  const Section &trunk = m.sections[0], &bent = m.sections[1], &on = m.sections[2];
  CHECK_EQUAL(trunk.order, 1);
  CHECK_EQUAL(bent.order, 2);
  CHECK_EQUAL(m.sections[3].order, 3);
  CHECK_EQUAL(trunk.strahler, 2);
  CHECK_EQUAL(bent.strahler, 1);
  CHECK_EQUAL(on.strahler, 2);
  CHECK_NEAR(trunk.length, 10, 0);
  CHECK_NEAR(bent.length, 7, 0);
  CHECK_NEAR(bent.chord, 5, 1e-15);
  CHECK_NEAR(bent.straightness, 5.0 / 7.0, 1e-15);
  CHECK_NEAR(bent.straightness_1um, 5.0 / 7.0, 1e-15);
  CHECK_NEAR(bent.path_distance, 17, 0);
  CHECK_NEAR(bent.tip_straightness, std::sqrt(14.0 * 14 + 9) / 17, 1e-15);
  CHECK_NEAR(m.sections[3].straightness_1um, none, 0); // 1 um long: not judged
  CHECK_NEAR(trunk.local_angle * degree, 90, 1e-12);
  CHECK_NEAR(trunk.remote_angle * degree, std::atan2(3, 4) * degree, 1e-9);
  CHECK_NEAR(on.local_angle, none, 0); // three daughters
  CHECK_NEAR(trunk.rall_ratio, std::pow(0.5, 1.5) + std::pow(0.25, 1.5), 1e-15);
  CHECK_NEAR(trunk.sibling_ratio, 0.5, 0);
  CHECK_NEAR(trunk.asymmetry, 3.0 / 5.0, 0); // 1 against 4 sections
  CHECK_NEAR(on.taper, -0.075, 1e-15);       // 1 -> 0.25 um over 10 um
  CHECK_NEAR(trunk.area, 2 * 3.14159265358979 * 10, 1e-9);
  CHECK_NEAR(trunk.volume, 3.14159265358979 * 10, 1e-9);
  const Group &all = m.groups[0];
  CHECK_EQUAL(all.tips, 4);
  CHECK_EQUAL(all.forks, 2);
  CHECK_EQUAL(all.bifurcations, 1);
  CHECK_EQUAL(all.trees, 1);
  CHECK_NEAR(all.length, 30, 1e-12);
  CHECK_NEAR(all.extent[0], 21, 0);
  CHECK_NEAR(all.extent[1], 4, 0);
  CHECK_NEAR(all.hull_volume, 0, 0); // flat
  CHECK_EQUAL(all.sholl.size(), 4);  // about (-2, 0, 0) at 5, 10, 15, 20 um; the tip at 23 um ends before 25
  CHECK_EQUAL(all.sholl[0], 1);
  CHECK_EQUAL(all.sholl[1], 1);
  CHECK_EQUAL(all.sholl[2], 2);
  CHECK_EQUAL(all.sholl[3], 1);
  s.position[4].z = 6;
  // Tetrahedra from (0,0,0): the hull of a known solid is a unit cube elsewhere; here only that it is no
  // longer flat.
  CHECK(measure(s, 5.0).groups[0].hull_volume > 1.0);
  CHECK_NEAR(hull_volume({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}, {0.1, 0.1, 0.1}}, nullptr), 4.0, 1e-12);
}

// A change of type makes a section, but no order; NeuroM counts it.
void check_change_of_type() {
  Samples s;
  for (int i = 0; i < 5; i++) {
    s.position.emplace_back(i, 0, 0), s.radius.push_back(1), s.parent.push_back(i - 1);
    s.kind.push_back(i < 3 ? 3 : 2);
  }
  const Metrics m = measure(s, 10.0);
  CHECK_EQUAL(m.sections.size(), 2);
  CHECK_EQUAL(m.sections[1].order, 1);
  CHECK_EQUAL(m.sections[1].ancestors, 1);
  CHECK_EQUAL(m.sections[1].kind, 2);
  CHECK_EQUAL(m.groups.size(), 2); // by the first section's type
  CHECK_EQUAL(m.groups[1].kind, 3);
  CHECK_EQUAL(m.groups[0].forks, 0);
  CHECK_EQUAL(m.groups[0].tips, 1);
  CHECK_EQUAL(measure(Samples{}, 10.0).groups.size(), 1); // nothing is a cell too
}

// Position of the first row of a file.
glm::dvec3 first_row(const std::string &path) {
  std::ifstream in(path);
  std::string line;
  while (std::getline(in, line))
    if (!line.empty() && line[0] != '#') break;
  std::istringstream row(line);
  double id, kind;
  glm::dvec3 p(0.0);
  CHECK(static_cast<bool>(row >> id >> kind >> p.x >> p.y >> p.z));
  return p;
}

void check_spread(const Spread &ours, const Json &theirs, double scale, double relative, double absolute) {
  CHECK_EQUAL(ours.count, theirs.at("n").number);
  CHECK_NEAR(ours.mean * scale, theirs.at("mean").number,
             absolute + relative * std::fabs(theirs.at("mean").number));
  CHECK_NEAR(ours.sd * scale, theirs.at("std").number,
             absolute + relative * std::fabs(theirs.at("mean").number));
}

// The last row of a straightness comes from the float32 coordinates of MorphIO: 1e-5 of a length, 0.02
// degree.
void check_group(const Group &ours, const Json &theirs) {
  CHECK_EQUAL(ours.trees, theirs.at("number_of_neurites").number);
  CHECK_EQUAL(ours.sections, theirs.at("number_of_sections").number);
  CHECK_EQUAL(ours.bifurcations, theirs.at("number_of_bifurcations").number);
  CHECK_EQUAL(ours.forks, theirs.at("number_of_forking_points").number);
  CHECK_EQUAL(ours.tips, theirs.at("number_of_leaves").number);
  const double length = theirs.at("total_length").number;
  CHECK_NEAR(ours.length, length, 1e-5 * length);
  CHECK_NEAR(ours.area, theirs.at("total_area").number, 1e-5 * ours.area);
  CHECK_NEAR(ours.volume, theirs.at("total_volume").number, 1e-5 * ours.volume);
  check_spread(ours.section_length, theirs.at("section_lengths"), 1, 1e-5, 0);
  check_spread(ours.ancestors, theirs.at("section_branch_orders"), 1, 1e-6, 0);
  check_spread(ours.straightness, theirs.at("tau"), 1, 1e-5, 0);
  check_spread(ours.local_angle, theirs.at("local_bifurcation_angles_deg"), degree, 0, 0.02);
  check_spread(ours.remote_angle, theirs.at("remote_bifurcation_angles_deg"), degree, 0, 0.02);
  check_spread(ours.asymmetry, theirs.at("partition_asymmetry"), 1, 1e-6, 1e-7);
  CHECK_EQUAL(ours.strahler_largest, theirs.at("section_strahler_orders_max").number);
  CHECK_NEAR(ours.path_largest, theirs.at("section_path_distances_q").items.back().number,
             1e-5 * ours.path_largest);
  const std::vector<Json> &sholl = theirs.at("sholl_crossings_20_500_20").items;
  for (std::size_t k = 0; k < sholl.size(); k++)
    CHECK_EQUAL(k < ours.sholl.size() ? ours.sholl[k] : 0, sholl[k].number);
}

double sum_of(const Metrics &m) {
  const Group &g = m.groups[0];
  return g.length + g.order.mean + g.local_angle.mean + g.remote_angle.mean + g.straightness_1um.mean +
         g.tip_straightness_1um.mean + g.rall_ratio.mean + g.asymmetry.mean + g.taper.mean +
         static_cast<double>(g.strahler_largest) + g.tip_path.sd;
}

// The same cell in another frame, and with its trees and daughters in another order.
void check_same_cell(const Samples &cell) {
  const Metrics before = measure(cell, 20.0);
  Samples turned = cell;
  const double c = std::cos(0.7), s = std::sin(0.7);
  const auto turn = [&](glm::dvec3 &p) {
    p = glm::dvec3(c * p.x - s * p.y + 31.0, s * p.x + c * p.y - 7.0, p.z + 1000.0);
  };
  for (glm::dvec3 &p : turned.position)
    turn(p);
  turn(turned.soma);
  const Metrics after = measure(turned, 20.0);
  CHECK_NEAR(sum_of(after), sum_of(before), 1e-6);
  CHECK_NEAR(after.groups[0].hull_volume, before.groups[0].hull_volume, 1e-6 * before.groups[0].hull_volume);

  // Samples by depth, last ones first: parents still come before their children.
  std::vector<std::size_t> depth(cell.size(), 0), order(cell.size()), place(cell.size());
  for (std::size_t i = 0; i < cell.size(); i++)
    if (cell.parent[i] >= 0) depth[i] = depth[static_cast<std::size_t>(cell.parent[i])] + 1;
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return depth[a] != depth[b] ? depth[a] < depth[b] : a > b; });
  for (std::size_t k = 0; k < order.size(); k++)
    place[order[k]] = k;
  Samples shuffled = cell;
  for (std::size_t k = 0; k < order.size(); k++) {
    const std::size_t i = order[k];
    shuffled.position[k] = cell.position[i], shuffled.radius[k] = cell.radius[i],
    shuffled.kind[k] = cell.kind[i];
    shuffled.parent[k] =
        cell.parent[i] < 0 ? -1 : static_cast<std::int64_t>(place[static_cast<std::size_t>(cell.parent[i])]);
  }
  CHECK_NEAR(sum_of(measure(shuffled, 20.0)), sum_of(before), 1e-9);
}

} // namespace

int main() {
  check_drawing();
  check_change_of_type();
  const Json figures = golden::load();
  conceg_ctx *ctx = conceg_ctx_new();
  for (const auto &[name, cell] : figures.at("cells").members) {
    const int failed = check_failed_;
    conceg_swc *swc = nullptr;
    CHECK_EQUAL(conceg_swc_read(ctx, (golden::folder() + cell.at("file").text).c_str(), 0, &swc), CONCEG_OK);
    Samples samples = samples_of(swc);
    samples.soma = first_row(golden::folder() + cell.at("file").text); // NeuroM's centre of every soma form
    const Metrics m = measure(samples, 20.0);
    for (const auto &[group, theirs] : cell.at("groups").members) {
      const int kind = group == "all" ? all_kinds : group == "axon" ? 2 : group == "basal" ? 3 : 4;
      const auto found =
          std::find_if(m.groups.begin(), m.groups.end(), [&](const Group &g) { return g.kind == kind; });
      CHECK(found != m.groups.end());
      if (found != m.groups.end()) check_group(*found, theirs);
    }
    check_same_cell(samples);
    if (failed != check_failed_) fprintf(stderr, "  in %s\n", name.c_str());
    conceg_swc_free(swc);
  }
  conceg_ctx_free(ctx);
  return check_done();
}
