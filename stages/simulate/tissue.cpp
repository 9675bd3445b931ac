// SPDX-License-Identifier: BSD-3-Clause
#include "tissue.hpp"

#include "cells.hpp"
#include "simulation.hpp"

#include <glm/geometric.hpp>

#include <limits>

namespace conceg::simulate {

namespace {

double volume_of(const Membranes &m, std::size_t begin, std::size_t end) {
  double six = 0.0;
  if (begin == end) return 0.0;
  const glm::dvec3 origin = m.vertex[m.face[begin].x]; // keeps the terms small
  for (std::size_t f = begin; f < end; f++) {
    const glm::uvec3 &c = m.face[f];
    six += glm::dot(m.vertex[c.x] - origin, glm::cross(m.vertex[c.y] - origin, m.vertex[c.z] - origin));
  }
  return six / 6.0;
}

} // namespace

Tissue::Tissue(conceg_ctx *ctx, conceg_doc *doc)
    : substrate_(nullptr, conceg_substrate_free), query_(nullptr, conceg_query_free) {
  conceg_substrate *opened = nullptr;
  must(conceg_substrate_open(doc, &opened));
  substrate_.reset(opened);
  conceg_substrate_box(opened, box.lo, box.hi, box.periodic);
  const std::uint64_t meshes = conceg_substrate_meshes(opened);
  if (meshes == 0) fail(CONCEG_E_MISSING, "/meshes: expected surfaces, got none; run conceg mesh before it");
  std::uint64_t vertices = 0, left_out = 0;
  for (std::uint64_t m = 0; m < meshes; m++) {
    conceg_mesh_view view = {};
    view.size = sizeof view;
    must(conceg_substrate_mesh(opened, m, &view));
    vertices += view.vertex_count;
    if (vertices >= std::numeric_limits<std::uint32_t>::max())
      fail(CONCEG_E_UNSUPPORTED, "/meshes/vertex: expected fewer than 2^32 vertices, got more");
    const auto first = static_cast<std::uint32_t>(membranes.vertex.size());
    const std::size_t first_face = membranes.face.size();
    for (std::uint64_t v = 0; v < view.vertex_count; v++)
      membranes.vertex.emplace_back(view.vertex[3 * v], view.vertex[3 * v + 1], view.vertex[3 * v + 2]);
    for (std::uint64_t f = 0; f < view.face_count; f++) {
      membranes.face.emplace_back(view.face[3 * f] + first, view.face[3 * f + 1] + first,
                                  view.face[3 * f + 2] + first);
      membranes.cell.push_back(view.cell);
      membranes.code.push_back(view.compartment ? view.compartment[f] : std::uint8_t{0});
    }
    if (!is_closed(membranes.face, first_face, membranes.face.size()))
      fail(CONCEG_E_FORMAT,
           "/meshes: expected closed surfaces, got one with open edges (surface %llu, of cell %u): walkers "
           "would leave the "
           "cell; mesh it again, or close it with another tool",
           static_cast<unsigned long long>(m), view.cell);
    left_out += view.face_count == 0;
    cell_volume += volume_of(membranes, first_face, membranes.face.size());
  }
  if (left_out)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "simulate: %llu surfaces without faces",
                   static_cast<unsigned long long>(left_out));
  for (std::uint64_t c = 0; c < conceg_substrate_cells(opened); c++) {
    conceg_cell_view view = {};
    view.size = sizeof view;
    must(conceg_substrate_cell(opened, c, &view));
    soma.push_back({{view.soma[0], view.soma[1], view.soma[2]}, view.soma_radius});
    type_name.emplace_back(view.type_name ? view.type_name : ""),
        class_name.emplace_back(view.class_name ? view.class_name : "");
    conceg_skeleton_view skeleton = {};
    skeleton.size = sizeof skeleton;
    must(conceg_substrate_skeleton(opened, c, &skeleton));
    for (std::uint64_t i = 0; i < skeleton.count; i++) {
      const double r = static_cast<double>(skeleton.radius[i]);
      thinnest_um = thinnest_um > 0.0 ? std::min(thinnest_um, r) : r;
    }
  }
  conceg_query *made = nullptr;
  must(conceg_query_new(ctx, opened, &made));
  query_.reset(made);
}

Locate Tissue::locate() const {
  return [query = query_.get()](const glm::dvec3 *points, std::size_t count, std::int64_t *cell) {
    if (count && conceg_query_locate(query, count, &points->x, cell, nullptr) != CONCEG_OK)
      fail(CONCEG_E_INTERNAL, "a point could not be located");
  };
}

std::vector<std::uint8_t> Tissue::chosen(const std::string &cells, const std::string &kind) const {
  std::vector<std::uint8_t> out(soma.size(), 0);
  bool known = kind.empty(), any = false;
  for (std::size_t c = 0; c < soma.size(); c++)
    known = known || type_name[c] == kind || class_name[c] == kind;
  if (!known) {
    std::string names;
    for (std::size_t c = 0; c < soma.size(); c++)
      for (const std::string &name : {class_name[c], type_name[c]})
        if (names.find("\"" + name + "\"") == std::string::npos)
          names += (names.empty() ? "\"" : ", \"") + name + "\"";
    fail(CONCEG_E_PARAM, "kind: expected the type or class of a cell (%.600s), got \"%s\"", names.c_str(),
         kind.c_str());
  }
  for (const CellInfo &cell : select_cells(substrate_.get(), cells))
    if (kind.empty() || cell.type_name == kind || cell.class_name == kind) out[cell.row] = 1, any = true;
  if (!any)
    fail(CONCEG_E_RANGE, "cells: expected a cell of kind \"%s\", got %s", kind.c_str(), cells.c_str());
  return out;
}

} // namespace conceg::simulate
