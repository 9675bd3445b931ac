// SPDX-License-Identifier: BSD-3-Clause
#include "cut.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::rendering {
namespace {

// An oriented piece of a membrane in the plane: going along it upwards, the cell lies on its left.
struct Piece {
  glm::dvec2 from, to;
  std::int32_t body;
};

glm::dvec2 flat(const CutPlane &plane, const glm::dvec3 &p) {
  return {p[plane.across], p[plane.up]};
}

// The pieces in which one surface meets the plane. A vertex on the plane counts as above it, so no piece is
// lost or doubled.
void cut_surface(const Body &body, std::int32_t number, const CutPlane &plane, std::vector<Piece> &pieces) {
  const bool mirrored = plane.axis == 1; // (x, z, y) is left-handed
  for (const glm::uvec3 &f : body.face) {
    const glm::dvec3 *corner[3] = {&body.vertex[f.x], &body.vertex[f.y], &body.vertex[f.z]};
    bool above[3];
    for (int k = 0; k < 3; k++)
      above[k] = (*corner[k])[plane.axis] >= plane.position;
    if (above[0] == above[1] && above[1] == above[2]) continue;
    glm::dvec2 rising(0.0), falling(0.0);
    for (int k = 0; k < 3; k++) {
      const int next = (k + 1) % 3;
      if (above[k] == above[next]) continue;
      // Computed from the lower end, so that both triangles of an edge get the same point.
      const glm::dvec3 &low = above[k] ? *corner[next] : *corner[k],
                       &high = above[k] ? *corner[k] : *corner[next];
      const double share = (plane.position - low[plane.axis]) / (high[plane.axis] - low[plane.axis]);
      (above[k] ? falling : rising) = flat(plane, low + share * (high - low));
    }
    pieces.push_back(mirrored ? Piece{rising, falling, number} : Piece{falling, rising, number});
  }
}

struct Crossing {
  double at;
  std::int32_t body;
  bool leaves;
};

class Sampler {
public:
  Sampler(const Scene &scene, const CutPlane &plane, int width, int height)
      : low_(flat(plane, scene.lo)), step_((flat(plane, scene.hi) - low_) / glm::dvec2(width, height)),
        width_(width), height_(height) {}

  double x(double column) const { return low_.x + (column + 0.5) * step_.x; }
  double y(double row) const { return low_.y + (height_ - row - 0.5) * step_.y; }
  double column(double at_x) const { return (at_x - low_.x) / step_.x - 0.5; }
  double row(double at_y) const { return height_ - (at_y - low_.y) / step_.y - 0.5; }
  int first(double place, int count) const {
    return static_cast<int>(std::min<double>(std::max(std::ceil(place), 0.0), count));
  }
  int width() const { return width_; }
  int height() const { return height_; }
  double left() const { return low_.x; }
  std::size_t index(int column_, int row_) const {
    return static_cast<std::size_t>(row_) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column_);
  }

private:
  glm::dvec2 low_, step_;
  int width_, height_;
};

std::vector<std::vector<Crossing>> cross_rows(const std::vector<Piece> &pieces, const Sampler &grid) {
  std::vector<std::vector<Crossing>> rows(static_cast<std::size_t>(grid.height()));
  for (const Piece &piece : pieces) {
    const bool upwards = piece.to.y > piece.from.y;
    const glm::dvec2 &low = upwards ? piece.from : piece.to, &high = upwards ? piece.to : piece.from;
    const int last = grid.first(grid.row(low.y) + 1.0, grid.height());
    for (int row = grid.first(grid.row(high.y) - 1.0, grid.height()); row < last; row++) {
      const double y = grid.y(row);
      if (y < low.y || y >= high.y) continue;
      const double at = low.x + (y - low.y) / (high.y - low.y) * (high.x - low.x);
      if (at >= grid.left()) rows[static_cast<std::size_t>(row)].push_back({at, piece.body, upwards});
    }
  }
  return rows;
}

// The owner of a row that no membrane crosses: the nearest piece straight above or below its middle tells.
std::int32_t owner_of_plain_row(const std::vector<Piece> &pieces, double x, double y) {
  double nearest = INFINITY;
  std::int32_t owner = -1;
  for (const Piece &piece : pieces) {
    const bool rightwards = piece.to.x > piece.from.x;
    const glm::dvec2 &left = rightwards ? piece.from : piece.to, &right = rightwards ? piece.to : piece.from;
    if (x < left.x || x >= right.x) continue;
    const double off = left.y + (x - left.x) / (right.x - left.x) * (right.y - left.y) - y;
    if (std::fabs(off) >= nearest) continue;
    nearest = std::fabs(off);
    owner = rightwards == (off < 0.0) ? piece.body : -1; // a piece that goes right has its cell above it
  }
  return owner;
}

void fill_row(CutMap &map, const Sampler &grid, int row, std::vector<Crossing> &crossings) {
  std::sort(crossings.begin(), crossings.end(), [](const Crossing &a, const Crossing &b) {
    if (a.at != b.at) return a.at < b.at;
    return a.leaves != b.leaves ? a.leaves : a.body < b.body;
  });
  std::int32_t owner = crossings.front().leaves ? crossings.front().body : -1;
  int column = 0;
  for (const Crossing &crossing : crossings) {
    const int end = grid.first(grid.column(crossing.at), grid.width());
    for (; column < end; column++)
      map.body[grid.index(column, row)] = owner;
    if (!crossing.leaves)
      owner = crossing.body;
    else if (owner == crossing.body)
      owner = -1;
  }
  for (; column < grid.width(); column++)
    map.body[grid.index(column, row)] = owner;
}

void mark_membrane(CutMap &map, const Sampler &grid, const Piece &piece, double half_um) {
  const glm::dvec2 along = piece.to - piece.from;
  const double length2 = glm::dot(along, along);
  const glm::dvec2 low = glm::min(piece.from, piece.to) - half_um,
                   high = glm::max(piece.from, piece.to) + half_um;
  const int right = grid.first(grid.column(high.x), grid.width()),
            bottom = grid.first(grid.row(low.y), grid.height());
  for (int row = grid.first(grid.row(high.y), grid.height()); row < bottom; row++)
    for (int column = grid.first(grid.column(low.x), grid.width()); column < right; column++) {
      const glm::dvec2 to = glm::dvec2(grid.x(column), grid.y(row)) - piece.from;
      const double share = length2 > 0.0 ? glm::clamp(glm::dot(to, along) / length2, 0.0, 1.0) : 0.0;
      const glm::dvec2 off = to - share * along;
      if (glm::dot(off, off) <= half_um * half_um) map.membrane[grid.index(column, row)] = 1;
    }
}

// Owner and distance of each sample to the nearest cone; beyond `reach_um` outside of every cone it stays
// infinite.
void cut_cones(const Scene &scene, const CutPlane &plane, const Sampler &grid, double reach_um, CutMap &map,
               std::vector<float> &nearest) {
  for (std::size_t k = 0; k < scene.bodies.size(); k++)
    for (const RoundCone &cone : scene.bodies[k].cones) {
      const glm::dvec3 low = glm::min(cone.a - cone.ra, cone.b - cone.rb) - reach_um,
                       high = glm::max(cone.a + cone.ra, cone.b + cone.rb) + reach_um;
      if (plane.position < low[plane.axis] || plane.position > high[plane.axis]) continue;
      const int right = grid.first(grid.column(high[plane.across]), grid.width()),
                bottom = grid.first(grid.row(low[plane.up]), grid.height());
      for (int row = grid.first(grid.row(high[plane.up]), grid.height()); row < bottom; row++)
        for (int column = grid.first(grid.column(low[plane.across]), grid.width()); column < right;
             column++) {
          glm::dvec3 p;
          p[plane.axis] = plane.position, p[plane.across] = grid.x(column), p[plane.up] = grid.y(row);
          const auto d = static_cast<float>(cone_distance(cone, p));
          const std::size_t at = grid.index(column, row);
          if (d >= nearest[at]) continue;
          nearest[at] = d;
          map.body[at] = d < 0.0f ? static_cast<std::int32_t>(k) : -1;
        }
    }
}

// Divided by its slope in the plane, the distance to a slanted membrane becomes that to its line.
void mark_cone_membranes(const std::vector<float> &nearest, const Sampler &grid, double half_um,
                         CutMap &map) {
  for (int row = 0; row < grid.height(); row++)
    for (int column = 0; column < grid.width(); column++) {
      const auto at = [&](int x, int y) {
        return nearest[grid.index(std::clamp(x, 0, grid.width() - 1), std::clamp(y, 0, grid.height() - 1))];
      };
      const double d = at(column, row);
      if (!(std::fabs(d) <= half_um)) continue;
      const double across = 0.5 * (at(column + 1, row) - at(column - 1, row)) / (grid.x(1) - grid.x(0));
      const double up = 0.5 * (at(column, row - 1) - at(column, row + 1)) / (grid.y(0) - grid.y(1));
      const double slope = std::sqrt(across * across + up * up);
      if (std::fabs(d) <= half_um * (slope < 1.0 ? slope : 1.0)) map.membrane[grid.index(column, row)] = 1;
    }
}

} // namespace

CutPlane cut_plane(int axis, double position_um) {
  return {axis, axis == 0 ? 1 : 0, axis == 2 ? 1 : 2, position_um};
}

CutMap cut(const Scene &scene, const CutPlane &plane, int width, int height, double membrane_um,
           Workers &workers, const Progress &progress) {
  const Sampler grid(scene, plane, width, height);
  CutMap map;
  map.width = width, map.height = height;
  map.body.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), -1);
  map.membrane.assign(map.body.size(), 0);
  std::vector<std::vector<Piece>> per_body(scene.bodies.size());
  bool cones = false;
  workers.loop(scene.bodies.size(), 1, [&](std::size_t k, unsigned) {
    cut_surface(scene.bodies[k], static_cast<std::int32_t>(k), plane, per_body[k]);
  });
  std::vector<Piece> pieces;
  for (std::size_t k = 0; k < per_body.size(); k++) {
    pieces.insert(pieces.end(), per_body[k].begin(), per_body[k].end());
    cones |= !scene.bodies[k].cones.empty();
  }
  report(progress, "render: cut", 1, 3);
  std::vector<std::vector<Crossing>> rows = cross_rows(pieces, grid);
  workers.loop(rows.size(), 16, [&](std::size_t row, unsigned) {
    const int y = static_cast<int>(row);
    if (!rows[row].empty()) {
      fill_row(map, grid, y, rows[row]);
    } else if (!pieces.empty()) {
      const std::int32_t owner = owner_of_plain_row(pieces, grid.x(0.5 * width), grid.y(y));
      for (int x = 0; x < width; x++)
        map.body[grid.index(x, y)] = owner;
    }
  });
  report(progress, "render: cut", 2, 3);
  for (const Piece &piece : pieces)
    mark_membrane(map, grid, piece, 0.5 * membrane_um);
  if (cones) {
    std::vector<float> nearest(map.body.size(), INFINITY);
    cut_cones(scene, plane, grid, membrane_um, map, nearest);
    mark_cone_membranes(nearest, grid, 0.5 * membrane_um, map);
  }
  std::size_t inside = 0;
  for (const std::int32_t body : map.body)
    inside += body >= 0;
  map.covered = map.body.empty() ? 0.0 : static_cast<double>(inside) / static_cast<double>(map.body.size());
  report(progress, "render: cut", 3, 3);
  return map;
}

} // namespace conceg::rendering
