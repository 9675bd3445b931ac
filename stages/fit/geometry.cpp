// SPDX-License-Identifier: BSD-3-Clause
#include "geometry.hpp"

#include "view.hpp"

#include "conceg/portable.h"

#include <algorithm>

namespace conceg::fit {
namespace {

template <class T> std::vector<T> values(conceg_doc *doc, const char *path) {
  const View<T> v = view<T>(doc, path);
  return std::vector<T>(v.begin(), v.end());
}

// Arrays of the document, checked before anything is looked up with them.
Surfaces read_surfaces(conceg_doc *doc, std::size_t cells) {
  Surfaces s;
  s.cell = values<std::uint32_t>(doc, "/meshes/cell");
  s.vertex_offset = values<std::uint64_t>(doc, "/meshes/vertex_offset");
  s.face_offset = values<std::uint64_t>(doc, "/meshes/face_offset");
  const View<double> vertex = view<double>(doc, "/meshes/vertex", 3);
  const View<std::uint32_t> face = view<std::uint32_t>(doc, "/meshes/face", 3);
  const View<std::uint8_t> compartment = view<std::uint8_t>(doc, "/meshes/compartment");
  const auto offsets = [&](const std::vector<std::uint64_t> &offset, std::size_t rows, const char *name) {
    if (offset.size() != s.cell.size() + 1 || offset.front() != 0 || offset.back() != rows ||
        !std::is_sorted(offset.begin(), offset.end()))
      fail(CONCEG_E_FORMAT, "/meshes/%s: expected ascending offsets from 0 to %zu", name, rows);
  };
  offsets(s.vertex_offset, vertex.rows(), "vertex_offset"),
      offsets(s.face_offset, face.rows(), "face_offset");
  if (compartment.rows() != face.rows())
    fail(CONCEG_E_FORMAT, "/meshes/compartment: expected %zu values, got %zu", face.rows(),
         compartment.rows());
  for (const std::uint32_t cell : s.cell)
    if (cell >= cells) fail(CONCEG_E_FORMAT, "/meshes/cell: expected rows of %zu cells, got %u", cells, cell);
  s.vertex = vertex.data(), s.face = face.data(), s.compartment = compartment.data();
  return s;
}

// Surfaces that count: closed, of the finest level.
std::vector<std::size_t> chosen_surfaces(conceg_doc *doc, std::size_t surfaces) {
  const std::vector<std::string> form =
      has(doc, "/meshes/form") ? texts(doc, "/meshes/form") : std::vector<std::string>(surfaces, "closed");
  const std::vector<std::uint8_t> lod = has(doc, "/meshes/lod") ? values<std::uint8_t>(doc, "/meshes/lod")
                                                                : std::vector<std::uint8_t>(surfaces, 0);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < std::min(form.size(), lod.size()) && i < surfaces; i++)
    if (form[i] == "closed" && lod[i] == 0) out.push_back(i);
  return out;
}

// Volume of the box when it is periodic along all axes, else 0.
double periodic_volume(conceg_doc *doc) {
  if (!has(doc, "/domain@lo")) return 0.0;
  const View<double> lo = view<double>(doc, "/domain@lo", 3), hi = view<double>(doc, "/domain@hi", 3);
  const View<std::uint8_t> periodic = view<std::uint8_t>(doc, "/domain@periodic", 3);
  double volume = 1.0;
  for (std::size_t axis = 0; axis < 3; axis++)
    volume *= periodic[axis] ? hi[axis] - lo[axis] : 0.0;
  return volume;
}

double sphere_radius(double volume) {
  return volume > 0.0 ? conceg_pow(volume / 4.18879020478639098462, 1.0 / 3.0) : 0.0;
}

} // namespace

Truth read_truth(conceg_ctx *ctx, conceg_doc *doc, Workers &workers) {
  Truth out;
  if (!has(doc, "/meshes/compartment") || !has(doc, "/cells/radius")) {
    conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                   "fit: no /meshes/compartment, so without the truth from the geometry");
    return out;
  }
  const std::vector<float> radius = values<float>(doc, "/cells/radius");
  const Surfaces surfaces = read_surfaces(doc, radius.size());
  const std::vector<std::size_t> chosen = chosen_surfaces(doc, surfaces.cell.size());
  std::vector<SomaVolume> part(chosen.size());
  workers.loop(chosen.size(), 1,
               [&](std::size_t i, unsigned) { part[i] = soma_volume(surfaces, chosen[i]); });
  std::vector<SomaVolume> cell(radius.size());
  SomaVolume all;
  for (std::size_t i = 0; i < chosen.size(); i++) {
    SomaVolume &own = cell[surfaces.cell[chosen[i]]];
    own.soma += part[i].soma, own.total += part[i].total;
    all.soma += part[i].soma, all.total += part[i].total;
  }
  if (!(all.total > 0.0)) {
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "fit: /meshes: no closed surface, so without the truth from the geometry");
    return out;
  }
  std::vector<double> of_mesh, of_sphere(radius.begin(), radius.end());
  for (const SomaVolume &volume : cell)
    of_mesh.push_back(sphere_radius(volume.soma));
  out.known = true, out.soma_share = all.soma / all.total;
  out.sphere = radii_of(of_sphere), out.mesh = radii_of(of_mesh);
  out.somas = static_cast<std::uint64_t>(
      std::count_if(of_sphere.begin(), of_sphere.end(), [](double r) { return r > 0; }));
  const double box = periodic_volume(doc);
  out.box = box > 0.0;
  if (out.box)
    out.soma = all.soma / box, out.neurite = (all.total - all.soma) / box,
    out.extracellular = 1.0 - all.total / box;
  return out;
}

} // namespace conceg::fit
