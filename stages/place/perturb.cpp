// SPDX-License-Identifier: BSD-3-Clause
#include "perturb.hpp"

#include "conceg/rng.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace conceg::place {

bool is_neuron(const std::string &class_name) {
  return class_name == "pyramidal" || class_name == "interneuron";
}

bool is_glia(const std::string &class_name) {
  return class_name == "astrocyte" || class_name == "microglia";
}

std::vector<std::uint8_t> staying(const std::vector<std::uint64_t> &ids, double share, std::uint64_t seed,
                                  const char *stream) {
  std::vector<std::pair<double, std::size_t>> rank;
  for (std::size_t i = 0; i < ids.size(); i++) {
    conceg_rng rng = conceg_rng_stream(seed, stream, ids[i]);
    rank.emplace_back(conceg_rng_uniform(&rng), i);
  }
  std::sort(rank.begin(), rank.end());
  const auto count = static_cast<std::size_t>(std::llround(share * static_cast<double>(ids.size())));
  std::vector<std::uint8_t> out(ids.size());
  for (std::size_t i = 0; i < std::min(count, rank.size()); i++)
    out[rank[i].second] = 1;
  return out;
}

std::vector<Demand> additional(const std::vector<Demand> &demands, const std::vector<std::uint8_t> &grows,
                               double factor) {
  std::vector<Demand> more = demands;
  double total = 0.0;
  for (Demand &demand : more) {
    demand.expected = grows[demand.type] ? (factor - 1.0) * static_cast<double>(demand.count) : 0.0;
    demand.count = 0;
    total += demand.expected;
  }
  if (total >= 0.5) round_by_largest_remainder(more);
  return more;
}

} // namespace conceg::place
