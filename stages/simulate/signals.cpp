// SPDX-License-Identifier: BSD-3-Clause
#include "signals.hpp"

#include "conceg/portable.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::simulate {

Signals mean_signals(const Protocol &protocol, const Walkers &walkers, const Compartment &compartment,
                     Workers &workers) {
  const std::size_t rows = protocol.measurements(), shapes = protocol.timeline.shapes;
  const std::vector<std::uint32_t> shell = shells(protocol);
  const std::size_t shell_count = shell.empty() ? 0 : 1 + *std::max_element(shell.begin(), shell.end());
  std::vector<std::vector<std::size_t>> member(shell_count);
  for (std::size_t r = 0; r < rows; r++)
    member[shell[r]].push_back(r);
  Signals out;
  out.real.resize(rows), out.imaginary.resize(rows), out.powder.resize(shell_count);
  const double n = static_cast<double>(compartment.walker.size());
  workers.loop(shell_count, 1, [&](std::size_t s, unsigned) {
    std::vector<Sums> real(member[s].size());
    std::vector<double> imaginary(member[s].size(), 0.0);
    Sums powder;
    for (const std::uint32_t w : compartment.walker) {
      const double weight = walkers.weight.empty() ? 1.0 : walkers.weight[w];
      double average = 0.0;
      for (std::size_t i = 0; i < member[s].size(); i++) {
        const glm::dvec3 *coefficient = &protocol.coefficient[member[s][i] * shapes];
        double phase = 0.0, sine = 0.0, cosine = 1.0;
        for (std::size_t k = 0; k < shapes; k++)
          phase += glm::dot(coefficient[k], walkers.vector[w * shapes + k]);
        conceg_sincos(phase, &sine, &cosine);
        real[i].add(weight * cosine - 1.0), imaginary[i] += weight * sine, average += weight * cosine - 1.0;
      }
      powder.add(average / static_cast<double>(member[s].size()));
    }
    for (std::size_t i = 0; i < member[s].size(); i++) {
      out.real[member[s][i]] = mean_of(real[i], 1.0, n);
      out.imaginary[member[s][i]] = n > 0.0 ? imaginary[i] / n : 0.0;
    }
    out.powder[s] = mean_of(powder, 1.0, n);
  });
  return out;
}

} // namespace conceg::simulate
