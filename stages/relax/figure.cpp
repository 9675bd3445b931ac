// SPDX-License-Identifier: BSD-3-Clause
#include "output.hpp"
#include "plot.hpp"
#include "trace.hpp"

#include <algorithm>

namespace conceg::relax {

void write_figure(const std::string &folder, const std::vector<Step> &steps) {
  if (steps.size() < 2)
    fail(CONCEG_E_RANGE,
         "pictures: expected 6 iterations or more for a figure, got %zu steps of it; raise "
         "relax.iterations",
         steps.size());
  make_folder(folder);
  plot::Line mean, largest, united, several, planes;
  double deepest = 0, fullest = 0;
  for (const Step &step : steps) {
    const double x = step.iteration;
    const auto pairs = static_cast<double>(std::max<std::uint64_t>(1, step.state.overlapping));
    mean.push_back({x, step.state.overlap_sum / pairs}), largest.push_back({x, step.state.largest_overlap});
    united.push_back({x, step.fractions.united}), several.push_back({x, step.fractions.several});
    planes.push_back({x, step.fractions.planes});
    deepest = std::max(deepest, step.state.largest_overlap),
    fullest = std::max(fullest, step.fractions.united);
  }
  const plot::Colour dark = plot::rgb(0x222222), red = plot::rgb(0xc0392b), blue = plot::rgb(0x2471a3);
  plot::Page page(470, 240);
  const std::vector<plot::Box> boxes = plot::columns({45, 25, 410, 150}, 2, 50);
  const double last = steps.back().iteration;
  plot::Panel overlap(
      page, boxes[0], {0, last, "iteration", 6, true},
      {0, plot::round_up(std::max(deepest, 1e-6)), "overlap of two round cones (um)", 6, true});
  plot::Panel fraction(page, boxes[1], {0, last, "iteration", 6, true},
                       {0, std::min(1.0, fullest * 1.1 + 0.01), "share of the box", 6, true});
  overlap.axes(), fraction.axes();
  page.text({boxes[0].left, 15}, "Overlap at target radii", {8, {}, plot::Anchor::left, true, false});
  page.text({boxes[1].left, 15}, "Volume fraction at target radii", {8, {}, plot::Anchor::left, true, false});
  overlap.line(largest, dark, 1), overlap.line(mean, red, 1);
  fraction.line(united, dark, 1), fraction.line(planes, blue, 1), fraction.line(several, red, 1);
  plot::legend(page, {boxes[0].left, 215}, {{"largest", dark}, {"mean of those that overlap", red}},
               plot::Anchor::left);
  plot::legend(page, {boxes[1].left, 215}, {{"in cells", dark}, {"behind planes", blue}, {"in several", red}},
               plot::Anchor::left);
  OutputFile file(folder + "/relaxation.svg");
  file.write(page.svg("Overlap and volume fraction as the tissue relaxes"));
  file.commit();
}

} // namespace conceg::relax
