// SPDX-License-Identifier: GPL-3.0-or-later
// The largest radius at a node: known distances, images across faces, open sides, the cap, and a brute-force
// oracle.
#include "../radius.hpp"

#include "check.h"
#include "conceg/rng.h"
#include "wrap.hpp"

#include <algorithm>
#include <cmath>

using namespace conceg;
using namespace conceg::triangulate;

static std::vector<float> radii(const conceg_box &box, const std::vector<glm::dvec3> &nodes,
                                const std::vector<Soma> &somas, double cap, unsigned threads = 1) {
  Workers workers(threads);
  return allowed_radii(box, nodes, somas, cap, workers, {});
}

int main() {
  conceg_box box = {{0, 0, 0}, {40, 30, 20}, {1, 1, 1}};
  const std::vector<Soma> one = {{{1, 15, 10}, 5}};
  const auto known =
      radii(box, {{8, 15, 10}, {1, 15, 10}, {38, 15, 10}, {35.5, 15, 10}, {20, 15, 10}}, one, 2.5);
  CHECK_NEAR(known[0], 2.0, 1e-6);
  CHECK_NEAR(known[1], -5.0, 1e-6); // inside
  CHECK_NEAR(known[2], -2.0, 1e-6); // inside the image across the face
  CHECK_NEAR(known[3], 0.5, 1e-6);
  CHECK_NEAR(known[4], 2.5, 1e-6); // the cap
  box.periodic[0] = 0;
  const auto open = radii(box, {{39.5, 15, 10}, {35.5, 15, 10}}, one, 2.5);
  CHECK_NEAR(open[0], 0.5, 1e-6); // the open side itself
  CHECK_NEAR(open[1], 2.5, 1e-6); // no image there
  CHECK_NEAR(radii(box, {{20, 15, 10}}, {}, 1.5)[0], 1.5, 1e-6);
  CHECK_NEAR(radii(box, {{20, 15, 10}}, {{{20, 15, 10}, 0}}, 1.5)[0], 1.5,
             1e-6); // a cell without soma takes no space

  box.periodic[0] = 1;
  std::vector<Soma> somas;
  std::vector<glm::dvec3> nodes;
  conceg_rng rng = conceg_rng_stream(1, "test", 1);
  const auto place = [&] {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; axis++)
      p[axis] = box.hi[axis] * conceg_rng_uniform(&rng);
    return p;
  };
  for (int i = 0; i < 12; i++) {
    const glm::dvec3 center = place();
    somas.push_back({center, 1.0 + 3.0 * conceg_rng_uniform(&rng)});
  }
  for (int i = 0; i < 9000; i++)
    nodes.push_back(place());
  const auto got = radii(box, nodes, somas, 1.75);
  double worst = 0.0;
  for (std::size_t i = 0; i < nodes.size(); i++) {
    double expected = 1.75;
    for (const Soma &soma : somas)
      for (int x = -1; x <= 1; x++)
        for (int y = -1; y <= 1; y++)
          for (int z = -1; z <= 1; z++) {
            const glm::dvec3 d = nodes[i] - soma.center - glm::dvec3(x, y, z) * side(box);
            expected = std::min(expected, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) - soma.radius);
          }
    worst = std::max(worst, std::fabs(expected - static_cast<double>(got[i])));
  }
  CHECK(worst < 1e-6);
  CHECK(got == radii(box, nodes, somas, 1.75, 2));
  CHECK(got == radii(box, nodes, somas, 1.75, 3));
  return check_done();
}
