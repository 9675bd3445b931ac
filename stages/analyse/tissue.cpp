// SPDX-License-Identifier: BSD-3-Clause
#include "tissue.hpp"

#include <cmath>

namespace conceg::analyse {

namespace {

// Far enough for any tissue, and near enough that lifts fit into 32 bits.
constexpr double farthest = 1e7; // um

bool near_enough(const glm::dvec3 &p) {
  return std::abs(p.x) < farthest && std::abs(p.y) < farthest && std::abs(p.z) < farthest;
}

unsigned long long number(std::uint64_t n) {
  return n;
}

void check_offsets(const char *path, const std::vector<std::uint64_t> &offset, std::size_t groups,
                   std::size_t rows) {
  if (offset.size() != groups + 1)
    fail(CONCEG_E_FORMAT, "%s: expected %zu values, got %zu", path, groups + 1, offset.size());
  if (offset.front() != 0 || offset.back() != rows)
    fail(CONCEG_E_FORMAT, "%s: expected 0 first and %zu last, got %llu and %llu", path, rows,
         number(offset.front()), number(offset.back()));
  for (std::size_t i = 0; i < groups; i++)
    if (offset[i] > offset[i + 1])
      fail(CONCEG_E_FORMAT, "%s[%zu]: expected ascending offsets, got %llu before %llu", path, i,
           number(offset[i]), number(offset[i + 1]));
}

void check_length(const char *path, std::size_t got, std::size_t expected) {
  if (got != expected) fail(CONCEG_E_FORMAT, "%s: expected %zu values, got %zu", path, expected, got);
}

} // namespace

void check(const Cells &c) {
  check_length("/types/class", c.type_class.size(), c.type_name.size());
  check_length("/cells/id", c.id.size(), c.type.size());
  check_length("/cells/soma", c.soma.size(), c.type.size());
  check_length("/cells/radius", c.soma_radius.size(), c.type.size());
  for (std::size_t i = 0; i < c.type.size(); i++) {
    if (c.type[i] >= c.type_name.size())
      fail(CONCEG_E_RANGE, "/cells/type[%zu]: expected a type below %zu, got %u", i, c.type_name.size(),
           c.type[i]);
    if (!near_enough(c.soma[i]))
      fail(CONCEG_E_RANGE, "/cells/soma[%zu]: expected finite coordinates below 1e7 um", i);
    if (!(c.soma_radius[i] >= 0) || !std::isfinite(c.soma_radius[i]))
      fail(CONCEG_E_RANGE, "/cells/radius[%zu]: expected a radius >= 0 um, got %g", i,
           static_cast<double>(c.soma_radius[i]));
  }
}

void check(const Skeletons &s, const Cells &cells) {
  const std::size_t points = s.position.size();
  check_offsets("/skeleton/cell_offset", s.cell_offset, cells.type.size(), points);
  check_length("/skeleton/radius", s.radius.size(), points);
  check_length("/skeleton/parent", s.parent.size(), points);
  check_length("/skeleton/kind", s.kind.size(), points);
  for (std::size_t cell = 0; cell < cells.type.size(); cell++)
    for (std::size_t i = s.cell_offset[cell]; i < s.cell_offset[cell + 1]; i++) {
      const std::size_t row = i - s.cell_offset[cell];
      if (s.parent[i] < -1 || s.parent[i] >= static_cast<std::int64_t>(row))
        fail(CONCEG_E_RANGE, "/skeleton/parent[%zu]: expected -1 or a row of the cell below %zu, got %lld", i,
             row, static_cast<long long>(s.parent[i]));
      if (!near_enough(s.position[i]))
        fail(CONCEG_E_RANGE, "/skeleton/position[%zu]: expected finite coordinates below 1e7 um", i);
      if (!(s.radius[i] > 0) || !std::isfinite(s.radius[i]))
        fail(CONCEG_E_RANGE, "/skeleton/radius[%zu]: expected a radius > 0 um, got %g", i,
             static_cast<double>(s.radius[i]));
    }
}

void check(const Meshes &m, const Cells &cells) {
  check_offsets("/meshes/vertex_offset", m.vertex_offset, m.cell.size(), m.vertex.size());
  check_offsets("/meshes/face_offset", m.face_offset, m.cell.size(), m.face.size() / 3);
  for (std::size_t v = 0; v < m.vertex.size(); v++)
    if (!near_enough(m.vertex[v]))
      fail(CONCEG_E_RANGE, "/meshes/vertex[%zu]: expected finite coordinates below 1e7 um", v);
  for (std::size_t k = 0; k < m.cell.size(); k++) {
    if (m.cell[k] >= cells.type.size())
      fail(CONCEG_E_RANGE, "/meshes/cell[%zu]: expected a cell below %zu, got %u", k, cells.type.size(),
           m.cell[k]);
    const std::uint64_t vertices = m.vertex_offset[k + 1] - m.vertex_offset[k];
    for (std::size_t f = 3 * m.face_offset[k]; f < 3 * m.face_offset[k + 1]; f++)
      if (m.face[f] >= vertices)
        fail(CONCEG_E_RANGE, "/meshes/face[%zu]: expected vertices below %llu, got %u", f / 3,
             number(vertices), m.face[f]);
  }
}

void check(const Bars &b, const Cells &cells) {
  const std::size_t rows = b.state.size();
  check_offsets("/bars/cell_offset", b.cell_offset, cells.type.size(), rows);
  check_length("/bars/asked_start", b.asked_start.size(), rows);
  check_length("/bars/asked_end", b.asked_end.size(), rows);
  check_length("/bars/achieved_start", b.achieved_start.size(), rows);
  check_length("/bars/achieved_end", b.achieved_end.size(), rows);
  for (std::size_t i = 0; i < rows; i++)
    if (b.state[i] > 4) fail(CONCEG_E_RANGE, "/bars/state[%zu]: expected 0 to 4, got %d", i, b.state[i]);
}

} // namespace conceg::analyse
