// SPDX-License-Identifier: BSD-3-Clause
// The periodic box over GLM vectors, and reading it from /domain.
#pragma once

#include "conceg/geom.h"
#include "view.hpp"

#include <glm/vec3.hpp>

namespace conceg {

inline conceg_box read_box(conceg_doc *doc) {
  conceg_box box = {};
  const View<double> lo = view<double>(doc, "/domain@lo", 3), hi = view<double>(doc, "/domain@hi", 3);
  const View<std::uint8_t> periodic = view<std::uint8_t>(doc, "/domain@periodic", 3);
  for (int a = 0; a < 3; a++) {
    box.lo[a] = lo[a], box.hi[a] = hi[a], box.periodic[a] = periodic[a] != 0;
    if (!(box.hi[a] > box.lo[a]))
      fail(CONCEG_E_RANGE, "/domain: expected lo < hi on axis %d, got %g and %g", a, lo[a], hi[a]);
  }
  return box;
}

inline glm::dvec3 side(const conceg_box &box) {
  return {conceg_box_side(&box, 0), conceg_box_side(&box, 1), conceg_box_side(&box, 2)};
}
inline double volume(const conceg_box &box) {
  const glm::dvec3 s = side(box);
  return s.x * s.y * s.z;
}
// The image of p inside the box (periodic axes only).
inline glm::dvec3 wrap(const conceg_box &box, const glm::dvec3 &p) {
  return {conceg_box_wrap(&box, 0, p.x), conceg_box_wrap(&box, 1, p.y), conceg_box_wrap(&box, 2, p.z)};
}
// The number of sides that wrap() takes off p.
inline glm::ivec3 lift(const conceg_box &box, const glm::dvec3 &p) {
  return {conceg_box_lift(&box, 0, p.x), conceg_box_lift(&box, 1, p.y), conceg_box_lift(&box, 2, p.z)};
}
// The image of the difference d = a - b of smallest size (periodic axes only).
inline glm::dvec3 nearest(const conceg_box &box, const glm::dvec3 &d) {
  return {conceg_box_nearest(&box, 0, d.x), conceg_box_nearest(&box, 1, d.y),
          conceg_box_nearest(&box, 2, d.z)};
}
inline glm::dvec3 snap(const glm::dvec3 &p) {
  return {conceg_snap(p.x), conceg_snap(p.y), conceg_snap(p.z)};
}

} // namespace conceg
