// SPDX-License-Identifier: BSD-3-Clause
// Steps per second of CPU time of the walker in the meshes of a document, one thread, as one JSON object on
// standard output: by a plain loop that casts one Embree ray a step (float triangles, hits refined in
// double), and by the stage's walls without and with each of its accelerations.  bench_simulate FILE WALKERS
// STEPS
#include "seeds.hpp"
#include "walk.hpp"

#include "conceg/conceg.h"
#include "conceg/query.h"

#include <embree3/rtcore.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "tile.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <sys/resource.h>
#include <vector>

using namespace conceg;
using namespace conceg::simulate;

namespace {

double clock_s(clockid_t id) {
  timespec t;
  clock_gettime(id, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Tissue {
  conceg_box box;
  Membranes membranes;
  conceg_query *query = nullptr;
};

Tissue open_tissue(conceg_ctx *ctx, const char *path, conceg_substrate **substrate) {
  Tissue t;
  if (conceg_substrate_open_file(ctx, path, substrate) != CONCEG_OK ||
      conceg_query_new(ctx, *substrate, &t.query) != CONCEG_OK) {
    std::fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    std::exit(1);
  }
  conceg_substrate_box(*substrate, t.box.lo, t.box.hi, t.box.periodic);
  for (std::uint64_t m = 0; m < conceg_substrate_meshes(*substrate); m++) {
    conceg_mesh_view view = {};
    view.size = sizeof view;
    if (conceg_substrate_mesh(*substrate, m, &view) != CONCEG_OK) std::exit(1);
    const auto first = static_cast<std::uint32_t>(t.membranes.vertex.size());
    for (std::uint64_t v = 0; v < view.vertex_count; v++)
      t.membranes.vertex.emplace_back(view.vertex[3 * v], view.vertex[3 * v + 1], view.vertex[3 * v + 2]);
    for (std::uint64_t f = 0; f < view.face_count; f++) {
      t.membranes.face.emplace_back(view.face[3 * f] + first, view.face[3 * f + 1] + first,
                                    view.face[3 * f + 2] + first);
      t.membranes.cell.push_back(view.cell), t.membranes.code.push_back(view.compartment[f]);
    }
  }
  return t;
}

// The plain loop: what a simulator on Embree does without accelerations.
class Plain {
public:
  explicit Plain(const Tissue &tissue) : box_(tissue.box), side_(side(tissue.box)) {
    Surface all;
    all.vertex = tissue.membranes.vertex, all.face = tissue.membranes.face;
    tiled_ = tile(widened(), all);
    device_ = rtcNewDevice("threads=1"), scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST), rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *v = static_cast<float *>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, tiled_.vertex.size()));
    for (std::size_t i = 0; i < tiled_.vertex.size(); i++)
      for (int k = 0; k < 3; k++)
        v[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(tiled_.vertex[i][k] - box_.lo[k]);
    auto *f = static_cast<std::uint32_t *>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, tiled_.face.size()));
    std::memcpy(f, tiled_.face.data(), 12 * tiled_.face.size());
    rtcCommitGeometry(g), rtcAttachGeometry(scene_, g), rtcReleaseGeometry(g), rtcCommitScene(scene_);
  }
  ~Plain() { rtcReleaseScene(scene_), rtcReleaseDevice(device_); }

  // One walker, with the integral of its place during pulses, as in the stage.
  glm::dvec3 walk(glm::dvec3 p, std::uint64_t steps, std::uint64_t pulse, double length, double dt,
                  std::uint64_t number) const {
    Directions directions(conceg_rng_stream(1, "plain", number));
    glm::dvec3 u(0.0), sum(0.0);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (std::uint64_t i = 0; i < steps; i++) {
      glm::dvec3 d = directions.next();
      double left = length;
      const glm::dvec3 before = u;
      for (int bounces = 0; bounces < 100; bounces++) {
        RTCRayHit ray;
        ray.ray.org_x = static_cast<float>(p.x), ray.ray.org_y = static_cast<float>(p.y),
        ray.ray.org_z = static_cast<float>(p.z);
        ray.ray.dir_x = static_cast<float>(d.x), ray.ray.dir_y = static_cast<float>(d.y),
        ray.ray.dir_z = static_cast<float>(d.z);
        ray.ray.tnear = 0.0f, ray.ray.tfar = static_cast<float>(left + 1e-4), ray.ray.time = 0.0f;
        ray.ray.mask = ~0u, ray.ray.id = 0, ray.ray.flags = 0, ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
        const glm::uvec3 &f = tiled_.face[ray.hit.primID];
        const glm::dvec3 a = tiled_.vertex[f.x] - origin();
        const glm::dvec3 n = glm::normalize(
            glm::cross(tiled_.vertex[f.y] - tiled_.vertex[f.x], tiled_.vertex[f.z] - tiled_.vertex[f.x]));
        const double speed = glm::dot(n, d), t = glm::dot(n, a - p) / speed,
                     stop = std::max(0.0, t - 2e-5 / std::fabs(speed));
        if (stop > left) break;
        p += stop * d, u += stop * d, left -= stop, d -= 2.0 * speed * n;
      }
      p += left * d, u += left * d;
      if (i < pulse || i >= steps - pulse) sum += (0.5 * dt) * (before + u);
      for (int k = 0; k < 3; k++)
        p[k] -= side_[k] * std::floor(p[k] / side_[k]);
    }
    return sum;
  }
  glm::dvec3 origin() const { return {box_.lo[0], box_.lo[1], box_.lo[2]}; }

private:
  conceg_box widened() const { return box_; }
  conceg_box box_;
  glm::dvec3 side_;
  TiledSurface tiled_;
  RTCDevice device_;
  RTCScene scene_;
};

void row(const char *name, double cpu, std::uint64_t steps, const Tally *tally) {
  std::printf(", \"%s\": {\"cpu_s\": %.3f, \"steps_per_s\": %.3g", name, cpu,
              static_cast<double>(steps) / cpu);
  if (tally)
    std::printf(", \"moves_per_step\": %.4f, \"casts_per_step\": %.4f, \"reflections_per_step\": %.4f, "
                "\"retractions\": %llu",
                static_cast<double>(tally->moves) / static_cast<double>(steps),
                static_cast<double>(tally->casts) / static_cast<double>(steps),
                static_cast<double>(tally->reflections) / static_cast<double>(steps),
                static_cast<unsigned long long>(tally->retractions));
  std::printf("}");
  std::fflush(stdout);
}

// The best of a few rounds, in which all ways take turns: a busy machine slows some of them.
constexpr int rounds = 3;

void measure(const char *where, const Tissue &tissue, const Walls &walls, const Plain &plain,
             const Seeds &seeds, std::uint64_t steps) {
  constexpr double dt = 1e-3;
  const std::uint64_t walkers = seeds.position.size(), all = walkers * steps;
  Physics physics;
  Timeline timeline;
  const double total = static_cast<double>(steps) * dt;
  timeline.end = {0.2 * total, 0.8 * total, total}, timeline.shape = {1.0, 0.0, -1.0}, timeline.shapes = 1;
  timeline.record = {0, 0, 0};
  std::vector<Start> starts;
  for (std::uint64_t i = 0; i < walkers; i++)
    starts.push_back({walls.local(seeds.position[i]), seeds.cell[i] >= 0, i});
  struct Mode {
    const char *name;
    bool skip, jumps;
  } modes[] = {{"cast_each_step", false, false}, {"skip", true, false}, {"skip_and_jumps", true, true}};
  double best[4] = {1e30, 1e30, 1e30, 1e30};
  Tally tally[3];
  std::uint64_t lost = 0;
  glm::dvec3 sink(0.0);
  for (int round = 0; round < rounds; round++) {
    double start = clock_s(CLOCK_PROCESS_CPUTIME_ID);
    for (std::uint64_t i = 0; i < walkers; i++)
      sink += plain.walk(starts[i].place, steps, steps / 5, step_length(physics.intra, dt), dt, i);
    best[3] = std::min(best[3], clock_s(CLOCK_PROCESS_CPUTIME_ID) - start);
    for (std::size_t m = 0; m < 3; m++) {
      physics.skip = modes[m].skip, physics.jumps = modes[m].jumps, tally[m] = Tally();
      start = clock_s(CLOCK_PROCESS_CPUTIME_ID);
      const std::vector<Walk> walks = walk(walls, timeline, physics, starts.data(), walkers, 1, tally[m]);
      best[m] = std::min(best[m], clock_s(CLOCK_PROCESS_CPUTIME_ID) - start);
      for (std::uint64_t i = 0; i < walkers && round == 0; i++) {
        const glm::dvec3 p = walls.position(walks[i].place);
        std::int64_t cell = -2;
        if (conceg_query_locate(tissue.query, 1, &p.x, &cell, nullptr) != CONCEG_OK) std::exit(1);
        lost += cell != seeds.cell[i];
      }
    }
  }
  std::printf(", \"%s\": {\"walkers\": %llu, \"leaks\": %llu, \"moved\": %.3g", where,
              static_cast<unsigned long long>(walkers), static_cast<unsigned long long>(lost),
              glm::length(sink));
  row("embree_plain", best[3], all, nullptr);
  for (std::size_t m = 0; m < 3; m++)
    row(modes[m].name, best[m], all, &tally[m]);
  std::printf("}");
}

} // namespace

int main(int argc, char **argv) {
  if (argc != 4) return 2;
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_substrate *substrate = nullptr;
  double start = clock_s(CLOCK_PROCESS_CPUTIME_ID);
  Tissue tissue = open_tissue(ctx, argv[1], &substrate);
  const std::uint64_t walkers = std::strtoull(argv[2], nullptr, 10),
                      steps = std::strtoull(argv[3], nullptr, 10);
  const double opened = clock_s(CLOCK_PROCESS_CPUTIME_ID) - start;
  start = clock_s(CLOCK_PROCESS_CPUTIME_ID);
  Workers workers(1);
  const Walls walls(tissue.box, tissue.membranes, step_length(Medium(), 1e-3) * 1.01, workers, Progress());
  std::printf("{\"open_cpu_s\": %.2f, \"walls_cpu_s\": %.2f, \"faces\": %zu, \"images\": %zu, \"voxels\": "
              "%zu, \"voxel_um\": %.3f, \"walls_mib\": %llu",
              opened, clock_s(CLOCK_PROCESS_CPUTIME_ID) - start, tissue.membranes.face.size(), walls.images(),
              walls.voxels(), walls.voxel_um(), static_cast<unsigned long long>(walls.bytes() >> 20));
  std::fflush(stdout);
  const Plain plain(tissue);
  const Locate locate = [&](const glm::dvec3 *p, std::size_t n, std::int64_t *cell) {
    if (conceg_query_locate(tissue.query, n, &p->x, cell, nullptr) != CONCEG_OK) std::exit(1);
  };
  Wanted wanted;
  wanted.cells.assign(conceg_substrate_cells(substrate), 1), wanted.extra = false;
  const Seeds intra = seed_walkers(tissue.box, wanted, walkers, 1, locate, workers, Progress());
  wanted.cells.assign(wanted.cells.size(), 0), wanted.extra = true;
  const Seeds extra = seed_walkers(tissue.box, wanted, walkers, 1, locate, workers, Progress());
  // In a soma: by the soma's sphere.
  Seeds soma, neurite;
  for (std::size_t i = 0; i < intra.position.size(); i++) {
    conceg_cell_view cell = {};
    cell.size = sizeof cell;
    if (conceg_substrate_cell(substrate, static_cast<std::uint64_t>(intra.cell[i]), &cell) != CONCEG_OK)
      return 1;
    const glm::dvec3 d =
        nearest(tissue.box, intra.position[i] - glm::dvec3(cell.soma[0], cell.soma[1], cell.soma[2]));
    Seeds &to = glm::length(d) < cell.soma_radius ? soma : neurite;
    to.position.push_back(intra.position[i]), to.cell.push_back(intra.cell[i]);
  }
  measure("intra", tissue, walls, plain, intra, steps);
  measure("soma", tissue, walls, plain, soma, steps);
  measure("neurite", tissue, walls, plain, neurite, steps);
  measure("extra", tissue, walls, plain, extra, steps);
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  std::printf(", \"peak_rss_mib\": %ld}\n", usage.ru_maxrss / 1024);
  conceg_query_free(tissue.query);
  conceg_substrate_free(substrate);
  conceg_ctx_free(ctx);
  return 0;
}
