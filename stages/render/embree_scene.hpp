// SPDX-License-Identifier: BSD-3-Clause
// The scene in Embree's hands. Floats are good enough here: nothing about the tissue is decided in a picture.
#pragma once

#include "scene.hpp"

#include <cmath>
#include <cstdint>

struct RTCDeviceTy;
struct RTCSceneTy;

namespace conceg::rendering {

struct RayHit {
  double distance = INFINITY;          // um
  glm::dvec3 normal = glm::dvec3(0.0); // unit, smoothed over the surface
  std::int32_t body = -1;
  bool inside = false;   // the surface is seen from within
  double rim = INFINITY; // um to the nearest edge of the triangle; only when the scene asks for wires
};

class RayScene {
public:
  RayScene(const Scene &scene, unsigned threads);
  ~RayScene();
  RayScene(const RayScene &) = delete;
  RayScene &operator=(const RayScene &) = delete;
  RayHit first(const glm::dvec3 &start, const glm::dvec3 &direction, double from, double to) const;
  bool blocked(const glm::dvec3 &start, const glm::dvec3 &direction, double to) const;
  // Where the ray meets an edge of the box; infinity when it meets none.
  double edge_distance(const glm::dvec3 &start, const glm::dvec3 &direction) const;

  // The body one of whose cones holds the point; -1 = none.
  std::int32_t cone_owner(const glm::dvec3 &point) const;

private:
  void add_surface(const Body &body, std::uint32_t number);
  void add_cones(const Body &body, std::uint32_t number);
  void add_edges();
  const Scene &scene_;
  glm::dvec3 middle_;
  std::vector<std::vector<RoundCone>> shapes_; // per geometry id, in the order of Embree's primitives
  bool has_cones_ = false;
  RTCDeviceTy *device_ = nullptr;
  RTCSceneTy *cells_ = nullptr, *edges_ = nullptr;
};

// Shortens [from, to] to the part of the ray within the box on the axes where the scene is cut; false when
// none is left.
bool clip_to_box(const Scene &scene, const glm::dvec3 &start, const glm::dvec3 &direction, double &from,
                 double &to);
// Outward normal of the side of the box that is nearest to a point on it.
glm::dvec3 box_normal(const Scene &scene, const glm::dvec3 &place);

} // namespace conceg::rendering
