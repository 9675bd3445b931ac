// SPDX-License-Identifier: BSD-3-Clause
#include "points.hpp"

#include "ray_faces.hpp"

#include "conceg/rng.h"

#include <algorithm>
#include <cmath>

namespace conceg::analyse {

namespace {

constexpr double most_images = 1e4; // that one face lies over; more mean a broken coordinate

// Rays run along `ray`, the shortest side; columns of a regular grid lie across it.
struct Columns {
  int ray, u, v;
  double lo_u, lo_v, side_u, side_v, side_ray;
  std::size_t count_u, count_v;
  std::size_t of(double x, double y) const {
    const auto index = [](double t, std::size_t n) {
      return std::min(n - 1, static_cast<std::size_t>(std::max(0.0, t * static_cast<double>(n))));
    };
    return index((x - lo_u) / side_u, count_u) * count_v + index((y - lo_v) / side_v, count_v);
  }
};

Columns make_columns(const conceg_box &box, std::size_t faces, std::uint64_t points) {
  Columns c;
  c.ray = 0;
  for (int a = 1; a < 3; a++)
    if (conceg_box_side(&box, a) < conceg_box_side(&box, c.ray)) c.ray = a;
  c.u = (c.ray + 1) % 3, c.v = (c.ray + 2) % 3;
  c.lo_u = box.lo[c.u], c.lo_v = box.lo[c.v];
  c.side_u = conceg_box_side(&box, c.u), c.side_v = conceg_box_side(&box, c.v),
  c.side_ray = conceg_box_side(&box, c.ray);
  // Some hundred faces and some ten points a column.
  const double wanted = std::min(
      4e6, std::max(1.0, std::min(static_cast<double>(faces) / 50, static_cast<double>(points) / 10)));
  const double width = std::sqrt(c.side_u * c.side_v / wanted);
  c.count_u = static_cast<std::size_t>(std::max(1.0, std::floor(c.side_u / width)));
  c.count_v = static_cast<std::size_t>(std::max(1.0, std::floor(c.side_v / width)));
  return c;
}

struct Point {
  double u, v, ray;
};

// Draws all points and sorts them by column, in the order of their numbers within each.
struct PointTable {
  std::vector<std::uint64_t> offset;
  std::vector<Point> point;
};

PointTable draw_points(const conceg_box &box, const Columns &columns, std::uint64_t count, std::uint64_t seed,
                       Workers &workers) {
  std::vector<Point> drawn(count);
  workers.loop(count, 8192, [&](std::size_t i, unsigned) {
    conceg_rng rng = conceg_rng_stream(seed, "analyse.points", i);
    double p[3];
    for (int a = 0; a < 3; a++)
      p[a] = box.lo[a] + conceg_rng_uniform(&rng) * conceg_box_side(&box, a);
    drawn[i] = {p[columns.u], p[columns.v], p[columns.ray]};
  });
  PointTable table;
  table.offset.assign(columns.count_u * columns.count_v + 1, 0);
  for (const Point &p : drawn)
    table.offset[columns.of(p.u, p.v) + 1]++;
  for (std::size_t c = 0; c + 1 < table.offset.size(); c++)
    table.offset[c + 1] += table.offset[c];
  table.point.resize(count);
  std::vector<std::uint64_t> next(table.offset.begin(), table.offset.end() - 1);
  for (const Point &p : drawn)
    table.point[next[columns.of(p.u, p.v)]++] = p;
  return table;
}

struct Reference {
  std::uint32_t face;          // among all faces
  std::int32_t lift_u, lift_v; // the point's image that the face sees is point + lift * side
};

// Calls body(column, reference) for every column and image that a face lies over.
template <class Body>
void for_each_column(const conceg_box &box, const Columns &columns, const Flat &flat, std::uint32_t face,
                     Body &&body) {
  const double low_u = std::min({flat.u[0], flat.u[1], flat.u[2]}),
               high_u = std::max({flat.u[0], flat.u[1], flat.u[2]});
  const double low_v = std::min({flat.v[0], flat.v[1], flat.v[2]}),
               high_v = std::max({flat.v[0], flat.v[1], flat.v[2]});
  const int from_u = conceg_box_lift(&box, columns.u, low_u - 1e-6),
            to_u = conceg_box_lift(&box, columns.u, high_u + 1e-6);
  const int from_v = conceg_box_lift(&box, columns.v, low_v - 1e-6),
            to_v = conceg_box_lift(&box, columns.v, high_v + 1e-6);
  const double images = (1.0 + to_u - from_u) * (1.0 + to_v - from_v);
  if (!(images <= most_images))
    fail(CONCEG_E_RANGE,
         "/meshes/face[%u]: a face reaches over %g images of the box: expected it near its cell", face,
         images);
  const auto range = [](double low, double high, double lo, double width, std::size_t count,
                        std::size_t &first, std::size_t &last) {
    // One column more on each side than the bounds: the lifted points are rounded.
    const double a = std::floor((low - lo) / width * static_cast<double>(count) - 1e-6);
    const double b = std::floor((high - lo) / width * static_cast<double>(count) + 1e-6);
    if (b < 0 || a >= static_cast<double>(count)) return false;
    first = static_cast<std::size_t>(std::max(0.0, a)),
    last = static_cast<std::size_t>(std::min(static_cast<double>(count - 1), b));
    return true;
  };
  for (int i = from_u; i <= to_u; i++) {
    std::size_t first_u, last_u, first_v, last_v;
    if (!range(low_u - i * columns.side_u, high_u - i * columns.side_u, columns.lo_u, columns.side_u,
               columns.count_u, first_u, last_u))
      continue;
    for (int j = from_v; j <= to_v; j++) {
      if (!range(low_v - j * columns.side_v, high_v - j * columns.side_v, columns.lo_v, columns.side_v,
                 columns.count_v, first_v, last_v))
        continue;
      for (std::size_t x = first_u; x <= last_u; x++)
        for (std::size_t y = first_v; y <= last_v; y++)
          body(x * columns.count_v + y, Reference{face, i, j});
    }
  }
}

struct FaceTable {
  std::vector<std::uint64_t> offset;
  std::vector<Reference> reference;
};

FaceTable index_faces(const Meshes &meshes, const conceg_box &box, const Columns &columns,
                      const Progress &progress) {
  FaceTable table;
  table.offset.assign(columns.count_u * columns.count_v + 1, 0);
  std::vector<std::uint64_t> next;
  for (int pass = 0; pass < 2; pass++) {
    for (std::size_t k = 0; k < meshes.cell.size(); k++) {
      report(progress, "analyse: index faces", static_cast<std::uint64_t>(pass) * meshes.cell.size() + k,
             2 * meshes.cell.size());
      for (std::size_t f = meshes.face_offset[k]; f < meshes.face_offset[k + 1]; f++)
        for_each_column(box, columns, flatten(meshes, columns.u, columns.v, columns.ray, k, f),
                        static_cast<std::uint32_t>(f), [&](std::size_t c, const Reference &r) {
                          if (pass == 0)
                            table.offset[c + 1]++;
                          else
                            table.reference[next[c]++] = r;
                        });
    }
    if (pass == 1) break;
    for (std::size_t c = 0; c + 1 < table.offset.size(); c++)
      table.offset[c + 1] += table.offset[c];
    table.reference.resize(table.offset.back());
    next.assign(table.offset.begin(), table.offset.end() - 1);
  }
  return table;
}

} // namespace

PointShare locate_points(const Meshes &meshes, const conceg_box &box, std::uint64_t points,
                         std::uint64_t seed, Workers &workers, const Progress &progress) {
  PointShare share;
  share.points = points;
  if (!points) return share;
  const std::size_t faces = meshes.face.size() / 3;
  if (faces >= UINT32_MAX)
    fail(CONCEG_E_RANGE, "/meshes/face: expected fewer than 2^32 faces, got %zu", faces);
  const Columns columns = make_columns(box, faces, points);
  const PointTable table = draw_points(box, columns, points, seed, workers);
  const FaceTable over = index_faces(meshes, box, columns, progress);
  const std::size_t count = columns.count_u * columns.count_v, batch = 8192;
  std::vector<std::uint64_t> inside(count, 0), several(count, 0);
  const bool periodic = box.periodic[columns.ray];
  const auto surface_of = [&](std::uint32_t face) {
    return static_cast<std::size_t>(
               std::upper_bound(meshes.face_offset.begin(), meshes.face_offset.end(), face) -
               meshes.face_offset.begin()) -
           1;
  };
  for (std::size_t start = 0; start < count; start += batch) {
    report(progress, "analyse: points", start, count);
    workers.loop(std::min(batch, count - start), 16, [&](std::size_t n, unsigned) {
      const std::size_t c = start + n;
      const Point *point = table.point.data() + table.offset[c];
      const std::size_t here = table.offset[c + 1] - table.offset[c];
      std::vector<std::int64_t> winding(here, 0);
      for (std::uint64_t r = over.offset[c]; r < over.offset[c + 1]; r++) {
        const Reference &reference = over.reference[r];
        const Flat flat =
            flatten(meshes, columns.u, columns.v, columns.ray, surface_of(reference.face), reference.face);
        const double shift_u = reference.lift_u * columns.side_u, shift_v = reference.lift_v * columns.side_v;
        for (std::size_t i = 0; i < here; i++) {
          double at;
          const int sign = crossing(flat, point[i].u + shift_u, point[i].v + shift_v, at);
          if (!sign) continue;
          // Of all images of the point along the ray, those below the face: a number up to a constant that a
          // closed surface cancels.
          const double below =
              periodic ? std::ceil((at - point[i].ray) / columns.side_ray) : (at > point[i].ray ? 1.0 : 0.0);
          winding[i] += sign * static_cast<std::int64_t>(below);
        }
      }
      for (const std::int64_t w : winding)
        inside[c] += w != 0, several[c] += w > 1 || w < 0;
    });
  }
  std::uint64_t sum = 0;
  for (std::size_t c = 0; c < count; c++)
    sum += inside[c], share.in_several += several[c];
  share.inside = static_cast<double>(sum) / static_cast<double>(points);
  share.standard_error = std::sqrt(share.inside * (1 - share.inside) / static_cast<double>(points));
  return share;
}

} // namespace conceg::analyse
