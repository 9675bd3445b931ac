// SPDX-License-Identifier: GPL-3.0-or-later
#include "radius.hpp"

#include "neighbours.hpp"
#include "wrap.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace conceg::triangulate {
namespace {

constexpr std::size_t kBlock = 4096; // nodes between two progress reports

// Distance to the nearest soma surface that is within the cap.
class SomaGrid {
public:
  SomaGrid(const conceg_box &box, const std::vector<Soma> &somas, double cap_um)
      : box_(box), somas_(somas), grid_(box, largest(somas) + cap_um) {
    for (std::size_t i = 0; i < somas.size(); i++)
      if (somas[i].radius > 0.0) grid_.add(somas[i].center, static_cast<std::uint32_t>(i));
  }

  double distance(const glm::dvec3 &p) const {
    double least = HUGE_VAL;
    grid_.around(p, [&](std::uint32_t i) {
      const glm::dvec3 d = nearest(box_, p - somas_[i].center);
      least = std::min(least, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) - somas_[i].radius);
      return true;
    });
    return least;
  }

private:
  static double largest(const std::vector<Soma> &somas) {
    double radius = 0.0;
    for (const Soma &soma : somas)
      radius = std::max(radius, soma.radius);
    return radius;
  }

  const conceg_box &box_;
  const std::vector<Soma> &somas_;
  NeighbourGrid grid_;
};

} // namespace

std::vector<float> allowed_radii(const conceg_box &box, const std::vector<glm::dvec3> &nodes,
                                 const std::vector<Soma> &somas, double cap_um, Workers &workers,
                                 const Progress &progress) {
  const SomaGrid grid(box, somas, cap_um);
  std::vector<float> radii(nodes.size());
  std::atomic<std::uint64_t> done{0};
  workers.loop((nodes.size() + kBlock - 1) / kBlock, 1, [&](std::size_t block, unsigned) {
    const std::size_t end = std::min(nodes.size(), (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; i++) {
      double radius = std::min(cap_um, grid.distance(nodes[i]));
      for (int axis = 0; axis < 3; axis++)
        if (!box.periodic[axis])
          radius = std::min({radius, nodes[i][axis] - box.lo[axis], box.hi[axis] - nodes[i][axis]});
      radii[i] = static_cast<float>(radius);
    }
    report(progress, "largest radii", done += end - block * kBlock, nodes.size());
  });
  return radii;
}

} // namespace conceg::triangulate
