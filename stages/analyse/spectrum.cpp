// SPDX-License-Identifier: BSD-3-Clause
#include "spectrum.hpp"

#include "conceg/portable.h"
#include "conceg/rng.h"

#include <unsupported/Eigen/FFT>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <complex>

namespace conceg::analyse {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::size_t first_of_fit = 3; // taking a line away lowers k = 1 by a third, k = 2 by an eighth

void take_mean(std::vector<double> &eta) {
  double sum = 0;
  for (const double v : eta)
    sum += v;
  for (double &v : eta)
    v -= sum / static_cast<double>(eta.size());
}

// Takes the line of least squares away.
void take_line(std::vector<double> &eta) {
  take_mean(eta);
  const double middle = 0.5 * static_cast<double>(eta.size() - 1);
  double sxy = 0, sxx = 0;
  for (std::size_t i = 0; i < eta.size(); i++) {
    const double x = static_cast<double>(i) - middle;
    sxy += x * eta[i], sxx += x * x;
  }
  if (!(sxx > 0)) return;
  for (std::size_t i = 0; i < eta.size(); i++)
    eta[i] -= sxy / sxx * (static_cast<double>(i) - middle);
}

double mean(const std::vector<double> &x) {
  double sum = 0;
  for (const double v : x)
    sum += v;
  return x.empty() ? 0 : sum / static_cast<double>(x.size());
}

// What one path adds.
struct PathPower {
  std::vector<double> raw, power, reciprocal;
  double diffusivity_ratio;
};

PathPower powers_of(const std::vector<double> &area, double step) {
  PathPower out;
  std::vector<double> eta, reciprocal;
  for (const double a : area)
    eta.push_back(conceg_log(a)), reciprocal.push_back(1 / a);
  const double mean_reciprocal = mean(reciprocal);
  for (double &w : reciprocal)
    w = w / mean_reciprocal - 1;
  out.diffusivity_ratio = 1 / (mean(area) * mean_reciprocal);
  take_mean(eta);
  out.raw = power_of(eta, step);
  take_line(eta);
  out.power = power_of(eta, step);
  take_line(reciprocal);
  out.reciprocal = power_of(reciprocal, step);
  return out;
}

// Means over all paths of cells, each cell as often as it is drawn.
std::vector<double> mean_of(const std::vector<PathPower> &powers, std::vector<double> PathPower::*which,
                            const std::vector<std::size_t> &cell_of, const std::vector<int> &times,
                            std::size_t bins) {
  std::vector<double> sum(bins, 0);
  double count = 0;
  for (std::size_t p = 0; p < powers.size(); p++) {
    const int n = times[cell_of[p]];
    if (!n) continue;
    count += n;
    for (std::size_t k = 0; k < bins; k++)
      sum[k] += n * (powers[p].*which)[k];
  }
  for (double &v : sum)
    v /= count > 0 ? count : 1;
  return sum;
}

// Band of the middle 95 % of the rows, column by column.
void band_of(std::vector<std::vector<double>> rows, std::size_t bins, std::vector<double> &low,
             std::vector<double> &high) {
  std::vector<double> column(rows.size());
  for (std::size_t k = 0; k < bins; k++) {
    for (std::size_t r = 0; r < rows.size(); r++)
      column[r] = rows[r][k];
    std::sort(column.begin(), column.end());
    const auto at = [&](double share) {
      return column[static_cast<std::size_t>(share * static_cast<double>(column.size() - 1) + 0.5)];
    };
    low.push_back(at(0.025)), high.push_back(at(0.975));
  }
}

struct Range {
  std::size_t first, end; // bins of the fit
};

Range fit_range(const std::vector<double> &q, const SpectrumSettings &settings) {
  Range range = {first_of_fit - 1, q.size()};
  while (range.first < q.size() && q[range.first] < settings.low_q)
    range.first++;
  while (range.end > range.first && q[range.end - 1] > settings.high_q)
    range.end--;
  return range;
}

double slope_in(const Range &range, const std::vector<double> &q, const std::vector<double> &power) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = range.first; k < range.end; k++) {
    if (!(power[k] > 0)) continue;
    const double x = conceg_log(q[k]), y = conceg_log(power[k]);
    n++, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double spread = n * sxx - sx * sx;
  return spread > 0 ? (n * sxy - sx * sy) / spread : 0;
}

double mean_in(const Range &range, const std::vector<double> &power) {
  double sum = 0;
  for (std::size_t k = range.first; k < range.end; k++)
    sum += power[k];
  return range.end > range.first ? sum / static_cast<double>(range.end - range.first) : 0;
}

// Radii along the path from a root to one tip.
struct Path {
  std::vector<double> at, radius; // um of path, um
};

Path path_to(const Skeletons &s, std::uint64_t first, std::uint64_t tip) {
  Path path;
  std::vector<std::uint64_t> rows;
  for (std::int64_t i = static_cast<std::int64_t>(tip - first); i >= 0;
       i = s.parent[first + static_cast<std::uint64_t>(i)])
    rows.push_back(first + static_cast<std::uint64_t>(i));
  std::reverse(rows.begin(), rows.end());
  double along = 0;
  for (std::size_t n = 0; n < rows.size(); n++) {
    if (n) along += glm::distance(s.position[rows[n]], s.position[rows[n - 1]]);
    path.at.push_back(along), path.radius.push_back(s.radius[rows[n]]);
  }
  return path;
}

std::vector<double> areas_of(const Path &path, const SpectrumSettings &settings) {
  std::vector<double> area;
  const auto count = static_cast<std::size_t>(std::lround(settings.length / settings.step));
  std::size_t n = 1;
  for (std::size_t i = 0; i < count; i++) {
    const double at = settings.skip + static_cast<double>(i) * settings.step;
    while (n + 1 < path.at.size() && path.at[n] < at)
      n++;
    const double whole = path.at[n] - path.at[n - 1], share = whole > 0 ? (at - path.at[n - 1]) / whole : 1;
    const double r = path.radius[n - 1] + share * (path.radius[n] - path.radius[n - 1]);
    area.push_back(pi * r * r);
  }
  return area;
}

} // namespace

std::vector<double> power_of(const std::vector<double> &eta, double step) {
  std::vector<std::complex<double>> transformed;
  Eigen::FFT<double> fft;
  fft.fwd(transformed, eta);
  const double length = step * static_cast<double>(eta.size());
  std::vector<double> power;
  for (std::size_t k = 1; k <= eta.size() / 2; k++)
    power.push_back(std::norm(transformed[k]) * step * step / length);
  return power;
}

AreaPaths area_paths(const Skeletons &skeletons, const std::vector<std::uint32_t> &cells, bool axons,
                     const SpectrumSettings &settings) {
  constexpr std::uint8_t axon = 2;
  AreaPaths out;
  double spacing = 0;
  for (const std::uint32_t cell : cells) {
    const std::uint64_t first = skeletons.cell_offset[cell], end = skeletons.cell_offset[cell + 1];
    std::vector<std::uint8_t> has_child(end - first, 0);
    for (std::uint64_t i = first; i < end; i++)
      if (skeletons.parent[i] >= 0) has_child[static_cast<std::size_t>(skeletons.parent[i])] = 1;
    for (std::uint64_t i = first; i < end; i++) {
      if (has_child[i - first] || (!axons && skeletons.kind[i] == axon)) continue;
      out.tips++;
      const Path path = path_to(skeletons, first, i);
      const double needed = settings.skip + settings.length;
      if (path.at.size() < 2 || path.at.back() < needed ||
          *std::min_element(path.radius.begin(), path.radius.end()) <= 0)
        continue;
      spacing += path.at.back() / static_cast<double>(path.at.size() - 1);
      out.profiles.push_back({cell, areas_of(path, settings)});
    }
  }
  if (!out.profiles.empty()) out.spacing = spacing / static_cast<double>(out.profiles.size());
  return out;
}

Spectrum spectrum_of(const AreaPaths &paths, const SpectrumSettings &settings, Workers &workers) {
  Spectrum out;
  out.paths = paths.profiles.size();
  if (!out.paths) return out;
  std::vector<PathPower> powers(paths.profiles.size());
  workers.loop(powers.size(), 4, [&](std::size_t p, unsigned) {
    powers[p] = powers_of(paths.profiles[p].area, settings.step);
  });
  const double length = settings.step * static_cast<double>(paths.profiles[0].area.size());
  const double most = paths.spacing > 0 ? pi / paths.spacing : pi / settings.step;
  for (std::size_t k = 1; k <= powers[0].raw.size() && 2 * pi * static_cast<double>(k) / length <= most; k++)
    out.q.push_back(2 * pi * static_cast<double>(k) / length);
  const std::size_t bins = out.q.size();

  std::vector<std::size_t> cell_of;
  std::vector<std::uint32_t> known;
  for (const AreaProfile &profile : paths.profiles) {
    const auto at = std::find(known.begin(), known.end(), profile.cell);
    cell_of.push_back(static_cast<std::size_t>(at - known.begin()));
    if (at == known.end()) known.push_back(profile.cell);
  }
  out.cells = known.size();
  const std::vector<int> once(known.size(), 1);
  out.raw = mean_of(powers, &PathPower::raw, cell_of, once, bins);
  out.power = mean_of(powers, &PathPower::power, cell_of, once, bins);
  const std::vector<double> reciprocal = mean_of(powers, &PathPower::reciprocal, cell_of, once, bins);
  for (const PathPower &p : powers)
    out.diffusivity_ratio += p.diffusivity_ratio / static_cast<double>(powers.size());

  std::vector<std::vector<double>> raw(static_cast<std::size_t>(settings.bootstraps)), power(raw.size());
  workers.loop(raw.size(), 1, [&](std::size_t b, unsigned) {
    conceg_rng rng = conceg_rng_stream(settings.seed, "analyse.spectrum", b);
    std::vector<int> times(known.size(), 0);
    for (std::size_t n = 0; n < known.size(); n++)
      times[conceg_rng_below(&rng, known.size())]++;
    raw[b] = mean_of(powers, &PathPower::raw, cell_of, times, bins);
    power[b] = mean_of(powers, &PathPower::power, cell_of, times, bins);
  });
  if (!raw.empty()) {
    band_of(std::move(raw), bins, out.raw_low, out.raw_high);
    band_of(std::move(power), bins, out.power_low, out.power_high);
  }
  const Range range = fit_range(out.q, settings);
  out.raw_exponent = slope_in(range, out.q, out.raw), out.exponent = slope_in(range, out.q, out.power);
  out.plateau = mean_in(range, out.power), out.reciprocal_plateau = mean_in(range, reciprocal);
  return out;
}

} // namespace conceg::analyse
