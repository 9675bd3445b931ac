// SPDX-License-Identifier: BSD-3-Clause
// From walkers to signals: means over the walkers of a compartment, with standard errors.
#pragma once

#include "parallel.hpp"
#include "protocol.hpp"
#include "spread.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::simulate {

struct Walkers {
  std::vector<glm::dvec3> vector;       // [walkers][shapes], um ms
  std::vector<double> weight;           // [walkers]; empty = all 1
  std::vector<glm::dvec3> displacement; // [times][walkers], um
  std::size_t count = 0;
};

// Walkers that are averaged together.
struct Compartment {
  std::string name;
  std::vector<std::uint32_t> walker;
};

struct Signals {
  std::vector<Mean> real;        // [measurements]: mean of weight * cos(phase)
  std::vector<double> imaginary; // [measurements]: mean of weight * sin(phase)
  std::vector<Mean> powder;      // [shells]: mean over the directions too
};
Signals mean_signals(const Protocol &protocol, const Walkers &walkers, const Compartment &compartment,
                     Workers &workers);

} // namespace conceg::simulate
