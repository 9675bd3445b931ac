// SPDX-License-Identifier: GPL-3.0-or-later
// Every directed edge with its shift equals CGAL's own periodic triangulation, which sees no tiles and no
// halo. test_triangulate_periodic_3 [SIDE_UM]; 50 um hold 250 000 nodes.
#include "network.hpp"

#include "check.h"

using namespace conceg::triangulate;

static void compare(const char *name, const conceg_box &box, const NodeOptions &options, double degree) {
  conceg::Workers workers(2);
  const auto nodes = make_nodes(box, options, workers, {});
  DelaunayOptions delaunay;
  delaunay.tile_um = 0.4 * conceg_box_side(&box, 0); // 27 tiles
  delaunay.halo_um = first_halo_um(box, options);
  std::uint64_t widened = 0;
  const std::vector<Edge> edges = network_of(box, nodes, delaunay, 2, &widened).edges();
  std::printf("%s: %zu nodes, %zu directed edges\n", name, nodes.size(), edges.size());
  CHECK(static_cast<double>(nodes.size()) > 1.9 * conceg::volume(box));
  CHECK_EQUAL(widened, 0);
  CHECK(edges == by_periodic_3(box, nodes));
  CHECK_NEAR(static_cast<double>(edges.size()) / static_cast<double>(nodes.size()), degree, 0.2);
}

int main(int arguments, char **argument) {
  const conceg_box box = cube(arguments > 1 ? std::atof(argument[1]) : 24.0);
  NodeOptions options;
  compare("bcc", box, options, 14.3);
  compare("graded", box, graded_options(box), 14.4);
  options.set = NodeSet::uniform;
  compare("uniform", box, options, 15.54); // 2 + 48 pi^2 / 35 in theory
  return check_done();
}
