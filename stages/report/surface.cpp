// SPDX-License-Identifier: BSD-3-Clause
#include "surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace conceg::reporting {

Surface clustered(const Surface &surface, double step_um) {
  using Voxel = std::array<std::int64_t, 3>;
  std::vector<std::pair<Voxel, std::uint32_t>> order(surface.vertex.size());
  for (std::size_t v = 0; v < order.size(); v++) {
    for (int a = 0; a < 3; a++)
      order[v].first[static_cast<std::size_t>(a)] =
          static_cast<std::int64_t>(std::floor(surface.vertex[v][a] / step_um));
    order[v].second = static_cast<std::uint32_t>(v);
  }
  std::sort(order.begin(), order.end());
  Surface out;
  out.cell = surface.cell;
  std::vector<std::uint32_t> renamed(surface.vertex.size());
  for (std::size_t begin = 0, end; begin < order.size(); begin = end) {
    glm::dvec3 sum(0.0);
    for (end = begin; end < order.size() && order[end].first == order[begin].first; end++) {
      sum += surface.vertex[order[end].second];
      renamed[order[end].second] = static_cast<std::uint32_t>(out.vertex.size());
    }
    out.vertex.push_back(sum / static_cast<double>(end - begin));
  }
  for (const glm::uvec3 &f : surface.face) {
    const glm::uvec3 g(renamed[f.x], renamed[f.y], renamed[f.z]);
    if (g.x != g.y && g.y != g.z && g.z != g.x) out.face.push_back(g);
  }
  return out;
}

std::size_t surface_bytes(const std::vector<Surface> &surfaces) {
  std::size_t bytes = 0;
  for (const Surface &surface : surfaces)
    bytes += 6 * surface.vertex.size() + 12 * surface.face.size();
  return bytes;
}

Coarsened coarsen(std::vector<Surface> surfaces, std::size_t most) {
  Coarsened out{std::move(surfaces), 0.0};
  if (surface_bytes(out.surfaces) <= most) return out;
  const std::vector<Surface> fine = std::move(out.surfaces);
  for (const double step : {0.1, 0.2, 0.4, 0.8}) {
    out.surfaces.clear(), out.step_um = step;
    for (const Surface &surface : fine)
      out.surfaces.push_back(clustered(surface, step));
    if (surface_bytes(out.surfaces) <= most) return out;
  }
  out.surfaces.clear();
  return out;
}

} // namespace conceg::reporting
