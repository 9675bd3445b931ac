// SPDX-License-Identifier: BSD-3-Clause
// Labels of faces: compartment and section, against the skeleton.
#include "gates.hpp"
#include "rows.hpp"

#include "surface.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace conceg::gates {
namespace {

constexpr std::uint32_t kNoSection = 0xffffffffu;
constexpr std::size_t kStride = 16; // of how many faces one is measured
const char *const g = "/meshes";

struct Faces {
  View<std::uint32_t> cell, face, section;
  View<std::uint8_t> compartment, lod;
  View<std::uint64_t> vertex_offset, face_offset;
  View<double> vertex;
  bool whole = false;
  explicit Faces(conceg_doc *doc)
      : cell(rows_of<std::uint32_t>(doc, "/meshes/cell")),
        face(rows_of<std::uint32_t>(doc, "/meshes/face", 3)),
        section(rows_of<std::uint32_t>(doc, "/meshes/section")),
        compartment(rows_of<std::uint8_t>(doc, "/meshes/compartment")),
        lod(rows_of<std::uint8_t>(doc, "/meshes/lod")),
        vertex_offset(rows_of<std::uint64_t>(doc, "/meshes/vertex_offset")),
        face_offset(rows_of<std::uint64_t>(doc, "/meshes/face_offset")),
        vertex(rows_of<double>(doc, "/meshes/vertex", 3)) {
    whole = cell.rows() && ascends(vertex_offset, cell.rows(), vertex.rows()) &&
            ascends(face_offset, cell.rows(), face.rows());
  }
};

// The segments of one cell, sorted by branch: segment of point i runs from its parent to it.
struct Branches {
  std::vector<std::uint32_t> first; // per branch, and one more: into `point`
  std::vector<std::uint32_t> point; // rows within the cell
  std::vector<std::uint8_t> kind;   // per branch; 0 = no such branch
  std::vector<double> reach;        // per branch: its largest radius
};

Branches branches_of(const Skeletons &s, std::size_t cell) {
  Branches b;
  const std::size_t from = s.offset[cell], count = s.offset[cell + 1] - from;
  std::uint32_t most = 0;
  for (std::size_t i = 0; i < count; i++)
    most = std::max(most, s.branch[from + i]);
  if (most >= count)
    most = count ? static_cast<std::uint32_t>(count - 1) : 0; // numbers beyond are no branches
  const std::size_t branches = count ? std::size_t(most) + 1 : 0;
  b.first.assign(branches + 1, 0), b.kind.assign(branches, 0), b.reach.assign(branches, 0);
  const auto valid = [&](std::size_t i) { return s.branch[from + i] < branches; };
  for (std::size_t i = 0; i < count; i++)
    if (valid(i)) b.first[s.branch[from + i] + 1]++;
  std::partial_sum(b.first.begin(), b.first.end(), b.first.begin());
  b.point.resize(b.first.empty() ? 0 : b.first.back());
  std::vector<std::uint32_t> next(b.first.begin(), b.first.end());
  for (std::size_t i = 0; i < count; i++) {
    if (!valid(i)) continue;
    const std::uint32_t branch = s.branch[from + i];
    b.point[next[branch]++] = static_cast<std::uint32_t>(i);
    b.kind[branch] = s.kind[from + i];
    b.reach[branch] = std::max(b.reach[branch], static_cast<double>(s.radius[from + i]));
    const std::int64_t parent = s.parent[from + i];
    if (parent >= 0 && parent < static_cast<std::int64_t>(i))
      b.reach[branch] =
          std::max(b.reach[branch], static_cast<double>(s.radius[from + static_cast<std::size_t>(parent)]));
  }
  return b;
}

glm::dvec3 vec(const double *p) {
  return {p[0], p[1], p[2]};
}

double to_segment(const glm::dvec3 &p, const glm::dvec3 &a, const glm::dvec3 &b) {
  const glm::dvec3 d = b - a;
  const double length2 = glm::dot(d, d),
               t = length2 > 0 ? std::clamp(glm::dot(p - a, d) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - a - t * d);
}

// How far a point is from a branch's axis; roots run from the soma's centre.
double to_branch(const Skeletons &s, const Cells &cells, std::size_t cell, const Branches &b,
                 std::uint32_t branch, const glm::dvec3 &p) {
  const std::size_t from = s.offset[cell];
  double least = INFINITY;
  for (std::uint32_t k = b.first[branch]; k < b.first[branch + 1]; k++) {
    const std::size_t i = b.point[k];
    const glm::dvec3 end = vec(s.position.row(from + i));
    const std::int64_t parent = s.parent[from + i];
    glm::dvec3 begin = end;
    if (parent >= 0 && parent < static_cast<std::int64_t>(i))
      begin = vec(s.position.row(from + static_cast<std::size_t>(parent)));
    else if (cells.radius[cell] > 0)
      begin = vec(cells.soma.row(cell));
    least = std::min(least, to_segment(p, begin, end));
  }
  return least;
}

struct Found {
  std::uint64_t compartment = 0, section = 0, far = 0, measured = 0;
  std::string first_compartment, first_section, first_far;
};

// One surface. `slack` (um): how much farther than its radius a face may lie from the axis it is named after.
Found look(const Faces &f, const Skeletons &s, const Cells &cells, std::size_t row, double slack) {
  Found found;
  const std::size_t cell = f.cell[row];
  if (cell >= cells.rows() || (row < f.lod.rows() && f.lod[row]))
    return found; // coarser ones are for viewers
  const Branches b = branches_of(s, cell);
  const std::uint64_t vertices = f.vertex_offset[row + 1] - f.vertex_offset[row];
  for (std::size_t i = f.face_offset[row]; i < f.face_offset[row + 1]; i++) {
    const std::size_t face = i - f.face_offset[row];
    const unsigned code = f.compartment[i], section = f.section[i];
    const bool on_soma = section == kNoSection;
    if (on_soma ? code != 1 : code != 2 && code != 3 && code != 4 && code != 7) {
      if (!found.compartment++)
        found.first_compartment = formatted("cell %zu, face %zu: compartment %u of section %d", cell, face,
                                            code, static_cast<int>(section));
    }
    const bool known = !on_soma && section < b.kind.size() && b.kind[section];
    if (on_soma ? !(cells.radius[cell] > 0) : !known || b.kind[section] != code) {
      if (!found.section++)
        found.first_section =
            formatted("cell %zu, face %zu: section %d, compartment %u, kind of the branch %d", cell, face,
                      static_cast<int>(section), code, known ? b.kind[section] : -1);
    }
    if (i % kStride || (!on_soma && !known)) continue;
    const std::uint32_t *corner = f.face.row(i);
    if (corner[0] >= vertices || corner[1] >= vertices || corner[2] >= vertices) continue;
    glm::dvec3 centre(0);
    for (int k = 0; k < 3; k++)
      centre += vec(f.vertex.row(f.vertex_offset[row] + corner[k])) / 3.0;
    const double reach = on_soma ? static_cast<double>(cells.radius[cell]) : b.reach[section],
                 off = on_soma ? glm::length(centre - vec(cells.soma.row(cell)))
                               : to_branch(s, cells, cell, b, section, centre);
    found.measured++;
    if (!(off <= 1.25 * reach + slack) && !found.far++)
      found.first_far =
          formatted("cell %zu, face %zu lies %.3f um from the axis of section %d, %.3f um thick", cell, face,
                    off, static_cast<int>(section), reach);
  }
  return found;
}

} // namespace

void label_gates(conceg_doc *doc, Workers &workers, Gates &gates) {
  const char *const names[] = {"compartments of faces", "sections of faces", "faces at their section"};
  const Cells cells(doc);
  const Skeletons s(doc, cells);
  const Faces f(doc);
  const bool labelled = f.whole && f.section.rows() == f.face.rows() && f.compartment.rows() == f.face.rows();
  if (!labelled || !s.whole || s.branch.rows() != s.points()) {
    const char *why = !has(doc, "/meshes/cell") ? "no /meshes"
                      : !f.whole                ? "/meshes cannot be read as surfaces"
                      : !labelled               ? "no compartment and section of each face"
                                                : "no /skeleton with branches";
    for (const char *name : names)
      gates.not_judged(g, name, why);
    return;
  }
  const double slack = 2 * scalar_of<double>(doc, "/meshes@grid_step", 0.5);
  std::vector<Found> found(f.cell.rows());
  workers.loop(found.size(), 1,
               [&](std::size_t row, unsigned) { found[row] = look(f, s, cells, row, slack); });
  Found all;
  const auto first = [](std::string &to, const std::string &from) {
    if (to.empty()) to = from;
  };
  for (const Found &one : found) {
    all.compartment += one.compartment, all.section += one.section, all.far += one.far;
    all.measured += one.measured;
    first(all.first_compartment, one.first_compartment), first(all.first_section, one.first_section);
    first(all.first_far, one.first_far);
  }
  const std::string looked_at = formatted("%zu faces", f.face.rows());
  gates.none(g, names[0], all.compartment, looked_at + ": 1 on a soma; 2, 3, 4 or 7 elsewhere",
             all.first_compartment);
  gates.none(g, names[1], all.section, looked_at + ": a branch of the cell, of the face's kind",
             all.first_section);
  gates.none(g, names[2], all.far,
             formatted("every %zuth face, %llu in all: within 1.25 r + %.2f um of its section's axis",
                       kStride, static_cast<unsigned long long>(all.measured), slack),
             all.first_far);
}

} // namespace conceg::gates
