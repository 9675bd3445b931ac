// SPDX-License-Identifier: BSD-3-Clause
#include "separate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace conceg::relax {

namespace {

constexpr double tolerance = 1e-7; // um; cuts aim this much beyond the gap, so that sweeps end
constexpr double constricted_share = 0.95;
constexpr int most_sweeps = 200, grow_sweeps = 8;

// The radii that a pair depends on, in the order: first at a, first at b, second at a, second at b.
std::array<std::uint32_t, 4> radii_of(const Bodies &bodies, const Pair &pair) {
  const Element &e = bodies.elements[pair.e], &f = bodies.elements[pair.f];
  return {e.radius_a, e.radius_b, f.radius_a, f.radius_b};
}

// Lists, for each radius, the places (4 k + j) of the pairs' radii; places of one pair and radius are all
// listed.
struct Incidence {
  std::vector<std::uint64_t> offset, place;
  Incidence(const Bodies &bodies, const std::vector<Pair> &pairs) : offset(bodies.radius.size() + 1, 0) {
    for (const Pair &pair : pairs)
      for (const std::uint32_t r : radii_of(bodies, pair))
        offset[r + 1]++;
    for (std::size_t r = 0; r < bodies.radius.size(); r++)
      offset[r + 1] += offset[r];
    place.resize(offset.back());
    std::vector<std::uint64_t> next(offset.begin(), offset.end() - 1);
    for (std::size_t k = 0; k < pairs.size(); k++) {
      const std::array<std::uint32_t, 4> radii = radii_of(bodies, pairs[k]);
      for (std::size_t j = 0; j < 4; j++)
        place[next[radii[j]]++] = 4 * k + j;
    }
  }
};

// Cuts at both ends that lower the radius at parameter s by `cut`, with the smallest sum of squares; an end
// takes no more than it has, and the other one the rest.
void share_cut(double cut, double s, bool one_radius, double most_a, double most_b, double &at_a,
               double &at_b) {
  if (one_radius) {
    at_a = at_b = cut;
    return;
  }
  const double weight = (1 - s) * (1 - s) + s * s;
  at_a = cut * (1 - s) / weight, at_b = cut * s / weight;
  if (at_a > most_a)
    at_a = most_a, at_b = s > 0 ? std::min(most_b, (cut - (1 - s) * at_a) / s) : 0;
  else if (at_b > most_b)
    at_b = most_b, at_a = s < 1 ? std::min(most_a, (cut - s * at_b) / (1 - s)) : 0;
}

// The cuts that one pair asks for; false when it already keeps the gap or has nothing left to give.
bool ask(const Bodies &bodies, const Pair &pair, const glm::dvec3 &side, double gap,
         const std::vector<double> &radius, std::array<double, 4> &asked) {
  asked = {0, 0, 0, 0};
  RoundCone first, second;
  cones_of(bodies, pair, radius, side, first, second);
  const Closest at = closest_cones(first, second);
  const double need = gap - at.gap;
  if (need <= 0) return false;
  const std::array<std::uint32_t, 4> r = radii_of(bodies, pair);
  const auto above = [&](std::uint32_t i) { return radius[i] - bodies.floor[i]; };
  const double spare_first = (1 - at.s) * above(r[0]) + at.s * above(r[1]);
  const double spare_second = (1 - at.t) * above(r[2]) + at.t * above(r[3]);
  const double spare = spare_first + spare_second;
  if (!(spare > 0)) return false;
  const double take = std::min(need + tolerance, spare);
  share_cut(take * spare_first / spare, at.s, r[0] == r[1], above(r[0]), above(r[1]), asked[0], asked[1]);
  share_cut(take * spare_second / spare, at.t, r[2] == r[3], above(r[2]), above(r[3]), asked[2], asked[3]);
  return true;
}

// Gives back radius where every pair of a point has room: each body takes at most half of the room of each of
// its pairs. Room only shrinks, so a point that got nothing gets nothing later: pairs of points that are
// done, and pairs whose radii stayed, are not measured again.
void grow_back(const Bodies &bodies, const std::vector<Pair> &pairs, const Incidence &incidence,
               const glm::dvec3 &side, double gap, const std::vector<double> &most,
               std::vector<double> &radius, Workers &workers) {
  constexpr std::int8_t never = -2;
  std::vector<double> room(pairs.size());
  std::vector<std::uint8_t> wants(bodies.radius.size(), 0);
  std::vector<std::int8_t> grew_in(bodies.radius.size(), never); // the last sweep that gave to a radius
  std::vector<std::uint32_t> wanting, live(pairs.size());
  for (std::uint32_t i = 0; i < bodies.points; i++)
    if (radius[i] < most[i]) wants[i] = 1, wanting.push_back(i);
  std::iota(live.begin(), live.end(), 0u);
  const auto any = [&](std::uint32_t k, const auto &holds) {
    const std::array<std::uint32_t, 4> r = radii_of(bodies, pairs[k]);
    return holds(r[0]) || holds(r[1]) || holds(r[2]) || holds(r[3]);
  };
  for (std::int8_t sweep = 0; sweep < grow_sweeps && !wanting.empty(); sweep++) {
    live.erase(std::remove_if(
                   live.begin(), live.end(),
                   [&](std::uint32_t k) { return !any(k, [&](std::uint32_t r) { return wants[r] != 0; }); }),
               live.end());
    workers.loop(live.size(), 512, [&](std::size_t n, unsigned) {
      const std::uint32_t k = live[n];
      if (sweep > 0 && !any(k, [&](std::uint32_t r) { return grew_in[r] == sweep - 1; })) return;
      RoundCone first, second;
      cones_of(bodies, pairs[k], radius, side, first, second);
      room[k] = std::max(0.0, 0.5 * (closest_cones(first, second).gap - gap - tolerance));
    });
    workers.loop(wanting.size(), 512, [&](std::size_t w, unsigned) {
      const std::uint32_t i = wanting[w];
      double more = most[i] - radius[i];
      for (std::uint64_t n = incidence.offset[i]; n < incidence.offset[i + 1] && more > 0; n++)
        more = std::min(more, room[incidence.place[n] / 4]);
      wants[i] = more > 0;
      if (more > 0) radius[i] += more, grew_in[i] = sweep, wants[i] = radius[i] < most[i];
    });
    wanting.erase(std::remove_if(wanting.begin(), wanting.end(), [&](std::uint32_t i) { return !wants[i]; }),
                  wanting.end());
  }
}

} // namespace

Cut cut_radii(const Bodies &bodies, const std::vector<Pair> &pairs, const glm::dvec3 &side, double gap,
              const std::vector<double> &most, std::vector<double> &radius, Workers &workers,
              const Progress &progress) {
  Cut cut;
  cut.pairs = pairs.size();
  const std::vector<double> asked_for = radius;
  const Incidence incidence(bodies, pairs);
  std::vector<std::array<double, 4>> asked(pairs.size(), {0, 0, 0, 0});
  std::vector<std::uint8_t> asks(pairs.size(), 0), listed(bodies.radius.size(), 0);
  std::vector<std::uint32_t> open(pairs.size()), touched;
  for (std::size_t k = 0; k < pairs.size(); k++)
    open[k] = static_cast<std::uint32_t>(k);
  for (; !open.empty() && cut.sweeps < most_sweeps; cut.sweeps++) {
    report(progress, "relax: cut radii", cut.sweeps, most_sweeps);
    workers.loop(open.size(), 256, [&](std::size_t n, unsigned) {
      asks[open[n]] = ask(bodies, pairs[open[n]], side, gap, radius, asked[open[n]]);
    });
    // Radii only shrink, so a pair that keeps its gap keeps it for good.
    open.erase(std::remove_if(open.begin(), open.end(), [&](std::uint32_t k) { return !asks[k]; }),
               open.end());
    touched.clear();
    for (const std::uint32_t k : open)
      for (const std::uint32_t r : radii_of(bodies, pairs[k]))
        if (!std::exchange(listed[r], std::uint8_t{1})) touched.push_back(r);
    for (const std::uint32_t r : touched)
      listed[r] = 0;
    workers.loop(touched.size(), 256, [&](std::size_t n, unsigned) {
      const std::uint32_t r = touched[n];
      double largest = 0;
      for (std::uint64_t at = incidence.offset[r]; at < incidence.offset[r + 1]; at++)
        largest = std::max(largest, asked[incidence.place[at] / 4][incidence.place[at] % 4]);
      radius[r] = std::max(bodies.floor[r], radius[r] - largest);
    });
  }
  grow_back(bodies, pairs, incidence, side, gap, most, radius, workers);
  double sum = 0;
  for (std::size_t i = 0; i < bodies.points; i++)
    cut.constricted += radius[i] < constricted_share * asked_for[i], sum += radius[i] / asked_for[i];
  if (bodies.points) cut.mean_share = sum / static_cast<double>(bodies.points);
  return cut;
}

float not_above(double x) {
  const auto rounded = static_cast<float>(x);
  return static_cast<double>(rounded) > x ? std::nextafter(rounded, 0.0f) : rounded;
}

Certificate certify(const Bodies &bodies, const std::vector<Pair> &pairs, const glm::dvec3 &side, double gap,
                    const std::vector<double> &radius, Workers &workers) {
  std::vector<double> gaps(pairs.size());
  workers.loop(pairs.size(), 512, [&](std::size_t k, unsigned) {
    RoundCone first, second;
    cones_of(bodies, pairs[k], radius, side, first, second);
    gaps[k] = closest_cones(first, second).gap;
  });
  Certificate out;
  out.pairs = pairs.size();
  out.smallest_gap = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < pairs.size(); k++) {
    const Pair &pair = pairs[k];
    const bool foreign = bodies.elements[pair.e].cell != bodies.elements[pair.f].cell;
    out.foreign += foreign;
    out.images += !foreign && !same_copy(pair);
    out.overlapping += gaps[k] < 0;
    out.tight += gaps[k] >= 0 && gaps[k] < gap;
    if (gaps[k] < 0 && pair.e >= bodies.points && pair.f >= bodies.points) {
      out.overlapping_somas++;
      if (-gaps[k] > out.deepest_somas)
        out.deepest_somas = -gaps[k], out.soma_e = bodies.elements[pair.e].cell,
        out.soma_f = bodies.elements[pair.f].cell;
    }
    if (gaps[k] < out.smallest_gap) out.smallest_gap = gaps[k], out.worst_e = pair.e, out.worst_f = pair.f;
  }
  out.largest_overlap = std::max(0.0, -out.smallest_gap);
  return out;
}

std::uint64_t count_pinched(const Bodies &bodies, const std::vector<Pair> &pairs, const glm::dvec3 &side,
                            double gap, double step, const std::vector<double> &radius, Workers &workers) {
  constexpr double thinnest_tube = 0.92; // of a step, sqrt(3)/2 + 0.05
  const double need = gap + 2 * thinnest_tube * step;
  std::vector<std::uint8_t> first(pairs.size()), second(pairs.size()), pinched(bodies.points, 0);
  workers.loop(pairs.size(), 512, [&](std::size_t k, unsigned) {
    RoundCone e, f;
    cones_of(bodies, pairs[k], radius, side, e, f);
    const bool joined =
        same_copy(pairs[k]) && bodies.elements[pairs[k].e].cell == bodies.elements[pairs[k].f].cell;
    if (joined) return; // one surface: nothing is cut
    first[k] = closest_cones({e.b, e.b, 0, 0}, f).gap < need - e.radius_b;
    second[k] = closest_cones({f.b, f.b, 0, 0}, e).gap < need - f.radius_b;
  });
  for (std::size_t k = 0; k < pairs.size(); k++) {
    if (first[k] && pairs[k].e < bodies.points) pinched[pairs[k].e] = 1;
    if (second[k] && pairs[k].f < bodies.points) pinched[pairs[k].f] = 1;
  }
  return static_cast<std::uint64_t>(std::count(pinched.begin(), pinched.end(), 1));
}

} // namespace conceg::relax
