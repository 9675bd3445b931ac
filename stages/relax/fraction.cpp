// SPDX-License-Identifier: BSD-3-Clause
#include "fraction.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace conceg::relax {

namespace {

// Kronecker sequence in three dimensions: g is the root of g^4 = g + 1.
constexpr double g = 1.22074408460575947536;

double fraction(double x) {
  return x - std::floor(x);
}

// Bins of the points, so that an element meets those near it only.
struct Bins {
  glm::dvec3 lo, size;
  glm::ivec3 count;
  std::vector<std::uint32_t> offset, point;
  std::size_t number(const glm::ivec3 &at) const {
    return (static_cast<std::size_t>(at.z) * static_cast<std::size_t>(count.y) +
            static_cast<std::size_t>(at.y)) *
               static_cast<std::size_t>(count.x) +
           static_cast<std::size_t>(at.x);
  }
  glm::ivec3 bin(const glm::dvec3 &p) const {
    return glm::clamp(glm::ivec3(glm::floor((p - lo) / size)), glm::ivec3(0), count - 1);
  }
};

Bins make_bins(const std::vector<glm::dvec3> &points, const conceg_box &box) {
  Bins bins;
  const glm::dvec3 sides = side(box);
  bins.lo = glm::dvec3(box.lo[0], box.lo[1], box.lo[2]);
  bins.count = glm::clamp(glm::ivec3(sides), glm::ivec3(1), glm::ivec3(128)); // of about 1 um
  bins.size = sides / glm::dvec3(bins.count);
  bins.offset.assign(bins.number(bins.count - 1) + 2, 0);
  for (const glm::dvec3 &p : points)
    bins.offset[bins.number(bins.bin(p)) + 1]++;
  for (std::size_t b = 1; b < bins.offset.size(); b++)
    bins.offset[b] += bins.offset[b - 1];
  bins.point.resize(points.size());
  std::vector<std::uint32_t> next(bins.offset.begin(), bins.offset.end() - 1);
  for (std::uint32_t i = 0; i < points.size(); i++)
    bins.point[next[bins.number(bins.bin(points[i]))]++] = i;
  return bins;
}

double distance_to(const RoundCone &cone, const glm::dvec3 &p) {
  return closest_cones({p, p, 0, 0}, cone).gap;
}

struct Found {
  std::uint32_t point;
  Sample::Near near;
};

// Points within `reach` of one element, over all images.
void meet(const Bodies &bodies, const std::vector<double> &most, const conceg_box &box, const Bins &bins,
          const std::vector<glm::dvec3> &points, std::uint32_t e, double reach, std::vector<Found> &out) {
  const RoundCone cone = cone_of(bodies, e, most);
  const glm::dvec3 sides = side(box), extent(std::max(cone.radius_a, cone.radius_b) + reach);
  const glm::dvec3 low = glm::min(cone.a, cone.b) - extent, high = glm::max(cone.a, cone.b) + extent;
  glm::ivec3 first(0), last(0);
  double images = 1;
  for (int a = 0; a < 3; a++) {
    if (!box.periodic[a]) continue;
    first[a] = static_cast<int>(std::ceil((box.lo[a] - high[a]) / sides[a]));
    last[a] = static_cast<int>(std::floor((box.hi[a] - low[a]) / sides[a]));
    images *= last[a] - first[a] + 1;
  }
  if (images > 1e4) fail(CONCEG_E_RANGE, "/skeleton: a piece of a cell meets %g images of the box", images);
  for (int x = first.x; x <= last.x; x++)
    for (int y = first.y; y <= last.y; y++)
      for (int z = first.z; z <= last.z; z++) {
        const glm::dvec3 shift = sides * glm::dvec3(x, y, z);
        const RoundCone image = {cone.a + shift, cone.b + shift, cone.radius_a, cone.radius_b};
        const glm::dvec3 from = low + shift, to = high + shift;
        bool apart = false;
        for (int a = 0; a < 3; a++)
          apart |= to[a] < box.lo[a] || from[a] > box.hi[a];
        if (apart) continue;
        const glm::ivec3 bin_from = bins.bin(from), bin_to = bins.bin(to);
        for (int k = bin_from.z; k <= bin_to.z; k++)
          for (int j = bin_from.y; j <= bin_to.y; j++)
            for (int i = bin_from.x; i <= bin_to.x; i++) {
              const std::size_t b = bins.number({i, j, k});
              for (std::uint32_t n = bins.offset[b]; n < bins.offset[b + 1]; n++)
                if (distance_to(image, points[bins.point[n]]) < reach)
                  out.push_back({bins.point[n], {e, {x, y, z}}});
            }
      }
}

auto label_of(const Bodies &bodies, const Sample::Near &n) {
  return std::make_tuple(bodies.elements[n.element].cell, n.lift[0], n.lift[1], n.lift[2]);
}

} // namespace

Sample make_sample(const Bodies &bodies, const std::vector<double> &most, const conceg_box &box,
                   std::size_t count, double reach, Workers &workers) {
  Sample sample;
  const glm::dvec3 sides = side(box), lo(box.lo[0], box.lo[1], box.lo[2]);
  for (std::size_t k = 0; k < count; k++) {
    const auto n = static_cast<double>(k);
    sample.point.push_back(lo + sides * glm::dvec3(fraction(0.5 + n / g), fraction(0.5 + n / (g * g)),
                                                   fraction(0.5 + n / (g * g * g))));
  }
  const Bins bins = make_bins(sample.point, box);
  constexpr std::size_t block = 1024;
  std::vector<std::vector<Found>> found((bodies.elements.size() + block - 1) / block);
  workers.loop(found.size(), 1, [&](std::size_t b, unsigned) {
    for (std::size_t e = b * block; e < std::min(bodies.elements.size(), (b + 1) * block); e++)
      meet(bodies, most, box, bins, sample.point, static_cast<std::uint32_t>(e), reach, found[b]);
  });
  sample.offset.assign(count + 1, 0);
  for (const auto &list : found)
    for (const Found &f : list)
      sample.offset[f.point + 1]++;
  for (std::size_t i = 0; i < count; i++)
    sample.offset[i + 1] += sample.offset[i];
  sample.near.resize(sample.offset[count]);
  std::vector<std::uint64_t> next(sample.offset.begin(), sample.offset.end() - 1);
  for (const auto &list : found)
    for (const Found &f : list)
      sample.near[next[f.point]++] = f.near;
  workers.loop(count, 1024, [&](std::size_t i, unsigned) {
    const auto from = sample.near.begin();
    std::sort(from + static_cast<std::ptrdiff_t>(sample.offset[i]),
              from + static_cast<std::ptrdiff_t>(sample.offset[i + 1]),
              [&](const Sample::Near &x, const Sample::Near &y) {
                return std::make_pair(label_of(bodies, x), x.element) <
                       std::make_pair(label_of(bodies, y), y.element);
              });
  });
  return sample;
}

Fractions fractions_of(const Bodies &bodies, const std::vector<double> &radius, const glm::dvec3 &side,
                       const Sample &sample, double gap, Workers &workers) {
  constexpr std::size_t block = 512;
  const std::size_t points = sample.point.size();
  struct Counts {
    std::uint64_t united = 0, several = 0, planes = 0;
  };
  std::vector<Counts> counts((points + block - 1) / block);
  workers.loop(counts.size(), 1, [&](std::size_t b, unsigned) {
    for (std::size_t i = b * block; i < std::min(points, (b + 1) * block); i++) {
      double nearest = std::numeric_limits<double>::infinity(), second = nearest;
      for (std::uint64_t n = sample.offset[i]; n < sample.offset[i + 1];) {
        const auto label = label_of(bodies, sample.near[n]);
        double least = std::numeric_limits<double>::infinity();
        for (; n < sample.offset[i + 1] && label_of(bodies, sample.near[n]) == label; n++) {
          RoundCone cone = cone_of(bodies, sample.near[n].element, radius);
          const std::int32_t *lift = sample.near[n].lift;
          const glm::dvec3 shift = side * glm::dvec3(lift[0], lift[1], lift[2]);
          cone.a += shift, cone.b += shift;
          least = std::min(least, distance_to(cone, sample.point[i]));
        }
        second = std::min(second, std::max(nearest, least));
        nearest = std::min(nearest, least);
      }
      counts[b].united += nearest <= 0;
      counts[b].several += second <= 0;
      counts[b].planes += nearest <= 0 && nearest + gap <= second;
    }
  });
  Counts sum;
  for (const Counts &c : counts)
    sum.united += c.united, sum.several += c.several, sum.planes += c.planes;
  const auto share = [&](std::uint64_t n) {
    return points ? static_cast<double>(n) / static_cast<double>(points) : 0.0;
  };
  return {share(sum.united), share(sum.several), share(sum.planes)};
}

} // namespace conceg::relax
