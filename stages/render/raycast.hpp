// SPDX-License-Identifier: BSD-3-Clause
// Parallel projection of a scene by ray casting: two lights, shadows, ambient occlusion, anti-aliasing.
#pragma once

#include "image.hpp"
#include "scene.hpp"

#include <memory>

namespace conceg::rendering {

// Looks from `azimuth_deg` (from +x towards +y) and `elevation_deg` (above the x y plane) at the middle of
// the scene.
class Camera {
public:
  Camera(const Scene &scene, double azimuth_deg, double elevation_deg);
  const glm::dvec3 &right() const { return right_; }
  const glm::dvec3 &up() const { return up_; }
  const glm::dvec3 &forward() const { return forward_; }
  glm::dvec2 extent() const { return extent_; } // um that the scene takes in the picture
  double depth() const { return depth_; }       // um from its nearest to its farthest point
  // A point of the picture plane before the scene; (0, 0) is the scene's middle, in um.
  glm::dvec3 start(const glm::dvec2 &at) const {
    return middle_ + at.x * right_ + at.y * up_ - 0.5 * depth_ * forward_;
  }
  glm::dvec2 project(const glm::dvec3 &p) const;

private:
  glm::dvec3 right_, up_, forward_, middle_;
  glm::dvec2 extent_;
  double depth_;
};

struct Frame {
  int left, top, width, height; // where in the picture, in pixels
  double um_per_pixel;
  int samples_per_side; // of a pixel
};

class RayScene; // the Embree scene

// Throws E_NOMEM or E_UNSUPPORTED when Embree cannot build it.
std::shared_ptr<const RayScene> make_ray_scene(const Scene &scene, unsigned threads);

// Draws the scene into a part of the picture, over what is there.
void draw_scene(Image &image, const Frame &view, const Scene &scene, const RayScene &rays,
                const Camera &camera, Workers &workers, const Progress &progress);

} // namespace conceg::rendering
