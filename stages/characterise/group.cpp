// SPDX-License-Identifier: BSD-3-Clause
#include "group.hpp"

#include "guard.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace conceg::characterise {
namespace {

// The cells of a kind differ by less than 4; voxels of an electron microscope and um by 100 and more.
constexpr double most_apart = 20.0;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

} // namespace

double extent_of(const Cell &cell) {
  const bool dendrites = std::any_of(cell.trees.begin(), cell.trees.end(),
                                     [](const Tree &tree) { return tree.neurite != neurite_axon; });
  glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi = -lo;
  for (const Tree &tree : cell.trees) {
    if (dendrites && tree.neurite == neurite_axon) continue;
    for (const glm::dvec3 &p : tree.position)
      lo = glm::min(lo, p), hi = glm::max(hi, p);
  }
  return cell.trees.empty() ? 0.0 : std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
}

void check_units(const std::string &entry, const std::vector<FileExtent> &files) {
  if (files.size() < 2) return;
  std::vector<double> logs;
  for (const FileExtent &file : files)
    logs.push_back(std::log(std::max(file.extent_um, 1e-6)));
  std::size_t farthest = 0;
  double apart = -1.0, typical = 0.0;
  for (std::size_t i = 0; i < files.size(); i++) {
    std::vector<double> others(logs);
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const double middle = median(others);
    if (std::abs(logs[i] - middle) >= apart)
      apart = std::abs(logs[i] - middle), farthest = i, typical = middle;
  }
  if (apart < std::log(most_apart)) return;
  fail(CONCEG_E_RANGE,
       "%s: expected a cell of about %.4g um across as the others of entry %s, got %.4g um; are its units "
       "um? scale "
       "the file, or give it an entry of its own",
       files[farthest].path.c_str(), std::exp(typical), entry.c_str(), files[farthest].extent_um);
}

} // namespace conceg::characterise
