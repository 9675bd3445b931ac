// SPDX-License-Identifier: BSD-3-Clause
// Times every phase of the mesher on a synthetic dense tissue: bench_mesh_forest [threads] [h_um] [side_um]
// [tolerance_um].
#include "faces.hpp"
#include "finish.hpp"
#include "scenes.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <sys/resource.h>
#include <time.h>

namespace {

class Clock {
public:
  void lap(const char *phase) {
    const double wall = now(CLOCK_MONOTONIC), cpu = now(CLOCK_PROCESS_CPUTIME_ID);
    std::printf("%-10s wall %6.2f s  cpu %6.2f s\n", phase, wall - wall_, cpu - cpu_);
    wall_ = wall, cpu_ = cpu;
  }

private:
  static double now(clockid_t id) {
    timespec t;
    clock_gettime(id, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
  }
  double wall_ = now(CLOCK_MONOTONIC), cpu_ = now(CLOCK_PROCESS_CPUTIME_ID);
};

std::size_t faces(const conceg::mesh::Views &surfaces) {
  std::size_t sum = 0;
  for (const auto &surface : surfaces)
    sum += surface.faces;
  return sum;
}

} // namespace

int main(int argc, char **argv) {
  using namespace conceg::mesh;
  const auto number = [&](int i, double fallback) { return argc > i ? std::atof(argv[i]) : fallback; };
  const unsigned threads = static_cast<unsigned>(number(1, 2));
  const double side = number(3, 40), volume = side * side * side, tolerance = number(4, 0.05);
  SceneOptions options;
  options.h = number(2, 0.25);
  const auto cells = static_cast<unsigned>(volume / 8000);
  const Tissue tissue = scenes::forest(side, cells, 20000.0 * volume / 64000 / cells, 7);
  conceg::Workers workers(threads);
  Clock clock;
  const Scene scene = make_scene(tissue, options);
  const Index index = make_index(scene, workers, {});
  clock.lap("index");
  FinishOptions finish_options;
  finish_options.tolerance = tolerance;
  const Finished done = finish(scene, index, {tissue.soma, tissue.soma, tissue.soma_radius}, tissue.box,
                               finish_options, workers, {});
  clock.lap("finish");
  for (const auto &surface : done.surfaces)
    workers.loop(surface.faces, 4096, [&](std::size_t f, unsigned) { label_face(scene, index, surface, f); });
  clock.lap("faces");
  CheckOptions check_options;
  check_options.least_gap = finish_options.least_gap();
  const CheckResult check = check_surfaces(done.surfaces, tissue.box, check_options, workers, {});
  clock.lap("check");
  double final_volume = 0, detached = 0, gap = 1;
  for (const Pieces &p : done.pieces)
    detached += p.detached_volume;
  for (const auto &surface : done.surfaces)
    final_volume += volume_of(surface);
  for (const double g : check.min_gap)
    gap = std::min(gap, g);
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  std::printf("h %.4f um, %zu cones, %zu cells: %llu before simplification, %zu final\n", scene.grid.unit,
              scene.cone.size(), tissue.cells(), (unsigned long long)done.base_faces, faces(done.surfaces));
  std::printf("fill %.4f, detached %.4f, min gap %.4f um, %llu pairs, %llu "
              "flaws, %d rounds, %llu repaired\n",
              final_volume / volume, detached / volume, gap, (unsigned long long)check.pairs_checked,
              (unsigned long long)check.errors, done.rounds, (unsigned long long)done.repaired_pairs);
  for (std::size_t i = 0; i < std::min<std::size_t>(5, check.defects.size()); i++)
    std::printf("  %s\n", describe(check.defects[i], done.surfaces).c_str());
  std::printf("peak %.0f MB\n", double(usage.ru_maxrss) / 1024);
  return check.errors != 0;
}
