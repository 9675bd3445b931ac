// SPDX-License-Identifier: BSD-3-Clause
#include "tree.hpp"

#include "wrap.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::exporting {
namespace {

constexpr double end_tolerance = 1e-9; // share of a segment: a crossing closer to an end is taken as that end
constexpr double crossing_limit = 1e6;

// Places along a -> b, in (0, 1) and ascending, at which a periodic side of the box (or of an image of it) is
// crossed.
std::vector<double> crossings(const conceg_box &box, const glm::dvec3 &a, const glm::dvec3 &b) {
  std::vector<double> places;
  for (int axis = 0; axis < 3; axis++) {
    if (!box.periodic[axis] || a[axis] == b[axis]) continue;
    const double length = conceg_box_side(&box, axis);
    const double low = std::min(a[axis], b[axis]), high = std::max(a[axis], b[axis]);
    const double first = std::ceil((low - box.lo[axis]) / length),
                 last = std::floor((high - box.lo[axis]) / length);
    if (!(last - first < crossing_limit))
      fail(CONCEG_E_RANGE, "/skeleton: a segment of %g um crosses the box too often", high - low);
    for (double k = first; k <= last; k++) {
      const double place = (box.lo[axis] + k * length - a[axis]) / (b[axis] - a[axis]);
      if (place > end_tolerance && place < 1.0 - end_tolerance) places.push_back(place);
    }
  }
  std::sort(places.begin(), places.end());
  return places;
}

class Splitter {
public:
  Splitter(const Tree &whole, const conceg_box &box) : whole_(whole), box_(box), sides_(side(box)) {}

  Tree run() {
    std::vector<std::int64_t> end(whole_.size()); // the point that ends each segment
    lift_.reserve(whole_.size());
    for (std::size_t i = 0; i < whole_.size(); i++) {
      if (whole_.parent[i] < 0) {
        const glm::ivec3 at = lift(box_, whole_.position[i]);
        end[i] = add(i, i, 0.0, at, -1, at == glm::ivec3(0) && whole_.on_soma[i]);
      } else {
        end[i] = segment(static_cast<std::size_t>(whole_.parent[i]), i,
                         end[static_cast<std::size_t>(whole_.parent[i])]);
      }
    }
    return std::move(split_);
  }

private:
  // The pieces of the segment from point `a` to point `b`, after the point `last` that stands for a; returns
  // the last point.
  std::int64_t segment(std::size_t a, std::size_t b, std::int64_t last) {
    std::vector<double> places = crossings(box_, whole_.position[a], whole_.position[b]);
    places.push_back(1.0);
    double from = 0.0;
    for (const double to : places) {
      const glm::ivec3 at = lift(box_, glm::mix(whole_.position[a], whole_.position[b], 0.5 * (from + to)));
      if (at != lift_[static_cast<std::size_t>(last)]) last = add(a, b, from, at, -1, false);
      if (to - from > end_tolerance || to == 1.0) last = add(a, b, to, at, last, false);
      from = to;
    }
    return last;
  }

  std::int64_t add(std::size_t a, std::size_t b, double place, const glm::ivec3 &at, std::int64_t parent,
                   bool on_soma) {
    const auto mix = [&](const std::vector<double> &column) {
      return column[a] + place * (column[b] - column[a]);
    };
    split_.position.push_back(
        (place == 1.0 ? whole_.position[b] : glm::mix(whole_.position[a], whole_.position[b], place)) -
        glm::dvec3(at) * sides_);
    split_.radius.push_back(place == 1.0 ? whole_.radius[b] : mix(whole_.radius));
    if (!whole_.target_radius.empty())
      split_.target_radius.push_back(place == 1.0 ? whole_.target_radius[b] : mix(whole_.target_radius));
    split_.parent.push_back(parent);
    split_.kind.push_back(whole_.kind[b]);
    split_.on_soma.push_back(on_soma);
    const auto copy = [b](const std::vector<double> &from, std::vector<double> &to) {
      if (!from.empty()) to.push_back(from[b]);
    };
    copy(whole_.bar, split_.bar), copy(whole_.branch, split_.branch), copy(whole_.tree, split_.tree),
        copy(whole_.status, split_.status);
    lift_.push_back(at);
    return static_cast<std::int64_t>(split_.size()) - 1;
  }

  const Tree &whole_;
  const conceg_box &box_;
  const glm::dvec3 sides_;
  Tree split_;
  std::vector<glm::ivec3> lift_;
};

} // namespace

Tree split_at_box(const Tree &whole, const conceg_box &box) {
  return Splitter(whole, box).run();
}

std::vector<std::vector<std::uint32_t>> runs(const Tree &tree) {
  std::vector<std::uint32_t> children(tree.size(), 0), run_of(tree.size(), 0);
  for (const std::int64_t parent : tree.parent)
    if (parent >= 0) children[static_cast<std::size_t>(parent)]++;
  std::vector<std::vector<std::uint32_t>> lists;
  for (std::uint32_t i = 0; i < tree.size(); i++) {
    const std::int64_t parent = tree.parent[i];
    const bool goes_on = parent >= 0 && children[static_cast<std::size_t>(parent)] == 1;
    if (goes_on) {
      run_of[i] = run_of[static_cast<std::size_t>(parent)];
    } else {
      run_of[i] = static_cast<std::uint32_t>(lists.size());
      lists.emplace_back();
      if (parent >= 0) lists.back().push_back(static_cast<std::uint32_t>(parent));
    }
    lists[run_of[i]].push_back(i);
  }
  return lists;
}

} // namespace conceg::exporting
