// SPDX-License-Identifier: BSD-3-Clause
// CACTUS strand lists: side of the box, number of strands, then for each strand its number of points and as
// many rows "x y z r". Centred frame, um. Words are read, not lines: the C++ half writes 6 digits and a
// trailing blank, the Python half 17.
#include "scene.hpp"

namespace conceg::importing {

Scene parse_cactus(TextFile text) {
  Scene scene;
  const double side = text.number("the side of the box");
  if (side > 0.0 && side <= coordinate_limit_um)
    scene.centred_box(glm::dvec3(side));
  else if (side != -1.0) // what the writer puts when it does not know
    text.refuse("expected the side of the box in um, or -1, got %g", side);
  const std::uint64_t strands = text.count("the number of strands");
  if (!strands) text.refuse("expected at least one strand, got 0");
  for (std::uint64_t strand = 0; strand < strands; strand++) {
    char what[64];
    std::snprintf(what, sizeof what, "the number of points of strand %llu",
                  static_cast<unsigned long long>(strand));
    const std::uint64_t points = text.count(what);
    if (!points)
      text.refuse("strand %llu: expected at least one point, got 0", static_cast<unsigned long long>(strand));
    std::snprintf(what, sizeof what, "x y z r of strand %llu", static_cast<unsigned long long>(strand));
    SceneCell cell;
    cell.type = "strand";
    for (std::uint64_t i = 0; i < points; i++) {
      const double x = text.coordinate(what), y = text.coordinate(what), z = text.coordinate(what);
      cell.follow({x, y, z}, text.radius(what), CONCEG_SWC_AXON);
    }
    cell.soma = cell.position[0];
    if (points == 1) { // a ball
      cell.soma_radius = cell.radius[0];
      cell.type = "ball", cell.cell_class = "other";
      cell.position.clear(), cell.radius.clear(), cell.parent.clear(), cell.kind.clear();
    }
    scene.cells.push_back(std::move(cell));
  }
  if (!text.at_end()) {
    std::string_view rest;
    text.word(rest);
    text.refuse("expected the end of the file after %llu strands, got \"%s\": a count is too small",
                static_cast<unsigned long long>(strands), shown(rest).c_str());
  }
  check_frame(scene, text.path(), "strand lists are in um, centred on the origin");
  return scene;
}

Scene read_cactus(const Request &request) {
  return parse_cactus(TextFile::open(request.ctx, only_file(request, "a strand list")));
}

} // namespace conceg::importing
