// SPDX-License-Identifier: BSD-3-Clause
// Somas never overlap, images included; they follow layer and profile; they do not depend on others' streams;
// a full box says so.
#include "../somas.hpp"

#include "check.h"
#include "wrap.hpp"

#include <cmath>
#include <string>

using namespace conceg;
using namespace conceg::place;

static std::vector<SomaRequest> requests(std::size_t count, double small, double large, double lo, double hi,
                                         const Profile *profile = nullptr) {
  std::vector<SomaRequest> out;
  for (std::size_t i = 0; i < count; i++)
    out.push_back({7 * i, small + (large - small) * static_cast<double>(i % 5) / 4.0, lo, hi, profile});
  return out;
}

// The smallest distance between surfaces over all images, by brute force.
static double smallest_gap(const conceg_box &box, const std::vector<SomaRequest> &somas,
                           const std::vector<glm::dvec3> &centers) {
  double smallest = HUGE_VAL;
  for (std::size_t i = 0; i < centers.size(); i++)
    for (std::size_t k = i; k < centers.size(); k++)
      for (int x = -1; x <= 1; x++)
        for (int y = -1; y <= 1; y++)
          for (int z = -1; z <= 1; z++) {
            if (i == k && !x && !y && !z) continue;
            if ((x && !box.periodic[0]) || (y && !box.periodic[1]) || (z && !box.periodic[2])) continue;
            const glm::dvec3 d = centers[i] - centers[k] - glm::dvec3(x, y, z) * side(box);
            smallest = std::min(smallest, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) - somas[i].radius -
                                              somas[k].radius);
          }
  return smallest;
}

static std::string message(const conceg_box &box, const std::vector<SomaRequest> &somas, double gap) {
  try {
    place_somas(box, somas, gap, 1, {});
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}
static bool contains(const std::string &text, const char *part) {
  return text.find(part) != std::string::npos;
}

static void test_apart() {
  const conceg_box box = {{-10, -10, -10}, {50, 40, 45}, {1, 1, 1}};
  const auto somas = requests(45, 4, 8, -10, 45); // 24 % of the box, 35 % with the gaps
  const auto centers = place_somas(box, somas, 1.0, 3, {});
  const double gap = smallest_gap(box, somas, centers);
  CHECK(gap >= 1.0 - 1e-9);
  for (const glm::dvec3 &c : centers)
    for (int axis = 0; axis < 3; axis++) {
      CHECK(c[axis] == conceg_snap(c[axis]));
      CHECK(c[axis] >= box.lo[axis] && c[axis] < box.hi[axis]);
    }
  auto closer = centers; // a planted overlap is seen by the oracle
  closer[3] = closer[17] + glm::dvec3(5, 0, 0);
  CHECK(smallest_gap(box, somas, closer) < 1.0);
  CHECK(centers == place_somas(box, somas, 1.0, 3, {}));
  CHECK(centers != place_somas(box, somas, 1.0, 4, {}));
}

static void test_open_sides() {
  const conceg_box box = {{0, 0, 0}, {40, 40, 40}, {0, 1, 0}};
  const auto somas = requests(20, 3, 6, 0, 40);
  const auto centers = place_somas(box, somas, 0.5, 1, {});
  CHECK(smallest_gap(box, somas, centers) >= 0.5 - 1e-9);
  for (std::size_t i = 0; i < centers.size(); i++)
    for (const int axis : {0, 2})
      CHECK(centers[i][axis] >= somas[i].radius && centers[i][axis] <= 40 - somas[i].radius);
}

static void test_layer_and_profile() {
  const conceg_box box = {{0, 0, 0}, {200, 200, 300}, {1, 1, 1}};
  for (const glm::dvec3 &c : place_somas(box, requests(200, 3, 3, 100, 150), 1, 1, {}))
    CHECK(c.z >= 100 && c.z < 150);
  // Density falling linearly from z = 0 to 0 at 300: the mean height is 100.
  const Profile profile = {{0, 300}, {1, 0}};
  double sum = 0.0, square = 0.0;
  const auto centers = place_somas(box, requests(4000, 0.5, 0.5, 0, 300, &profile), 0, 1, {});
  for (const glm::dvec3 &c : centers)
    sum += c.z, square += c.z * c.z;
  CHECK_NEAR(sum / 4000, 100.0, 3.5); // sd 70.7 / sqrt(4000) = 1.1
  CHECK_NEAR(square / 4000, 15000.0, 750.0);
}

// Another soma elsewhere leaves a soma where it was: streams are named by the cell.
static void test_independence() {
  const conceg_box box = {{0, 0, 0}, {400, 400, 400}, {1, 1, 1}};
  auto somas = requests(20, 5, 5, 0, 400);
  const auto before = place_somas(box, somas, 1, 1, {});
  somas.push_back({1000, 5, 0, 400, nullptr});
  const auto after = place_somas(box, somas, 1, 1, {});
  for (std::size_t i = 0; i < before.size(); i++)
    CHECK(before[i] == after[i]);
}

static void test_refusals() {
  const conceg_box box = {{0, 0, 0}, {40, 40, 40}, {1, 1, 1}};
  const std::string full = message(box, requests(60, 6, 7, 0, 40), 1);
  CHECK(contains(full, "asked for 60 somas") && contains(full, "lower the density"));
  CHECK(contains(message(box, requests(100000, 6, 7, 0, 40), 1), "asked for 100000"));
  const conceg_box small = {{0, 0, 0}, {40, 12, 40}, {1, 1, 1}};
  CHECK(contains(message(small, requests(1, 6, 6, 0, 40), 1),
                 "domain: expected a side of at least 13 um on axis 1"));
  CHECK(message(small, requests(1, 5.5, 5.5, 0, 40), 1).empty());
  const conceg_box open = {{0, 0, 0}, {40, 40, 40}, {1, 1, 0}};
  CHECK(contains(message(open, requests(1, 6, 6, 0, 4), 1), "layers: expected room"));
}

int main() {
  test_apart();
  test_open_sides();
  test_layer_and_profile();
  test_independence();
  test_refusals();
  return check_done();
}
