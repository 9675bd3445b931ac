// SPDX-License-Identifier: BSD-3-Clause
#include "levels.hpp"
#include "check.hpp"
#include "simplify.hpp"
#include "topology.hpp"

#include <atomic>

namespace conceg::mesh {
namespace {

Surface copy_of(const SurfaceView &view) {
  Surface surface;
  surface.cell = view.cell, surface.origin = view.origin;
  surface.vertex.reserve(view.vertices);
  for (std::uint32_t v = 0; v < view.vertices; v++)
    surface.vertex.emplace_back(view.from_origin(v));
  surface.face.assign(view.face, view.face + view.faces);
  return surface;
}

bool is_sound(const Surface &surface) {
  std::vector<Defect> defects;
  Bits plain;
  return !surface.face.empty() && check_topology(surface, 0, defects, plain) && defects.empty();
}

// True when it has become coarser.
bool coarsen(Surface &surface, double tolerance) {
  const std::vector<float> allowed(surface.vertex.size(), static_cast<float>(tolerance));
  Surface coarse = simplify(surface, allowed, {});
  if (coarse.face.size() == surface.face.size() || !is_sound(coarse)) return false;
  surface = std::move(coarse);
  return true;
}

} // namespace

std::vector<Level> make_levels(const Views &surfaces, std::size_t cells, int count, double tolerance,
                               const std::string &folder, Workers &workers, const Progress &progress) {
  std::vector<Level> levels(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < levels.size(); i++, tolerance *= kLevelStep) {
    const Views &before = i ? levels[i - 1].surfaces : surfaces;
    levels[i].file = std::make_unique<SurfaceFile>(folder, cells);
    std::atomic<std::size_t> unchanged{0}, done{0};
    workers.loop(before.size(), 1, [&](std::size_t s, unsigned) {
      Surface surface = copy_of(before[s]);
      unchanged += !coarsen(surface, tolerance);
      levels[i].file->add(surface, nullptr);
      report(progress, "mesh: levels of detail", ++done, before.size());
    });
    levels[i].surfaces = levels[i].file->views(), levels[i].unchanged = unchanged;
  }
  return levels;
}

} // namespace conceg::mesh
