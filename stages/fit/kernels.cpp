// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"

#include "sphere_gpd.hpp"
#include "sphere_table.hpp"

namespace conceg::fit {

Sphere make_sphere(const Model &model, const Timing &timing, double most_b, Workers &workers,
                   const Progress &progress) {
  if (model.kernel == Kernel::exact) {
    const SphereRange range{most_b, model.lower[soma_radius], model.upper[soma_radius], model.lower[soma_d],
                            model.upper[soma_d]};
    return {SphereTable(timing, range, workers, progress), nullptr, nullptr};
  }
  const SphereGpd gpd(timing);
  const double low = model.lower[soma_radius], high = model.upper[soma_radius];
  return {gpd, [gpd](double radius, double d) { return gpd.apparent(radius, d); },
          [gpd, low, high](double apparent, double d) { return gpd.radius_of(apparent, d, low, high); }};
}

} // namespace conceg::fit
