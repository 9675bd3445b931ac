// SPDX-License-Identifier: BSD-3-Clause
// Collision search of relax, all close pairs of the round cones of a document at their target radii, by the
// stage's Embree search and by a plain uniform grid, one thread, as one JSON object on standard output. Both
// must find the same pairs.  bench_relax FILE REACH_UM
#include "collide.hpp"
#include "input.hpp"

#include "conceg/conceg.h"
#include "view.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iterator>
#include <tuple>

using namespace conceg;
using namespace conceg::relax;

namespace {

double cpu_s() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Ball {
  glm::dvec3 middle; // in the box
  glm::ivec3 lift;   // sides taken off
  double radius;     // of a ball around the element
};

bool before(const Pair &x, const Pair &y) {
  return std::tie(x.e, x.f, x.lift[0], x.lift[1], x.lift[2]) <
         std::tie(y.e, y.f, y.lift[0], y.lift[1], y.lift[2]);
}


// Elements by the grid cell of their middle, periodic; the few that are larger than a cell (somas) meet all
// others.
struct UniformGrid {
  const Bodies &bodies;
  glm::dvec3 lo, sides, step;
  glm::ivec3 count;
  std::vector<Ball> ball;
  std::vector<std::uint32_t> offset, element, large;
  double reach;

  UniformGrid(const Bodies &b, const conceg_box &box, double reach_um) : bodies(b), reach(reach_um) {
    lo = {box.lo[0], box.lo[1], box.lo[2]}, sides = side(box);
    std::vector<double> radii;
    for (std::uint32_t e = 0; e < b.elements.size(); e++) {
      const RoundCone cone = cone_of(b, e, b.radius);
      const glm::dvec3 middle = 0.5 * (cone.a + cone.b), turns = glm::floor((middle - lo) / sides);
      ball.push_back({middle - sides * turns, glm::ivec3(turns),
                      0.5 * glm::distance(cone.a, cone.b) + std::max(cone.radius_a, cone.radius_b)});
      radii.push_back(ball.back().radius);
    }
    std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() * 999 / 1000),
                     radii.end());
    const double widest = radii[radii.size() * 999 / 1000]; // what one ring of cells covers
    count = glm::max(glm::ivec3(sides / (2 * widest + reach)), glm::ivec3(1));
    step = sides / glm::dvec3(count);
    offset.assign(static_cast<std::size_t>(count.x) * count.y * count.z + 1, 0);
    for (std::uint32_t e = 0; e < ball.size(); e++)
      ball[e].radius > widest ? large.push_back(e) : static_cast<void>(offset[cell_of(e) + 1]++);
    for (std::size_t c = 1; c < offset.size(); c++)
      offset[c] += offset[c - 1];
    element.resize(offset.back());
    std::vector<std::uint32_t> next(offset.begin(), offset.end() - 1);
    for (std::uint32_t e = 0; e < ball.size(); e++)
      if (!(ball[e].radius > widest)) element[next[cell_of(e)]++] = e;
  }

  glm::ivec3 place_of(std::uint32_t e) const {
    return glm::min(glm::ivec3((ball[e].middle - lo) / step), count - 1);
  }
  std::size_t number(const glm::ivec3 &p) const {
    return (static_cast<std::size_t>(p.z) * count.y + p.y) * count.x + p.x;
  }
  std::size_t cell_of(std::uint32_t e) const { return number(place_of(e)); }

  void meet(std::uint32_t e, std::uint32_t f, std::vector<Pair> &out) const {
    glm::dvec3 apart = ball[f].middle - ball[e].middle;
    const glm::dvec3 turns = glm::floor(apart / sides + 0.5);
    apart -= sides * turns;
    const double most = ball[e].radius + ball[f].radius + reach;
    if (glm::dot(apart, apart) >= most * most) return;
    const glm::ivec3 lift = ball[e].lift - ball[f].lift - glm::ivec3(turns);
    const Pair pair = {e, f, {lift.x, lift.y, lift.z}};
    RoundCone first, second;
    cones_of(bodies, pair, bodies.radius, sides, first, second);
    const double thick =
        std::max(first.radius_a, first.radius_b) + std::max(second.radius_a, second.radius_b);
    first.radius_a = first.radius_b = second.radius_a = second.radius_b = 0;
    if (closest_axes(first, second).gap - thick >= reach) return;
    if (same_copy(pair) && bodies.elements[e].cell == bodies.elements[f].cell && near_in_tree(bodies, e, f))
      return;
    out.push_back(pair);
  }

  std::vector<Pair> pairs() const {
    std::vector<Pair> out;
    for (int z = 0; z < count.z; z++)
      for (int y = 0; y < count.y; y++)
        for (int x = 0; x < count.x; x++) {
          const std::size_t home = number({x, y, z});
          for (int k = -1; k <= 1; k++)
            for (int j = -1; j <= 1; j++)
              for (int i = -1; i <= 1; i++) {
                const std::size_t other = number((glm::ivec3(x + i, y + j, z + k) + count) % count);
                for (std::uint32_t n = offset[home]; n < offset[home + 1]; n++)
                  for (std::uint32_t m = offset[other]; m < offset[other + 1]; m++)
                    if (element[n] < element[m]) meet(element[n], element[m], out);
              }
        }
    std::vector<std::uint8_t> is_large(ball.size(), 0);
    for (const std::uint32_t e : large)
      is_large[e] = 1;
    for (const std::uint32_t e : large)
      for (std::uint32_t f = 0; f < ball.size(); f++)
        if (f != e && (!is_large[f] || e < f)) meet(std::min(e, f), std::max(e, f), out);
    std::sort(out.begin(), out.end(), before);
    return out;
  }
};

} // namespace

int main(int argc, char **argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bench_relax FILE REACH_UM\n");
    return 2;
  }
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = nullptr;
  if (!ctx || conceg_doc_open(ctx, argv[1], &doc) != CONCEG_OK) {
    std::fprintf(stderr, "%s\n", ctx ? conceg_ctx_error(ctx) : "out of memory");
    return 1;
  }
  try {
    const double reach = std::atof(argv[2]);
    const conceg_box box = read_box(doc);
    const Bodies bodies = make_bodies(read_skeletons(doc), 0.15);
    Workers workers(1);
    Collider collider(1);
    double embree = 0, grid = 0;
    std::vector<Pair> by_embree, by_grid;
    for (int turn = 0; turn < 3; turn++) { // the best of three, in turns
      double began = cpu_s();
      by_embree = collider.find(bodies, bodies.radius, box, reach, workers).pairs;
      embree = turn ? std::min(embree, cpu_s() - began) : cpu_s() - began;
      began = cpu_s();
      by_grid = UniformGrid(bodies, box, reach).pairs();
      grid = turn ? std::min(grid, cpu_s() - began) : cpu_s() - began;
    }
    // An element can meet another one over two images at once, and its own image; the grid takes the nearest.
    std::vector<Pair> missed, more;
    std::set_difference(by_embree.begin(), by_embree.end(), by_grid.begin(), by_grid.end(),
                        std::back_inserter(missed), before);
    std::set_difference(by_grid.begin(), by_grid.end(), by_embree.begin(), by_embree.end(),
                        std::back_inserter(more), before);
    std::printf("{\"elements\": %zu, \"reach_um\": %g, \"pairs\": %zu, \"missed_by_grid\": %zu, "
                "\"missed_by_embree\": %zu, "
                "\"embree_cpu_s\": %.3f, \"uniform_grid_cpu_s\": %.3f}\n",
                bodies.elements.size(), reach, by_embree.size(), missed.size(), more.size(), embree, grid);
    if (conceg_doc_close(doc) != CONCEG_OK) return 1;
    conceg_ctx_free(ctx);
    return more.empty() ? 0 : 1;
  } catch (const std::exception &error) {
    std::fprintf(stderr, "%s %s\n", error.what(), conceg_ctx_error(ctx));
    return 1;
  }
}
