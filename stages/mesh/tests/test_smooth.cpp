// SPDX-License-Identifier: BSD-3-Clause
// The smooth surface of one cell: closed, manifold, smooth, with the volume of the cell.
#include "check.h"
#include "scenes.hpp"
#include "smooth.hpp"

#include <cstring>

using namespace scenes;

namespace {

const double pi = 3.14159265358979323846;

SceneOptions step(double h) {
  SceneOptions options;
  options.h = h;
  return options;
}

SmoothCell smooth_of(const Tissue &tissue, double h, unsigned threads = 1) {
  conceg::Workers workers(threads);
  const SmoothCell done = smooth_cell(tissue, step(h), tissue.soma[0], workers, {});
  for (const Defect &defect : done.check.defects) {
    std::fprintf(stderr, "%s\n", describe(defect, views_of({done.surface})).c_str());
    break;
  }
  CHECK_EQUAL(done.check.errors, 0);
  CHECK_EQUAL(done.check.closed[0], 1);
  return done;
}

void ball_and_tubes_have_their_volume() {
  for (const double h : {1.0, 0.5}) {
    Tissue ball = empty_box(20);
    add_cell(ball, {8.03, 7.9, 8.11}, 4);
    const SmoothCell done = smooth_of(ball, h);
    const double ratio = volume_of(done.surface) / (4.0 / 3 * pi * 64);
    std::printf("ball of r = 4 um at h = %.1f: volume %.5f of the exact one, %zu faces\n", h, ratio,
                done.surface.face.size());
    CHECK_NEAR(ratio, 1, 0.002);
    CHECK_EQUAL(euler_characteristic(done.surface), 2);
  }
  double worst = 0;
  for (int turn = 0; turn < 12; turn++) { // tubes of two steps in any direction
    conceg_rng rng = conceg_rng_stream(9, "test.smooth", static_cast<std::uint64_t>(turn));
    Tissue tissue = empty_box(9);
    const glm::dvec3 along = 3.0 * random_direction(rng), centre(4.5 + conceg_rng_uniform(&rng), 4.5, 4.5);
    add_tube(tissue, centre - along, centre + along, 0.4);
    const double exact = pi * 0.16 * 6 + 4.0 / 3 * pi * 0.064,
                 ratio = volume_of(smooth_of(tissue, 0.2).surface) / exact;
    worst = std::max(worst, std::fabs(ratio - 1));
  }
  std::printf("tubes of r = 2 h: volume off by %.4f at most\n", worst);
  CHECK(worst < 0.01);
}

// A soma with six roots that fork; its images in the periodic box are no part of the surface.
void branched_cell() {
  Tissue tissue = empty_box(60);
  const Tissue wild = forest(60, 1, 150, 5, 0.4, 0.7);
  tissue = wild;
  const SmoothCell done = smooth_of(tissue, 0.2);
  // The exact volume: the cell's field on voxels of a quarter of the step.
  const Volume voxels = volume_of_tissue(tissue, step(0.08), 2);
  std::size_t inside = 0;
  for (const std::uint32_t label : voxels.label)
    inside += label != 0;
  const double exact = double(inside) * std::pow(voxels.layout.spacing().x, 3),
               ratio = volume_of(done.surface) / exact;
  std::printf("branched cell: volume %.5f of the field's, %zu faces, %u pieces detached\n", ratio,
              done.surface.face.size(), done.pieces.detached);
  CHECK_NEAR(ratio, 1, 0.01);
  CHECK_EQUAL(done.pieces.detached, 0);
  for (const unsigned threads : {2u, 3u}) {
    const SmoothCell again = smooth_of(tissue, 0.2, threads);
    const Surface &a = done.surface, &b = again.surface;
    CHECK(a.vertex.size() == b.vertex.size() && a.face == b.face);
    CHECK(std::memcmp(a.vertex.data(), b.vertex.data(), a.vertex.size() * sizeof(glm::vec3)) == 0);
  }
}

// Two branches that part at a few degrees leave a cleft narrower than a step: mended there, not given up.
void narrow_clefts_are_mended() {
  std::uint64_t mended = 0;
  for (std::uint64_t turn = 0; turn < 24; turn++) {
    conceg_rng rng = conceg_rng_stream(12, "test.cleft", turn);
    Tissue tissue = empty_box(60);
    add_cell(tissue, {30, 30, 30}, 2);
    const glm::dvec3 out = random_direction(rng),
                     across = glm::normalize(glm::cross(out, random_direction(rng)));
    const double apart = 0.55 + 0.05 * double(turn % 6); // radius 0.3: surfaces 0 to 0.2 um apart
    const std::int64_t fork = add_point(tissue, tissue.soma[0] + 3.0 * out, 0.3,
                                        add_point(tissue, tissue.soma[0] + 2.0 * out, 0.3, -1));
    for (const double side : {-0.5, 0.5}) {
      const glm::dvec3 aside = side * apart * across;
      const std::int64_t near = add_point(tissue, tissue.soma[0] + 4.0 * out + aside, 0.3, fork);
      add_point(tissue, tissue.soma[0] + 9.0 * out + aside, 0.3, near);
    }
    mended += smooth_of(tissue, 0.2).repaired;
  }
  std::printf("clefts: %llu places mended\n", static_cast<unsigned long long>(mended));
  CHECK(mended > 0);
}

} // namespace

int main() {
  if (!conceg::vdb_available()) {
    std::printf("SKIPPED: no OpenVDB in this build: no smooth surfaces\n");
    return 77;
  }
  ball_and_tubes_have_their_volume();
  branched_cell();
  narrow_clefts_are_mended();
  return check_done();
}
