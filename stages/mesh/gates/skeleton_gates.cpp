// SPDX-License-Identifier: BSD-3-Clause
// Format, cells, skeletons and bars.
#include "gates.hpp"
#include "rows.hpp"

#include "wrap.hpp"

#include <glm/geometric.hpp>

#include <cmath>

namespace conceg::gates {
namespace {

struct Problems {
  std::uint64_t errors = 0, stale = 0;
  std::string first_error, first_stale;
};

void note_problem(void *user, const conceg_problem *problem) {
  auto &found = *static_cast<Problems *>(user);
  const std::string text =
      formatted("%s %s: expected %s, got %s", problem->rule, problem->path, problem->expected, problem->got);
  if (problem->severity == 0 && !found.errors++) found.first_error = text;
  if (std::string(problem->rule) == "CGX-070" && !found.stale++) found.first_stale = text;
}

// Counts what breaks a rule, and keeps the first place.
struct Finds {
  std::uint64_t count = 0;
  std::string first;
  template <class Say> void add(const Say &say) {
    if (!count++) first = say();
  }
};

} // namespace

void format_gates(conceg_doc *doc, Gates &gates) {
  Problems found;
  const conceg_status status = conceg_doc_validate(doc, nullptr, note_problem, &found);
  if (status != CONCEG_OK && status != CONCEG_E_FORMAT) must(status);
  gates.none("/", "format", found.errors, "every MUST rule of spec/cgx.md", found.first_error);
  gates.none("/", "origins", found.stale, "digests of @made_from against the groups as they are now",
             found.first_stale);
}

void cell_gates(conceg_doc *doc, Gates &gates) {
  const Cells cells(doc);
  const char *const in_box = "somata in the box", *const empty = "no empty cell";
  if (!cells.whole) {
    for (const char *name : {in_box, empty})
      gates.not_judged("/cells", name, "/cells cannot be read as rows");
    return;
  }
  const conceg_box box = read_box(doc);
  Finds outside, nothing;
  std::size_t lost_axons = 0;
  for (std::size_t i = 0; i < cells.rows(); i++) {
    bool inside = true;
    for (int axis = 0; axis < 3; axis++) {
      const double x = cells.soma.row(i)[axis];
      inside = inside && x >= box.lo[axis] && (box.periodic[axis] ? x < box.hi[axis] : x <= box.hi[axis]);
    }
    if (!inside)
      outside.add([&] {
        return formatted("cell %zu at (%g, %g, %g) um", i, cells.soma.row(i)[0], cells.soma.row(i)[1],
                         cells.soma.row(i)[2]);
      });
    if (cells.radius[i] > 0 || cells.points_of(i)) continue;
    if (cells.class_of(i) == "axon")
      lost_axons++;
    else
      nothing.add([&] { return formatted("cell %zu has neither soma nor skeleton", i); });
  }
  gates.none("/cells", in_box, outside.count, formatted("%zu cells", cells.rows()), outside.first);
  gates.none("/cells", empty, nothing.count,
             formatted("%zu cells; %zu passing axons found no free start", cells.rows(), lost_axons),
             nothing.first);
}

void skeleton_gates(conceg_doc *doc, Gates &gates) {
  const char *const g = "/skeleton";
  const char *const names[] = {"tree order", "radii", "places", "roots at their soma",
                               "inside the open sides"};
  const Cells cells(doc);
  const Skeletons s(doc, cells);
  if (!s.whole) {
    for (const char *name : names)
      gates.not_judged(g, name, has(doc, g) ? "/skeleton cannot be read as rows" : "no /skeleton");
    return;
  }
  const conceg_box box = read_box(doc);
  Finds order, radii, places, beyond;
  double least = INFINITY, largest = 0, farthest_root = 0;
  std::size_t roots = 0, worst_cell = 0;
  for (std::size_t cell = 0; cell < cells.rows(); cell++)
    for (std::size_t i = s.offset[cell]; i < s.offset[cell + 1]; i++) {
      const std::size_t row = i - s.offset[cell];
      const double *p = s.position.row(i), *c = cells.soma.row(cell);
      const double r = static_cast<double>(s.radius[i]);
      const auto place = [&] { return formatted("cell %zu, point %zu", cell, row); };
      if (s.parent[i] < -1 || s.parent[i] >= static_cast<std::int64_t>(row))
        order.add([&] { return place() + formatted(": parent %lld", static_cast<long long>(s.parent[i])); });
      if (!(r > 0) || !std::isfinite(r)) radii.add([&] { return place() + formatted(": %g um", r); });
      least = std::min(least, r), largest = std::max(largest, r);
      if (!std::isfinite(p[0] + p[1] + p[2])) {
        places.add(place);
        continue;
      }
      for (int axis = 0; axis < 3; axis++)
        if (!box.periodic[axis] && (p[axis] < box.lo[axis] - 1 || p[axis] > box.hi[axis] + 1)) {
          beyond.add([&] { return place() + formatted(" at (%g, %g, %g) um", p[0], p[1], p[2]); });
          break;
        }
      if (s.parent[i] != -1 || !(cells.radius[cell] > 0)) continue;
      const double off = glm::length(glm::dvec3(p[0] - c[0], p[1] - c[1], p[2] - c[2])) -
                         static_cast<double>(cells.radius[cell]);
      roots++;
      if (off > farthest_root) farthest_root = off, worst_cell = cell;
    }
  const std::string looked_at = formatted("%zu points of %zu cells", s.points(), cells.rows());
  gates.none(g, names[0], order.count, looked_at, order.first);
  gates.none(g, names[1], radii.count, looked_at + formatted(", %g to %g um", least, largest), radii.first);
  gates.none(g, names[2], places.count, looked_at, places.first);
  if (roots)
    gates.at_most(g, names[3], farthest_root, kRootReach, "um",
                  formatted("%zu roots, from the soma's surface; farthest in cell %zu", roots, worst_cell));
  else
    gates.not_judged(g, names[3], "no cell with a soma and a skeleton");
  if (box.periodic[0] && box.periodic[1] && box.periodic[2])
    gates.not_judged(g, names[4], "all sides are periodic");
  else
    gates.none(g, names[4], beyond.count, looked_at + ", more than 1 um beyond an open side", beyond.first);
}

void bar_gates(conceg_doc *doc, const Limits &limits, Gates &gates) {
  const char *const g = "/bars";
  const char *const names[] = {"cable asked for", "tips asked for", "bars in the skeleton"};
  const Cells cells(doc);
  const Skeletons s(doc, cells);
  const Bars b(doc, cells);
  const bool grown = b.whole && s.whole && s.bar.rows() == s.points() && s.points();
  if (!grown) {
    const char *why = !has(doc, g) ? "no /bars: nothing was asked for"
                      : !b.whole   ? "/bars cannot be read as rows"
                      : !s.whole   ? "no /skeleton that can be read"
                                   : "no /skeleton/bar";
    for (const char *name : names)
      gates.not_judged(g, name, why);
    return;
  }
  double asked = 0, achieved = 0;
  Finds tips, unknown;
  std::size_t bars = 0, state[5] = {}, all_tips = 0;
  for (std::size_t cell = 0; cell < cells.rows(); cell++) {
    const std::size_t first = b.offset[cell], count = b.offset[cell + 1] - first;
    bars += count;
    std::size_t grown_bars = 0, cell_tips = 0;
    std::vector<std::uint8_t> seen(count);
    std::vector<std::uint8_t> has_child(s.offset[cell + 1] - s.offset[cell]);
    for (std::size_t i = s.offset[cell]; i < s.offset[cell + 1]; i++) {
      const std::size_t row = i - s.offset[cell];
      if (s.parent[i] >= 0 && s.parent[i] < static_cast<std::int64_t>(row))
        has_child[static_cast<std::size_t>(s.parent[i])] = 1;
      if (s.bar[i] < count) seen[s.bar[i]] = 1;
    }
    for (std::size_t row = 0; row < has_child.size(); row++)
      cell_tips += !has_child[row];
    for (std::size_t i = 0; i < count; i++) {
      const std::size_t k = first + i;
      state[std::min<std::size_t>(4, b.state[k])]++;
      asked += b.asked_end[k] - b.asked_start[k];
      achieved += std::max(0.0, b.achieved_end[k] - b.achieved_start[k]);
      const bool stands = b.state[k] == 1 || b.state[k] == 2;
      grown_bars += stands && seen[i];
      if (stands && !seen[i] && b.achieved_end[k] > b.achieved_start[k])
        unknown.add(
            [&] { return formatted("cell %zu, bar %zu (state %u) has no point", cell, i, b.state[k]); });
      if (!stands && b.state[k] != 4 && seen[i])
        unknown.add(
            [&] { return formatted("cell %zu, bar %zu (state %u) has points", cell, i, b.state[k]); });
    }
    all_tips += cell_tips;
    if (cell_tips != grown_bars)
      tips.add([&] { return formatted("cell %zu has %zu tips for %zu bars", cell, cell_tips, grown_bars); });
  }
  gates.at_least(g, names[0], asked > 0 ? achieved / asked : 1, limits.cable, "1",
                 formatted("%.1f of %.1f um in %zu bars: %zu done, %zu short, %zu lost, %zu handed on",
                           achieved, asked, bars, state[1], state[2], state[3], state[4]));
  gates.none(g, names[1], tips.count,
             formatted("%zu tips of %zu cells: one per bar that stands", all_tips, cells.rows()), tips.first);
  gates.none(g, names[2], unknown.count, formatted("%zu bars", bars), unknown.first);
}

} // namespace conceg::gates
