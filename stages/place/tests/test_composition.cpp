// SPDX-License-Identifier: BSD-3-Clause
// Cell counts: largest remainder, layers, own densities, the profile's exact integral, and wrong input.
#include "../composition.hpp"

#include "check.h"
#include "guard.hpp"

#include <string>

using namespace conceg;
using namespace conceg::place;

static std::string message(const Box &box, const std::vector<Layer> &layers,
                           const std::vector<TypeShare> &types, double density, const Profile &profile = {}) {
  try {
    compose(box, layers, types, density, profile);
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}
static bool contains(const std::string &text, const char *part) {
  return text.find(part) != std::string::npos;
}

static std::vector<std::uint64_t> counts(const std::vector<Demand> &demands) {
  std::vector<std::uint64_t> out;
  for (const Demand &demand : demands)
    out.push_back(demand.count);
  return out;
}

static TypeShare part(const char *name, double fraction, int layer = -1) {
  return {name, fraction, kNotGiven, layer};
}
static TypeShare own(const char *name, double density, int layer = -1) {
  return {name, kNotGiven, density, layer};
}

int main() {
  const Box cube = {1600, 0, 40};
  // The default cube: 8.192 cells; quotas 2.03 2.03 0.508 0.508 3.11; the first of the two equal remainders
  // gets the eighth.
  const std::vector<TypeShare> mixture = {part("a", 0.248), part("b", 0.248), part("c", 0.062),
                                          part("d", 0.062), part("e", 0.38)};
  CHECK(counts(compose(cube, {}, mixture, 1.28e-4, {})) == (std::vector<std::uint64_t>{2, 2, 1, 0, 3}));

  // Layers of 20 and 10 um with 3.2 and 8 cells; a type in one layer, one in the other, one in both, one of
  // its own density.
  const std::vector<Layer> layers = {{"low", 0, 20, 1e-4}, {"high", 20, 30, 5e-4}};
  CHECK(
      contains(message(cube, layers,
                       {part("low only", 0.5, 0), part("high only", 0.75, 1), part("both", 0.5)}, kNotGiven),
               "add up to 1 in layer high"));
  const auto good = compose(cube, layers,
                            {part("low only", 0.25, 0), part("high only", 0.25, 1), part("both", 0.75),
                             own("own", 1e-3), own("own high", 1e-3, 1)},
                            kNotGiven, {});
  CHECK_EQUAL(good.size(), 6);
  CHECK(counts(good) == (std::vector<std::uint64_t>{1, 2, 2, 6, 64, 16})); // 0.8 2.4 2 6 64 16: total 91.2
  CHECK_EQUAL(good[0].layer, 0);
  CHECK_NEAR(good[2].z_lo, 20, 0);
  CHECK_EQUAL(good[4].layer, -1);
  CHECK_NEAR(good[4].z_hi, 40, 0);

  // A profile is integrated exactly: 0 to 10 um constant 1e-3, then falling to 0 at 30 um, then 0.
  const Profile profile = {{10, 30}, {1e-3, 0}};
  CHECK_NEAR(profile.integral(0, 40), 10e-3 + 0.5 * 20e-3, 1e-15);
  CHECK_NEAR(profile.integral(15, 20), 5 * 0.5 * (0.75e-3 + 0.5e-3), 1e-15);
  CHECK_NEAR(profile.integral(35, 40), 0, 0);
  CHECK_NEAR(profile.at(20), 0.5e-3, 1e-15);
  const auto by_profile = compose(cube, {}, {part("a", 1)}, kNotGiven, profile);
  CHECK_EQUAL(by_profile[0].count, 32);
  CHECK(by_profile[0].by_profile);
  const auto split = compose(cube, {{"low", 0, 20, kNotGiven}, {"high", 20, 40, kNotGiven}},
                             {part("a", 1, 0), part("b", 1, 1)}, kNotGiven, profile);
  CHECK(counts(split) == (std::vector<std::uint64_t>{28, 4}));

  CHECK(contains(message(cube, {}, {part("a", 0.9)}, 1e-4), "got 0.9"));
  CHECK(contains(message(cube, {}, {part("a", 1)}, kNotGiven), "expected a cell density"));
  CHECK(contains(message(cube, {}, {part("a", 1)}, 1e-9), "at least one cell"));
  CHECK(contains(message(cube, {}, {part("a", 1)}, 1e9), "fewer than"));
  CHECK(contains(message(cube, {}, {{"a", kNotGiven, kNotGiven, -1}}, 1e-4), "either fraction or density"));
  CHECK(contains(message(cube, {{"a", 0, 20, 1e-4}, {"b", 19, 30, 1e-4}}, {part("a", 1)}, kNotGiven),
                 "overlap"));
  CHECK(contains(message(cube, {{"a", 0, 50, 1e-4}}, {part("a", 1)}, kNotGiven), "inside the box"));
  return check_done();
}
