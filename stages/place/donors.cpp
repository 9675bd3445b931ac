// SPDX-License-Identifier: BSD-3-Clause
#include "donors.hpp"

#include "conceg/rng.h"
#include "conceg/swc.h"

namespace conceg::place {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Of a tip from the soma's centre when the way from the soma's surface is `length` times what it was.
double shortened(double distance, double soma_radius, double length) {
  if (length == 1.0 || distance <= soma_radius) return distance;
  return soma_radius + (distance - soma_radius) * length;
}

// The smallest turn that takes +z to `pia`.
glm::dquat upright(const glm::dvec3 &pia) {
  if (pia.z < -0.999999999) return {0, 1, 0, 0}; // upside down: any half turn about a level axis
  const double length = std::sqrt((1.0 + pia.z) * (1.0 + pia.z) + pia.x * pia.x + pia.y * pia.y);
  return {(1.0 + pia.z) / length, -pia.y / length, pia.x / length, 0.0};
}

// Uniform on the rotations (Marsaglia's point on the 4-sphere).
glm::dquat uniform_rotation(conceg_rng &rng) {
  const auto in_disc = [&](double &a, double &b) {
    for (;;) {
      a = 2.0 * conceg_rng_uniform(&rng) - 1.0, b = 2.0 * conceg_rng_uniform(&rng) - 1.0;
      const double square = a * a + b * b;
      if (square < 1.0 && square > 0.0) return square;
    }
  };
  double x, y, z, w;
  const double s1 = in_disc(x, y), s2 = in_disc(z, w), scale = std::sqrt((1.0 - s1) / s2);
  return {w * scale, x, y, z * scale};
}

bool unknown_frame(const Dictionary &dictionary, std::size_t donor) {
  return !dictionary.donor.frame_kind.empty() && dictionary.donor.frame_kind[donor] == "unknown";
}

} // namespace

std::size_t draw_donor(const Pool &pool, std::uint64_t cell_id, std::uint64_t seed) {
  conceg_rng rng = conceg_rng_stream(seed, "place.donor", cell_id);
  return pool.donors[conceg_rng_below(&rng, pool.donors.size())];
}

glm::dquat draw_rotation(const Dictionary &dictionary, std::size_t donor, std::uint64_t cell_id,
                         const DonorOptions &options) {
  conceg_rng rng = conceg_rng_stream(options.seed, "place.rotation", cell_id);
  if (unknown_frame(dictionary, donor)) return uniform_rotation(rng);
  double sine, cosine;
  conceg_sincos(kPi * conceg_rng_uniform(&rng), &sine, &cosine); // half of the azimuth
  return upright(options.pia) * glm::dquat(cosine, 0.0, 0.0, sine);
}

std::vector<TreeDraw> draw_trees(const Dictionary &dictionary, const Pool &pool, const CellDraw &cell,
                                 const DonorOptions &options) {
  conceg_rng rng = conceg_rng_stream(options.seed, "place.trees", cell.id);
  std::vector<TreeDraw> trees;
  for (std::size_t own = dictionary.donor.tree_offset[cell.donor];
       own < dictionary.donor.tree_offset[cell.donor + 1]; own++) {
    if (dictionary.tree.bar_offset[own] == dictionary.tree.bar_offset[own + 1]) continue;
    const std::uint8_t neurite = dictionary.tree.neurite[own];
    TreeDraw draw = {own, cell.rotation};
    if (options.independent_trees) {
      const std::vector<PooledTree> &alike = pool.trees[neurite];
      const PooledTree drawn = alike[conceg_rng_below(&rng, alike.size())];
      draw.tree = drawn.tree;
      // Nothing is known of how this donor's frame lies to that of the cell.
      if (unknown_frame(dictionary, drawn.donor)) draw.rotation = cell.rotation * uniform_rotation(rng);
    }
    // Axons are drawn too, so that growing them leaves the other trees as they are.
    if (neurite != CONCEG_SWC_AXON || options.axons) trees.push_back(draw);
  }
  return trees;
}

void append_cell(const Dictionary &dictionary, const Pool &pool, const CellDraw &cell,
                 const DonorOptions &options, Bars &bars) {
  const DictionaryBars &from = dictionary.bar;
  const std::uint64_t first_row = bars.tree.size();
  const double soma_radius = dictionary.donor.soma_radius[cell.donor];
  conceg_rng rng = conceg_rng_stream(options.seed, "place.angle", cell.id);
  std::uint32_t tree_number = 0;
  for (const auto &[tree, rotation] : draw_trees(dictionary, pool, cell, options)) {
    const std::vector<std::size_t> rows = parents_first(dictionary, tree);
    const std::uint8_t neurite = dictionary.tree.neurite[tree];
    // A tree that shrinks keeps its form: all lengths by one factor, radii along it as they were.
    const double length =
        neurite == CONCEG_SWC_BASAL || neurite == CONCEG_SWC_APICAL ? cell.dendrite_length : 1.0;
    const std::uint64_t first_of_tree = bars.tree.size() - first_row;
    std::vector<std::int64_t> row_of(rows.size());
    for (std::size_t i = 0; i < rows.size(); i++) {
      const std::size_t bar = dictionary.tree.bar_offset[tree] + rows[i];
      const bool root = from.parent[bar] == -1;
      row_of[rows[i]] = static_cast<std::int64_t>(first_of_tree + i);
      bars.tree.push_back(tree_number);
      bars.parent.push_back(root ? -1 : row_of[static_cast<std::size_t>(from.parent[bar])]);
      bars.neurite.push_back(neurite);
      bars.start.push_back(from.birth[bar] * length);
      bars.end.push_back(from.death[bar] * length);
      bars.attractor.push_back(cell.soma + rotation * from.tip_direction[bar] *
                                               shortened(from.tip_distance[bar], soma_radius, length));
      const bool drawn = !root && options.drawn_angles && !pool.angles.empty();
      bars.angle.push_back(drawn ? pool.angles[conceg_rng_below(&rng, pool.angles.size())] : from.angle[bar]);
      bars.radius.push_back(from.radius[bar] * cell.radius_scale);
      bars.taper.push_back(from.taper[bar] * cell.radius_scale / length);
      bars.radius_floor.push_back(options.min_radius_um);
    }
    tree_number++;
  }
  bars.cell_offset.push_back(bars.tree.size());
}

} // namespace conceg::place
