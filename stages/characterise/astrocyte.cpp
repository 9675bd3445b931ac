// SPDX-License-Identifier: BSD-3-Clause
#include "astrocyte.hpp"

#include "conceg/rng.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace conceg::characterise {
namespace {

constexpr int azimuths_tried = 8;
constexpr double golden_angle = 2.39996322972865332, pi = 3.14159265358979324;
constexpr double thinnest_um = 0.05;

// Normal plus exponential (scipy's exponnorm), cut to [low, high].
double draw_exponnorm(conceg_rng &rng, double loc, double scale, double shape, double low, double high) {
  const double normal = conceg_rng_normal(&rng), exponential = conceg_rng_exponential(&rng);
  return std::clamp(loc + scale * (normal + shape * exponential), low, high);
}

glm::dvec3 rotated_about(const glm::dvec3 &v, const glm::dvec3 &axis, double sine, double cosine) {
  return v * cosine + glm::cross(axis, v) * sine + axis * (glm::dot(axis, v) * (1.0 - cosine));
}

// A unit vector at `angle` from the unit vector `from`, at `azimuth` around it.
glm::dvec3 tilted(const glm::dvec3 &from, double angle, double azimuth) {
  const glm::dvec3 helper = std::abs(from.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(1.0, 0.0, 0.0);
  double sine, cosine;
  conceg_sincos(azimuth, &sine, &cosine);
  const glm::dvec3 side = rotated_about(glm::normalize(glm::cross(from, helper)), from, sine, cosine);
  conceg_sincos(angle, &sine, &cosine);
  return glm::normalize(from * cosine + side * sine);
}

// n directions spread evenly (Fibonacci lattice), turned by one random rotation.
std::vector<glm::dvec3> spread_directions(conceg_rng &rng, std::size_t n) {
  double q[4], norm = 0.0;
  for (double &x : q)
    x = conceg_rng_normal(&rng), norm += x * x;
  norm = std::sqrt(norm);
  const Rotation turn{q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
  std::vector<glm::dvec3> out(n);
  for (std::size_t i = 0; i < n; i++) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(n),
                 r = std::sqrt(1.0 - z * z);
    double sine, cosine;
    conceg_sincos(golden_angle * static_cast<double>(i), &sine, &cosine);
    out[i] = rotate(turn, {r * cosine, r * sine, z});
  }
  return out;
}

// Diagrams in a random order; again from the start when there are fewer than asked.
std::vector<std::size_t> draw_diagrams(conceg_rng &rng, std::size_t available, std::size_t asked) {
  std::vector<std::size_t> deck(available), out;
  while (out.size() < asked) {
    std::iota(deck.begin(), deck.end(), std::size_t{0});
    for (std::size_t i = available; i > 1; i--)
      std::swap(deck[i - 1], deck[conceg_rng_below(&rng, i)]);
    for (std::size_t i = 0; i < available && out.size() < asked; i++)
      out.push_back(deck[i]);
  }
  return out;
}

struct Placed {
  glm::dvec3 fork, direction;
};

// Where a bar goes: the azimuth whose tip stays in the territory and is farthest from the tips that are
// there.
Placed place_bar(conceg_rng &rng, const Placed &parent, double along, double length, double angle,
                 double territory, const std::vector<glm::dvec3> &tips) {
  const glm::dvec3 fork = parent.fork + parent.direction * along;
  Placed best{fork, parent.direction};
  double best_score = 0.0;
  const double start = 2.0 * pi * conceg_rng_uniform(&rng);
  for (int k = 0; k < azimuths_tried; k++) {
    const glm::dvec3 direction = tilted(parent.direction, angle, start + 2.0 * pi * k / azimuths_tried);
    const glm::dvec3 tip = fork + direction * length;
    const double beyond = std::max(0.0, glm::length(tip) - territory);
    double nearest = 2.0 * territory;
    for (const glm::dvec3 &other : tips)
      nearest = std::min(nearest, glm::length(tip - other));
    const double score = nearest - 10.0 * beyond;
    if (k == 0 || score > best_score) best_score = score, best.direction = direction;
  }
  return best;
}

// Directions, angles and radii of the rows of one tree.
BarTree place_tree(conceg_rng &rng, const ProcessStatistics &process, const AstrocyteRules &rules,
                   double soma_radius, const glm::dvec3 &trunk, std::vector<BarRow> rows,
                   std::vector<glm::dvec3> &tips) {
  std::vector<Placed> placed(rows.size());
  std::vector<double> start_radius(rows.size());
  for (std::size_t i = 0; i < rows.size(); i++) {
    BarRow &row = rows[i];
    const double length = row.death - row.birth, reach = rules.straightness * length;
    if (row.parent < 0) {
      placed[i] = {trunk * soma_radius, trunk};
      start_radius[i] = 0.5 * draw_exponnorm(rng, process.trunk_loc, process.trunk_scale, process.trunk_shape,
                                             process.trunk_low, process.trunk_high);
      row.angle = 0.0;
    } else {
      const auto up = static_cast<std::size_t>(row.parent);
      const double along = row.birth - rows[up].birth;
      row.angle = std::clamp(rules.angle_mean + rules.angle_sd * conceg_rng_normal(&rng), 0.25, 2.75);
      placed[i] = place_bar(rng, placed[up], rules.straightness * along, reach, row.angle,
                            rules.territory_radius_um, tips);
      const double ratio =
          std::clamp(-process.sibling_loc - process.sibling_scale * conceg_rng_exponential(&rng),
                     process.sibling_low, process.sibling_high);
      start_radius[i] = ratio * (start_radius[up] + rows[up].taper * along);
    }
    const double tip_radius =
        std::min(start_radius[i], 0.5 * draw_exponnorm(rng, process.tip_loc, process.tip_scale,
                                                       process.tip_shape, process.tip_low, process.tip_high));
    row.radius = std::max(thinnest_um, 0.5 * (start_radius[i] + tip_radius));
    row.taper = (tip_radius - start_radius[i]) / length;
    const glm::dvec3 tip = placed[i].fork + placed[i].direction * reach;
    const double distance = glm::length(tip);
    row.tip_direction = tip / distance;
    row.tip_distance = std::min(distance, rules.territory_radius_um);
    tips.push_back(row.tip_direction * row.tip_distance);
  }
  return {neurite_glia, trunk, std::move(rows)};
}

// Rows by birth, each below one that outlives it (elder rule): the one with fewest daughters, then the
// longest.
std::vector<BarRow> hang_bars(std::vector<std::array<double, 2>> bars) {
  std::sort(bars.begin(), bars.end(),
            [](const auto &a, const auto &b) { return a[0] != b[0] ? a[0] < b[0] : a[1] > b[1]; });
  std::vector<BarRow> rows;
  std::vector<std::size_t> daughters;
  for (const auto &bar : bars) {
    BarRow row{bar[0], bar[1], 0.0, 0.0, 0.0, 0.0, -1, {}};
    for (std::size_t p = 0; p < rows.size(); p++) {
      if (rows[p].death < row.death) continue;
      const auto now = static_cast<std::size_t>(row.parent);
      if (row.parent < 0 || daughters[p] < daughters[now] ||
          (daughters[p] == daughters[now] &&
           rows[p].death - rows[p].birth > rows[now].death - rows[now].birth))
        row.parent = static_cast<std::int64_t>(p);
    }
    if (row.parent >= 0) daughters[static_cast<std::size_t>(row.parent)]++;
    rows.push_back(row);
    daughters.push_back(0);
  }
  return rows;
}

} // namespace

double mean_order(const std::vector<BarRow> &rows) {
  std::vector<int> first(rows.size(), 1); // order of the branch that a bar starts with
  double sum = 0.0;
  std::size_t branches = 0;
  for (std::size_t i = 0; i < rows.size(); i++) {
    int forks = 0;
    for (std::size_t j = i + 1; j < rows.size(); j++)
      if (rows[j].parent == static_cast<std::int64_t>(i)) first[j] = first[i] + ++forks;
    for (int k = 0; k <= forks; k++)
      sum += first[i] + k, branches++;
  }
  return sum / static_cast<double>(branches);
}

std::vector<BarRow> prune_diagram(const std::vector<std::array<double, 2>> &diagram,
                                  const AstrocyteRules &rules) {
  const double reach = rules.territory_radius_um / rules.straightness; // longest path inside the territory
  std::vector<std::array<double, 2>> bars;
  for (const auto &bar : diagram)
    if (bar[0] < reach) bars.push_back({bar[0], std::min(bar[1], reach)});
  // The root bar first, then by persistence.
  std::sort(bars.begin(), bars.end(), [](const auto &a, const auto &b) {
    const double la = a[1] - a[0], lb = b[1] - b[0];
    if ((a[0] == 0.0) != (b[0] == 0.0)) return a[0] == 0.0;
    return la != lb ? la > lb : a[0] < b[0];
  });
  std::vector<BarRow> best;
  double cable = 0.0, best_miss = 0.0;
  for (std::size_t n = 1; n <= bars.size(); n++) {
    const double length = bars[n - 1][1] - bars[n - 1][0];
    if (n > 1 && length < rules.shortest_bar_um) break;
    cable += length;
    std::vector<BarRow> rows = hang_bars({bars.begin(), bars.begin() + static_cast<std::ptrdiff_t>(n)});
    const double a =
        (cable / static_cast<double>(2 * n - 1) - rules.branch_length_um) / rules.branch_length_sd_um;
    const double b = (mean_order(rows) - rules.order) / rules.order_sd;
    if (n == 1 || a * a + b * b < best_miss) best_miss = a * a + b * b, best = std::move(rows);
  }
  return best;
}

Astrocyte make_astrocyte(const AstrocyteStatistics &statistics, const AstrocyteRules &rules,
                         std::uint64_t seed, std::uint64_t index) {
  conceg_rng rng = conceg_rng_stream(seed, "characterise.astrocyte", index);
  Astrocyte cell;
  cell.soma_radius =
      std::max(0.5 * statistics.soma_radius_mean,
               statistics.soma_radius_mean + statistics.soma_radius_sd * conceg_rng_normal(&rng));
  struct Trunk {
    const ProcessStatistics *process;
    std::size_t diagram;
  };
  std::vector<Trunk> trunks;
  for (const ProcessStatistics &process : statistics.processes) {
    const double drawn = std::floor(process.trees_mean + process.trees_sd * conceg_rng_normal(&rng) + 0.5);
    const auto trees = static_cast<std::size_t>(std::clamp(drawn, process.trees_low, process.trees_high));
    for (std::size_t diagram : draw_diagrams(rng, process.diagrams.size(), trees))
      trunks.push_back({&process, diagram});
  }
  for (std::size_t i = trunks.size(); i > 1; i--)
    std::swap(trunks[i - 1], trunks[conceg_rng_below(&rng, i)]);
  const std::vector<glm::dvec3> directions = spread_directions(rng, trunks.size());
  std::vector<glm::dvec3> tips;
  for (std::size_t i = 0; i < trunks.size(); i++)
    cell.trees.push_back(place_tree(rng, *trunks[i].process, rules, cell.soma_radius, directions[i],
                                    prune_diagram(trunks[i].process->diagrams[trunks[i].diagram], rules),
                                    tips));
  return cell;
}

} // namespace conceg::characterise
