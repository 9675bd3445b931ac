// SPDX-License-Identifier: BSD-3-Clause
// A made-up world for the tests of growth: jittered body-centred nodes joined by distance, cells with random
// barcodes, and checks of what grew.
#pragma once

#include "deliver.hpp"
#include "geometry.hpp"
#include "grow.hpp"
#include "occupancy.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <vector>

struct World {
  conceg_box box = {};
  std::vector<double> node;
  std::vector<float> node_radius;
  std::vector<std::uint64_t> edge_offset;
  std::vector<std::uint32_t> edge;
  std::vector<std::int8_t> edge_shift;
  std::vector<std::uint64_t> cell_id;
  std::vector<double> soma;
  std::vector<float> soma_radius;
  std::vector<std::uint64_t> bar_offset{0};
  std::vector<std::uint32_t> tree;
  std::vector<std::int64_t> parent;
  std::vector<std::uint8_t> neurite;
  std::vector<double> start, end, attractor, angle, radius, taper, floor;
  std::vector<conceg::grow::CalibreLaw> calibre; // per bar, or empty
  double straightness = 0.0;                     // asked of all branches, 0 = free

  void make_box(double side, bool periodic) {
    for (int a = 0; a < 3; a++)
      box.lo[a] = 0.0, box.hi[a] = side, box.periodic[a] = periodic;
  }

  void add_cell(const glm::dvec3 &at, double r) {
    cell_id.push_back(1000 + cell_id.size());
    soma.insert(soma.end(), {at.x, at.y, at.z});
    soma_radius.push_back(static_cast<float>(r));
    bar_offset.push_back(tree.size());
  }
  // A bar of the last cell.
  void add_bar(std::uint32_t in_tree, std::int64_t of, double from, double to, const glm::dvec3 &towards,
               double r, double branch_angle = 1.1) {
    tree.push_back(in_tree), parent.push_back(of), neurite.push_back(3);
    start.push_back(from), end.push_back(to);
    attractor.insert(attractor.end(), {towards.x, towards.y, towards.z});
    angle.push_back(branch_angle), radius.push_back(r), taper.push_back(0.0), floor.push_back(0.1);
    bar_offset.back() = tree.size();
  }

  // Nodes: two per cubic cell of side h, shifted by at most jitter x h; edges between all nodes nearer than
  // `join`.
  void make_network(double h, double jitter, double join) {
    const int n = static_cast<int>((box.hi[0] - box.lo[0]) / h + 0.5);
    conceg_rng rng = conceg_rng_stream(7, "test.nodes", 1);
    const auto shift = [&] { return jitter * h * (2.0 * conceg_rng_uniform(&rng) - 1.0); };
    for (int x = 0; x < n; x++)
      for (int y = 0; y < n; y++)
        for (int z = 0; z < n; z++)
          for (int half = 0; half < 2; half++)
            for (const int i : {x, y, z})
              node.push_back(conceg_snap((i + 0.25 + 0.5 * half) * h + shift()));
    const std::size_t nodes = node.size() / 3;
    std::map<std::vector<int>, std::vector<std::uint32_t>> buckets;
    const auto bucket = [&](std::size_t i, int a) { return static_cast<int>(node[3 * i + a] / join); };
    const int m = static_cast<int>((box.hi[0] - box.lo[0]) / join);
    const auto clamp = [&](int i) { return i >= m ? m - 1 : i; };
    for (std::uint32_t i = 0; i < nodes; i++)
      buckets[{clamp(bucket(i, 0)), clamp(bucket(i, 1)), clamp(bucket(i, 2))}].push_back(i);
    const double side = box.hi[0] - box.lo[0];
    edge_offset.push_back(0);
    for (std::uint32_t i = 0; i < nodes; i++) {
      const int at[3] = {clamp(bucket(i, 0)), clamp(bucket(i, 1)), clamp(bucket(i, 2))};
      for (int dx = -1; dx <= 1; dx++)
        for (int dy = -1; dy <= 1; dy++)
          for (int dz = -1; dz <= 1; dz++) {
            const int to[3] = {at[0] + dx, at[1] + dy, at[2] + dz};
            int lift[3], in[3];
            bool inside = true;
            for (int a = 0; a < 3; a++) {
              lift[a] = to[a] < 0 ? -1 : to[a] >= m ? 1 : 0;
              in[a] = to[a] - lift[a] * m;
              inside &= lift[a] == 0 || box.periodic[a];
            }
            if (!inside) continue;
            for (const std::uint32_t j : buckets[{in[0], in[1], in[2]}]) {
              double square = 0.0;
              for (int a = 0; a < 3; a++) {
                const double d = node[3 * j + a] + lift[a] * side - node[3 * i + a];
                square += d * d;
              }
              if (square < 1e-12 || square > join * join) continue;
              edge.push_back(j);
              for (int a = 0; a < 3; a++)
                edge_shift.push_back(static_cast<std::int8_t>(lift[a]));
            }
          }
      edge_offset.push_back(edge.size());
    }
    node_radius.assign(nodes, 2.0f);
    for (std::uint32_t i = 0; i < nodes; i++)
      for (std::size_t c = 0; c < cell_id.size(); c++) {
        if (!(soma_radius[c] > 0.0f)) continue;
        double square = 0.0;
        for (int a = 0; a < 3; a++) {
          const double d = conceg_box_nearest(&box, a, node[3 * i + a] - soma[3 * c + a]);
          square += d * d;
        }
        node_radius[i] = std::min(node_radius[i], static_cast<float>(std::sqrt(square) - soma_radius[c]));
      }
  }

  conceg::grow::Input input(std::uint64_t seed = 1) const {
    conceg::grow::Input in;
    in.box = box, in.seed = seed;
    in.network = {node.size() / 3,    node.data(), node_radius.data(),
                  edge_offset.data(), edge.data(), edge_shift.data()};
    in.cells = {cell_id.size(), cell_id.data(), soma.data(), soma_radius.data()};
    in.bars = {tree.size(), bar_offset.data(), tree.data(),  parent.data(), neurite.data(), start.data(),
               end.data(),  attractor.data(),  angle.data(), radius.data(), taper.data(),   floor.data(),
               {}};
    in.bars.calibre = calibre;
    if (straightness > 0.0) in.types.straightness = {straightness};
    return in;
  }

  // Trees with random barcodes, the attractor of each bar about 0.8 of its end away.
  void add_random_trees(unsigned trees, unsigned bars, double longest, double r, std::uint64_t id) {
    conceg_rng rng = conceg_rng_stream(11, "test.bars", id);
    const auto direction = [&] {
      glm::dvec3 d;
      do
        d = glm::dvec3{conceg_rng_uniform(&rng), conceg_rng_uniform(&rng), conceg_rng_uniform(&rng)} * 2.0 -
            1.0;
      while (glm::dot(d, d) > 1.0 || glm::dot(d, d) < 0.01);
      return glm::normalize(d);
    };
    const std::size_t c = soma_radius.size() - 1;
    const glm::dvec3 at(soma[3 * c], soma[3 * c + 1], soma[3 * c + 2]);
    for (unsigned t = 0; t < trees; t++) {
      const auto first = static_cast<std::int64_t>(tree.size() - bar_offset[c]);
      const glm::dvec3 trunk = direction();
      for (unsigned b = 0; b < bars; b++) {
        const std::uint64_t made = tree.size() - bar_offset[c] - static_cast<std::size_t>(first);
        const std::int64_t of = b == 0 ? -1 : first + static_cast<std::int64_t>(conceg_rng_below(&rng, made));
        const std::size_t host = bar_offset[c] + static_cast<std::size_t>(std::max<std::int64_t>(of, 0));
        if (b > 0 && end[host] - start[host] < 12.0) continue;
        const double from =
            b == 0 ? 0.0 : start[host] + 3.0 + (end[host] - start[host] - 6.0) * conceg_rng_uniform(&rng);
        const double to = b == 0 ? longest : from + 2.0 + (end[host] - from - 2.0) * conceg_rng_uniform(&rng);
        const glm::dvec3 u = glm::normalize(trunk + 0.7 * direction());
        const double far = 0.8 * to + soma_radius[c];
        add_bar(t, of, from, to, at + u * far, r, 0.6 + 0.9 * conceg_rng_uniform(&rng));
      }
    }
  }
};

struct Grown {
  conceg::grow::State state;
  conceg::grow::Summary summary;
  conceg::grow::Skeleton skeleton;
  conceg::grow::BarReport bars;
};

inline Grown grow_world(const World &world, const conceg::grow::Parameters &parameters = {},
                        unsigned threads = 1, std::uint64_t seed = 1) {
  Grown grown;
  grown.state.input = world.input(seed);
  grown.state.parameters = parameters;
  conceg::Phases phases;
  grown.summary = conceg::grow::grow(grown.state, threads, nullptr, phases);
  grown.skeleton = conceg::grow::deliver_skeleton(grown.state);
  grown.bars = conceg::grow::deliver_bars(grown.state);
  return grown;
}

// Deepest overlap between delivered pieces (and somas) of different cells or of different images of one cell,
// um; 0 = none.
inline double deepest_overlap(const World &world, const conceg::grow::Skeleton &skeleton) {
  struct Piece {
    glm::dvec3 middle, half;
    double radius;
    std::uint32_t cell;
    bool soma;
  };
  std::vector<Piece> pieces;
  for (std::uint32_t c = 0; c < world.cell_id.size(); c++) {
    if (world.soma_radius[c] > 0.0f)
      pieces.push_back({{world.soma[3 * c], world.soma[3 * c + 1], world.soma[3 * c + 2]},
                        glm::dvec3(0.0),
                        world.soma_radius[c],
                        c,
                        true});
    for (std::size_t i = skeleton.cell_offset[c]; i < skeleton.cell_offset[c + 1]; i++) {
      if (skeleton.parent[i] < 0) continue;
      const std::size_t p = skeleton.cell_offset[c] + static_cast<std::size_t>(skeleton.parent[i]);
      pieces.push_back({0.5 * (skeleton.position[i] + skeleton.position[p]),
                        0.5 * (skeleton.position[i] - skeleton.position[p]),
                        std::max(skeleton.radius[i], skeleton.radius[p]), c, false});
    }
  }
  double deepest = 0.0;
  for (std::size_t i = 0; i < pieces.size(); i++)
    for (std::size_t j = i; j < pieces.size(); j++) {
      glm::dvec3 d = pieces[i].middle - pieces[j].middle;
      bool moved = false;
      for (int a = 0; a < 3; a++) {
        const double near = conceg_box_nearest(&world.box, a, d[a]);
        moved |= std::fabs(near - d[a]) > 1e-6;
        d[a] = near;
      }
      if (pieces[i].cell == pieces[j].cell && !moved) continue;
      const double reach =
          glm::length(pieces[i].half) + glm::length(pieces[j].half) + pieces[i].radius + pieces[j].radius;
      if (glm::dot(d, d) > reach * reach) continue;
      const double gap = conceg::grow::segment_segment_distance(d, pieces[i].half, pieces[j].half) -
                         pieces[i].radius - pieces[j].radius;
      deepest = std::max(deepest, -gap);
    }
  return deepest;
}

// The barcode of the delivered points: per bar of one cell its start and end, measured along the delivered
// line.
struct Measured {
  double start, end;
};
inline std::map<std::uint32_t, Measured> measured_bars(const conceg::grow::Skeleton &skeleton,
                                                       std::uint32_t cell) {
  std::map<std::uint32_t, Measured> found;
  const std::size_t first = skeleton.cell_offset[cell];
  std::vector<double> path(skeleton.cell_offset[cell + 1] - first, 0.0);
  for (std::size_t i = 0; i < path.size(); i++) {
    const std::int64_t p = skeleton.parent[first + i];
    const std::uint32_t bar = skeleton.bar[first + i];
    if (p >= 0) path[i] = path[p] + glm::distance(skeleton.position[first + i], skeleton.position[first + p]);
    const bool starts = p < 0 || skeleton.bar[first + p] != bar;
    if (starts) found[bar] = {p < 0 ? 0.0 : path[p], path[i]};
    found[bar].end = std::max(found[bar].end, path[i]);
  }
  return found;
}

template <class T> bool same_bytes(const std::vector<T> &a, const std::vector<T> &b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}
