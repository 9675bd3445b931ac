// SPDX-License-Identifier: BSD-3-Clause
// The donor frame: +z points to the pia.
#pragma once

#include "morphology.hpp"

#include <array>

namespace conceg::characterise {

// A rotation as a unit quaternion w x y z.
using Rotation = std::array<double, 4>;

// Unit vector from the soma to the centre of the cable of the apical trees; 0 without one.
glm::dvec3 apical_axis(const Cell &cell);

// The smallest rotation that turns the unit vector `axis` to +z.
Rotation rotation_to_z(const glm::dvec3 &axis);

glm::dvec3 rotate(const Rotation &q, const glm::dvec3 &v);

} // namespace conceg::characterise
