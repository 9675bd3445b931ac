// SPDX-License-Identifier: BSD-3-Clause
#include "scene.hpp"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <atomic>

namespace conceg::rendering {
namespace {

std::vector<glm::vec3> vertex_normals(const Surface &surface) {
  std::vector<glm::dvec3> sum(surface.vertex.size(), glm::dvec3(0.0));
  for (const glm::uvec3 &f : surface.face) {
    const glm::dvec3 &a = surface.vertex[f.x];
    const glm::dvec3 normal =
        glm::cross(surface.vertex[f.y] - a, surface.vertex[f.z] - a); // weighted by area
    for (int k = 0; k < 3; k++)
      sum[f[k]] += normal;
  }
  std::vector<glm::vec3> normals(sum.size());
  for (std::size_t i = 0; i < sum.size(); i++) {
    const double length = glm::length(sum[i]);
    normals[i] = length > 0.0 ? glm::vec3(sum[i] / length) : glm::vec3(0.0f);
  }
  return normals;
}

void bounds_of(const RoundCone &cone, glm::dvec3 &low, glm::dvec3 &high) {
  low = glm::min(cone.a - cone.ra, cone.b - cone.rb), high = glm::max(cone.a + cone.ra, cone.b + cone.rb);
}

bool reaches(const Body &body, const glm::dvec3 &lo, const glm::dvec3 &hi) {
  const auto meets = [&](const glm::dvec3 &low, const glm::dvec3 &high) {
    return glm::all(glm::lessThanEqual(low, hi)) && glm::all(glm::greaterThanEqual(high, lo));
  };
  for (const glm::uvec3 &f : body.face) {
    const glm::dvec3 &a = body.vertex[f.x], &b = body.vertex[f.y], &c = body.vertex[f.z];
    if (meets(glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c))) return true;
  }
  for (const RoundCone &cone : body.cones) {
    glm::dvec3 low, high;
    bounds_of(cone, low, high);
    if (meets(low, high)) return true;
  }
  return false;
}

Body make_body(const conceg_box &box, bool clipped, const Cell &cell) {
  Body body;
  body.type = cell.type;
  const std::vector<glm::vec3> normals = vertex_normals(cell.surface);
  if (!clipped) {
    body.vertex = cell.surface.vertex, body.face = cell.surface.face, body.normal = normals,
    body.cones = cell.cones;
    return body;
  }
  TiledSurface tiled = tile(box, cell.surface);
  body.normal.reserve(tiled.source_vertex.size());
  for (const std::uint32_t source : tiled.source_vertex)
    body.normal.push_back(normals[source]);
  body.vertex = std::move(tiled.vertex), body.face = std::move(tiled.face);
  for (const RoundCone &cone : cell.cones) {
    glm::dvec3 low, high;
    bounds_of(cone, low, high);
    for_each_lift(box, low, high, [&](const glm::ivec3 &lift) {
      const glm::dvec3 shift = glm::dvec3(lift) * side(box);
      body.cones.push_back({cone.a + shift, cone.b + shift, cone.ra, cone.rb});
    });
  }
  return body;
}

} // namespace

void add_bodies(Scene &scene, const std::vector<Cell> &cells, Workers &workers, const Progress &progress) {
  scene.bodies.resize(cells.size());
  std::atomic<std::size_t> done{0};
  workers.loop(cells.size(), 1, [&](std::size_t i, unsigned) {
    scene.bodies[i] = make_body(scene.box, scene.clipped, cells[i]);
    scene.bodies[i].colour = cell_colour(scene.type_colour[cells[i].type], cells[i].id);
    report(progress, "render: cells", ++done, cells.size());
  });
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const Body &body : scene.bodies) {
    for (const glm::dvec3 &p : body.vertex)
      low = glm::min(low, p), high = glm::max(high, p);
    for (const RoundCone &cone : body.cones) {
      glm::dvec3 from, to;
      bounds_of(cone, from, to);
      low = glm::min(low, from), high = glm::max(high, to);
    }
  }
  const bool empty = !(low.x <= high.x);
  for (int axis = 0; axis < 3; axis++) {
    const bool cut = scene.clipped && scene.box.periodic[axis];
    scene.lo[axis] = empty || cut    ? scene.box.lo[axis]
                     : scene.clipped ? std::min(low[axis], scene.box.lo[axis])
                                     : low[axis];
    scene.hi[axis] = empty || cut    ? scene.box.hi[axis]
                     : scene.clipped ? std::max(high[axis], scene.box.hi[axis])
                                     : high[axis];
  }
}

void zoom(Scene &scene, const glm::dvec3 &centre, double size) {
  for (int axis = 0; axis < 3; axis++) {
    const double width = std::min(size, scene.hi[axis] - scene.lo[axis]);
    const double low = glm::clamp(centre[axis] - 0.5 * width, scene.lo[axis], scene.hi[axis] - width);
    scene.box.lo[axis] = scene.lo[axis] = low, scene.box.hi[axis] = scene.hi[axis] = low + width;
    scene.box.periodic[axis] = 1; // its sides are cut faces
  }
  scene.clipped = true;
  std::vector<Body> kept;
  for (Body &body : scene.bodies)
    if (reaches(body, scene.lo, scene.hi)) kept.push_back(std::move(body));
  scene.bodies = std::move(kept);
}

} // namespace conceg::rendering
