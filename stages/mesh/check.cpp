// SPDX-License-Identifier: BSD-3-Clause
#include "check.hpp"
#include "pairs.hpp"
#include "topology.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace conceg::mesh {
namespace {

bool earlier(const Defect &l, const Defect &r) {
  return std::tie(l.flaw, l.surface, l.face, l.other_surface, l.other_face, l.lift.z, l.lift.y, l.lift.x) <
         std::tie(r.flaw, r.surface, r.face, r.other_surface, r.other_face, r.lift.z, r.lift.y, r.lift.x);
}

// Around vertices of faces that have changed the pair test has to look for itself.
void doubt_vertices(const SurfaceView &surface, const Changed &changed, std::uint32_t number, Bits &plain) {
  if (changed.face.empty() || changed.face[number].empty()) return;
  for (std::uint32_t f = 0; f < surface.faces; f++)
    for (int k = 0; changed.face[number][f] && k < 3; k++)
      plain.clear(surface.face[f][k]);
}

} // namespace

const char *flaw_name(Flaw flaw) {
  static const char *const names[] = {"face with a bad vertex index",
                                      "degenerate face",
                                      "unused vertex",
                                      "open edge",
                                      "face turned against its neighbour",
                                      "vertex with several fans",
                                      "surface facing inwards",
                                      "two cells cross",
                                      "cell crosses its own image",
                                      "cell crosses itself",
                                      "fold",
                                      "narrow gap"};
  return names[static_cast<std::size_t>(flaw)];
}

CheckResult check_surfaces(const Views &surfaces, const conceg_box &box, const CheckOptions &options,
                           Workers &workers, const Progress &progress) {
  CheckResult result;
  check_again(surfaces, {std::vector<std::uint8_t>(surfaces.size(), 1)}, box, options, workers, progress,
              result);
  return result;
}

void check_again(const Views &surfaces, const Changed &changed, const conceg_box &box,
                 const CheckOptions &options, Workers &workers, const Progress &progress,
                 CheckResult &result) {
  auto &defects = result.defects;
  defects.erase(std::remove_if(defects.begin(), defects.end(),
                               [&](const Defect &d) {
                                 if (!is_pair(d.flaw)) return changed.surface[d.surface] != 0;
                                 return changed.holds(d.surface, d.face) ||
                                        changed.holds(d.other_surface, d.other_face);
                               }),
                defects.end());
  std::vector<std::vector<Defect>> found(surfaces.size());
  result.usable.resize(surfaces.size()), result.closed.resize(surfaces.size());
  result.plain.resize(surfaces.size()), result.min_gap.assign(surfaces.size(), options.reach);
  workers.loop(surfaces.size(), 1, [&](std::size_t s, unsigned) {
    if (!changed.surface[s]) {
      doubt_vertices(surfaces[s], changed, static_cast<std::uint32_t>(s), result.plain[s]);
      return;
    }
    result.usable[s] = check_topology(surfaces[s], static_cast<std::uint32_t>(s), found[s], result.plain[s]);
    result.closed[s] = found[s].empty();
  });
  for (const auto &list : found)
    defects.insert(defects.end(), list.begin(), list.end());
  check_pairs(surfaces, changed, box, options, workers, progress, result);
  std::sort(defects.begin(), defects.end(), earlier);
  result.errors = result.crossings = 0;
  for (const Defect &defect : defects) {
    result.errors += defect.flaw != Flaw::near;
    result.crossings += is_pair(defect.flaw) && defect.flaw != Flaw::near;
  }
}

std::string describe(const Defect &defect, const Views &surfaces) {
  char text[320];
  const unsigned cell = surfaces[defect.surface].cell;
  if (!is_pair(defect.flaw)) {
    const bool vertex = defect.flaw == Flaw::unused_vertex || defect.flaw == Flaw::split_vertex;
    std::snprintf(text, sizeof text, "%s: cell %u, %s %u, at (%.4f, %.4f, %.4f) um", flaw_name(defect.flaw),
                  cell, vertex ? "vertex" : "face", defect.face, defect.where.x, defect.where.y,
                  defect.where.z);
  } else {
    std::snprintf(text, sizeof text,
                  "%s: cell %u, face %u and cell %u, face %u (image %d %d %d), at (%.4f, %.4f, %.4f) um",
                  flaw_name(defect.flaw), cell, defect.face, surfaces[defect.other_surface].cell,
                  defect.other_face, defect.lift.x, defect.lift.y, defect.lift.z, defect.where.x,
                  defect.where.y, defect.where.z);
  }
  return text;
}

} // namespace conceg::mesh
