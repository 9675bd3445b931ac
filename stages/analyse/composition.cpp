// SPDX-License-Identifier: BSD-3-Clause
#include "composition.hpp"

#include "conceg/portable.h"
#include "conceg/rng.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace conceg::analyse {

namespace {

constexpr std::uint32_t leaf_side = 8;
constexpr std::size_t leaf_voxels = 512;
constexpr int bootstraps = 200;
constexpr std::size_t octants = 8;

using Run = LabelRuns::Run;

// Runs of the rows of one cube, and the pieces they belong to (union by the smaller number).
struct Pieces {
  std::vector<Run> run;
  std::vector<std::size_t> row; // begin of each row of the cube
  std::vector<std::uint32_t> parent;

  std::uint32_t root(std::uint32_t i) {
    while (parent[i] != i)
      i = parent[i] = parent[parent[i]];
    return i;
  }
  void join(std::uint32_t i, std::uint32_t j) {
    i = root(i), j = root(j);
    parent[std::max(i, j)] = std::min(i, j);
  }

  // Adds the part of a row within [from, to), shifted by `shift`.
  void add(const Run *begin, const Run *end, std::uint32_t from, std::uint32_t to, std::uint32_t shift) {
    const Run *r = std::partition_point(begin, end, [&](const Run &x) { return x.end <= from; });
    for (; r != end && r->begin < to; r++) {
      const Run cut = {std::max(r->begin, from) - from + shift, std::min(r->end, to) - from + shift,
                       r->label};
      if (run.size() > row.back() && run.back().end == cut.begin && run.back().label == cut.label)
        run.back().end = cut.end; // over the seam
      else
        run.push_back(cut);
    }
  }

  void join_if_touching(std::size_t i, std::size_t j) {
    const Run &a = run[i], &b = run[j];
    if (a.label == b.label && a.begin <= b.end && b.begin <= a.end)
      join(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j));
  }

  // Joins runs of two rows that touch, edges and corners included.
  void join_rows(std::size_t one, std::size_t other) {
    std::size_t i = row[one], j = row[other];
    const std::size_t i_end = row[one + 1], j_end = row[other + 1];
    while (i < i_end && j < j_end) {
      join_if_touching(i, j);
      if (run[i].end < run[j].end) {
        i++;
        continue;
      }
      // Runs that end together: the next of either row may touch the other one at a corner.
      if (run[i].end == run[j].end && i + 1 < i_end) join_if_touching(i + 1, j);
      j++;
    }
  }
};

std::uint64_t largest_fragment(Pieces &pieces, std::uint32_t nx, std::uint32_t ny) {
  pieces.parent.resize(pieces.run.size());
  std::iota(pieces.parent.begin(), pieces.parent.end(), 0u);
  for (std::size_t x = 0; x < nx; x++)
    for (std::size_t y = 0; y < ny; y++) {
      const std::size_t here = x * ny + y;
      if (y > 0) pieces.join_rows(here, here - 1);
      if (x == 0) continue;
      if (y > 0) pieces.join_rows(here, here - ny - 1);
      pieces.join_rows(here, here - ny);
      if (y + 1 < ny) pieces.join_rows(here, here - ny + 1);
    }
  std::vector<std::uint64_t> size(pieces.run.size(), 0);
  std::uint64_t largest = 0;
  for (std::uint32_t i = 0; i < pieces.run.size(); i++) {
    std::uint64_t &sum = size[pieces.root(i)];
    sum += pieces.run[i].end - pieces.run[i].begin;
    largest = std::max(largest, sum);
  }
  return largest;
}

std::uint64_t largest_cell(const Pieces &pieces) {
  std::uint32_t most = 0;
  for (const Run &r : pieces.run)
    most = std::max(most, r.label);
  std::vector<std::uint64_t> size(static_cast<std::size_t>(most) + 1, 0);
  for (const Run &r : pieces.run)
    size[r.label] += r.end - r.begin;
  return *std::max_element(size.begin(), size.end());
}

// The cubes of one length.
struct Sample {
  std::vector<double> fragment, cell; // um3
  std::vector<std::uint8_t> octant;   // of the box, where the cube's middle lies
};

struct Moments {
  double mean = 0, sd = 0, geometric = 0;
  std::uint64_t empty = 0;
};

Moments moments_of(const std::vector<double> &x) {
  Moments m;
  double logs = 0, squares = 0;
  for (const double v : x) {
    m.mean += v / static_cast<double>(x.size());
    if (v > 0)
      logs += conceg_log(v);
    else
      m.empty++;
  }
  for (const double v : x)
    squares += (v - m.mean) * (v - m.mean);
  if (x.size() > 1) m.sd = std::sqrt(squares / static_cast<double>(x.size() - 1));
  if (m.empty < x.size()) m.geometric = conceg_exp(logs / static_cast<double>(x.size() - m.empty));
  return m;
}

Sample sample_cubes(const LabelRuns &runs, const glm::dvec3 &spacing, const std::array<bool, 3> &periodic,
                    const std::array<std::uint32_t, 3> &side, std::size_t length,
                    const CompositionSettings &settings, Workers &workers) {
  Sample out;
  const auto count = static_cast<std::size_t>(settings.cubes);
  out.fragment.resize(count), out.cell.resize(count), out.octant.resize(count);
  const double voxel = spacing.x * spacing.y * spacing.z;
  workers.loop(count, 1, [&](std::size_t c, unsigned) {
    conceg_rng rng = conceg_rng_stream(settings.seed, "analyse.composition", length * count + c);
    std::array<std::uint32_t, 3> corner = {};
    for (std::size_t a = 0; a < 3; a++) {
      const std::uint32_t whole = runs.shape()[a];
      corner[a] =
          static_cast<std::uint32_t>(conceg_rng_below(&rng, periodic[a] ? whole : whole - side[a] + 1));
      const bool upper = 2 * ((corner[a] + side[a] / 2) % whole) >= whole;
      out.octant[c] = static_cast<std::uint8_t>(out.octant[c] | (upper ? 1u << a : 0u));
    }
    const Largest largest = largest_piece(runs, corner, side);
    out.fragment[c] = voxel * static_cast<double>(largest.fragment);
    out.cell[c] = voxel * static_cast<double>(largest.cell);
  });
  return out;
}

// Means of one length from the octants that are drawn (each as often as it stands there).
double mean_of_octants(const std::vector<double> &x, const std::vector<std::uint8_t> &octant,
                       const std::array<int, octants> &times) {
  double sum = 0, count = 0;
  for (std::size_t c = 0; c < x.size(); c++)
    sum += times[octant[c]] * x[c], count += times[octant[c]];
  return count > 0 ? sum / count : 0;
}

double bootstrap_error(const std::vector<double> &side,
                       const std::vector<const std::vector<double> *> &values,
                       const std::vector<const std::vector<std::uint8_t> *> &octant, std::uint64_t seed) {
  double sum = 0, squares = 0;
  int used = 0;
  conceg_rng rng = conceg_rng_stream(seed, "analyse.composition.bootstrap", 0);
  for (int b = 0; b < bootstraps; b++) {
    std::array<int, octants> times = {};
    for (std::size_t k = 0; k < octants; k++)
      times[conceg_rng_below(&rng, octants)]++;
    std::vector<double> means;
    for (std::size_t k = 0; k < side.size(); k++)
      means.push_back(mean_of_octants(*values[k], *octant[k], times));
    if (std::any_of(means.begin(), means.end(), [](double m) { return !(m > 0); })) continue;
    const double slope = log_slope(side, means);
    sum += slope, squares += slope * slope, used++;
  }
  if (used < 2) return 0;
  const double mean = sum / used;
  return std::sqrt(std::max(0.0, (squares - used * mean * mean) / (used - 1)));
}

ScaleFit fit_from(double from, const std::vector<ScaleRow> &rows, const std::vector<Sample> &samples,
                  std::uint64_t seed) {
  ScaleFit fit;
  std::vector<double> side, fragment, cell;
  std::vector<const std::vector<double> *> fragments, cells;
  std::vector<const std::vector<std::uint8_t> *> octant;
  for (std::size_t k = 0; k < rows.size(); k++) {
    if (rows[k].side < from || !(rows[k].fragment_mean > 0)) continue;
    side.push_back(rows[k].side), fragment.push_back(rows[k].fragment_mean),
        cell.push_back(rows[k].cell_mean);
    fragments.push_back(&samples[k].fragment), cells.push_back(&samples[k].cell);
    octant.push_back(&samples[k].octant);
  }
  fit.rows = side.size();
  if (fit.rows < 3) return fit;
  fit.from = side.front(), fit.to = side.back();
  fit.fragment = log_slope(side, fragment), fit.cell = log_slope(side, cell);
  fit.fragment_error = bootstrap_error(side, fragments, octant, seed);
  fit.cell_error = bootstrap_error(side, cells, octant, seed);
  return fit;
}

} // namespace

LabelRuns::LabelRuns(const std::array<std::uint32_t, 3> &shape, const LabelOf &label, Workers &workers)
    : shape_(shape) {
  fill(label, workers);
}

LabelRuns::LabelRuns(const LabelVolume &volume, Workers &workers) {
  std::array<std::size_t, 3> leaves = {};
  for (std::size_t a = 0; a < 3; a++) {
    shape_[a] = static_cast<std::uint32_t>(volume.shape[a]);
    leaves[a] = (volume.shape[a] + leaf_side - 1) / leaf_side;
  }
  std::vector<std::int64_t> place(leaves[0] * leaves[1] * leaves[2], -1);
  const auto at = [&](std::size_t x, std::size_t y, std::size_t z) {
    return (x * leaves[1] + y) * leaves[2] + z;
  };
  for (std::size_t i = 0; i < volume.leaves; i++) {
    const auto number = [&](std::size_t a) {
      return static_cast<std::size_t>(volume.leaf_origin[3 * i + a]) / leaf_side;
    };
    place[at(number(0), number(1), number(2))] = static_cast<std::int64_t>(i);
  }
  fill(
      [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) -> std::uint32_t {
        const std::int64_t leaf = place[at(x / leaf_side, y / leaf_side, z / leaf_side)];
        if (leaf < 0) return 0;
        return volume.label[static_cast<std::size_t>(leaf) * leaf_voxels +
                            (x % leaf_side * leaf_side + y % leaf_side) * leaf_side + z % leaf_side];
      },
      workers);
}

void LabelRuns::fill(const LabelOf &label, Workers &workers) {
  std::vector<std::vector<Run>> plane(shape_[0]);
  std::vector<std::vector<std::uint64_t>> count(shape_[0]);
  workers.loop(shape_[0], 1, [&](std::size_t x, unsigned) {
    for (std::uint32_t y = 0; y < shape_[1]; y++) {
      const std::size_t first = plane[x].size();
      for (std::uint32_t z = 0; z < shape_[2]; z++) {
        const std::uint32_t l = label(static_cast<std::uint32_t>(x), y, z);
        if (!l) continue;
        if (plane[x].size() > first && plane[x].back().end == z && plane[x].back().label == l)
          plane[x].back().end++;
        else
          plane[x].push_back({z, z + 1, l});
      }
      count[x].push_back(plane[x].size() - first);
    }
  });
  offset_.assign(1, 0);
  for (std::size_t x = 0; x < shape_[0]; x++) {
    for (const std::uint64_t n : count[x])
      offset_.push_back(offset_.back() + n);
    run_.insert(run_.end(), plane[x].begin(), plane[x].end());
    std::vector<Run>().swap(plane[x]);
  }
}

Largest largest_piece(const LabelRuns &runs, const std::array<std::uint32_t, 3> &corner,
                      const std::array<std::uint32_t, 3> &side) {
  Pieces pieces;
  pieces.row.reserve(static_cast<std::size_t>(side[0]) * side[1] + 1);
  const std::uint32_t deep = runs.shape()[2];
  for (std::uint32_t x = 0; x < side[0]; x++)
    for (std::uint32_t y = 0; y < side[1]; y++) {
      pieces.row.push_back(pieces.run.size());
      const std::uint32_t at_x = (corner[0] + x) % runs.shape()[0], at_y = (corner[1] + y) % runs.shape()[1];
      const Run *begin = runs.begin(at_x, at_y), *end = runs.end(at_x, at_y);
      const std::uint32_t first = std::min(side[2], deep - corner[2]);
      pieces.add(begin, end, corner[2], corner[2] + first, 0);
      if (first < side[2]) pieces.add(begin, end, 0, side[2] - first, first);
    }
  pieces.row.push_back(pieces.run.size());
  Largest out;
  if (pieces.run.empty()) return out;
  out.cell = largest_cell(pieces);
  out.fragment = largest_fragment(pieces, side[0], side[1]);
  return out;
}

double log_slope(const std::vector<double> &x, const std::vector<double> &y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); i++) {
    const double u = conceg_log(x[i]), v = conceg_log(y[i]);
    sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

Composition composition_of(const LabelRuns &runs, const glm::dvec3 &spacing,
                           const std::array<bool, 3> &periodic, const CompositionSettings &settings,
                           Workers &workers, const Progress &progress) {
  double most = settings.largest;
  for (int a = 0; a < 3; a++)
    most = std::min(most, spacing[a] * runs.shape()[static_cast<std::size_t>(a)]);
  if (!(most >= 2 * settings.smallest))
    fail(CONCEG_E_RANGE, "composition: the box's shortest side is %g um; at least %g um are needed", most,
         2 * settings.smallest);
  Composition out;
  std::vector<Sample> samples;
  for (int k = 0; k < settings.lengths; k++) {
    report(progress, "composition", static_cast<std::uint64_t>(k),
           static_cast<std::uint64_t>(settings.lengths));
    const double share = settings.lengths > 1 ? static_cast<double>(k) / (settings.lengths - 1) : 1;
    const double length = settings.smallest * conceg_exp(share * conceg_log(most / settings.smallest));
    std::array<std::uint32_t, 3> side = {};
    double product = 1;
    for (std::size_t a = 0; a < 3; a++) {
      const double step = spacing[static_cast<int>(a)];
      side[a] =
          std::min(runs.shape()[a], std::max(1u, static_cast<std::uint32_t>(std::lround(length / step))));
      product *= side[a] * step;
    }
    ScaleRow row;
    row.side = std::cbrt(product);
    if (!out.rows.empty() && row.side <= out.rows.back().side) continue; // the same voxels again
    samples.push_back(
        sample_cubes(runs, spacing, periodic, side, static_cast<std::size_t>(k), settings, workers));
    const Moments fragment = moments_of(samples.back().fragment), cell = moments_of(samples.back().cell);
    row.cubes = samples.back().cell.size(), row.empty = fragment.empty;
    row.fragment_mean = fragment.mean, row.fragment_sd = fragment.sd;
    row.fragment_geometric_mean = fragment.geometric;
    row.cell_mean = cell.mean, row.cell_sd = cell.sd, row.cell_geometric_mean = cell.geometric;
    out.rows.push_back(row);
  }
  for (std::size_t k = 0; k + 1 < out.rows.size(); k++) {
    ScaleRow &a = out.rows[k], &b = out.rows[k + 1];
    if (a.fragment_mean > 0 && b.fragment_mean > 0)
      a.fragment_slope = log_slope({a.side, b.side}, {a.fragment_mean, b.fragment_mean}),
      a.cell_slope = log_slope({a.side, b.side}, {a.cell_mean, b.cell_mean});
  }
  out.all = fit_from(settings.smallest, out.rows, samples, settings.seed);
  out.beyond_somas = fit_from(15, out.rows, samples, settings.seed);
  return out;
}

} // namespace conceg::analyse
