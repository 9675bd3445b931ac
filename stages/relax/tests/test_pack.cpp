// SPDX-License-Identifier: BSD-3-Clause
// Packing of known optimum: parallel cables that were pushed off the places of a hexagonal lattice, where all
// of them have room at their target radius.
#include "../pack.hpp"
#include "check.h"
#include "scene.hpp"

#include <cmath>
#include <cstring>

using namespace conceg;
using namespace conceg::relax;

namespace {

constexpr double pi = 3.14159265358979323846, side_um = 1.0; // of the lattice
constexpr int columns = 6, rows = 6, points = 9;

conceg_box lattice_box() {
  conceg_box box = {};
  box.hi[0] = columns * side_um, box.hi[1] = rows * side_um * std::sqrt(3.0) / 2, box.hi[2] = 6;
  box.periodic[0] = box.periodic[1] = 1;
  return box;
}

// Cables along z that fill `fraction` of the plane.
Bodies cables(double fraction, double push_um) {
  const double radius = side_um / 2 * std::sqrt(fraction / (pi / std::sqrt(12.0)));
  Skeletons s;
  conceg_rng rng = conceg_rng_stream(1, "test.relax.pack", 0);
  for (int row = 0; row < rows; row++)
    for (int column = 0; column < columns; column++) {
      const glm::dvec3 place((column + 0.5 * (row % 2)) * side_um, row * side_um * std::sqrt(3.0) / 2, 0.6);
      scene::add_cable(s, place, {0, 0, 0.6}, points, static_cast<float>(radius));
      const double x = conceg_rng_uniform(&rng), y = conceg_rng_uniform(&rng);
      for (std::size_t i = s.position.size() - points + 1; i < s.position.size(); i++) // roots do not move
        s.position[i] += push_um * glm::dvec3(2 * x - 1, 2 * y - 1, 0);
    }
  return make_bodies(s, 0.1);
}

double filled(const Bodies &bodies, const std::vector<double> &radius) {
  const conceg_box box = lattice_box();
  double sum = 0;
  for (std::size_t i = 0; i < bodies.points; i++)
    sum += pi * radius[i] * radius[i] / points;
  return sum / (box.hi[0] * box.hi[1]);
}

double pack_lattice(double fraction, double push_um, int rounds, unsigned threads,
                    std::vector<glm::dvec3> *places = nullptr) {
  Bodies bodies = cables(fraction, push_um);
  const conceg_box box = lattice_box();
  const Sections sections = make_sections(bodies);
  Workers workers(threads);
  Collider collider(threads);
  Strength strength;
  strength.gap = 0, strength.attraction = 0;
  move_bodies(bodies, sections, box, strength, Motion(), collider, workers, {});
  Rounds asked;
  asked.count = rounds, asked.most = 1;
  const std::vector<double> radius =
      pack(bodies, sections, box, strength, Motion(), asked, collider, workers, {}).radius;
  const Certificate end =
      certify(bodies, collider.find(bodies, radius, box, 0.1, workers).pairs, side(box), 0, radius, workers);
  CHECK(end.pairs > 100);
  CHECK_EQUAL(end.overlapping, 0u);
  if (places) *places = bodies.position;
  return filled(bodies, radius);
}

void lattice_is_found() {
  const Bodies pushed = cables(0.80, 0.12);
  std::vector<double> radius = pushed.radius;
  Workers workers(1);
  cut_radii(pushed, scene::find(pushed, lattice_box(), 0), side(lattice_box()), 0, pushed.radius, radius,
            workers, {});
  const double without = filled(pushed, radius), moved = pack_lattice(0.80, 0.12, 0, 2),
               packed = pack_lattice(0.80, 0.12, 10, 2);
  printf("0.80 possible: %.4f cut in place, %.4f moved, %.4f in rounds\n", without, moved, packed);
  CHECK(without < 0.72);
  CHECK(moved > 0.79);
  CHECK_NEAR(packed, 0.80, 0.002);
}

// Pushed so far that the lattice's order is lost.
void rounds_help() {
  const double moved = pack_lattice(0.85, 0.6, 0, 2), packed = pack_lattice(0.85, 0.6, 20, 2);
  printf("0.85 possible in order: %.4f moved, %.4f in rounds\n", moved, packed);
  CHECK(packed > moved + 0.01);
}

void same_bytes() {
  std::vector<glm::dvec3> one, three;
  CHECK(pack_lattice(0.85, 0.12, 3, 1, &one) == pack_lattice(0.85, 0.12, 3, 3, &three));
  CHECK(!memcmp(one.data(), three.data(), one.size() * sizeof one[0]));
}

} // namespace

int main() {
  lattice_is_found();
  rounds_help();
  same_bytes();
  return check_done();
}
