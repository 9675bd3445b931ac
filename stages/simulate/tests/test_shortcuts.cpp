// SPDX-License-Identifier: BSD-3-Clause
// What the walker leaves out must not be missed: steps that are not held against membranes lead to the same
// bits as steps that are, distances are never larger than true ones, and jumps give the signal of steps.
// test_shortcuts [SEED FACTOR]: FACTOR times the walkers.
#include "shapes.hpp"

#include "../distance_grid.hpp"
#include "../protocol.hpp"

#include "check.h"

#include <cstring>
#include <limits>

using namespace conceg;
using namespace conceg::simulate;
using namespace conceg::simulate::testing;

namespace {

std::uint64_t seed = 1;
std::size_t factor = 1;

struct Ball {
  glm::dvec3 centre;
  double radius;
};
// Balls 0.04 um apart, small and large, across the sides of the box, and a thin cylinder through it.
const std::vector<Ball> balls = {{{3.0, 3.0, 3.0}, 1.8}, {{5.24, 3.0, 3.0}, 0.4},  {{3.0, 5.44, 3.0}, 0.6},
                                 {{0.1, 0.2, 5.9}, 0.7}, {{3.0, 3.0, 5.16}, 0.32}, {{0.9, 3.0, 3.0}, 0.26}};
constexpr double box_um = 6.0, tube_um = 0.35, tube_x = 5.2, tube_y = 5.3;

Membranes crowd() {
  Membranes m;
  for (std::uint32_t b = 0; b < balls.size(); b++)
    add_sphere(m, balls[b].centre, balls[b].radius, balls[b].radius > 1.0 ? 5 : 3, b);
  add_cylinder(m, tube_x, tube_y, tube_um, box_um, 32);
  return m;
}

std::vector<Start> starts(std::size_t count) {
  std::vector<Start> out;
  const conceg_box box = cube(box_um);
  for (std::uint64_t i = 0; i < count;) {
    conceg_rng rng = conceg_rng_stream(seed, "test.shortcuts", out.size() + 1000000 * i);
    for (;;) {
      glm::dvec3 p;
      for (int axis = 0; axis < 3; axis++)
        p[axis] = box_um * conceg_rng_uniform(&rng);
      double depth = tube_um - std::hypot(p.x - tube_x, p.y - tube_y), nearest = std::fabs(depth);
      bool inside = depth > 0.0;
      for (const Ball &b : balls) {
        depth = b.radius - glm::length(nearest_image(box, p - b.centre));
        inside = inside || depth > 0.0, nearest = std::min(nearest, std::fabs(depth));
      }
      // Facets lie a little off the shapes; as many inside as outside.
      if (nearest < 0.03 || inside != (i % 2 == 0)) continue;
      out.push_back({p, inside, i++});
      break;
    }
  }
  return out;
}

// The same draws, held against membranes and not: the same walkers, bit by bit.
void test_rooms(Workers &workers) {
  const Walls walls(cube(box_um), crowd(), 0.12, workers, Progress());
  const Protocol protocol = pulsed({{1.0, {1, 0, 0}, 1, 3, 4, 0}});
  const std::vector<Start> start = starts(400 * factor);
  Physics physics;
  physics.jumps = false;
  Tally skipped, held;
  const std::vector<Walk> a =
      walk(walls, protocol.timeline, physics, start.data(), start.size(), seed, skipped);
  physics.skip = false;
  const std::vector<Walk> b = walk(walls, protocol.timeline, physics, start.data(), start.size(), seed, held);
  std::size_t other = 0;
  for (std::size_t i = 0; i < a.size(); i++)
    other += std::memcmp(&a[i].place, &b[i].place, sizeof a[i].place) != 0 ||
             std::memcmp(&a[i].vector[0], &b[i].vector[0], sizeof a[i].vector[0]) != 0;
  std::printf(
      "  %zu walkers, %.3g steps: %.3f of them held against membranes, %.3f reflections; %zu differ\n",
      a.size(), static_cast<double>(held.steps),
      static_cast<double>(skipped.casts) / static_cast<double>(held.casts),
      static_cast<double>(held.reflections) / static_cast<double>(held.steps), other);
  CHECK_EQUAL(other, 0);
  CHECK_EQUAL(skipped.reflections, held.reflections);
  CHECK_EQUAL(held.casts, held.steps);
  CHECK(skipped.casts < held.casts / 2);
}

// What a move meets first, against all faces one by one.
void test_contacts(Workers &workers) {
  const Membranes m = crowd();
  const Walls walls(cube(box_um), m, 0.12, workers, Progress());
  std::size_t met = 0, other = 0, unclear = 0;
  for (std::uint64_t i = 0; i < 1500 * factor; i++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.contacts", i);
    const auto within = [&rng](double span) {
      return glm::dvec3(conceg_rng_uniform(&rng), conceg_rng_uniform(&rng), conceg_rng_uniform(&rng)) * span;
    };
    glm::dvec3 place = within(box_um);
    if (i % 2) { // beside a membrane
      const glm::uvec3 &f = m.face[conceg_rng_u64(&rng) % m.face.size()];
      place = (m.vertex[f.x] + m.vertex[f.y] + m.vertex[f.z]) / 3.0 + within(0.1) - 0.05;
      place -= box_um * glm::floor(place / box_um);
    }
    const glm::dvec3 move = 0.12 / std::sqrt(3.0) * (2.0 * within(1.0) - 1.0);
    double first = 2.0, edge = 1.0;
    for (const glm::uvec3 &f : m.face)
      for (int lift = 0; lift < 27; lift++) {
        const glm::dvec3 shift = box_um * (glm::dvec3(lift % 3, lift / 3 % 3, lift / 9) - 1.0);
        const glm::dvec3 a = m.vertex[f.x] + shift, ab = m.vertex[f.y] - m.vertex[f.x],
                         ac = m.vertex[f.z] - m.vertex[f.x], from = place - a;
        const double volume = glm::dot(glm::cross(ab, ac), move);
        if (volume == 0.0) continue;
        const double at = -glm::dot(glm::cross(ab, ac), from) / volume,
                     v = glm::dot(glm::cross(move, from), ac) / volume,
                     w = -glm::dot(glm::cross(move, from), ab) / volume;
        const double inner = std::min({v, w, 1.0 - v - w});
        if (at < -1e-4 || at > 1.0001 || inner < -1e-4) continue;
        // Where it begins, ends, or meets an edge, rounding and the clearance decide.
        edge = std::min({edge, std::fabs(at), std::fabs(1.0 - at), std::fabs(inner)});
        if (at > 0.0 && at < 1.0 && inner > 0.0) first = std::min(first, at);
      }
    if (edge < 2e-4) {
      unclear++;
      continue;
    }
    const Contact contact = walls.first_contact(walls.spot(place), place, move);
    const bool meets = contact.face != Contact::none;
    met += meets;
    const double stop = std::fabs(first - contact.at) * std::fabs(glm::dot(move, contact.normal));
    other += meets != (first <= 1.0) || (meets && std::fabs(stop - clearance_um) > 1e-11);
  }
  std::printf("  %zu moves held against all faces: %zu meet one, %zu unclear; %zu differ\n",
              std::size_t{1500} * factor, met, unclear, other);
  CHECK_EQUAL(other, 0);
  CHECK(met > 200 && unclear < 100 * factor);
}

// Known distances against those from all faces.
void test_distances(Workers &workers) {
  const conceg_box box = cube(box_um);
  const Membranes m = crowd();
  const Walls walls(box, m, 0.12, workers, Progress());
  double loss = 0.0;
  std::size_t beyond = 0, far = 0, near = 0;
  for (std::uint64_t i = 0; i < 600 * factor; i++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.distance", i);
    glm::dvec3 p;
    for (int axis = 0; axis < 3; axis++)
      p[axis] = box_um * conceg_rng_uniform(&rng);
    double nearest = std::numeric_limits<double>::infinity();
    // Faces are small across z; along it the cylinder's go through the box.
    for (const glm::uvec3 &f : m.face)
      for (const double lift : {-box_um, 0.0, box_um}) {
        glm::dvec3 shift = nearest_image(box, m.vertex[f.x] - p) - m.vertex[f.x];
        shift.z += lift;
        nearest = std::min(nearest, squared_distance(glm::dvec3(0.0), m.vertex[f.x] + shift,
                                                     m.vertex[f.y] + shift, m.vertex[f.z] + shift));
      }
    nearest = std::sqrt(nearest);
    const double known = walls.free_radius(walls.spot(p), p);
    beyond += known > nearest;
    far += nearest > 0.4;
    if (known > 0.0) loss += nearest - known, near++;
    CHECK_EQUAL(walls.is_free(walls.spot(p), p, 0.3), known > 0.3);
  }
  std::printf("  distances of %zu places: %zu above the true one; on average %.3f um below it\n",
              std::size_t{600} * factor, beyond, loss / static_cast<double>(near));
  CHECK_EQUAL(beyond, 0);
  CHECK(far > 100);
  // Half a fine voxel's diagonal of the mark (0.11), the way to the centre (0.06), marks beside their faces,
  // bytes.
  CHECK(loss / static_cast<double>(near) < 0.3);
}

// Signals of one run with jumps and one without, over so many walkers that the standard error of a run of a
// sixteenth of them is 2.8 standard errors of their difference: that far apart they may be.
void test_jumps(Workers &workers, bool inside) {
  const double side = inside ? 7.0 : 8.0;
  Membranes m;
  add_sphere(m, glm::dvec3(0.5 * side), 3.0, 4);
  const Walls walls(cube(side), m, 0.12, workers, Progress());
  std::vector<Pulses> rows;
  const std::vector<double> bs = {1.0, 3.0, 8.0};
  for (const double b : bs)
    for (int axis = 0; axis < 3; axis++) {
      glm::dvec3 n(0.0);
      n[axis] = 1.0, rows.push_back({b, n, 1.0, 4.0, 5.0, 0});
    }
  const Protocol protocol = pulsed(rows);
  const std::size_t count = 16000 * factor;
  std::vector<Start> start;
  for (std::uint64_t i = 0; i < count; i++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.jumps", i);
    glm::dvec3 p;
    do {
      for (int axis = 0; axis < 3; axis++)
        p[axis] = side * conceg_rng_uniform(&rng);
    } while (std::fabs(glm::distance(p, glm::dvec3(0.5 * side)) - 3.0) < 0.02 ||
             (glm::distance(p, glm::dvec3(0.5 * side)) < 3.0) != inside);
    start.push_back({p, inside, i});
  }
  std::vector<double> sum[2], square[2];
  double moves = 0.0;
  for (const int jumps : {0, 1}) {
    Physics physics;
    physics.jumps = jumps != 0;
    std::vector<std::vector<double>> cosine(count, std::vector<double>(bs.size(), 0.0));
    std::vector<Tally> tally((count + 63) / 64);
    workers.loop(tally.size(), 1, [&](std::size_t block, unsigned) {
      const std::size_t begin = 64 * block, many = std::min<std::size_t>(64, count - begin);
      // Other draws for the jumping walkers, or the steps that both make would be the same.
      const std::vector<Walk> walks = walk(walls, protocol.timeline, physics, &start[begin], many,
                                           seed + 100 * static_cast<unsigned>(jumps), tally[block]);
      for (std::size_t i = 0; i < many; i++)
        for (std::size_t r = 0; r < rows.size(); r++)
          cosine[begin + i][r / 3] += std::cos(glm::dot(protocol.coefficient[r], walks[i].vector[0])) / 3.0;
    });
    Tally all;
    for (const Tally &t : tally)
      all.add(t);
    if (jumps) moves = static_cast<double>(all.moves) / static_cast<double>(all.steps);
    sum[jumps].assign(bs.size(), 0.0), square[jumps].assign(bs.size(), 0.0);
    for (const auto &row : cosine)
      for (std::size_t k = 0; k < bs.size(); k++)
        sum[jumps][k] += row[k], square[jumps][k] += row[k] * row[k];
  }
  const double n = static_cast<double>(count);
  for (std::size_t k = 0; k < bs.size(); k++) {
    double mean[2], variance[2];
    for (const int jumps : {0, 1})
      mean[jumps] = sum[jumps][k] / n, variance[jumps] = square[jumps][k] / n - mean[jumps] * mean[jumps];
    const double difference = mean[1] - mean[0], error = std::sqrt((variance[0] + variance[1]) / n),
                 one = std::sqrt(variance[0] / (n / 16.0));
    std::printf("  %s a ball of 3 um, b %g: steps %.5f, jumps %.5f (%.3f moves a step), difference %+.5f "
                "(%.5f); standard "
                "error of %.0f walkers %.5f\n",
                inside ? "in" : "around", bs[k], mean[0], mean[1], moves, difference, error, n / 16.0, one);
    CHECK(std::fabs(difference) < one);
  }
  CHECK(moves < (inside ? 0.6 : 0.8));
}

} // namespace

int main(int argc, char **argv) {
  if (argc > 1) seed = std::strtoull(argv[1], nullptr, 10);
  if (argc > 2) factor = std::strtoull(argv[2], nullptr, 10);
  Workers workers(2);
  test_rooms(workers);
  test_contacts(workers);
  test_distances(workers);
  test_jumps(workers, true);
  test_jumps(workers, false);
  return check_done();
}
