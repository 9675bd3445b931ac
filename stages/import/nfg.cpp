// SPDX-License-Identifier: BSD-3-Clause
// Numerical Fibre Generator: a folder of strand_..-rRADIUS.txt, rows "x y z", all in mm; the radius is in the
// name.
#include "scene.hpp"

namespace conceg::importing {
namespace {

constexpr double um_per_mm = 1000.0, widest_um = 1000.0;

double radius_in_name(const TextFile &text) {
  const std::string name = base_name(text.path());
  const std::size_t at = name.rfind("-r"), end = name.rfind(".txt");
  double radius = 0.0;
  if (at == std::string::npos || end == std::string::npos || end < at + 3 ||
      !parse_number(std::string_view(name).substr(at + 2, end - at - 2), radius))
    fail(CONCEG_E_FORMAT, "%s: expected a name like strand_00-r0.015000.txt that holds the radius in mm",
         text.path().c_str());
  if (!(static_cast<float>(radius * um_per_mm) > 0.0f && radius * um_per_mm <= widest_um))
    fail(CONCEG_E_FORMAT, "%s: expected a radius above 0 and at most %g mm in the name, got %g: is it in mm?",
         text.path().c_str(), widest_um / um_per_mm, radius);
  return radius * um_per_mm;
}

} // namespace

void parse_nfg(TextFile text, Scene &scene) {
  SceneCell cell;
  cell.type = "strand";
  const double radius = radius_in_name(text);
  std::string_view line;
  while (text.line(line)) {
    const auto words = words_of(line);
    if (words.empty() || words[0][0] == '#') continue;
    if (words.size() != 3) text.refuse("expected x y z, got %zu values", words.size());
    glm::dvec3 at(0.0);
    for (int axis = 0; axis < 3; axis++)
      at[axis] = text.number(words[static_cast<std::size_t>(axis)], "x y z") * um_per_mm;
    if (!(std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) <= coordinate_limit_um))
      text.refuse("expected coordinates of at most %g mm, got %g %g %g: are they in mm?",
                  coordinate_limit_um / um_per_mm, at.x / um_per_mm, at.y / um_per_mm, at.z / um_per_mm);
    cell.follow(at, radius, CONCEG_SWC_AXON);
  }
  if (cell.position.size() < 2) text.refuse("expected at least two points, got %zu", cell.position.size());
  cell.soma = cell.position[0];
  scene.cells.push_back(std::move(cell));
}

Scene read_nfg(const Request &request) {
  Scene scene;
  for (const std::string &path : find_files(request.names, {".txt"}))
    parse_nfg(TextFile::open(request.ctx, path), scene);
  return scene;
}

} // namespace conceg::importing
