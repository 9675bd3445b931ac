// SPDX-License-Identifier: BSD-3-Clause
#include "calibre.hpp"

#include <algorithm>

namespace conceg::grow {

namespace {

constexpr double settling_um = 2.0; // path lengths of an open line change by less when it settles

const CalibreLaw *law_of(const State &state, std::uint32_t bar) {
  const std::vector<CalibreLaw> &laws = state.input.bars.calibre;
  return laws.empty() || !(laws[bar].sd > 0.0) ? nullptr : &laws[bar];
}

// exp(g - sd^2 / 2): its mean is 1, so that the law stays the mean radius, which is what the dictionary
// holds.
double factor(const CalibreLaw &law, double value) {
  return conceg_exp(law.sd * value - 0.5 * law.sd * law.sd);
}

double floor_of(const State &state, std::uint32_t bar) {
  return std::max(std::min(state.input.bars.radius_floor[bar], state.projections[bar].radius_limit),
                  state.parameters.r_min_um);
}

double committed(const State &state, double target) {
  return std::max(state.parameters.radius_fraction * target, state.parameters.r_min_um);
}

} // namespace

void draw_calibre(State &state, std::uint32_t bar) {
  const CalibreLaw *law = law_of(state, bar);
  if (!law) return;
  Projection &projection = state.projections[bar];
  const std::uint64_t row = bar - state.input.bars.cell_offset[projection.cell];
  conceg_rng stream = conceg_rng_stream(state.input.seed, "grow.calibre",
                                        conceg_rng_mix(state.input.cells.id[projection.cell]) + row);
  double first = first_value(stream);
  // A daughter carries on where its parent is, or the radius would jump at the fork.
  if (projection.host != none && state.projections[projection.host].calibre.drawn())
    first = state.projections[projection.host].calibre.at(projection.start_path);
  projection.calibre.draw(projection.start_path, state.input.bars.asked_end[bar], law->correlation_length_um,
                          first, stream);
}

bool calibre_varies(const State &state, std::uint32_t bar) {
  return state.projections[bar].calibre.drawn();
}

double law_radius(const State &state, std::uint32_t bar, double path) {
  const Bars &bars = state.input.bars;
  const double middle = 0.5 * (bars.asked_start[bar] + bars.asked_end[bar]);
  const double law = std::max(bars.radius[bar] + bars.taper[bar] * (path - middle), bars.radius_floor[bar]);
  return std::max(std::min(law, state.projections[bar].radius_limit), state.parameters.r_min_um);
}

double target_radius(const State &state, std::uint32_t bar, double path) {
  const double law = law_radius(state, bar, path);
  if (!calibre_varies(state, bar)) return law;
  const double value = state.projections[bar].calibre.at(path);
  return std::max(law * factor(*law_of(state, bar), value), floor_of(state, bar));
}

double wanted_radius(const State &state, std::uint32_t bar, double path) {
  return committed(state, target_radius(state, bar, path));
}

double wanted_radius(const State &state, std::uint32_t bar, double path_from, double path_to) {
  return std::max(wanted_radius(state, bar, path_from), wanted_radius(state, bar, path_to));
}

double widest_wanted(const State &state, std::uint32_t bar, double path_from, double path_to) {
  if (!calibre_varies(state, bar)) return wanted_radius(state, bar, path_from, path_to);
  const double from = path_from - settling_um, to = path_to + settling_um;
  const double law = std::max(law_radius(state, bar, from), law_radius(state, bar, to));
  const double value = state.projections[bar].calibre.largest(from, to);
  return committed(state, std::max(law * factor(*law_of(state, bar), value), floor_of(state, bar)));
}

} // namespace conceg::grow
