// SPDX-License-Identifier: BSD-3-Clause
#include "smooth.hpp"

#include "volume.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::mesh {
namespace {

constexpr double kWidestSag = 0.1; // steps; on a crease the normals say nothing about a curvature
constexpr int kRepairs = 8;        // rounds

// The cell in an open box that holds all of it, whole steps wide, so that the grid is cubic.
Tissue free_cell(const Tissue &tissue, double h) {
  Tissue cell = tissue;
  glm::dvec3 low = tissue.soma[0] - double(tissue.soma_radius[0]),
             high = tissue.soma[0] + double(tissue.soma_radius[0]);
  for (std::size_t i = 0; i < tissue.point.size(); i++) {
    low = glm::min(low, tissue.point[i] - double(tissue.radius[i]));
    high = glm::max(high, tissue.point[i] + double(tissue.radius[i]));
  }
  for (int axis = 0; axis < 3; axis++) {
    const double first = std::floor(low[axis] / h) - 4, last = std::ceil(high[axis] / h) + 4;
    cell.box.periodic[axis] = 0, cell.box.lo[axis] = first * h, cell.box.hi[axis] = last * h;
  }
  return cell;
}

// Distance from a face to the curved surface through its corners, in the mean: sum of e . (n_j - n_i) over
// its edges e from corner i to corner j, divided by 24.
double sag_of(const VdbSurface &surface, const glm::uvec3 &face) {
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    const std::uint32_t i = face[k], j = face[(k + 1) % 3];
    sum += glm::dot(surface.vertex[j] - surface.vertex[i], surface.normal[j] - surface.normal[i]);
  }
  return sum / 24;
}

// Moves the vertices along their normals so that the faces lie on the surface in the mean, not inside it.
void make_up_for_flat_faces(VdbSurface &surface, double h) {
  std::vector<double> weight(surface.vertex.size()), sag(surface.vertex.size());
  for (const glm::uvec3 &face : surface.face) {
    const glm::dvec3 &a = surface.vertex[face.x];
    const double area = glm::length(glm::cross(surface.vertex[face.y] - a, surface.vertex[face.z] - a)),
                 of_face = area * sag_of(surface, face);
    for (int k = 0; k < 3; k++)
      weight[face[k]] += area, sag[face[k]] += of_face;
  }
  for (std::size_t v = 0; v < surface.vertex.size(); v++)
    if (weight[v] > 0)
      surface.vertex[v] +=
          glm::clamp(sag[v] / weight[v], -kWidestSag * h, kWidestSag * h) * surface.normal[v];
}

Surface written_surface(const VdbSurface &smooth, const glm::dvec3 &origin) {
  Surface surface;
  surface.origin = origin;
  for (const glm::dvec3 &p : smooth.vertex)
    surface.vertex.push_back(written(p - origin));
  surface.face = smooth.face;
  return surface;
}

// Where the surface meets itself (in clefts as narrow as a step), vertices go back to where the mesher put
// them: those of the faces concerned in the first round, then a ring more in each. Returns the number of such
// places.
std::uint64_t repair(VdbSurface &smooth, const conceg_box &box, const glm::dvec3 &origin,
                     const CheckOptions &options, int &rounds, Workers &workers, const Progress &progress) {
  std::vector<std::uint8_t> back(smooth.vertex.size(), 0);
  std::uint64_t places = 0;
  for (rounds = 0; rounds < kRepairs; rounds++) {
    const std::vector<Surface> surfaces = {written_surface(smooth, origin)};
    const CheckResult check = check_surfaces(views_of(surfaces), box, options, workers, progress);
    std::uint64_t found = 0;
    for (const Defect &defect : check.defects)
      if (defect.flaw == Flaw::crossing_self || defect.flaw == Flaw::fold) {
        found++;
        for (const std::uint32_t f : {defect.face, defect.other_face})
          for (int k = 0; k < 3; k++)
            back[smooth.face[f][k]] = 1;
      }
    if (!found) break;
    places += found;
    for (int ring = 0; ring < rounds; ring++) {
      const std::vector<std::uint8_t> before = back;
      for (const glm::uvec3 &face : smooth.face)
        if (before[face.x] || before[face.y] || before[face.z])
          for (int k = 0; k < 3; k++)
            back[face[k]] = 1;
    }
    for (std::size_t v = 0; v < back.size(); v++)
      if (back[v]) smooth.vertex[v] = smooth.raw[v];
  }
  return places;
}

} // namespace

SmoothCell smooth_cell(const Tissue &tissue, const SceneOptions &options, const glm::dvec3 &origin,
                       Workers &workers, const Progress &progress) {
  VdbSurface smooth;
  {
    const VolumeLayout layout = lay_out_volume(free_cell(tissue, options.h), options, workers, progress);
    std::vector<float> distance(layout.values());
    fill_volume(layout, nullptr, distance.data(), workers, progress);
    smooth = vdb_surface(leaves(layout, nullptr, distance.data()), workers.threads());
  }
  make_up_for_flat_faces(smooth, options.h);
  SmoothCell done;
  CheckOptions check;
  done.repaired = repair(smooth, tissue.box, origin, check, done.rounds, workers, progress);
  done.surface = written_surface(smooth, origin);
  done.pieces = keep_soma_piece(done.surface, tissue.soma[0] - origin, tissue.soma_radius[0] > 0);
  if (done.surface.face.empty())
    fail(CONCEG_E_STAGE, "mesh: nothing of the cell is large enough for a grid of %g um; lower h_um",
         options.h);
  done.check = check_surfaces({done.surface}, tissue.box, check, workers, progress);
  return done;
}

} // namespace conceg::mesh
