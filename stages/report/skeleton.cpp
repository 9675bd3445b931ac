// SPDX-License-Identifier: BSD-3-Clause
#include "skeleton.hpp"

#include <glm/geometric.hpp>

namespace conceg::reporting {
namespace {

glm::dvec3 point(const SkeletonView &s, std::size_t i) {
  return {s.position[3 * i], s.position[3 * i + 1], s.position[3 * i + 2]};
}

// Which points end a run: tips, forks, and those whose one daughter has another kind or is not the next row.
// Calls visit(first row, rows, row before the first or -1) for each run of a cell, in order.
template <class Visit> void each_run(const SkeletonView &s, std::size_t cell, Visit &&visit) {
  const std::size_t first = s.cell_offset[cell], count = s.cell_offset[cell + 1] - first;
  std::vector<std::uint8_t> daughters(count, 0);
  for (std::size_t i = 0; i < count; i++) {
    const std::int64_t parent = s.parent[first + i];
    if (parent >= 0 && daughters[static_cast<std::size_t>(parent)] < 2)
      daughters[static_cast<std::size_t>(parent)]++;
  }
  for (std::size_t begin = 0, end; begin < count; begin = end) {
    end = begin + 1;
    while (end < count && s.parent[first + end] == static_cast<std::int64_t>(end) - 1 &&
           daughters[end - 1] == 1 && s.kind[first + end] == s.kind[first + begin])
      end++;
    visit(first + begin, end - begin, s.parent[first + begin]);
  }
}

// Calls keep(row) for the points that stay of one run; `before` is the row that it begins at, or -1.
template <class Keep>
void each_kept(const SkeletonView &s, std::size_t first, std::size_t count, std::int64_t before,
               double spacing_um, Keep &&keep) {
  glm::dvec3 last = point(s, before >= 0 ? static_cast<std::size_t>(before) : first);
  double gone = 0.0;
  if (before >= 0) keep(static_cast<std::size_t>(before));
  for (std::size_t i = first; i < first + count; i++) {
    const glm::dvec3 here = point(s, i);
    gone += glm::length(here - last), last = here;
    const bool end = i + 1 == first + count, start = before < 0 && i == first;
    if (!end && !start && gone < spacing_um) continue;
    keep(i), gone = 0.0;
  }
}

std::size_t count_points(const SkeletonView &s, double spacing_um, std::size_t stride) {
  std::size_t points = 0;
  for (std::size_t cell = 0; cell < s.cells; cell += stride)
    each_run(s, cell, [&](std::size_t first, std::size_t count, std::int64_t parent) {
      const std::int64_t before = parent < 0 ? -1 : static_cast<std::int64_t>(s.cell_offset[cell]) + parent;
      each_kept(s, first, count, before, spacing_um, [&](std::size_t) { points++; });
    });
  return points;
}

} // namespace

Runs runs_of(const SkeletonView &s, double spacing_um, std::size_t stride) {
  Runs out;
  for (std::size_t cell = 0; cell < s.cells; cell += stride)
    each_run(s, cell, [&](std::size_t first, std::size_t count, std::int64_t parent) {
      const std::int64_t before = parent < 0 ? -1 : static_cast<std::int64_t>(s.cell_offset[cell]) + parent;
      each_kept(s, first, count, before, spacing_um, [&](std::size_t i) {
        out.position.push_back(point(s, i)), out.radius.push_back(s.radius[i]);
      });
      out.point_offset.push_back(static_cast<std::uint32_t>(out.position.size()));
      out.cell.push_back(static_cast<std::uint32_t>(cell)), out.kind.push_back(s.kind[first]);
    });
  return out;
}

Thinned thin(const SkeletonView &skeletons, std::size_t most) {
  Thinned out;
  for (const double spacing : {0.0, 0.5, 1.0, 2.0, 4.0, 8.0}) {
    out.spacing_um = spacing;
    if (count_points(skeletons, spacing, 1) <= most) break;
  }
  while (out.stride < skeletons.cells && count_points(skeletons, out.spacing_um, out.stride) > most)
    out.stride++;
  if (count_points(skeletons, out.spacing_um, out.stride) > most) return out.stride = 0, out;
  out.runs = runs_of(skeletons, out.spacing_um, out.stride);
  return out;
}

} // namespace conceg::reporting
