// SPDX-License-Identifier: BSD-3-Clause
#include "measures.hpp"

namespace conceg::characterise {
namespace {

const char *name_of(int kind) {
  switch (kind) {
  case metrics::all_kinds:
    return "all";
  case neurite_axon:
    return "axon";
  case neurite_basal:
    return "basal";
  case neurite_apical:
    return "apical";
  case neurite_glia:
    return "glia";
  default:
    return "other";
  }
}

void put(Table &table, const char *mean, const char *sd, const metrics::Spread &spread, const char *unit) {
  table.put(mean, spread.mean, unit), table.put(sd, spread.sd, unit);
}

void put_section(Table &t, const metrics::Section &s) {
  t.put("parent", static_cast<std::uint64_t>(s.parent + 1));
  t.put("tree", std::uint64_t{s.tree} + 1);
  t.put("neurite", name_of(s.kind));
  t.put("order", static_cast<std::uint64_t>(s.order)),
      t.put("order_from_0", static_cast<std::uint64_t>(s.order - 1));
  t.put("strahler", static_cast<std::uint64_t>(s.strahler));
  t.put("daughters", std::uint64_t{s.children}), t.put("samples", std::uint64_t{s.samples});
  t.put("length", s.length, "um"), t.put("chord", s.chord, "um");
  t.put("straightness", s.straightness, "1"), t.put("straightness_1um", s.straightness_1um, "1");
  t.put("tip_straightness", s.tip_straightness, "1"),
      t.put("tip_straightness_1um", s.tip_straightness_1um, "1");
  t.put("path_distance", s.path_distance, "um"), t.put("radial_distance", s.radial_distance, "um");
  t.put("mean_radius", s.mean_radius, "um"), t.put("taper", s.taper, "1");
  t.put("area", s.area, "um^2"), t.put("volume", s.volume, "um^3");
  t.put("local_angle", s.local_angle, "rad"), t.put("remote_angle", s.remote_angle, "rad");
  t.put("rall_ratio", s.rall_ratio, "1"), t.put("sibling_ratio", s.sibling_ratio, "1");
  t.put("asymmetry", s.asymmetry, "1");
}

void put_group(Table &t, const metrics::Group &g) {
  t.put("stems", g.trees), t.put("sections", g.sections), t.put("forks", g.forks),
      t.put("bifurcations", g.bifurcations);
  t.put("tips", g.tips);
  t.put("length", g.length, "um"), t.put("area", g.area, "um^2"), t.put("volume", g.volume, "um^3");
  put(t, "order", "order_sd", g.order, "1");
  t.put("order_from_0", g.sections ? g.order.mean - 1.0 : 0.0, "1");
  t.put("order_largest", static_cast<std::uint64_t>(g.order_largest));
  t.put("strahler_largest", static_cast<std::uint64_t>(g.strahler_largest));
  put(t, "section_length", "section_length_sd", g.section_length, "um");
  put(t, "straightness", "straightness_sd", g.straightness, "1");
  put(t, "straightness_1um", "straightness_1um_sd", g.straightness_1um, "1");
  put(t, "tip_straightness", "tip_straightness_sd", g.tip_straightness, "1");
  put(t, "tip_straightness_1um", "tip_straightness_1um_sd", g.tip_straightness_1um, "1");
  put(t, "local_angle", "local_angle_sd", g.local_angle, "rad");
  put(t, "remote_angle", "remote_angle_sd", g.remote_angle, "rad");
  put(t, "tip_path", "tip_path_sd", g.tip_path, "um");
  t.put("path_largest", g.path_largest, "um"), t.put("radial_largest", g.radial_largest, "um");
  put(t, "taper", "taper_sd", g.taper, "1"), put(t, "rall_ratio", "rall_ratio_sd", g.rall_ratio, "1");
  put(t, "asymmetry", "asymmetry_sd", g.asymmetry, "1");
  t.put("extent_x", g.extent[0], "um"), t.put("extent_y", g.extent[1], "um"),
      t.put("extent_z", g.extent[2], "um");
  t.put("hull_volume", g.hull_volume, "um^3");
}

} // namespace

metrics::Samples whole_cell(const Samples &samples, const glm::dvec3 &soma, double soma_radius) {
  return {samples.position, samples.radius, samples.kind, samples.parent, soma, soma_radius};
}

metrics::Samples whole_cell(const Cell &cell) {
  metrics::Samples out;
  out.soma = cell.soma, out.soma_radius = cell.soma_radius;
  for (const Tree &tree : cell.trees) {
    const auto first = static_cast<std::int64_t>(out.size());
    out.position.insert(out.position.end(), tree.position.begin(), tree.position.end());
    out.radius.insert(out.radius.end(), tree.radius.begin(), tree.radius.end());
    out.kind.insert(out.kind.end(), tree.size(), tree.neurite);
    for (const std::int64_t up : tree.parent)
      out.parent.push_back(up < 0 ? -1 : up + first);
  }
  return out;
}

void Measures::add(const std::string &entry, const std::string &donor, const metrics::Metrics &cell) {
  std::uint64_t number = 0;
  for (const metrics::Section &section : cell.sections) {
    sections_.put("entry", entry), sections_.put("donor", donor), sections_.put("section", ++number);
    put_section(sections_, section);
  }
  for (const metrics::Group &group : cell.groups) {
    cells_.put("entry", entry), cells_.put("donor", donor), cells_.put("neurite", name_of(group.kind));
    put_group(cells_, group);
    for (std::size_t k = 0; k < group.sholl.size(); k++) {
      sholl_.put("entry", entry), sholl_.put("donor", donor), sholl_.put("neurite", name_of(group.kind));
      sholl_.put("radius", sholl_step_um * static_cast<double>(k + 1), "um"),
          sholl_.put("crossings", group.sholl[k]);
    }
  }
}

} // namespace conceg::characterise
