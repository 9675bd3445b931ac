// SPDX-License-Identifier: BSD-3-Clause
#include "somas.hpp"

#include "conceg/rng.h"
#include "neighbours.hpp"
#include "wrap.hpp"

#include <algorithm>
#include <numeric>

namespace conceg::place {
namespace {

constexpr int kTrials = 20000;                           // per soma, before the box counts as full
constexpr int kTrialsWhenFull = 200;                     // per soma after that, to learn how many fit
constexpr std::size_t kMissesInRow = 1000;               // then no more are tried
constexpr double kSphereVolume = 4.18879020478639098462; // 4 pi / 3

// The centres placed so far.
class Placed {
public:
  Placed(const conceg_box &box, double largest_radius, double gap)
      : box_(box), gap_(gap), grid_(box, 2.0 * largest_radius + gap) {}

  void add(const glm::dvec3 &center, double radius) {
    grid_.add(center, static_cast<std::uint32_t>(center_.size()));
    center_.push_back(center);
    radius_.push_back(radius);
  }

  bool is_free(const glm::dvec3 &center, double radius) const {
    bool free = true;
    grid_.around(center, [&](std::uint32_t i) {
      const glm::dvec3 d = nearest(box_, center - center_[i]);
      const double apart = radius + radius_[i] + gap_;
      return free = d.x * d.x + d.y * d.y + d.z * d.z >= apart * apart;
    });
    return free;
  }

private:
  const conceg_box &box_;
  double gap_;
  NeighbourGrid grid_;
  std::vector<glm::dvec3> center_;
  std::vector<double> radius_;
};

// A height in [lo, hi) whose density is the profile's.
double height_by_profile(const Profile &profile, double lo, double hi, double uniform) {
  double rest = uniform * profile.integral(lo, hi), from = lo;
  for (std::size_t i = 0; i <= profile.z.size(); i++) {
    const double to = i < profile.z.size() ? std::min(profile.z[i], hi) : hi;
    if (to <= from) continue;
    const double a = profile.at(from), piece = 0.5 * (a + profile.at(to)) * (to - from);
    if (rest <= piece || to >= hi) {
      const double slope = (profile.at(to) - a) / (to - from);
      const double root =
          a + std::sqrt(std::max(0.0, a * a + 2.0 * slope * rest)); // of a t + slope t^2 / 2 = rest
      return std::min(to, from + (root > 0.0 ? 2.0 * rest / root : 0.0));
    }
    rest -= piece;
    from = to;
  }
  return lo;
}

glm::dvec3 trial(const conceg_box &box, const SomaRequest &soma, conceg_rng &rng) {
  glm::dvec3 center;
  for (int axis = 0; axis < 3; axis++) {
    double lo = box.lo[axis], hi = box.hi[axis];
    if (axis == 2) lo = std::max(lo, conceg_snap(soma.z_lo)), hi = std::min(hi, conceg_snap(soma.z_hi));
    if (axis == 2 && soma.profile) {
      center[axis] = conceg_snap(height_by_profile(*soma.profile, lo, hi, conceg_rng_uniform(&rng)));
      if (center[axis] >= hi) center[axis] = hi - CONCEG_LATTICE_STEP_UM;
    } else {
      const auto steps = static_cast<std::uint64_t>((hi - lo) / CONCEG_LATTICE_STEP_UM);
      center[axis] = lo + static_cast<double>(conceg_rng_below(&rng, std::max<std::uint64_t>(1, steps))) *
                              CONCEG_LATTICE_STEP_UM;
    }
  }
  return center;
}

bool inside_open_sides(const conceg_box &box, const glm::dvec3 &center, double radius) {
  for (int axis = 0; axis < 3; axis++)
    if (!box.periodic[axis] && (center[axis] - radius < box.lo[axis] || center[axis] + radius > box.hi[axis]))
      return false;
  return true;
}

// Each soma alone must find room in the box and in its layer.
void check_alone(const conceg_box &box, const SomaRequest &soma, double gap) {
  for (int axis = 0; axis < 3; axis++) {
    const double side = conceg_box_side(&box, axis),
                 needed = 2.0 * soma.radius + (box.periodic[axis] ? gap : 0.0);
    if (needed > side)
      fail(CONCEG_E_RANGE,
           "domain: expected a side of at least %.4g um on axis %d, for a soma of radius %.4g um%s, got %.4g "
           "um; enlarge domain.size_um",
           needed, axis, soma.radius, box.periodic[axis] ? " and the gap to its own image" : "", side);
  }
  if (!box.periodic[2] &&
      !(std::max(soma.z_lo, box.lo[2] + soma.radius) <= std::min(soma.z_hi, box.hi[2] - soma.radius)))
    fail(CONCEG_E_RANGE,
         "layers: expected room for a soma of radius %.4g um inside the open side, got the layer from %g to "
         "%g um; make it thicker",
         soma.radius, soma.z_lo, soma.z_hi);
}

[[noreturn]] void fail_full(const conceg_box &box, const std::vector<SomaRequest> &requests, double gap,
                            std::size_t possible) {
  double filled = 0.0;
  for (const SomaRequest &soma : requests)
    filled += kSphereVolume * soma.radius * soma.radius * soma.radius;
  fail(CONCEG_E_RANGE,
       "density: asked for %zu somas, which would take %.1f %% of the box; %zu fit at random with a gap of "
       "%g um; lower the "
       "density, use smaller somas or lower place.soma_gap_um",
       requests.size(), 100.0 * filled / volume(box), possible, gap);
}

} // namespace

std::vector<glm::dvec3> place_somas(const conceg_box &box, const std::vector<SomaRequest> &requests,
                                    double gap_um, std::uint64_t seed, const Progress &progress,
                                    const Somas &standing) {
  double largest = 0.0;
  for (const double radius : standing.radius)
    largest = std::max(largest, radius);
  for (const SomaRequest &soma : requests) {
    check_alone(box, soma, gap_um);
    largest = std::max(largest, soma.radius);
  }
  std::vector<std::size_t> order(requests.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return requests[a].radius != requests[b].radius ? requests[a].radius > requests[b].radius
                                                    : requests[a].id < requests[b].id;
  });
  Placed placed(box, largest, gap_um);
  for (std::size_t i = 0; i < standing.center.size(); i++)
    placed.add(standing.center[i], standing.radius[i]);
  std::vector<glm::dvec3> centers(requests.size());
  std::size_t found_count = 0, misses_in_row = 0;
  for (std::size_t i = 0; i < order.size() && misses_in_row < kMissesInRow; i++) {
    const SomaRequest &soma = requests[order[i]];
    conceg_rng rng = conceg_rng_stream(seed, "place.soma", soma.id);
    const int trials = found_count == i ? kTrials : kTrialsWhenFull;
    bool found = false;
    for (int t = 0; t < trials && !found; t++) {
      centers[order[i]] = trial(box, soma, rng);
      found = inside_open_sides(box, centers[order[i]], soma.radius) &&
              placed.is_free(centers[order[i]], soma.radius);
    }
    if (found) placed.add(centers[order[i]], soma.radius);
    found_count += found;
    misses_in_row = found ? 0 : misses_in_row + 1;
    report(progress, "somas", i + 1, order.size());
  }
  if (found_count < requests.size()) fail_full(box, requests, gap_um, found_count);
  return centers;
}

} // namespace conceg::place
