// SPDX-License-Identifier: BSD-3-Clause
#include "spheres.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::exporting {
namespace {

constexpr double spheres_a_radius = 4.0;
constexpr double most_spheres_a_segment = 1e6;

// Adds the spheres of the round cone from sphere `from` to `to`, the latter last; returns its number. With
// radii in geometric progression each step is the same share of the thicker neighbour's radius.
std::int64_t add_cone(SphereTree &tree, std::int64_t from, const Sphere &to) {
  const Sphere a = tree.spheres[static_cast<std::size_t>(from)];
  const double length = glm::length(to.at - a.at), growth = std::log(to.outer / a.outer),
               slope = length > 0.0 ? std::fabs(to.outer - a.outer) / length : INFINITY;
  const bool even = std::fabs(growth) < 1e-9;
  double steps = 1.0;
  if (even)
    steps = std::ceil(spheres_a_radius * length / std::max(a.outer, to.outer));
  else if (slope < spheres_a_radius) // otherwise one step stays within the limit
    steps = std::ceil(std::fabs(growth) / -std::log1p(-slope / spheres_a_radius));
  steps = std::max(steps, 1.0);
  if (!(steps <= most_spheres_a_segment))
    fail(CONCEG_E_RANGE, "caterpillar: a segment of %g um with radii of %g and %g um would take %g spheres",
         length, a.outer, to.outer, steps);
  for (double k = 1.0; k <= steps; k++) {
    const double place = k == steps ? 1.0
                         : even     ? k / steps
                                    : std::expm1(growth * k / steps) / std::expm1(growth);
    const double outer = glm::mix(a.outer, to.outer, place);
    tree.spheres.push_back({glm::mix(a.at, to.at, place), std::min(outer, glm::mix(a.inner, to.inner, place)),
                            outer, k == 1.0 ? from : static_cast<std::int64_t>(tree.spheres.size()) - 1});
  }
  return static_cast<std::int64_t>(tree.spheres.size()) - 1;
}

double distance_to_box(const conceg_box &box, const glm::dvec3 &p) {
  glm::dvec3 outside(0.0);
  for (int axis = 0; axis < 3; axis++)
    if (box.periodic[axis]) outside[axis] = std::max({box.lo[axis] - p[axis], p[axis] - box.hi[axis], 0.0});
  return glm::length(outside);
}

} // namespace

std::vector<SphereTree> sphere_trees(const Cell &cell, const Tree &tree, const std::vector<double> &inner) {
  std::vector<SphereTree> pieces;
  if (cell.soma_radius > 0.0) {
    pieces.emplace_back();
    pieces[0].soma = true;
    pieces[0].spheres.push_back({cell.soma, cell.soma_radius, cell.soma_radius, -1});
  }
  std::vector<std::size_t> piece(tree.size());
  std::vector<std::int64_t> number(tree.size()); // of each point's sphere in its piece
  for (std::size_t i = 0; i < tree.size(); i++) {
    const double r = tree.radius[i];
    Sphere sphere = {tree.position[i], inner.empty() ? r : std::min(r, inner[i]), r, -1};
    if (tree.parent[i] >= 0) {
      const auto parent = static_cast<std::size_t>(tree.parent[i]);
      piece[i] = piece[parent];
      number[i] = add_cone(pieces[piece[i]], number[parent], sphere);
    } else if (cell.soma_radius > 0.0) {
      // As relax and mesh do, the root begins one radius below the soma's surface. From the centre to there
      // the spheres touch the soma from inside and thin out to it.
      const double distance = glm::length(sphere.at - cell.soma), depth = cell.soma_radius - r;
      std::int64_t last = 0;
      if (depth > 0.0 && distance > depth) {
        Sphere below = sphere;
        below.at = cell.soma + (sphere.at - cell.soma) * (depth / distance);
        last = add_cone(pieces[0], last, below);
      }
      piece[i] = 0;
      number[i] = add_cone(pieces[0], last, sphere);
    } else {
      piece[i] = pieces.size(), number[i] = 0;
      pieces.emplace_back();
      pieces.back().spheres.push_back(sphere);
    }
  }
  return pieces;
}

std::vector<SphereTree> images_in_box(const SphereTree &whole, const conceg_box &box) {
  struct Image {
    glm::ivec3 lift;
    std::size_t sphere;
  };
  const glm::dvec3 sides = side(box);
  std::vector<Image> images;
  for (std::size_t i = 0; i < whole.spheres.size(); i++) {
    const Sphere &sphere = whole.spheres[i];
    for_each_lift(box, sphere.at - sphere.outer, sphere.at + sphere.outer, [&](const glm::ivec3 &lift) {
      if (distance_to_box(box, sphere.at + glm::dvec3(lift) * sides) < sphere.outer)
        images.push_back({lift, i});
    });
  }
  std::stable_sort(images.begin(), images.end(), [](const Image &p, const Image &q) {
    if (p.lift.x != q.lift.x) return p.lift.x < q.lift.x;
    if (p.lift.y != q.lift.y) return p.lift.y < q.lift.y;
    return p.lift.z < q.lift.z;
  });
  struct Place {
    std::size_t image_of = ~std::size_t{0}, piece = 0; // first image of the lift that the place is of
    std::int64_t number = 0;
  };
  std::vector<Place> place(whole.spheres.size());
  std::vector<SphereTree> pieces;
  std::size_t first = 0;
  for (std::size_t i = 0; i < images.size(); i++) {
    if (images[i].lift != images[first].lift) first = i;
    Sphere sphere = whole.spheres[images[i].sphere];
    sphere.at += glm::dvec3(images[i].lift) * sides;
    const Place *parent = sphere.parent < 0 ? nullptr : &place[static_cast<std::size_t>(sphere.parent)];
    Place &here = place[images[i].sphere];
    here.image_of = first;
    if (parent && parent->image_of == first) {
      here.piece = parent->piece, sphere.parent = parent->number;
    } else {
      here.piece = pieces.size(), sphere.parent = -1;
      pieces.emplace_back();
      pieces.back().lift = images[i].lift;
      pieces.back().soma = whole.soma && images[i].sphere == 0;
    }
    here.number = static_cast<std::int64_t>(pieces[here.piece].spheres.size());
    pieces[here.piece].spheres.push_back(sphere);
  }
  return pieces;
}

BallShares ball_shares(std::vector<Ball> balls, const glm::dvec3 &sides) {
  constexpr int points = 512;
  constexpr std::uint8_t any = 1, of_axon = 2;
  const glm::dvec3 step = sides / static_cast<double>(points);
  std::sort(balls.begin(), balls.end(),
            [](const Ball &p, const Ball &q) { return p.at.z - p.radius < q.at.z - q.radius; });
  // Grid rows from the first to one past the last whose point lies within `reach` of `at`.
  const auto range = [&](double at, double reach, double width) {
    const auto row = [&](double x) {
      return static_cast<int>(std::clamp(std::ceil(x / width - 0.5), 0.0, static_cast<double>(points)));
    };
    return std::pair<int, int>(row(at - reach), row(at + reach));
  };
  std::vector<std::uint8_t> plane(static_cast<std::size_t>(points) * points);
  std::vector<std::size_t> active;
  std::size_t next = 0, in_axons = 0, in_any = 0;
  for (int k = 0; k < points; k++) {
    const double z = (k + 0.5) * step.z;
    for (; next < balls.size() && balls[next].at.z - balls[next].radius < z; next++)
      active.push_back(next);
    active.erase(std::remove_if(active.begin(), active.end(),
                                [&](std::size_t b) { return balls[b].at.z + balls[b].radius <= z; }),
                 active.end());
    std::fill(plane.begin(), plane.end(), std::uint8_t{0});
    for (const std::size_t b : active) {
      const Ball &ball = balls[b];
      const double left = ball.radius * ball.radius - (z - ball.at.z) * (z - ball.at.z);
      const auto [y0, y1] = range(ball.at.y, std::sqrt(std::max(0.0, left)), step.y);
      for (int y = y0; y < y1; y++) {
        const double off = (y + 0.5) * step.y - ball.at.y;
        const auto [x0, x1] = range(ball.at.x, std::sqrt(std::max(0.0, left - off * off)), step.x);
        for (int x = x0; x < x1; x++)
          plane[static_cast<std::size_t>(y) * points + static_cast<std::size_t>(x)] |=
              ball.axon ? any | of_axon : any;
      }
    }
    for (const std::uint8_t point : plane)
      in_any += point != 0, in_axons += (point & of_axon) != 0;
  }
  const double all = std::pow(points, 3);
  return {static_cast<double>(in_axons) / all, static_cast<double>(in_any) / all};
}

} // namespace conceg::exporting
