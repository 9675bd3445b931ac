// SPDX-License-Identifier: BSD-3-Clause
#include "figure.hpp"

#include "morphology.hpp"
#include "panels.hpp"

#include <algorithm>
#include <cstdio>

namespace conceg::characterise {
namespace {

// The page is 180 mm wide, as two columns of a journal are. All in pt.
constexpr double page_width = 510.0, margin = 12.0, right = page_width - margin, first_row = 52.0,
                 row_gap = 46.0, left_of_axis = 30.0, tallest = 280.0, flattest = 90.0,
                 branches_height = 76.0;

const plot::Colour ink = plot::rgb(0x222222), quiet = plot::rgb(0x777E86);

std::string counted(std::size_t count, const std::string &word) {
  return std::to_string(count) + " " + word + (count == 1 ? "" : "s");
}

bool drawn(const DrawnCell &cell) {
  return cell.samples.size() != 0;
}

// Where the panels lie; the cells have one scale and their somata one height.
struct Layout {
  plot::Box barcode, diagram;
  std::vector<const DrawnCell *> cells;
  std::vector<plot::Box> boxes; // of the cells
  double scale = 1.0, up = 0.0, down = 0.0;
  double branches = 0.0, height = 0.0; // top of the last row, and of the page's end
};

// Alone a cell stands at the right of barcode and diagram, two stand below them.
void place_panels(Layout &out) {
  if (out.cells.size() == 1) {
    constexpr double column = 212.0, barcode_height = 136.0, side = 186.0;
    out.barcode = {margin + left_of_axis, first_row, column, barcode_height};
    out.diagram = {margin + left_of_axis, first_row + barcode_height + row_gap, side, side};
    const double left = margin + left_of_axis + column + 26.0;
    out.boxes = {{left, first_row, right - left, barcode_height + row_gap + side}};
  } else {
    constexpr double side = 156.0;
    const double left = right - side;
    out.barcode = {margin + 14.0, first_row, left - 48.0 - margin - 14.0, side};
    out.diagram = {left, first_row, side, side};
    out.boxes = plot::columns({margin, first_row + side + row_gap, right - margin, tallest}, 2, 16.0);
  }
}

Layout lay_out(const DrawnEntry &entry) {
  Layout out;
  out.cells.push_back(&entry.donors[entry.typical].cell);
  if (drawn(entry.grown)) out.cells.push_back(&entry.grown);
  place_panels(out);
  const bool two = out.cells.size() == 2;
  double widest = 1.0;
  for (const DrawnCell *cell : out.cells) {
    if (!drawn(*cell)) continue;
    const Extent extent = extent_of(cell->samples);
    widest = std::max(widest, extent.right - extent.left);
    out.up = std::max(out.up, extent.up), out.down = std::min(out.down, extent.down);
  }
  constexpr double below = 24.0; // for the scale bar
  const double high = std::max(1.0, out.up - out.down);
  out.scale = std::min((out.boxes[0].width - 20.0) / widest, (out.boxes[0].height - below) / high);
  if (two)
    for (plot::Box &box : out.boxes)
      box.height = std::max(flattest, high * out.scale + below);
  const bool measured = !entry.donor_branches.empty() || !entry.grown_branches.empty();
  const double end = out.boxes[0].top + out.boxes[0].height + (two ? 0.0 : 18.0);
  out.branches = end + (two ? 50.0 : 44.0);
  out.height = measured ? out.branches + branches_height + 30.0 : end + 12.0;
  return out;
}

void draw_pia(plot::Page &page, const plot::Point &at, bool known) {
  if (!known) {
    page.text({at.x, at.y + 8.0}, "pia unknown", {text_size, quiet, plot::Anchor::right});
    return;
  }
  const double x = at.x - 6.0;
  page.lines({{{x, at.y + 22.0}, {x, at.y + 11.0}}}, ink, 0.8);
  page.area({{x, at.y + 8.0}, {x - 2.2, at.y + 13.0}, {x + 2.2, at.y + 13.0}}, ink);
  page.text({x, at.y + 5.0}, "pia", {text_size, ink, plot::Anchor::middle});
}

void draw_cells(plot::Page &page, const Layout &layout) {
  for (std::size_t i = 0; i < layout.cells.size(); i++) {
    const DrawnCell &cell = *layout.cells[i];
    const plot::Box &box = layout.boxes[i];
    head(page, {box.left, box.top - 10.0}, static_cast<char>('c' + i), cell.title);
    if (!drawn(cell)) {
      page.text({box.left + box.width / 2.0, box.top + box.height / 2.0},
                "no reconstruction: these donors were made of barcodes",
                {text_size, quiet, plot::Anchor::middle});
      continue;
    }
    const Extent extent = extent_of(cell.samples);
    const double slack = (box.height - (layout.up - layout.down) * layout.scale) / 2.0;
    draw_cell(page,
              {box.left + box.width / 2.0 - (extent.left + extent.right) / 2.0 * layout.scale,
               box.top + slack + layout.up * layout.scale},
              layout.scale, cell.samples);
    draw_pia(page, {box.left + box.width, box.top}, cell.pia_up);
    const double length = plot::round_down(60.0 / layout.scale);
    char label[32];
    std::snprintf(label, sizeof label, "%g µm", length);
    plot::scale_bar(page, {box.left, box.top + box.height}, length, layout.scale, label);
  }
}

std::vector<plot::Key> kinds_of(const DrawnEntry &entry) {
  std::vector<bool> found(neurite_order().size(), false);
  for (const DrawnDonor &donor : entry.donors)
    for (const DrawnBar &bar : donor.bars)
      for (std::size_t k = 0; k < found.size(); k++)
        found[k] = found[k] || bar.neurite == neurite_order()[k];
  std::vector<plot::Key> keys;
  for (std::size_t k = 0; k < found.size(); k++)
    if (found[k]) {
      const int neurite = neurite_order()[k];
      keys.push_back({neurite_name(neurite, found[0]), neurite_colour(neurite), 2.2});
    }
  return keys;
}

void draw_heading(plot::Page &page, const DrawnEntry &entry) {
  const plot::TextStyle name{bold_size, ink, plot::Anchor::left, true};
  page.text({margin, 20.0}, entry.name, name);
  page.text({margin + page.text_width(entry.name, name) + 8.0, 20.0},
            entry.cell_class + ", " + counted(entry.donors.size(), "donor") +
                (entry.compared && !drawn(entry.grown) ? ", none grown" : ""),
            {text_size, quiet});
  plot::legend(page, {page_width - margin, 20.0}, kinds_of(entry), plot::Anchor::right);
}

} // namespace

std::string draw_entry(const DrawnEntry &entry) {
  const Layout layout = lay_out(entry);
  plot::Page page(page_width, layout.height);
  draw_heading(page, entry);

  const DrawnDonor &donor = entry.donors[entry.typical];
  head(page, {margin, layout.barcode.top - 10.0}, 'a', "barcode of donor " + donor.id);
  draw_barcode(page, layout.barcode, donor.bars);
  head(page, {layout.diagram.left - left_of_axis, layout.diagram.top - 10.0}, 'b', "bars of all donors");
  draw_diagram(page, layout.diagram, entry.donors);
  draw_cells(page, layout);

  if (!entry.donor_branches.empty() || !entry.grown_branches.empty()) {
    head(page, {margin, layout.branches - (layout.cells.size() == 2 ? 22.0 : 16.0)},
         static_cast<char>('c' + layout.cells.size()), "branches, mean ± sd");
    draw_distributions(page, {margin + 12.0, layout.branches, right - margin - 12.0, branches_height}, entry);
  }
  return page.svg(entry.name);
}

} // namespace conceg::characterise
