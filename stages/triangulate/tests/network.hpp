// SPDX-License-Identifier: GPL-3.0-or-later
// Small networks for the tests of this folder.
#pragma once

#include "../delaunay.hpp"
#include "../levels.hpp"
#include "../nodes.hpp"

#include "wrap.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Periodic_3_Delaunay_triangulation_3.h>
#include <CGAL/Periodic_3_Delaunay_triangulation_traits_3.h>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

namespace conceg::triangulate {

// A directed edge: from, to, shift.
using Edge = std::array<std::int64_t, 5>;

struct Network {
  std::vector<std::uint64_t> offset;
  std::vector<std::uint32_t> neighbour;
  std::vector<std::int8_t> shift;
  bool operator==(const Network &o) const {
    return offset == o.offset && neighbour == o.neighbour && shift == o.shift;
  }
  // Sorted.
  std::vector<Edge> edges() const {
    std::vector<Edge> out;
    out.reserve(neighbour.size());
    for (std::size_t i = 0; i + 1 < offset.size(); i++)
      for (std::uint64_t k = offset[i]; k < offset[i + 1]; k++)
        out.push_back(
            {static_cast<std::int64_t>(i), neighbour[k], shift[3 * k], shift[3 * k + 1], shift[3 * k + 2]});
    std::sort(out.begin(), out.end());
    return out;
  }
};

inline conceg_box cube(double side, bool periodic = true) {
  conceg_box box = {};
  for (int axis = 0; axis < 3; axis++)
    box.lo[axis] = -1.25, box.hi[axis] = -1.25 + side, box.periodic[axis] = periodic;
  return box;
}

inline std::vector<glm::dvec3> nodes_of(const conceg_box &box, NodeSet set, double density = 2.0,
                                        bool mirrored = false) {
  Workers workers(1);
  NodeOptions options;
  options.set = set;
  options.density_per_um3 = density;
  options.mirrored_faces = mirrored;
  return make_nodes(box, options, workers, {});
}

// Nodes of three levels around a soma near a corner and one in the middle.
inline NodeOptions graded_options(const conceg_box &box, double density = 2.0) {
  NodeOptions options;
  options.density_per_um3 = density;
  const glm::dvec3 lo(box.lo[0], box.lo[1], box.lo[2]);
  const std::vector<Soma> somas = {{lo + 0.02 * side(box), 0.8}, {lo + 0.55 * side(box), 1.2}};
  options.levels = grade_levels(lattice_of(box, density), soma_zones(somas, 2, 0.7), somas);
  return options;
}

inline std::vector<glm::dvec3> graded_nodes(const conceg_box &box) {
  Workers workers(1);
  return make_nodes(box, graded_options(box), workers, {});
}

inline Network network_of(const conceg_box &box, const std::vector<glm::dvec3> &nodes,
                          const DelaunayOptions &options, unsigned threads, std::uint64_t *widened = nullptr,
                          double *largest_circumradius = nullptr) {
  Workers workers(threads);
  Edges edges = delaunay_edges(box, nodes, options, workers, {});
  if (widened) *widened = edges.widened;
  if (largest_circumradius) *largest_circumradius = edges.largest_circumradius;
  Network network;
  network.offset.resize(nodes.size() + 1);
  network.neighbour.resize(edges.count);
  network.shift.resize(3 * edges.count);
  merge_tiles(std::move(edges), nodes.size(), network.offset.data(), network.neighbour.data(),
              network.shift.data());
  return network;
}

inline Network network_of(const conceg_box &box, const std::vector<glm::dvec3> &nodes, double tile,
                          double halo, unsigned threads, bool mirrored = false,
                          std::uint64_t *widened = nullptr) {
  DelaunayOptions options;
  options.tile_um = tile, options.halo_um = halo, options.mirrored_faces = mirrored;
  return network_of(box, nodes, options, threads, widened);
}

inline bool symmetric(const std::vector<Edge> &edges) {
  return std::all_of(edges.begin(), edges.end(), [&](const Edge &e) {
    return std::binary_search(edges.begin(), edges.end(), Edge{e[1], e[0], -e[2], -e[3], -e[4]});
  });
}

// All directed edges by CGAL's own periodic triangulation, sorted.
inline std::vector<Edge> by_periodic_3(const conceg_box &box, const std::vector<glm::dvec3> &nodes) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Traits = CGAL::Periodic_3_Delaunay_triangulation_traits_3<Kernel>;
  using Periodic = CGAL::Periodic_3_Delaunay_triangulation_3<Traits>;
  std::map<std::array<double, 3>, std::uint32_t> id;
  std::vector<Kernel::Point_3> points;
  for (std::size_t i = 0; i < nodes.size(); i++) {
    id[{nodes[i].x, nodes[i].y, nodes[i].z}] = static_cast<std::uint32_t>(i);
    points.emplace_back(nodes[i].x, nodes[i].y, nodes[i].z);
  }
  const Periodic::Iso_cuboid cuboid(box.lo[0], box.lo[1], box.lo[2], box.hi[0], box.hi[1], box.hi[2]);
  Periodic periodic(cuboid);
  periodic.insert(points.begin(), points.end(), true);
  std::vector<Edge> edges;
  for (auto edge = periodic.edges_begin(); edge != periodic.edges_end(); ++edge) {
    const auto a = periodic.periodic_point(edge->first, edge->second);
    const auto b = periodic.periodic_point(edge->first, edge->third);
    const auto node = [&](const auto &p) {
      return static_cast<std::int64_t>(id.at({p.first.x(), p.first.y(), p.first.z()}));
    };
    Edge there = {node(a), node(b)}, back = {node(b), node(a)};
    for (int axis = 0; axis < 3; axis++) {
      there[2 + axis] = b.second[axis] - a.second[axis];
      back[2 + axis] = -there[2 + axis];
    }
    edges.push_back(there), edges.push_back(back);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end()); // a small box is held 27 times
  return edges;
}

} // namespace conceg::triangulate
