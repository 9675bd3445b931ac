// SPDX-License-Identifier: BSD-3-Clause
// Labels drawn back from their membranes: distances against all pairs, a lattice of squares whose answer is
// known.
#include "../erosion.hpp"
#include "../pore_space.hpp"
#include "check.h"
#include "conceg/rng.h"

#include <algorithm>
#include <cmath>

using namespace conceg;
using namespace conceg::analyse;

namespace {

constexpr double h = 0.016;

template <class Label> LabelGrid labelled(std::array<std::size_t, 3> shape, const Label &label) {
  LabelGrid g = {shape, {}, {h, h, 2.5 * h}};
  for (std::size_t x = 0; x < shape[0]; x++)
    for (std::size_t y = 0; y < shape[1]; y++)
      for (std::size_t z = 0; z < shape[2]; z++)
        g.label.push_back(label(x, y, z));
  return g;
}

// Of random labels, some of them 0, against all pairs of one section; cut off beyond.
void distances_are_those_of_all_pairs() {
  conceg_rng rng = conceg_rng_stream(1, "test.erosion", 0);
  LabelGrid g = labelled({30, 23, 3}, [](auto...) { return 1u; });
  for (int k = 0; k < 60; k++)
    g.label[conceg_rng_below(&rng, g.label.size())] = static_cast<std::uint32_t>(conceg_rng_below(&rng, 4));
  g.spacing = {h, 0.75 * h, 1};
  const double half = 0.5 * h * std::sqrt(0.75), deepest = 5 * h;
  Workers workers(2);
  const std::vector<float> found = membrane_distances(g, deepest, workers);
  double worst = 0;
  std::size_t cut = 0;
  for (std::size_t i = 0; i < g.label.size(); i++) {
    double nearest = deepest + half;
    for (std::size_t j = i % 3; j < g.label.size(); j += 3) {
      const double dx = h * (static_cast<double>(i / 69) - static_cast<double>(j / 69)),
                   dy = 0.75 * h * (static_cast<double>(i / 3 % 23) - static_cast<double>(j / 3 % 23));
      if (g.label[j] != g.label[i]) nearest = std::min(nearest, std::sqrt(dx * dx + dy * dy));
    }
    cut += nearest == deepest + half;
    worst = std::max(worst, std::abs(nearest - half - static_cast<double>(found[i])));
  }
  CHECK(worst < 1e-6);
  CHECK(cut > 0 && cut < g.label.size() / 2);
}

// Squares of 20 voxels: with d off each side 1 - ((s - 2 d) / s)^2 of the plane is open.
void squares() {
  constexpr double s = 20 * h;
  for (const double asked : {0.10, 0.15, 0.20, 0.30}) {
    LabelGrid g = labelled({200, 200, 4}, [](std::size_t x, std::size_t y, std::size_t z) {
      return static_cast<std::uint32_t>(1 + x / 20 + 10 * (y / 20) + 100 * (z % 2)); // others in each section
    });
    ErosionSettings settings;
    settings.open_fraction = asked, settings.between = 2, settings.refine = 4;
    Workers workers(2);
    const Erosion e = erode(g, settings, workers);
    // Outer membranes are those of the box, and no membranes: 9 of 10 along each axis.
    const double kept = std::sqrt(1 - asked), depth = (1 - kept) * s / 2 / 0.9;
    printf("squares at %.2f: depth %.4f um (%.4f), open %.4f\n", asked, e.depth, depth, e.open_fraction);
    CHECK_NEAR(e.depth, depth, h / 8 + 1e-4);
    CHECK_NEAR(e.open_fraction, asked, 0.02); // all membranes lie along the voxels: steps of a quarter of one
    CHECK_EQUAL(e.sections.size(), static_cast<std::size_t>(2));
    CHECK_EQUAL(e.sections[0].open.size(), static_cast<std::size_t>(800 * 800));
    CHECK(!e.sections[0].periodic[0]);
    CHECK_NEAR(open_fraction(e.sections[0]), e.open_fraction, 1e-9);
    const PoreSpace pores = pore_space(e.sections, workers);
    CHECK_NEAR(pores.chords.median, 2 * e.depth, h / 4 + 1e-9);
    Workers one(1);
    LabelGrid again = labelled({200, 200, 4}, [](std::size_t x, std::size_t y, std::size_t z) {
      return static_cast<std::uint32_t>(1 + x / 20 + 10 * (y / 20) + 100 * (z % 2));
    });
    const Erosion same = erode(again, settings, one);
    CHECK(same.depth == e.depth && same.sections[1].open == e.sections[1].open && again.label == g.label);
  }
}

// Discs in a medium that has no label: nothing is taken where enough is open, and more is refused.
void unlabelled() {
  const auto half = [](std::size_t x, auto...) { return x < 50 ? 0u : 7u; };
  ErosionSettings settings;
  Workers workers(2);
  settings.open_fraction = 0.3;
  const auto fails = [&](LabelGrid g) {
    try {
      erode(g, settings, workers);
    } catch (const Error &e) {
      return e.status() == CONCEG_E_RANGE;
    }
    return false;
  };
  CHECK(fails(labelled({100, 20, 1}, half)));                       // half of it has no label
  CHECK(fails(labelled({100, 20, 1}, [](auto...) { return 1u; }))); // no membrane at all
  settings.open_fraction = 0.6;
  LabelGrid g = labelled({100, 20, 1}, half);
  const Erosion e = erode(g, settings, workers);
  CHECK_NEAR(e.without_label, 0.5, 1e-9);
  CHECK_NEAR(e.depth, 10 * h, h / 4);
  CHECK_NEAR(e.labels_open_fraction, 0.6, 0.011);
  CHECK_EQUAL(g.label[59 * 20], 0u);
  CHECK_EQUAL(g.label[61 * 20], 7u);
}

} // namespace

int main() {
  distances_are_those_of_all_pairs();
  squares();
  unlabelled();
  return check_done();
}
