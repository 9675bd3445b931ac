// SPDX-License-Identifier: BSD-3-Clause
#include "structure_report.hpp"

#include "output.hpp"
#include "plot.hpp"

#include <algorithm>

namespace conceg::analyse {
namespace {

using namespace plot;

const Colour black = rgb(0x000000), real_colour = rgb(0x000000), grown_colour = rgb(0xd55e00);
constexpr double left = 76.0, top = 34.0, row_height = 66.0, row_gap = 26.0, page_width = 640.0;

struct Shown {
  Level level;
  Trait trait;
  const char *label;
  double scale;
};
constexpr Shown shown[] = {
    {Level::branch, Trait::order, "order of branches", 1.0},
    {Level::branch, Trait::branch_length, "branch [um]", 1.0},
    {Level::branch, Trait::straightness, "straightness", 1.0},
    {Level::branch, Trait::local_angle, "angle [degree]", 1.0},
    {Level::branch, Trait::tip_path, "path to tips [um]", 1.0},
    {Level::cell, Trait::cable, "cable of cells [mm]", 1e-3},
};

const StructureMeans *find(const StructureResult &r, const Shown &column) {
  for (const StructureMeans &m : r.means)
    if (m.level == column.level && m.trait == column.trait) return &m;
  return nullptr;
}

// Straight between the quantiles; the last one lies 1 high.
Line curve(const std::vector<double> &values, double scale) {
  Line line;
  for (std::size_t q = 0; q < values.size(); q++)
    line.push_back({scale * values[q], static_cast<double>(q) / static_cast<double>(quantiles - 1)});
  return line;
}

// To the 95 % of both sides and a fifth more: the longest branches would squeeze the rest.
double end_of(const StructureMeans &m, double scale) {
  double end = 0;
  for (const std::vector<double> *values : {&m.grown_quantiles, &m.real_quantiles})
    if (!values->empty()) end = std::max(end, scale * (*values)[quantiles - 2]);
  return end > 0 ? 1.2 * end : 1.0;
}

void draw_panel(Page &page, const Box &box, const StructureMeans &m, const Shown &column, bool first) {
  const bool bounded = column.trait == Trait::straightness;
  Panel panel(page, box, {bounded ? 0.4 : 0.0, bounded ? 1.0 : end_of(m, column.scale), column.label, 4},
              {0.0, 1.0, first ? "share" : "", 3, first});
  panel.axes();
  page.clip(box);
  panel.line(curve(m.real_quantiles, column.scale), real_colour, 1.2);
  panel.line(curve(m.grown_quantiles, column.scale), grown_colour, 1.2);
  page.unclip();
}

} // namespace

void draw_structure(const std::string &folder, const std::vector<StructureResult> &results) {
  std::vector<const StructureResult *> rows;
  for (const StructureResult &r : results)
    if (!r.means.empty()) rows.push_back(&r);
  if (folder.empty() || rows.empty()) return;
  const double height = top + static_cast<double>(rows.size()) * (row_height + row_gap);
  Page page(page_width, height);
  for (std::size_t i = 0; i < rows.size(); i++) {
    const double y = top + static_cast<double>(i) * (row_height + row_gap);
    const StructureResult &r = *rows[i];
    page.text({left - 36.0, y - 4.0},
              r.entry + ": " + std::to_string(r.grown) + " grown, " +
                  (r.donors ? std::to_string(r.donors) + " real" + (r.wide() ? " (wide)" : "") : "none real"),
              {7.0, black, Anchor::left, true, false});
    const std::vector<Box> boxes =
        columns({left - 36.0, y, page_width - left + 28.0, row_height - 16.0}, 6, 22.0);
    for (std::size_t k = 0; k < 6; k++)
      if (const StructureMeans *m = find(r, shown[k])) draw_panel(page, boxes[k], *m, shown[k], k == 0);
  }
  page.text({8.0, 12.0}, "Distributions of grown and of real cells that they were not grown from",
            {8.0, black, Anchor::left, true, false});
  legend(page, {page_width - 8.0, 12.0}, {{"real", real_colour}, {"grown", grown_colour}}, Anchor::right);
  OutputFile file(folder + "/structure.svg");
  file.write(page.svg("Structure of grown and of real cells")), file.commit();
}

} // namespace conceg::analyse
