// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay.hpp"

#include "circumsphere.hpp"
#include "tiles.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <atomic>

namespace conceg::triangulate {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_3<std::uint32_t, Kernel>; // info: index of the copy
using Cell = CGAL::Delaunay_triangulation_cell_base_3<Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<Vertex, Cell>>;

constexpr double kSafety = 1e-6;  // um; far above the rounding of a circumsphere, far below a node spacing
constexpr double kWiden = 1.5;    // factor of the halo when a certificate fails
constexpr int kAttempts = 24;     // 1.5^24 = 17 000 halos
constexpr double kBucketUm = 4.0; // width of the buckets that nodes are gathered from

Delaunay triangulation_of(const std::vector<Copy> &copies) {
  std::vector<std::pair<Kernel::Point_3, std::uint32_t>> points;
  points.reserve(copies.size());
  for (std::size_t i = 0; i < copies.size(); i++) {
    const glm::dvec3 &p = copies[i].position;
    points.emplace_back(Kernel::Point_3(p.x, p.y, p.z), static_cast<std::uint32_t>(i));
  }
  Delaunay delaunay;
  delaunay.insert(points.begin(), points.end()); // sorts them along a Hilbert curve first
  if (delaunay.number_of_vertices() != copies.size())
    fail(CONCEG_E_INTERNAL, "network: expected %zu vertices, got %zu; two nodes share a place", copies.size(),
         static_cast<std::size_t>(delaunay.number_of_vertices()));
  return delaunay;
}

// True when no node outside `region` can change an edge at a core copy: each cell there is finite and its
// circumsphere lies in the region, of which every node was inserted.
bool certified(const Delaunay &delaunay, const std::vector<Copy> &copies, const Region &region,
               double &largest_circumradius) {
  if (delaunay.dimension() < 3) return false;
  for (auto cell = delaunay.all_cells_begin(); cell != delaunay.all_cells_end(); ++cell) {
    bool at_core = false, infinite = false;
    std::array<const double *, 4> corner{};
    for (int i = 0; i < 4; i++) {
      if (delaunay.is_infinite(cell->vertex(i))) {
        infinite = true;
        continue;
      }
      const Copy &copy = copies[cell->vertex(i)->info()];
      at_core = at_core || copy.core;
      corner[i] = &copy.position.x;
    }
    if (!at_core) continue;
    Sphere sphere{};
    if (infinite || !circumsphere(corner, sphere)) return false;
    for (int axis = 0; axis < 3; axis++)
      if (!(sphere.center[axis] - sphere.radius >= region.lo[axis] + kSafety &&
            sphere.center[axis] + sphere.radius <= region.hi[axis] - kSafety))
        return false;
    largest_circumradius = std::max(largest_circumradius, sphere.radius);
  }
  return true;
}

// Neighbours of the core copies, each listed once per cell that it shares with the copy.
struct Stars {
  std::vector<std::uint64_t> offset; // [copies + 1]
  std::vector<std::uint32_t> other;  // index of the neighbouring copy
};

Stars stars_of(const Delaunay &delaunay, const std::vector<Copy> &copies) {
  Stars stars;
  stars.offset.assign(copies.size() + 1, 0);
  const auto each_pair = [&](auto &&visit) {
    for (auto cell = delaunay.finite_cells_begin(); cell != delaunay.finite_cells_end(); ++cell)
      for (int i = 0; i < 4; i++) {
        const std::uint32_t from = cell->vertex(i)->info();
        if (!copies[from].core) continue;
        for (int k = 1; k < 4; k++)
          visit(from, cell->vertex((i + k) & 3)->info());
      }
  };
  each_pair([&](std::uint32_t from, std::uint32_t) { stars.offset[from + 1]++; });
  for (std::size_t i = 0; i < copies.size(); i++)
    stars.offset[i + 1] += stars.offset[i];
  stars.other.resize(stars.offset.back());
  std::vector<std::uint64_t> next(stars.offset.begin(), stars.offset.end() - 1);
  each_pair([&](std::uint32_t from, std::uint32_t to) { stars.other[next[from]++] = to; });
  return stars;
}

// Neighbour and shift in one number that sorts by neighbour, then by shift.
std::uint64_t key_of(std::uint32_t node, const std::array<std::int8_t, 3> &from,
                     const std::array<std::int8_t, 3> &to) {
  std::uint64_t key = node;
  for (int axis = 0; axis < 3; axis++) {
    const int shift = to[axis] - from[axis];
    if (shift < -127 || shift > 127)
      fail(CONCEG_E_INTERNAL, "network: expected a shift of at most 127 sides, got %d", shift);
    key = key << 8 | static_cast<std::uint64_t>(shift + 128);
  }
  return key;
}

// One row per node of the tile. A node has one core copy, or its twins too in the paper's network; twins come
// last and their node is also their row, since all nodes are in that one tile.
TileEdges rows_of(const Delaunay &delaunay, const std::vector<Copy> &copies) {
  const Stars stars = stars_of(delaunay, copies);
  const auto core = static_cast<std::size_t>(
      std::count_if(copies.begin(), copies.end(), [](const Copy &c) { return c.core; }));
  std::vector<std::uint32_t> sources(core);
  for (std::size_t i = 0; i < core; i++)
    sources[i] = static_cast<std::uint32_t>(i);
  std::stable_sort(sources.begin(), sources.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return copies[a].node < copies[b].node; });

  TileEdges rows;
  std::vector<std::uint32_t> seen(copies.size(), kGhost); // last source that listed the copy
  std::vector<std::uint64_t> keys;
  for (std::size_t s = 0; s < sources.size();) {
    const std::uint32_t node = copies[sources[s]].node;
    keys.clear();
    for (; s < sources.size() && copies[sources[s]].node == node; s++) {
      const std::uint32_t source = sources[s];
      for (std::uint64_t i = stars.offset[source]; i < stars.offset[source + 1]; i++) {
        const std::uint32_t other = stars.other[i];
        if (seen[other] == source || copies[other].node == kGhost) continue;
        seen[other] = source;
        keys.push_back(key_of(copies[other].node, copies[source].shift, copies[other].shift));
      }
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    rows.node.push_back(node);
    rows.degree.push_back(static_cast<std::uint32_t>(keys.size()));
    for (const std::uint64_t key : keys) {
      rows.neighbour.push_back(static_cast<std::uint32_t>(key >> 24));
      rows.shift.push_back({static_cast<std::int8_t>(static_cast<int>(key >> 16 & 255) - 128),
                            static_cast<std::int8_t>(static_cast<int>(key >> 8 & 255) - 128),
                            static_cast<std::int8_t>(static_cast<int>(key & 255) - 128)});
    }
  }
  rows.neighbour.shrink_to_fit();
  rows.shift.shrink_to_fit();
  return rows;
}

// The rows of one tile; widens the halo until the certificate holds.
TileEdges triangulate_tile(const Buckets &buckets, const Tile &tile, double halo_um, std::uint64_t &widened,
                           double &largest_circumradius) {
  for (int attempt = 0; attempt < kAttempts; attempt++, halo_um *= kWiden) {
    const std::vector<Copy> copies = gather_copies(buckets, tile, halo_um);
    if (copies.empty() || !copies[0].core) return {}; // no node of its own
    const Delaunay delaunay = triangulation_of(copies);
    double largest = 0.0;
    if (certified(delaunay, copies, region_of(buckets, tile, halo_um), largest)) {
      largest_circumradius = largest;
      return rows_of(delaunay, copies);
    }
    widened++;
  }
  fail(CONCEG_E_STAGE,
       "network: no Delaunay triangulation within a halo of %g um; ask for a higher density_per_um3",
       halo_um);
}

} // namespace

Edges delaunay_edges(const conceg_box &box, const std::vector<glm::dvec3> &nodes,
                     const DelaunayOptions &options, Workers &workers, const Progress &progress) {
  Edges edges;
  if (options.mirrored_faces) {
    const std::vector<Copy> copies = gather_mirrored(box, nodes);
    report(progress, "triangulate", 0, nodes.size());
    edges.tiles.push_back(rows_of(triangulation_of(copies), copies));
    report(progress, "triangulate", nodes.size(), nodes.size());
  } else {
    const Buckets buckets(box, nodes, std::min(kBucketUm, options.tile_um));
    const std::vector<Tile> tiles =
        cut_tiles(buckets, options.tile_um, workers.threads(), options.tile_nodes);
    edges.tiles.resize(tiles.size());
    std::vector<std::uint64_t> widened(tiles.size());
    std::vector<double> largest(tiles.size());
    std::atomic<std::uint64_t> done{0};
    workers.loop(tiles.size(), 1, [&](std::size_t i, unsigned) {
      edges.tiles[i] = triangulate_tile(buckets, tiles[i], options.halo_um, widened[i], largest[i]);
      report(progress, "triangulate", done += edges.tiles[i].node.size(), nodes.size());
    });
    for (std::size_t i = 0; i < tiles.size(); i++) {
      edges.widened += widened[i];
      edges.largest_circumradius = std::max(edges.largest_circumradius, largest[i]);
    }
  }
  for (const TileEdges &tile : edges.tiles)
    edges.count += tile.neighbour.size();
  return edges;
}

void merge_tiles(Edges &&edges, std::size_t nodes, std::uint64_t *offset, std::uint32_t *neighbour,
                 std::int8_t *shift) {
  std::fill(offset, offset + nodes + 1, 0);
  for (const TileEdges &tile : edges.tiles)
    for (std::size_t row = 0; row < tile.node.size(); row++)
      offset[tile.node[row] + 1] = tile.degree[row];
  for (std::size_t i = 0; i < nodes; i++)
    offset[i + 1] += offset[i];
  for (TileEdges &tile : edges.tiles) {
    std::size_t from = 0;
    for (std::size_t row = 0; row < tile.node.size(); row++) {
      const std::uint64_t to = offset[tile.node[row]];
      std::copy_n(tile.neighbour.begin() + static_cast<std::ptrdiff_t>(from), tile.degree[row],
                  neighbour + to);
      for (std::size_t k = 0; k < tile.degree[row]; k++)
        std::copy_n(tile.shift[from + k].begin(), 3, shift + 3 * (to + k));
      from += tile.degree[row];
    }
    tile = {};
  }
}

} // namespace conceg::triangulate
