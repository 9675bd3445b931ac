// SPDX-License-Identifier: GPL-3.0-or-later
#include "tissue.hpp"

#include "wrap.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::triangulate {
namespace {

constexpr double kFarthest = 1e7; // um
constexpr std::uint8_t kAxon = 2; // of /bars/neurite

// A column of /bars with as many rows as /bars/radius has.
template <class T> View<T> bar_column(conceg_doc *doc, const char *path, std::size_t width = 1) {
  const std::size_t rows = view<double>(doc, "/bars/radius").rows();
  const View<T> values = view<T>(doc, path, width);
  if (values.rows() != rows)
    fail(CONCEG_E_FORMAT, "%s: expected %zu rows as in /bars/radius, got %zu", path, rows, values.rows());
  return values;
}

} // namespace

conceg_box read_lattice_box(conceg_doc *doc) {
  const conceg_box box = read_box(doc);
  for (int axis = 0; axis < 3; axis++)
    if (conceg_snap(box.lo[axis]) != box.lo[axis] || conceg_snap(box.hi[axis]) != box.hi[axis])
      fail(CONCEG_E_RANGE,
           "/domain: expected corners on the lattice of 2^-16 um, got %.9g and %.9g on axis %d; place rounds "
           "them",
           box.lo[axis], box.hi[axis], axis);
  return box;
}

std::vector<Soma> read_somas(conceg_doc *doc) {
  const View<double> center = view<double>(doc, "/cells/soma", 3);
  const View<float> radius = view<float>(doc, "/cells/radius");
  if (center.rows() != radius.rows())
    fail(CONCEG_E_FORMAT, "/cells/radius: expected %zu rows as in /cells/soma, got %zu", center.rows(),
         radius.rows());
  std::vector<Soma> somas(center.rows());
  for (std::size_t i = 0; i < somas.size(); i++) {
    somas[i] = {{center.row(i)[0], center.row(i)[1], center.row(i)[2]}, static_cast<double>(radius[i])};
    for (int axis = 0; axis < 3; axis++)
      if (!(std::fabs(somas[i].center[axis]) < kFarthest))
        fail(CONCEG_E_RANGE, "/cells/soma[%zu]: expected coordinates within %g um, got %g", i, kFarthest,
             somas[i].center[axis]);
    if (!(somas[i].radius >= 0.0 && somas[i].radius < kFarthest))
      fail(CONCEG_E_RANGE, "/cells/radius[%zu]: expected 0 um or more, got %g", i, somas[i].radius);
  }
  return somas;
}

double largest_target_um(conceg_doc *doc) {
  const View<double> radius = bar_column<double>(doc, "/bars/radius");
  const View<double> start = bar_column<double>(doc, "/bars/asked_start");
  const View<double> end = bar_column<double>(doc, "/bars/asked_end");
  const View<double> taper = bar_column<double>(doc, "/bars/taper");
  const View<double> floor = bar_column<double>(doc, "/bars/radius_floor");
  double largest = 0.0;
  for (std::size_t i = 0; i < radius.rows(); i++)
    largest = std::max({largest, floor[i], radius[i] + std::fabs(taper[i]) * 0.5 * (end[i] - start[i])});
  return std::min(largest, kFarthest);
}

std::vector<Territory> read_territories(conceg_doc *doc, const std::vector<Soma> &somas) {
  const View<double> radius = bar_column<double>(doc, "/bars/radius");
  const View<double> start = bar_column<double>(doc, "/bars/asked_start");
  const View<double> end = bar_column<double>(doc, "/bars/asked_end");
  const View<double> attractor = bar_column<double>(doc, "/bars/attractor", 3);
  const View<std::uint8_t> neurite = bar_column<std::uint8_t>(doc, "/bars/neurite");
  const View<std::uint64_t> offset = view<std::uint64_t>(doc, "/bars/cell_offset");
  if (offset.rows() != somas.size() + 1 || offset[somas.size()] != radius.rows())
    fail(CONCEG_E_FORMAT, "/bars/cell_offset: expected %zu offsets up to %zu", somas.size() + 1,
         radius.rows());
  std::vector<Territory> territories;
  for (std::size_t cell = 0; cell < somas.size(); cell++) {
    double cable = 0.0, thickness = 0.0, reach = 0.0;
    for (std::uint64_t bar = offset[cell]; bar < offset[cell + 1] && bar < radius.rows(); bar++) {
      const double length = end[bar] - start[bar];
      if (neurite[bar] == kAxon || !(length > 0.0)) continue;
      const double *tip = attractor.row(bar);
      const glm::dvec3 d = glm::dvec3(tip[0], tip[1], tip[2]) - somas[cell].center;
      cable += length;
      thickness += length * radius[bar];
      reach += length * std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    }
    if (cable > 0.0)
      territories.push_back({somas[cell].center, std::min(reach / cable, kFarthest), thickness / cable});
  }
  return territories;
}

std::vector<Zone> thin_zones(const std::vector<Territory> &territories, double spacing_um, double radii,
                             double farthest_um, unsigned finest) {
  std::vector<Zone> zones;
  for (const Territory &territory : territories) {
    if (territory.radius_um > farthest_um) continue;
    unsigned level = 0;
    for (double spacing = spacing_um; level < finest && spacing > radii * territory.mean_radius_um;
         spacing *= 0.5)
      level++;
    if (level > 0) zones.push_back({territory.center, territory.radius_um, level});
  }
  return zones;
}

} // namespace conceg::triangulate
