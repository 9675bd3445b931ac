// SPDX-License-Identifier: BSD-3-Clause
#include "cones.hpp"
#include "guard.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace conceg::mesh {
namespace {

constexpr double kWidest = double(1 << 19); // voxels from the box, so that vertex keys hold 20 bits per axis

constexpr double kSnapLoss = 0.007;    // measured on tubes and balls
constexpr double kClusterLoss = 0.057; // the same

Grid make_grid(const conceg_box &box, const SceneOptions &options) {
  Grid grid;
  for (int axis = 0; axis < 3; axis++) {
    const double side = conceg_box_side(&box, axis),
                 cubes = std::max(4.0, std::ceil(side / options.h - 1e-9));
    if (!(cubes < kWidest))
      fail(CONCEG_E_RANGE, "h_um: expected at least %g for a side of %g um, got %g", side / kWidest, side,
           options.h);
    grid.size[axis] = static_cast<int>(cubes);
    grid.step[axis] = side / cubes;
    grid.origin[axis] = box.lo[axis] + (options.centred ? 0.5 * grid.step[axis] : 0.0);
    grid.periodic[axis] = box.periodic[axis] != 0;
    grid.low[axis] = 0;
    grid.high[axis] = grid.size[axis];
  }
  grid.unit = std::min({grid.step.x, grid.step.y, grid.step.z});
  grid.scale = glm::vec3(grid.step / grid.unit);
  return grid;
}

class Builder {
public:
  Builder(const Tissue &tissue, const SceneOptions &options) : tissue_(tissue), options_(options) {
    scene_.grid = make_grid(tissue.box, options);
    scene_.gap = options.gap / scene_.grid.unit;
    if (options.centred) scene_.snap = 0;
    scene_.cells = tissue.cells();
    scene_.thin_points.resize(tissue.cells());
  }

  Scene build() {
    for (std::size_t cell = 0; cell < tissue_.cells(); cell++)
      add_cell(cell);
    for (int axis = 0; axis < 3; axis++)
      if (!scene_.grid.periodic[axis]) span_open_axis(axis);
    return std::move(scene_);
  }

private:
  void add_cell(std::size_t cell) {
    cell_ = cell;
    const double soma_radius = tissue_.soma_radius[cell];
    const glm::dvec3 &soma = tissue_.soma[cell];
    if (soma_radius > 0) {
      open_section(kNoSection, 0.0);
      add_cone(soma, soma_radius, soma, soma_radius, kSomaKind);
    }
    const std::size_t first = tissue_.offset[cell], count = tissue_.offset[cell + 1] - first;
    std::vector<std::uint32_t> branch;
    if (tissue_.branch.empty())
      branch = derive_branches(tissue_.parent.data() + first, count);
    else
      branch.assign(tissue_.branch.begin() + first, tissue_.branch.begin() + first + count);
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t l, std::uint32_t r) { return branch[l] < branch[r]; });
    for (std::size_t i = 0; i < count; i++) {
      const std::size_t point = order[i];
      if (i == 0 || branch[point] != branch[order[i - 1]])
        open_section(branch[point], tissue_.radius[first + point]);
      add_segment(first, point, soma, soma_radius);
    }
  }

  void add_segment(std::size_t first, std::size_t point, const glm::dvec3 &soma, double soma_radius) {
    const glm::dvec3 &end = tissue_.point[first + point];
    const double radius = tissue_.radius[first + point];
    const std::uint8_t kind = tissue_.kind[first + point];
    if (grown_radius(radius, kind) < kThinnestTube * scene_.grid.unit) scene_.thin_points[cell_]++;
    const std::int64_t parent = tissue_.parent[first + point];
    if (parent >= 0) {
      add_cone(tissue_.point[first + parent], tissue_.radius[first + parent], end, radius, kind);
      return;
    }
    // A root is joined to its soma by a cone that starts one radius below the soma's surface.
    const double distance = glm::length(end - soma), depth = std::max(0.0, soma_radius - radius);
    const bool inside = soma_radius <= 0 || distance <= depth;
    add_cone(inside ? end : soma + (end - soma) * (depth / distance), radius, end, radius, kind);
  }

  void open_section(std::uint32_t branch, double radius) {
    const double blend = options_.smooth * radius / scene_.grid.unit;
    // Nodes farther than two steps (plus gap) from a surface cannot touch an edge that the surface crosses.
    const double reach =
        2.2 * glm::length(scene_.grid.step) / (std::sqrt(3.0) * scene_.grid.unit) + scene_.gap + blend;
    scene_.section.push_back({static_cast<float>(blend), static_cast<float>(reach), branch});
  }

  void add_cone(const glm::dvec3 &a, double ra, const glm::dvec3 &b, double rb, std::uint8_t kind) {
    Cone cone = {};
    cone.a = fixed(a), cone.b = fixed(b);
    cone.ra = fixed_radius(ra, kind), cone.rb = fixed_radius(rb, kind);
    cone.cell = static_cast<std::uint32_t>(cell_);
    cone.section = static_cast<std::uint32_t>(scene_.section.size() - 1);
    cone.kind = kind;
    scene_.cone.push_back(cone);
  }

  glm::ivec3 fixed(const glm::dvec3 &position) const {
    const glm::dvec3 voxel = scene_.grid.voxel_of(position);
    glm::ivec3 out;
    for (int axis = 0; axis < 3; axis++) {
      if (!(std::fabs(voxel[axis]) < kWidest - 4096))
        fail(CONCEG_E_RANGE,
             "cell %zu: expected points within %g voxels of the box, got %g on axis %d; use a larger h_um",
             cell_, kWidest - 4096, voxel[axis], axis);
      out[axis] = static_cast<int>(std::floor(voxel[axis] * kFixed + 0.5));
    }
    return out;
  }

  // Straight faces between nodes lie inside a surface with curvatures k1 and k2 by (k1 + k2) h^2 / 12 in the
  // mean, clusters of their corners by (k1 + k2) h^2 kClusterLoss more, and the snap of node values takes
  // kSnapLoss steps; primitives for meshing are that much larger, so that volumes come out right.
  double mesh_loss(double radius, std::uint8_t kind) const {
    if (options_.centred) return 0; // voxels are points: no faces, no loss
    const double h = scene_.grid.unit, curvature = (kind == kSomaKind ? 2 : 1) / radius,
                 faces = 1.0 / 12 + (options_.cluster ? kClusterLoss : 0.0);
    return std::min(0.25 * radius, curvature * h * h * faces + kSnapLoss * h);
  }

  double grown_radius(double radius, std::uint8_t kind) const {
    const double inflated = radius + std::min(options_.inflate, 0.25 * radius);
    return inflated + mesh_loss(inflated, kind);
  }

  std::int32_t fixed_radius(double radius, std::uint8_t kind) const {
    const double grown = grown_radius(radius, kind);
    if (!(grown < 2048 * scene_.grid.unit))
      fail(CONCEG_E_RANGE, "cell %zu: expected radii below 2048 voxels, got %g um; use a larger h_um", cell_,
           radius);
    return std::max(1, static_cast<int>(std::floor(grown / scene_.grid.unit * kFixed + 0.5)));
  }

  void span_open_axis(int axis) {
    int low = 0, high = scene_.grid.size[axis];
    for (const Cone &cone : scene_.cone) {
      const double margin =
          std::max(cone.ra, cone.rb) / double(kFixed) + scene_.section[cone.section].reach + 1;
      low = std::min(
          low, static_cast<int>(std::floor(std::min(cone.a[axis], cone.b[axis]) / double(kFixed) - margin)));
      high = std::max(
          high, static_cast<int>(std::ceil(std::max(cone.a[axis], cone.b[axis]) / double(kFixed) + margin)));
    }
    if (options_.centred) return; // volumes cover the box alone
    scene_.grid.low[axis] = low, scene_.grid.high[axis] = high;
  }

  const Tissue &tissue_;
  const SceneOptions &options_;
  Scene scene_;
  std::size_t cell_ = 0;
};

} // namespace

double primitive_area(const Scene &scene) {
  constexpr double pi = 3.14159265358979323846;
  double sum = 0;
  for (const Cone &cone : scene.cone) {
    const double ra = cone.ra / double(kFixed), rb = cone.rb / double(kFixed);
    const double length = glm::length(glm::dvec3(cone.b - cone.a) * glm::dvec3(scene.grid.scale)) / kFixed;
    sum += cone.kind == kSomaKind ? 4 * pi * ra * ra : pi * (ra + rb) * length;
  }
  return sum;
}

std::vector<std::uint32_t> derive_branches(const std::int64_t *parent, std::size_t count) {
  std::vector<std::uint32_t> children(count), branch(count);
  for (std::size_t i = 0; i < count; i++)
    if (parent[i] >= 0) children[static_cast<std::size_t>(parent[i])]++;
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < count; i++) {
    const bool starts = parent[i] < 0 || children[static_cast<std::size_t>(parent[i])] > 1;
    branch[i] = starts ? next++ : branch[static_cast<std::size_t>(parent[i])];
  }
  return branch;
}

Scene make_scene(const Tissue &tissue, const SceneOptions &options) {
  return Builder(tissue, options).build();
}

} // namespace conceg::mesh
