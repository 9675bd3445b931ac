// SPDX-License-Identifier: BSD-3-Clause
// Synthetic tissues for the tests of the mesh stage: plain arrays, no document.
#pragma once

#include "components.hpp"
#include "conceg/rng.h"
#include "extract.hpp"
#include "finish.hpp"
#include "volume.hpp"

#include <glm/geometric.hpp>

namespace scenes {

using namespace conceg::mesh;

inline Tissue empty_box(double side, bool periodic = true) {
  Tissue tissue;
  for (int axis = 0; axis < 3; axis++)
    tissue.box.lo[axis] = 0, tissue.box.hi[axis] = side, tissue.box.periodic[axis] = periodic;
  tissue.offset.push_back(0);
  return tissue;
}

inline void add_cell(Tissue &tissue, const glm::dvec3 &soma, double radius) {
  tissue.soma.push_back(soma);
  tissue.soma_radius.push_back(static_cast<float>(radius));
  tissue.offset.push_back(tissue.point.size());
}

// Adds a point to the last cell and returns its row in the cell.
inline std::int64_t add_point(Tissue &tissue, const glm::dvec3 &p, double radius, std::int64_t parent,
                              int kind = 3) {
  tissue.point.push_back(p);
  tissue.radius.push_back(static_cast<float>(radius));
  tissue.parent.push_back(parent);
  tissue.kind.push_back(static_cast<std::uint8_t>(kind));
  tissue.offset.back() = tissue.point.size();
  return static_cast<std::int64_t>(tissue.offset.back() - tissue.offset[tissue.offset.size() - 2]) - 1;
}

// A straight tube without a soma.
inline void add_tube(Tissue &tissue, const glm::dvec3 &a, const glm::dvec3 &b, double radius) {
  add_cell(tissue, 0.5 * (a + b), 0);
  const std::int64_t first = add_point(tissue, a, radius, -1);
  add_point(tissue, b, radius, first);
}

inline glm::dvec3 random_direction(conceg_rng &rng) {
  const double z = 2 * conceg_rng_uniform(&rng) - 1, angle = 6.283185307179586 * conceg_rng_uniform(&rng);
  const double flat = std::sqrt(1 - z * z);
  return {flat * conceg_cos(angle), flat * conceg_sin(angle), z};
}

// Branching random walks around somas: dense, with cells that touch and cross one another and themselves.
inline Tissue forest(double side, unsigned cells, double cable_per_cell, std::uint64_t seed,
                     double thin = 0.3, double thick = 0.6) {
  Tissue tissue = empty_box(side);
  for (unsigned cell = 0; cell < cells; cell++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.forest", cell);
    const double radius = 6 + conceg_rng_uniform(&rng);
    const glm::dvec3 soma(conceg_snap(side * conceg_rng_uniform(&rng)),
                          conceg_snap(side * conceg_rng_uniform(&rng)),
                          conceg_snap(side * conceg_rng_uniform(&rng)));
    add_cell(tissue, soma, radius);
    struct Tip {
      std::int64_t row;
      glm::dvec3 at, direction;
      double radius;
    };
    std::vector<Tip> tips;
    for (int trunk = 0; trunk < 6; trunk++) {
      const glm::dvec3 direction = random_direction(rng), at = soma + radius * direction;
      const double r = thin + (thick - thin) * conceg_rng_uniform(&rng);
      tips.push_back({add_point(tissue, at, r, -1), at, direction, r});
    }
    double cable = 0;
    for (std::size_t turn = 0; cable < cable_per_cell; turn++) {
      Tip &tip = tips[turn % tips.size()];
      tip.direction = glm::normalize(tip.direction + 0.35 * random_direction(rng));
      tip.at += tip.direction;
      tip.row = add_point(tissue, tip.at, tip.radius, tip.row);
      cable += 1;
      if (conceg_rng_uniform(&rng) < 0.02) {
        Tip fork = tip;
        fork.direction = glm::normalize(tip.direction + random_direction(rng));
        fork.radius = std::max(thin, 0.9 * tip.radius);
        tips.push_back(fork);
      }
    }
  }
  return tissue;
}

struct Meshed {
  Scene scene;
  Index index;
  std::vector<Surface> surfaces; // per cell
};

// The base mesh, or with `cluster` the light mesh, before simplification.
inline Meshed mesh_of(const Tissue &tissue, SceneOptions options, unsigned threads = 1, bool keep_all = true,
                      bool cluster = false) {
  options.cluster = cluster;
  conceg::Workers workers(threads);
  Meshed out;
  out.scene = make_scene(tissue, options);
  out.index = make_index(out.scene, workers, {});
  const std::vector<std::uint8_t> wanted(tissue.cells(), 1);
  std::vector<Apart> apart(tissue.cells());
  ChunkFile chunks(".", tissue.cells());
  const std::vector<std::uint32_t> rows = rows_of(out.scene, out.index, wanted).row;
  workers.loop(rows.size(), 1, [&](std::size_t i, unsigned) {
    std::vector<ChunkFile::Marched> marched;
    std::vector<std::uint32_t> cells;
    march_row(out.scene, out.index, rows[i], cluster, wanted, apart, marched, cells);
    chunks.add(marched);
  });
  for (std::uint32_t cell = 0; cell < tissue.cells(); cell++) {
    std::vector<Chunk> own = chunks.take(cell);
    out.surfaces.push_back(join_cell(out.scene, out.index, cell, tissue.soma[cell], own, apart[cell]));
    if (!keep_all) keep_soma_piece(out.surfaces[cell], glm::dvec3(0), tissue.soma_radius[cell] > 0);
  }
  return out;
}

struct Volume {
  VolumeLayout layout;
  std::vector<std::uint32_t> label;
  std::vector<float> distance;
};

inline Volume volume_of_tissue(const Tissue &tissue, const SceneOptions &options, unsigned threads = 1) {
  conceg::Workers workers(threads);
  Volume volume;
  volume.layout = lay_out_volume(tissue, options, workers, {});
  volume.label.resize(volume.layout.values()), volume.distance.resize(volume.layout.values());
  fill_volume(volume.layout, volume.label.data(), volume.distance.data(), workers, {});
  return volume;
}

// A finished tissue with its surfaces in memory, and what the check says of all of them.
struct Done {
  std::vector<Surface> surfaces;
  std::vector<Pieces> pieces;
  CheckResult check;
  int rounds = 0;
  std::uint64_t repaired_pairs = 0, moved_vertices = 0, base_faces = 0;
  std::size_t taken_over = 0;
};

inline Surface copy_of(const SurfaceView &view) {
  Surface surface;
  surface.cell = view.cell, surface.origin = view.origin;
  surface.vertex.assign(view.relative, view.relative + view.vertices);
  surface.face.assign(view.face, view.face + view.faces);
  return surface;
}

inline Done finish_tissue(const Tissue &tissue, SceneOptions scene_options, FinishOptions options,
                          unsigned threads = 1, const conceg::Progress &progress = {}) {
  scene_options.cluster = options.cluster, options.folder = ".";
  conceg::Workers workers(threads);
  const Scene scene = make_scene(tissue, scene_options);
  const Index index = make_index(scene, workers, {});
  Finished finished = finish(scene, index, {tissue.soma, tissue.soma, tissue.soma_radius}, tissue.box,
                             options, workers, progress);
  Done done;
  for (const SurfaceView &view : finished.surfaces)
    done.surfaces.push_back(copy_of(view));
  done.pieces = finished.pieces, done.rounds = finished.rounds, done.base_faces = finished.base_faces;
  done.repaired_pairs = finished.repaired_pairs, done.moved_vertices = finished.moved_vertices;
  done.taken_over = finished.taken_over;
  CheckOptions check;
  check.reach = 1.5 * options.gap, check.least_gap = options.least_gap();
  done.check = check_surfaces(views_of(done.surfaces), tissue.box, check, workers, {});
  return done;
}

} // namespace scenes
