// SPDX-License-Identifier: BSD-3-Clause
#include "composition.hpp"

#include "guard.hpp"

#include <algorithm>
#include <numeric>

namespace conceg::place {
namespace {

constexpr double kSumTolerance = 1e-6; // of fractions
constexpr double kCellLimit = 1e8;

bool given(double value) {
  return !std::isnan(value);
}

void check_layers(const Box &box, const std::vector<Layer> &layers) {
  for (std::size_t i = 0; i < layers.size(); i++) {
    if (!(layers[i].z_lo < layers[i].z_hi && layers[i].z_lo >= box.z_lo && layers[i].z_hi <= box.z_hi))
      fail(CONCEG_E_RANGE,
           "layers[%zu].z_um (%s): expected an interval inside the box's %g to %g um, got %g to %g", i,
           layers[i].name.c_str(), box.z_lo, box.z_hi, layers[i].z_lo, layers[i].z_hi);
    for (std::size_t k = 0; k < i; k++)
      if (layers[i].z_lo < layers[k].z_hi && layers[k].z_lo < layers[i].z_hi)
        fail(CONCEG_E_RANGE, "layers[%zu].z_um (%s): expected no overlap, got one with layer %s", i,
             layers[i].name.c_str(), layers[k].name.c_str());
  }
}

// Cells of all types with a fraction, expected in one layer (or in the box where there are no layers).
double expected_cells(const Box &box, const Layer &layer, double density, const Profile &profile) {
  if (given(layer.density)) return layer.density * box.area * (layer.z_hi - layer.z_lo);
  if (given(density)) return density * box.area * (layer.z_hi - layer.z_lo);
  return box.area * profile.integral(layer.z_lo, layer.z_hi);
}

// The fractions of the types that live in a layer must add up to 1.
void check_fractions(const std::vector<TypeShare> &types, int index, const std::string &where) {
  double sum = 0.0;
  for (const TypeShare &type : types)
    if (given(type.fraction) && (type.layer == index || type.layer == -1)) sum += type.fraction;
  if (std::fabs(sum - 1.0) > kSumTolerance)
    fail(CONCEG_E_RANGE, "types: expected fractions that add up to 1 in %s, got %.9g", where.c_str(), sum);
}

void add_by_fraction(const Box &box, const std::vector<Layer> &layers, const std::vector<TypeShare> &types,
                     double density, const Profile &profile, std::vector<Demand> &demands) {
  const bool any =
      std::any_of(types.begin(), types.end(), [](const TypeShare &t) { return given(t.fraction); });
  if (!any) return;
  const bool layered = !layers.empty();
  const std::vector<Layer> whole = {{"the box", box.z_lo, box.z_hi, kNotGiven}};
  const std::vector<Layer> &ranges = layered ? layers : whole;
  for (std::size_t i = 0; i < ranges.size(); i++) {
    const Layer &layer = ranges[i];
    const bool by_profile = !given(layer.density) && !given(density);
    if (by_profile && profile.z.empty())
      fail(CONCEG_E_RANGE,
           "density_per_um3: expected a cell density for %s, got none; give density_per_um3, density_profile "
           "or one per layer",
           layer.name.c_str());
    const double cells = expected_cells(box, layer, density, profile);
    if (!(cells > 0.0)) continue;
    check_fractions(types, layered ? static_cast<int>(i) : -1, layered ? "layer " + layer.name : layer.name);
    for (std::size_t t = 0; t < types.size(); t++) {
      const bool here = types[t].layer == -1 || (layered && types[t].layer == static_cast<int>(i));
      if (given(types[t].fraction) && here)
        demands.push_back({t, layered ? static_cast<int>(i) : -1, layer.z_lo, layer.z_hi, by_profile,
                           cells * types[t].fraction, 0});
    }
  }
}

void add_by_own_density(const Box &box, const std::vector<Layer> &layers, const std::vector<TypeShare> &types,
                        std::vector<Demand> &demands) {
  for (std::size_t t = 0; t < types.size(); t++) {
    if (!given(types[t].density)) continue;
    const int layer = types[t].layer;
    const double lo = layer < 0 ? box.z_lo : layers[layer].z_lo,
                 hi = layer < 0 ? box.z_hi : layers[layer].z_hi;
    demands.push_back({t, layer, lo, hi, false, types[t].density * box.area * (hi - lo), 0});
  }
}

} // namespace

// Hamilton's method: everybody gets the whole part, the largest remainders get the rest; the earlier one wins
// a tie.
void round_by_largest_remainder(std::vector<Demand> &demands) {
  double total = 0.0;
  for (const Demand &demand : demands)
    total += demand.expected;
  if (!(total < kCellLimit))
    fail(CONCEG_E_RANGE,
         "density: expected fewer than %g cells in the box, got %g; lower the densities or the box",
         kCellLimit, total);
  const auto cells = static_cast<std::uint64_t>(total + 0.5);
  if (cells == 0)
    fail(CONCEG_E_RANGE,
         "density: expected at least one cell, got %.3g = density x volume; ask for a higher density or a "
         "larger box",
         total);
  std::uint64_t given_out = 0;
  for (Demand &demand : demands)
    given_out += demand.count = static_cast<std::uint64_t>(demand.expected);
  std::vector<std::size_t> order(demands.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto remainder = [&](std::size_t i) {
    return demands[i].expected - static_cast<double>(demands[i].count);
  };
  std::vector<double> remainders(demands.size());
  for (std::size_t i = 0; i < demands.size(); i++)
    remainders[i] = remainder(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return remainders[a] > remainders[b]; });
  for (std::size_t i = 0; given_out < cells && i < order.size(); i++, given_out++)
    demands[order[i]].count++;
}

double Profile::at(double height) const {
  if (height <= z.front()) return density.front();
  if (height >= z.back()) return density.back();
  const std::size_t i = static_cast<std::size_t>(std::upper_bound(z.begin(), z.end(), height) - z.begin());
  const double t = (height - z[i - 1]) / (z[i] - z[i - 1]);
  return density[i - 1] + t * (density[i] - density[i - 1]);
}

double Profile::integral(double lo, double hi) const {
  double sum = 0.0, from = lo;
  for (std::size_t i = 0; i <= z.size() && from < hi; i++) {
    const double to = i < z.size() ? std::min(z[i], hi) : hi;
    if (to <= from) continue;
    sum += 0.5 * (at(from) + at(to)) * (to - from);
    from = to;
  }
  return sum;
}

std::vector<Demand> compose(const Box &box, const std::vector<Layer> &layers,
                            const std::vector<TypeShare> &types, double density, const Profile &profile) {
  check_layers(box, layers);
  for (std::size_t t = 0; t < types.size(); t++)
    if (!types[t].passing && given(types[t].fraction) == given(types[t].density))
      fail(CONCEG_E_RANGE, "types[%zu] (%s): expected either fraction or density_per_um3", t,
           types[t].name.c_str());
  std::vector<Demand> demands;
  if (std::all_of(types.begin(), types.end(), [](const TypeShare &t) { return t.passing; })) return demands;
  add_by_fraction(box, layers, types, density, profile, demands);
  add_by_own_density(box, layers, types, demands);
  round_by_largest_remainder(demands);
  return demands;
}

} // namespace conceg::place
