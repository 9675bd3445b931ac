// SPDX-License-Identifier: BSD-3-Clause
#include "metrics.hpp"

#include "straightness.hpp"

#include "conceg/portable.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conceg::metrics {
namespace {

constexpr double pi = 3.14159265358979323846;

// What a section needs while its samples pass by.
struct Walk {
  glm::dvec3 start, direction{0.0}; // of the first segment that has some length
  double first_radius;              // of its first own sample
  ResampledPath resampled;
  double weighted_radius = 0.0, sum_radius = 0.0;
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0; // least squares of radius on path
  Walk(const glm::dvec3 &from, double radius)
      : start(from), first_radius(radius), resampled(from, resample_step_um) {}
  void place(double path, double radius) {
    n += 1.0, sx += path, sy += radius, sxx += path * path, sxy += path * radius;
  }
};

class Measurement {
public:
  Measurement(const Samples &cell, double sholl_step_um) : cell_(cell), step_(sholl_step_um) {}

  Metrics run() {
    count_children();
    for (std::size_t i = 0; i < cell_.size(); i++)
      visit(i);
    for (std::size_t s = 0; s < sections_.size(); s++)
      finish(s);
    measure_ends();
    measure_tips();
    Metrics out;
    std::vector<int> kinds = tree_kind_;
    std::sort(kinds.begin(), kinds.end());
    kinds.erase(std::unique(kinds.begin(), kinds.end()), kinds.end());
    out.groups.push_back(group(all_kinds));
    std::vector<glm::dvec3> corners; // of all groups: their hull is that of the cell
    for (const int kind : kinds) {
      out.groups.push_back(group(kind));
      measure_space(out.groups.back(), corners);
    }
    join_space(out.groups, corners);
    out.sections = std::move(sections_);
    return out;
  }

private:
  void count_children() {
    children_.assign(cell_.size(), 0);
    section_of_.resize(cell_.size());
    for (const std::int64_t up : cell_.parent)
      if (up >= 0) children_[static_cast<std::size_t>(up)]++;
  }

  // A section opens at its fork and takes the fork's sample along, as a point that it shares.
  std::size_t open(std::size_t sample, std::int64_t up, bool fork) {
    const bool root = up < 0;
    const std::size_t from = root ? sample : static_cast<std::size_t>(up);
    Section section;
    section.kind = cell_.kind[sample];
    if (root) {
      section.tree = static_cast<std::uint32_t>(tree_kind_.size());
      tree_kind_.push_back(section.kind), tree_first_.push_back(sample);
    } else {
      const std::size_t before = section_of_[from];
      Section &parent = sections_[before];
      section.parent = static_cast<std::int64_t>(before);
      section.tree = parent.tree, section.order = parent.order + fork,
      section.ancestors = parent.ancestors + 1;
      section.path_distance = parent.path_distance;
      parent.children++;
    }
    section.samples = 1, section.last = from;
    sections_.push_back(section);
    walks_.emplace_back(cell_.position[from], cell_.radius[sample]);
    walks_.back().place(0.0, cell_.radius[from]);
    walks_.back().sum_radius = cell_.radius[from];
    return sections_.size() - 1;
  }

  void visit(std::size_t i) {
    const std::int64_t up = cell_.parent[i];
    if (up < 0) {
      section_of_[i] = open(i, up, false);
      return;
    }
    const auto from = static_cast<std::size_t>(up);
    const bool fork = children_[from] > 1;
    section_of_[i] = fork || cell_.kind[i] != cell_.kind[from] ? open(i, up, fork) : section_of_[from];
    extend(section_of_[i], from, i);
  }

  void extend(std::size_t index, std::size_t from, std::size_t to) {
    Section &section = sections_[index];
    Walk &walk = walks_[index];
    const glm::dvec3 edge = cell_.position[to] - cell_.position[from];
    const double h = glm::length(edge), r0 = cell_.radius[from], r1 = cell_.radius[to];
    if (h > 0.0 && walk.direction == glm::dvec3(0.0)) walk.direction = edge;
    section.length += h, section.path_distance += h;
    section.area += pi * (r0 + r1) * std::sqrt((r0 - r1) * (r0 - r1) + h * h);
    section.volume += pi * h * (r0 * r0 + r0 * r1 + r1 * r1) / 3.0;
    walk.weighted_radius += h * (r0 + r1) / 2.0, walk.sum_radius += r1;
    walk.place(section.length, r1);
    walk.resampled.add(cell_.position[to]);
    section.samples++, section.last = to;
  }

  void finish(std::size_t index) {
    Section &s = sections_[index];
    const Walk &walk = walks_[index];
    s.chord = glm::length(cell_.position[s.last] - walk.start);
    if (s.length > 0.0) s.straightness = std::min(1.0, s.chord / s.length);
    if (s.length >= shortest_judged_um) s.straightness_1um = walk.resampled.straightness();
    s.radial_distance = glm::length(cell_.position[s.last] - cell_.soma);
    s.mean_radius = s.length > 0.0 ? walk.weighted_radius / s.length : walk.sum_radius / s.samples;
    const double spread = walk.n * walk.sxx - walk.sx * walk.sx;
    if (s.length > 0.0 && spread > 0.0) s.taper = (walk.n * walk.sxy - walk.sx * walk.sy) / spread;
  }

  static double angle(const glm::dvec3 &a, const glm::dvec3 &b) {
    return conceg_atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
  }

  // From the tips inwards: what depends on the daughters of a section.
  void measure_ends() {
    const std::size_t count = sections_.size();
    std::vector<std::uint64_t> subtree(count, 1);
    std::vector<std::int64_t> first(count, -1), second(count, -1); // daughters
    std::vector<int> highest(count, 0), ties(count, 0);
    std::vector<double> powers(count, 0.0);
    for (std::size_t s = count; s-- > 0;) {
      Section &section = sections_[s];
      if (section.children) section.strahler = highest[s] + (ties[s] > 1);
      if (section.children == 2) measure_fork(section, subtree, first[s], second[s]);
      if (section.children >= 2 && cell_.radius[section.last] > 0.0)
        section.rall_ratio = powers[s] / std::pow(cell_.radius[section.last], 1.5);
      if (section.parent < 0) continue;
      const auto up = static_cast<std::size_t>(section.parent);
      subtree[up] += subtree[s];
      second[up] = first[up], first[up] = static_cast<std::int64_t>(s);
      if (section.strahler > highest[up])
        highest[up] = section.strahler, ties[up] = 1;
      else if (section.strahler == highest[up])
        ties[up]++;
      powers[up] += std::pow(std::max(0.0, walks_[s].first_radius), 1.5);
    }
  }

  void measure_fork(Section &section, const std::vector<std::uint64_t> &subtree, std::int64_t one,
                    std::int64_t other) {
    const auto a = static_cast<std::size_t>(one), b = static_cast<std::size_t>(other);
    const glm::dvec3 zero(0.0);
    if (walks_[a].direction != zero && walks_[b].direction != zero)
      section.local_angle = angle(walks_[a].direction, walks_[b].direction);
    const glm::dvec3 fork = cell_.position[section.last];
    section.remote_angle =
        angle(cell_.position[sections_[a].last] - fork, cell_.position[sections_[b].last] - fork);
    const double thin = std::min(walks_[a].first_radius, walks_[b].first_radius),
                 thick = std::max(walks_[a].first_radius, walks_[b].first_radius);
    if (thick > 0.0) section.sibling_ratio = thin / thick;
    const auto n = static_cast<double>(subtree[a]), m = static_cast<double>(subtree[b]);
    section.asymmetry = std::fabs(n - m) / (n + m);
  }

  void measure_tips() {
    std::vector<std::size_t> line;
    for (Section &section : sections_) {
      if (section.children) continue;
      line.clear();
      for (auto i = static_cast<std::int64_t>(section.last); i >= 0;
           i = cell_.parent[static_cast<std::size_t>(i)])
        line.push_back(static_cast<std::size_t>(i));
      const glm::dvec3 &start = cell_.position[line.back()];
      const double chord = glm::length(cell_.position[section.last] - start);
      section.tip_straightness =
          section.path_distance > 0.0 ? std::min(1.0, chord / section.path_distance) : 1.0;
      if (section.path_distance < shortest_judged_um) continue;
      ResampledPath path(start, resample_step_um);
      for (std::size_t k = line.size() - 1; k-- > 0;)
        path.add(cell_.position[line[k]]);
      section.tip_straightness_1um = path.straightness();
    }
  }

  bool belongs(const Section &section, int kind) const {
    return kind == all_kinds || tree_kind_[section.tree] == kind;
  }

  template <class Value> Spread spread(int kind, Value value) const {
    Spread out;
    double sum = 0.0, squares = 0.0;
    for (const Section &section : sections_) {
      double v;
      if (belongs(section, kind) && value(section, v)) out.count++, sum += v;
    }
    if (!out.count) return out;
    out.mean = sum / static_cast<double>(out.count);
    for (const Section &section : sections_) {
      double v;
      if (belongs(section, kind) && value(section, v)) squares += (v - out.mean) * (v - out.mean);
    }
    out.sd = std::sqrt(squares / static_cast<double>(out.count));
    return out;
  }
  // Of a column in which `none` means that a section has no such value.
  Spread spread(int kind, double Section::*column) const {
    return spread(kind, [column](const Section &s, double &v) { return (v = s.*column) != none; });
  }

  Group group(int kind) const {
    Group g;
    g.kind = kind;
    for (const int tree : tree_kind_)
      g.trees += kind == all_kinds || tree == kind;
    for (const Section &s : sections_) {
      if (!belongs(s, kind)) continue;
      g.sections++, g.tips += !s.children, g.forks += s.children >= 2, g.bifurcations += s.children == 2;
      g.length += s.length, g.area += s.area, g.volume += s.volume;
      g.order_largest = std::max(g.order_largest, s.order);
      g.strahler_largest = std::max(g.strahler_largest, s.strahler);
      g.path_largest = std::max(g.path_largest, s.path_distance);
    }
    g.order = spread(kind, [](const Section &s, double &v) { return v = s.order, true; });
    g.ancestors = spread(kind, [](const Section &s, double &v) { return v = s.ancestors, true; });
    g.section_length = spread(kind, &Section::length);
    g.straightness = spread(kind, &Section::straightness),
    g.straightness_1um = spread(kind, &Section::straightness_1um);
    g.tip_straightness = spread(kind, &Section::tip_straightness);
    g.tip_straightness_1um = spread(kind, &Section::tip_straightness_1um);
    g.local_angle = spread(kind, &Section::local_angle),
    g.remote_angle = spread(kind, &Section::remote_angle);
    g.taper = spread(kind, [](const Section &s, double &v) { return v = s.taper, s.length > 0.0; });
    g.rall_ratio = spread(kind, &Section::rall_ratio), g.asymmetry = spread(kind, &Section::asymmetry);
    g.tip_path = spread(kind, [](const Section &s, double &v) { return v = s.path_distance, !s.children; });
    return g;
  }

  // What needs the samples again: extent, hull, spheres of Sholl.
  void measure_space(Group &g, std::vector<glm::dvec3> &corners) const {
    std::vector<glm::dvec3> points, own;
    for (std::size_t i = 0; i < cell_.size(); i++) {
      if (!belongs(sections_[section_of_[i]], g.kind)) continue;
      points.push_back(cell_.position[i]);
      g.radial_largest = std::max(g.radial_largest, glm::length(cell_.position[i] - cell_.soma));
      if (cell_.parent[i] >= 0) cross_spheres(g, static_cast<std::size_t>(cell_.parent[i]), i);
    }
    g.extent = extent_of(points);
    g.hull_volume = hull_volume(points, &own);
    corners.insert(corners.end(), own.begin(), own.end());
  }

  static std::array<double, 3> extent_of(const std::vector<glm::dvec3> &points) {
    std::array<double, 3> extent{};
    for (int axis = 0; axis < 3 && !points.empty(); axis++) {
      double low = points[0][axis], high = low;
      for (const glm::dvec3 &p : points)
        low = std::min(low, p[axis]), high = std::max(high, p[axis]);
      extent[static_cast<std::size_t>(axis)] = high - low;
    }
    return extent;
  }

  // The first group is the sum of the others.
  static void join_space(std::vector<Group> &groups, const std::vector<glm::dvec3> &corners) {
    Group &all = groups.front();
    for (std::size_t k = 1; k < groups.size(); k++) {
      const Group &g = groups[k];
      all.radial_largest = std::max(all.radial_largest, g.radial_largest);
      if (all.sholl.size() < g.sholl.size()) all.sholl.resize(g.sholl.size());
      for (std::size_t i = 0; i < g.sholl.size(); i++)
        all.sholl[i] += g.sholl[i];
    }
    all.extent = extent_of(corners);
    all.hull_volume = groups.size() == 2 ? groups[1].hull_volume : hull_volume(corners, nullptr);
  }

  // A segment crosses every sphere between the distances of its ends, both included.
  void cross_spheres(Group &g, std::size_t from, std::size_t to) const {
    const glm::dvec3 a = cell_.position[from] - cell_.soma, b = cell_.position[to] - cell_.soma;
    const double near = std::min(glm::dot(a, a), glm::dot(b, b)),
                 far = std::max(glm::dot(a, a), glm::dot(b, b));
    auto k = static_cast<std::uint64_t>(std::max(1.0, std::floor(std::sqrt(near) / step_)));
    for (; (static_cast<double>(k) * step_) * (static_cast<double>(k) * step_) <= far; k++) {
      const double radius = static_cast<double>(k) * step_;
      if (radius * radius < near) continue;
      if (g.sholl.size() < k) g.sholl.resize(k);
      g.sholl[k - 1]++;
    }
  }

  const Samples &cell_;
  double step_;
  std::vector<std::uint32_t> children_;
  std::vector<std::size_t> section_of_, tree_first_;
  std::vector<int> tree_kind_;
  std::vector<Section> sections_;
  std::vector<Walk> walks_;
};

} // namespace

Metrics measure(const Samples &cell, double sholl_step_um) {
  return Measurement(cell, sholl_step_um).run();
}

} // namespace conceg::metrics
