// SPDX-License-Identifier: BSD-3-Clause
#include "final_check.hpp"

#include "formatted.hpp"
#include "view.hpp"
#include "wrap.hpp"

#include <cmath>

namespace conceg::mesh {
namespace {

struct Arrays {
  View<std::uint32_t> cell, face;
  View<std::uint8_t> lod;
  View<double> origin, vertex;
  View<std::uint64_t> vertex_offset, face_offset;
  std::vector<std::string> form;
  explicit Arrays(conceg_doc *doc)
      : cell(view<std::uint32_t>(doc, "/meshes/cell")), face(view<std::uint32_t>(doc, "/meshes/face", 3)),
        lod(view<std::uint8_t>(doc, "/meshes/lod")), origin(view<double>(doc, "/meshes/origin", 3)),
        vertex(view<double>(doc, "/meshes/vertex", 3)),
        vertex_offset(view<std::uint64_t>(doc, "/meshes/vertex_offset")),
        face_offset(view<std::uint64_t>(doc, "/meshes/face_offset")), form(texts(doc, "/meshes/form")) {}
  std::size_t rows() const { return cell.rows(); }
};

bool ascends(const View<std::uint64_t> &offset, std::size_t rows, std::size_t end) {
  bool sound = offset.rows() == rows + 1 && offset[0] == 0 && offset[rows] == end;
  for (std::size_t i = 0; sound && i < rows; i++)
    sound = offset[i] <= offset[i + 1];
  return sound;
}

bool is_single(double relative) {
  return double(static_cast<float>(relative)) == relative; // false for NaN
}

// Formats that hold single precision write vertex - origin: it must be such a value.
void check_values(const Arrays &arrays, const Views &surfaces, Workers &workers,
                  std::vector<std::string> &broken) {
  std::vector<std::string> found(surfaces.size());
  workers.loop(surfaces.size(), 1, [&](std::size_t s, unsigned) {
    const SurfaceView &surface = surfaces[s];
    for (std::uint32_t v = 0; v < surface.vertices && found[s].empty(); v++) {
      const glm::dvec3 p = surface.from_origin(v);
      if (!is_single(p.x) || !is_single(p.y) || !is_single(p.z))
        found[s] = formatted("vertex is not its origin plus a single-precision value: cell %u, vertex %u, at "
                             "(%.4f, %.4f, %.4f) um",
                             surface.cell, v, surface.at(v).x, surface.at(v).y, surface.at(v).z);
    }
  });
  for (const std::string &text : found)
    if (!text.empty()) broken.push_back(text);
  if (arrays.rows() && surfaces.empty()) broken.push_back("/meshes: no closed surface of level 0");
}

Views surfaces_of(const Arrays &arrays, std::vector<std::string> &broken) {
  Views surfaces;
  const std::size_t rows = arrays.rows();
  if (arrays.origin.rows() != rows || arrays.lod.rows() != rows || arrays.form.size() != rows ||
      !ascends(arrays.vertex_offset, rows, arrays.vertex.rows()) ||
      !ascends(arrays.face_offset, rows, arrays.face.rows())) {
    broken.push_back("/meshes: arrays of lengths that do not fit together");
    return surfaces;
  }
  static_assert(sizeof(glm::dvec3) == 24 && sizeof(glm::uvec3) == 12, "rows of three values");
  for (std::size_t k = 0; k < rows; k++) {
    if (arrays.lod[k] != 0 || arrays.form[k] != "closed") continue;
    SurfaceView s;
    s.cell = arrays.cell[k];
    s.origin = {arrays.origin.row(k)[0], arrays.origin.row(k)[1], arrays.origin.row(k)[2]};
    s.absolute = reinterpret_cast<const glm::dvec3 *>(arrays.vertex.data()) + arrays.vertex_offset[k];
    s.face = reinterpret_cast<const glm::uvec3 *>(arrays.face.data()) + arrays.face_offset[k];
    s.vertices = arrays.vertex_offset[k + 1] - arrays.vertex_offset[k];
    s.faces = arrays.face_offset[k + 1] - arrays.face_offset[k];
    surfaces.push_back(s);
  }
  return surfaces;
}

std::vector<std::uint32_t> missing_cells(const Views &surfaces, std::size_t cells,
                                         std::vector<std::string> &broken) {
  std::vector<std::uint32_t> count(cells), missing;
  for (const SurfaceView &s : surfaces) {
    if (s.cell >= cells) {
      broken.push_back(formatted("/meshes/cell: cell %u, but there are %zu cells", s.cell, cells));
    } else if (++count[s.cell] == 2) {
      broken.push_back(formatted("/meshes/cell: cell %u has two closed surfaces", s.cell));
    }
    if (!s.faces) broken.push_back(formatted("cell %u: a surface without faces", s.cell));
  }
  for (std::uint32_t cell = 0; cell < cells; cell++)
    if (!count[cell]) missing.push_back(cell);
  return missing;
}

} // namespace

std::vector<std::string> FinalCheck::lines(std::size_t most) const {
  std::vector<std::string> out = broken;
  for (const Defect &defect : result.defects)
    if (out.size() < most) out.push_back(describe(defect, surfaces));
  for (const std::uint32_t cell : missing)
    if (out.size() < most) out.push_back(formatted("cell %u has no surface", cell));
  if (out.size() > most) out.resize(most);
  return out;
}

FinalCheck check_document(conceg_doc *doc, double least_gap, double reach, std::size_t memory,
                          Workers &workers, const Progress &progress) {
  FinalCheck out;
  const Arrays arrays(doc);
  out.surfaces = surfaces_of(arrays, out.broken);
  if (!out.broken.empty()) return out;
  check_values(arrays, out.surfaces, workers, out.broken);
  out.missing = missing_cells(out.surfaces, view<double>(doc, "/cells/soma", 3).rows(), out.broken);
  CheckOptions options;
  options.least_gap = least_gap, options.reach = reach, options.memory = memory;
  out.result = check_surfaces(out.surfaces, read_box(doc), options, workers, progress);
  return out;
}

} // namespace conceg::mesh
