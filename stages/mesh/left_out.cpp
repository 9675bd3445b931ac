// SPDX-License-Identifier: BSD-3-Clause
#include "left_out.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <numeric>

namespace conceg::mesh {
namespace {

constexpr double kColumn = 0.5; // um, of the table of faces
constexpr double kAcross = 0.6; // of the radius: where the places around the axis lie

// Is a place inside of a closed surface? Faces are held in columns along x.
class Inside {
public:
  explicit Inside(const SurfaceView &surface) : surface_(surface) {
    glm::dvec3 high(-INFINITY);
    low_ = glm::dvec3(INFINITY);
    for (std::uint32_t v = 0; v < surface.vertices; v++)
      low_ = glm::min(low_, surface.at(v)), high = glm::max(high, surface.at(v));
    for (int i = 0; i < 2; i++)
      columns_[i] = static_cast<std::size_t>((high[i + 1] - low_[i + 1]) / kColumn) + 1;
    first_.assign(columns_[0] * columns_[1] + 1, 0);
    for (std::size_t f = 0; f < surface.faces; f++)
      each_column(f, [&](std::size_t c) { first_[c + 1]++; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    face_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t f = 0; f < surface.faces; f++)
      each_column(f, [&](std::size_t c) { face_[next[c]++] = static_cast<std::uint32_t>(f); });
  }

  bool holds(const glm::dvec3 &p) const {
    const double y = (p.y - low_.y) / kColumn, z = (p.z - low_.z) / kColumn;
    if (!(y >= 0 && z >= 0 && y < static_cast<double>(columns_[0]) && z < static_cast<double>(columns_[1])))
      return false;
    const std::size_t c = static_cast<std::size_t>(y) * columns_[1] + static_cast<std::size_t>(z);
    bool inside = false;
    for (std::size_t k = first_[c]; k < first_[c + 1]; k++)
      inside ^= is_passed(surface_.face[face_[k]], p);
    return inside;
  }

private:
  template <class Body> void each_column(std::size_t f, Body &&body) const {
    const glm::uvec3 &v = surface_.face[f];
    const glm::dvec3 a = surface_.at(v.x), b = surface_.at(v.y), c = surface_.at(v.z);
    const glm::dvec3 from = (glm::min(a, glm::min(b, c)) - low_) / kColumn,
                     to = (glm::max(a, glm::max(b, c)) - low_) / kColumn;
    for (auto y = static_cast<std::size_t>(from.y); y <= static_cast<std::size_t>(to.y); y++)
      for (auto z = static_cast<std::size_t>(from.z); z <= static_cast<std::size_t>(to.z); z++)
        body(y * columns_[1] + z);
  }

  // By a ray along +x; half-open in z, so that a common edge counts once.
  bool is_passed(const glm::uvec3 &v, const glm::dvec3 &p) const {
    const glm::dvec3 t[3] = {surface_.at(v.x) - p, surface_.at(v.y) - p, surface_.at(v.z) - p};
    bool inside = false;
    for (int i = 0, j = 2; i < 3; j = i++)
      if ((t[i].z > 0) != (t[j].z > 0) && 0 < t[i].y - t[i].z * (t[j].y - t[i].y) / (t[j].z - t[i].z))
        inside = !inside;
    if (!inside) return false;
    const glm::dvec3 normal = cross_product(t[1] - t[0], t[2] - t[0]);
    return normal.x != 0 && glm::dot(t[0], normal) / normal.x > 0;
  }

  const SurfaceView &surface_;
  glm::dvec3 low_{};
  std::size_t columns_[2] = {};
  std::vector<std::size_t> first_; // per column y * columns_[1] + z, and one more
  std::vector<std::uint32_t> face_;
};

bool is_outside(const Inside &inside, const glm::dvec3 &a, const glm::dvec3 &b, double radius) {
  const glm::dvec3 middle = 0.5 * (a + b), axis = b - a;
  if (inside.holds(middle)) return false;
  const glm::dvec3 aside = std::fabs(axis.x) < std::fabs(axis.y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  glm::dvec3 e = cross_product(axis, aside);
  if (!(glm::dot(e, e) > 0)) return true;
  e = glm::normalize(e);
  const glm::dvec3 f = glm::normalize(cross_product(axis, e));
  const double half = 0.70710678118654752;
  const double turn[8][2] = {{1, 0},  {half, half},   {0, 1},  {-half, half},
                             {-1, 0}, {-half, -half}, {0, -1}, {half, -half}};
  for (const auto &t : turn)
    if (inside.holds(middle + kAcross * radius * (t[0] * e + t[1] * f))) return false;
  return true;
}

void look(const Tissue &tissue, const SurfaceView &surface, std::uint8_t *left_out) {
  const std::size_t first = tissue.offset[surface.cell], last = tissue.offset[surface.cell + 1];
  const Inside inside(surface);
  std::vector<std::uint8_t> told(last - first);
  for (std::size_t i = first; i < last; i++) {
    if (tissue.parent[i] < 0) continue;
    const std::size_t parent = first + static_cast<std::size_t>(tissue.parent[i]);
    const double radius = 0.5 * (double(tissue.radius[i]) + double(tissue.radius[parent]));
    left_out[i] = is_outside(inside, tissue.point[parent], tissue.point[i], radius);
    if (tissue.parent[parent] < 0 && !(tissue.soma_radius[surface.cell] > 0) && !told[parent - first])
      told[parent - first] = 1, left_out[parent] = left_out[i];
  }
}

// Puts a cell's parts into a new tissue: what hangs on its soma, or on a root that stays, first; then each
// run of segments that are alike.
class Divider {
public:
  Divider(const Tissue &tissue, const std::vector<std::uint8_t> &left_out)
      : tissue_(tissue), left_out_(left_out) {
    out_.tissue.box = tissue.box;
    out_.tissue.offset.push_back(0);
    has_branch_ = !tissue.branch.empty();
  }

  Relabelled run() {
    for (std::size_t cell = 0; cell < tissue_.cells(); cell++)
      add_own(cell);
    for (std::size_t cell = 0; cell < tissue_.cells(); cell++)
      add_parts(cell);
    return std::move(out_);
  }

private:
  static constexpr std::size_t kOwn = 0;

  // The part that each point's segment is in.
  std::size_t divide(std::size_t cell) {
    const std::size_t first = tissue_.offset[cell], count = tissue_.offset[cell + 1] - first;
    part_.assign(count, kOwn);
    std::size_t parts = 1;
    for (std::size_t i = 0; i < count; i++) {
      const std::int64_t parent = tissue_.parent[first + i];
      if (parent < 0)
        part_[i] = left_out_[first + i] ? parts++ : kOwn;
      else
        part_[i] = left_out_[first + i] == left_out_[first + static_cast<std::size_t>(parent)]
                       ? part_[static_cast<std::size_t>(parent)]
                       : parts++;
    }
    return parts;
  }

  void add_own(std::size_t cell) {
    divide(cell);
    open_cell(tissue_.soma[cell], tissue_.soma_radius[cell], static_cast<std::uint32_t>(cell) + 1);
    add_points(cell, kOwn);
  }

  void add_parts(std::size_t cell) {
    const std::size_t first = tissue_.offset[cell], parts = divide(cell);
    for (std::size_t part = 1; part < parts; part++) {
      const std::size_t i =
          first + static_cast<std::size_t>(std::find(part_.begin(), part_.end(), part) - part_.begin());
      open_cell(tissue_.point[i], 0.0f, left_out_[i] ? 0 : static_cast<std::uint32_t>(cell) + 1);
      add_points(cell, part);
    }
  }

  void open_cell(const glm::dvec3 &soma, float radius, std::uint32_t label) {
    out_.tissue.soma.push_back(soma), out_.tissue.soma_radius.push_back(radius);
    out_.tissue.offset.push_back(out_.tissue.point.size());
    out_.label.push_back(label);
  }

  // A part that begins within the tree begins with a point of its own: what is left out in the middle of its
  // first segment, where it is known to be outside, what comes back at that segment's begin.
  void add_points(std::size_t cell, std::size_t part) {
    const std::size_t first = tissue_.offset[cell];
    std::int64_t rows = 0;
    row_.assign(part_.size(), -1);
    for (std::size_t i = 0; i < part_.size(); i++) {
      if (part_[i] != part) continue;
      const std::int64_t parent = tissue_.parent[first + i];
      std::int64_t to = parent < 0 ? -1 : row_[static_cast<std::size_t>(parent)];
      if (parent >= 0 && to < 0) {
        const std::size_t p = first + static_cast<std::size_t>(parent), q = first + i;
        const bool middle = left_out_[q];
        add_point(middle ? 0.5 * (tissue_.point[p] + tissue_.point[q]) : tissue_.point[p],
                  middle ? 0.5f * (tissue_.radius[p] + tissue_.radius[q]) : tissue_.radius[p], -1, q);
        to = rows++;
      }
      add_point(tissue_.point[first + i], tissue_.radius[first + i], to, first + i);
      row_[i] = rows++;
    }
    out_.tissue.offset.back() = out_.tissue.point.size();
  }

  void add_point(const glm::dvec3 &point, float radius, std::int64_t parent, std::size_t like) {
    out_.tissue.point.push_back(point), out_.tissue.radius.push_back(radius);
    out_.tissue.parent.push_back(parent), out_.tissue.kind.push_back(tissue_.kind[like]);
    if (has_branch_) out_.tissue.branch.push_back(tissue_.branch[like]);
  }

  const Tissue &tissue_;
  const std::vector<std::uint8_t> &left_out_;
  Relabelled out_;
  bool has_branch_ = false;
  std::vector<std::size_t> part_; // per point of the cell at work
  std::vector<std::int64_t> row_; // its row in the part at work
};

} // namespace

std::vector<std::uint8_t> left_out_segments(const Tissue &tissue, const Views &surfaces,
                                            const std::vector<Pieces> &pieces, Workers &workers) {
  std::vector<std::uint8_t> left_out;
  if (std::none_of(pieces.begin(), pieces.end(), [](const Pieces &p) { return p.detached > 0; }))
    return left_out;
  left_out.resize(tissue.point.size());
  workers.loop(surfaces.size(), 1, [&](std::size_t s, unsigned) {
    if (pieces[surfaces[s].cell].detached > 0) look(tissue, surfaces[s], left_out.data());
  });
  return left_out;
}

Relabelled with_left_out_apart(const Tissue &tissue, const std::vector<std::uint8_t> &left_out) {
  return Divider(tissue, left_out).run();
}

} // namespace conceg::mesh
