// SPDX-License-Identifier: BSD-3-Clause
// D(t), K(t) and how D(t) ends: free walkers, pores, tubes by a finite-volume solution of the Fick-Jacobs
// equation, errors against the spread of many draws.
#include "../diffusivity.hpp"
#include "../spectrum.hpp"

#include "conceg/rng.h"

#include "check.h"

#include <cmath>
#include <functional>
#include <numeric>

using namespace conceg;
using namespace conceg::analyse;

namespace {

constexpr double pi = 3.14159265358979323846;

double normal(conceg_rng &rng) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - conceg_rng_uniform(&rng)));
  return radius * std::cos(2.0 * pi * conceg_rng_uniform(&rng));
}

std::vector<double> spaced(double first, double last, std::size_t count) {
  std::vector<double> out;
  for (std::size_t i = 0; i < count; i++)
    out.push_back(first * std::pow(last / first, static_cast<double>(i) / static_cast<double>(count - 1)));
  return out;
}

// Walkers of free diffusivity `d`, of which the share `bound` only rattles, with a variance of `rattle` along
// each axis: <x^2> / (2 t) = (1 - bound) d + bound rattle / t.
struct Made {
  std::vector<double> time;
  std::vector<std::vector<glm::dvec3>> moved;
  std::vector<std::uint32_t> all;
  std::vector<const glm::dvec3 *> pointers() const {
    std::vector<const glm::dvec3 *> out;
    for (const auto &m : moved)
      out.push_back(m.data());
    return out;
  }
};
Made made_walkers(std::size_t count, const std::vector<double> &time, double d, double bound, double rattle,
                  std::uint64_t draw) {
  Made out;
  out.time = time, out.moved.assign(time.size(), std::vector<glm::dvec3>(count));
  out.all.resize(count);
  std::iota(out.all.begin(), out.all.end(), 0u);
  for (std::size_t w = 0; w < count; w++) {
    conceg_rng rng = conceg_rng_stream(draw, "test.walker", w);
    const bool is_bound = conceg_rng_uniform(&rng) < bound;
    glm::dvec3 x(0.0), first(0.0);
    double before = 0.0;
    for (int a = 0; a < 3; a++)
      first[a] = std::sqrt(rattle) * normal(rng);
    for (std::size_t t = 0; t < time.size(); t++) {
      for (int a = 0; a < 3; a++)
        x[a] = is_bound ? std::sqrt(rattle) * normal(rng) - first[a]
                        : x[a] + std::sqrt(2.0 * d * (time[t] - before)) * normal(rng);
      before = time[t], out.moved[t][w] = x;
    }
  }
  return out;
}

DiffusivityCurve curve_of(const Made &m, int axis = mean_axis) {
  return diffusivity_curve(m.pointers(), m.time, m.all, axis);
}

void check_state(const std::string &got, const char *expected) {
  CHECK_TEXT(got.c_str(), expected);
}

// An exact curve, with errors of `share` that do not depend on each other.
DiffusivityCurve exact_curve(const std::vector<double> &time, const std::vector<double> &value,
                             double share) {
  DiffusivityCurve out = {time, value, std::vector<double>(time.size() * time.size(), 0.0), 0};
  for (std::size_t t = 0; t < time.size(); t++)
    out.covariance[t * time.size() + t] = std::pow(share * value[t], 2);
  return out;
}

void free_walkers() {
  const Made free = made_walkers(20000, spaced(1, 100, 12), 2.0, 0.0, 1.0, 1);
  for (std::size_t t = 0; t < free.time.size(); t++) {
    const Spread s = spread_of(free.moved[t].data(), free.all, free.time[t]);
    CHECK_NEAR(s.msd.value / (6.0 * free.time[t]), 2.0, 4.5 * s.msd.error / (6.0 * free.time[t]));
    CHECK_NEAR(s.msd.error / (6.0 * free.time[t]), 2.0 * std::sqrt(2.0 / 3.0 / 20000.0), 0.001);
    CHECK_NEAR(s.mean_kurtosis.value, 0.0, 4.5 * s.mean_kurtosis.error);
    CHECK_NEAR(s.mean_kurtosis.error, std::sqrt(24.0 / 3.0 / 20000.0), 0.004);
    for (int a = 0; a < 3; a++)
      CHECK_NEAR(s.diffusivity[a].value, 2.0, 4.5 * s.diffusivity[a].error);
  }
  const Tail exponent = fit_tail(curve_of(free), 0.0), half = fit_tail(curve_of(free), 0.5);
  check_state(exponent.state, "void: D does not depend on time beyond its error");
  check_state(half.state, "fitted");
  CHECK_NEAR(half.limit.value, 2.0, 4.5 * half.limit.error);
  CHECK_NEAR(half.amplitude.value, 0.0, 4.5 * half.amplitude.error);
}

// z scores of many draws have a spread of 1, of the limit with the exponent held and of all with it fitted.
void errors_are_right() {
  constexpr int draws = 200;
  double held = 0, limit = 0, exponent = 0, chi2 = 0;
  int fitted = 0;
  for (int draw = 0; draw < draws; draw++) {
    const DiffusivityCurve curve =
        curve_of(made_walkers(2000, spaced(2, 40, 8), 1.0, 0.5, 3.0, 100 + static_cast<std::uint64_t>(draw)));
    const Tail one = fit_tail(curve, 1.0), any = fit_tail(curve, 0.0);
    held += std::pow((one.limit.value - 0.5) / one.limit.error, 2) / draws;
    chi2 += one.chi2 / static_cast<double>(one.degrees) / draws;
    if (!any.is_fitted()) continue;
    fitted++;
    limit += std::pow((any.limit.value - 0.5) / any.limit.error, 2);
    exponent += std::pow((any.exponent.value - 1.0) / any.exponent.error, 2);
  }
  printf(
      "errors of %d draws: mean z^2 of the limit %.3f (exponent held), %.3f and of the exponent %.3f (of %d "
      "fitted); chi2 / degrees %.3f\n",
      draws, held, limit / fitted, exponent / fitted, fitted, chi2);
  const double spread = 4.5 * std::sqrt(2.0 / draws);
  CHECK(fitted > 0.95 * draws);
  CHECK_NEAR(held, 1.0, spread);
  CHECK_NEAR(limit / fitted, 1.0, spread);
  CHECK_NEAR(exponent / fitted, 1.0, spread);
  CHECK_NEAR(chi2, 1.0, spread);
}

// Walkers in a ball: MSD = 6/5 R^2 (1 - ...), of the roots of (mu^2 - 2) sin mu + 2 mu cos mu.
void ball() {
  const double root[] = {2.0815759778,  5.9403699906,  9.2058401429, 12.4044450219, 15.5792364104,
                         18.7426455848, 21.8996964795, 25.052825281, 28.203361004,  31.3520917266};
  const auto curve = [&](double first, double last) {
    const std::vector<double> time = spaced(first, last, 12);
    std::vector<double> value;
    for (const double t : time) {
      double msd = 0.0, share = 0.0;
      for (const double mu : root) {
        const double weight = 2.0 / (mu * mu * (mu * mu - 2.0));
        msd += weight * (1.0 - std::exp(-mu * mu * 2.0 * t / 25.0)), share += weight;
      }
      value.push_back((msd + 0.2 - share) * 25.0 / t); // roots beyond these have reached their limit
    }
    return exact_curve(time, value, 1e-3);
  };
  const Tail closed = fit_tail(curve(20, 200), 0.0);
  check_state(closed.state, "fitted");
  CHECK_NEAR(closed.exponent.value, 1.0, 0.01);
  CHECK_NEAR(closed.limit.value, 0.0, 1e-3);
  CHECK_NEAR(fit_tail(curve(20, 200), 1.0).amplitude.value, 5.0, 0.01); // R^2 / 5
  // Too short: D(t) falls by the surface, as 1 - a sqrt(t).
  const Tail brief = fit_tail(curve(0.05, 0.5), 0.0);
  printf("ball, 0.05 to 0.5 ms: %s\n", brief.state.c_str());
  CHECK(brief.state.rfind("void", 0) == 0 && brief.limit.value == 0.0);
  CHECK(fit_tail(curve(0.3, 3), 0.0).state != "fitted");
}

// A tube of cross-section A(x) that goes on and on, in cells of dx. With E[X_t] = x + u(x, t):
// A u_t = d/dx (D_0 A (1 + u_x)), and the slope of <x^2> / 2 is D_0 <A (1 + u_x)> / <A>.
class Tube {
public:
  Tube(std::vector<double> area, double dx) : face_(std::move(area)), dx_(dx) {
    const std::size_t n = face_.size();
    for (std::size_t i = 0; i < n; i++)
      cell_.push_back(0.5 * (face_[i] + face_[(i + 1) % n]));
  }
  double mean_area() const { return std::accumulate(cell_.begin(), cell_.end(), 0.0) / size(); }
  double mean_reciprocal() const {
    double sum = 0.0;
    for (const double a : face_)
      sum += 1.0 / a;
    return sum / size();
  }
  double limit(double free) const { return free / (mean_area() * mean_reciprocal()); }
  // Of w = (1 / A) / <1 / A> - 1, mean over 0 < q < most_q (rad/um), um.
  double power(double most_q) const {
    std::vector<double> w;
    for (const double a : face_)
      w.push_back(1.0 / a / mean_reciprocal() - 1.0);
    const std::vector<double> all = power_of(w, dx_);
    const double first = 2.0 * pi / (size() * dx_);
    const auto many = static_cast<std::size_t>(most_q / first);
    return std::accumulate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(many), 0.0) /
           static_cast<double>(many);
  }
  // D(t) = <x^2> / (2 t) by Crank and Nicolson's steps of a thirtieth of the time.
  std::vector<double> diffusivity(const std::vector<double> &time, double free) const {
    std::vector<double> out, u(face_.size(), 0.0);
    double now = 0.0, half_msd = 0.0, slope = slope_of(u, free);
    Work work;
    for (const double end : time) {
      while (now < end) {
        double step = std::max(1e-3, now / 30.0);
        if (now + 1.0001 * step >= end) step = end - now;
        advance(u, step, free, work);
        const double after = slope_of(u, free);
        half_msd += 0.5 * step * (slope + after), slope = after, now += step;
      }
      now = end;
      out.push_back(half_msd / end);
    }
    return out;
  }

private:
  struct Work {
    std::vector<double> diagonal, right, factor, other;
  };
  double size() const { return static_cast<double>(face_.size()); }
  // Flux through the left face of cell i, over D_0.
  double flux(const std::vector<double> &u, std::size_t i) const {
    return face_[i] * (1.0 + (u[i] - u[i ? i - 1 : u.size() - 1]) / dx_);
  }
  double slope_of(const std::vector<double> &u, double free) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < u.size(); i++)
      sum += flux(u, i);
    return free * sum / size() / mean_area();
  }
  // (A + h K) u' = A u + h (2 d(A)/dx - K u) with h = step D_0 / 2, a cyclic tridiagonal system by Thomas's
  // elimination and the correction of Sherman and Morrison.
  void advance(std::vector<double> &u, double step, double free, Work &work) const {
    const std::size_t n = u.size();
    const double h = 0.5 * step * free / dx_;
    std::vector<double> &diagonal = work.diagonal, &right = work.right, &factor = work.factor,
                        &other = work.other;
    for (std::vector<double> *v : {&diagonal, &right, &factor, &other})
      v->assign(n, 0.0);
    for (std::size_t i = 0; i < n; i++) {
      const std::size_t next = i + 1 < n ? i + 1 : 0;
      diagonal[i] = cell_[i] + h / dx_ * (face_[i] + face_[next]);
      right[i] = cell_[i] * u[i] + h * (flux(u, next) - flux(u, i)) + h * (face_[next] - face_[i]);
    }
    const double corner = -h / dx_ * face_[0], gamma = -diagonal[0];
    diagonal[0] -= gamma, diagonal[n - 1] -= corner * corner / gamma;
    other[0] = gamma, other[n - 1] = corner;
    for (std::size_t i = 0; i < n; i++) {
      const double off = i ? -h / dx_ * face_[i] : 0.0; // to the left neighbour
      const double pivot = 1.0 / (diagonal[i] - (i ? off * factor[i - 1] : 0.0));
      factor[i] = i + 1 < n ? -h / dx_ * face_[i + 1] * pivot : 0.0;
      right[i] = (right[i] - (i ? off * right[i - 1] : 0.0)) * pivot;
      other[i] = (other[i] - (i ? off * other[i - 1] : 0.0)) * pivot;
      if (std::fabs(other[i]) < 1e-100) other[i] = 0.0; // on its way to slow, denormal numbers
    }
    for (std::size_t i = n - 1; i-- > 0;) {
      right[i] -= factor[i] * right[i + 1], other[i] -= factor[i] * other[i + 1];
      if (std::fabs(other[i]) < 1e-100) other[i] = 0.0;
    }
    const double share =
        (right[0] + corner / gamma * right[n - 1]) / (1.0 + other[0] + corner / gamma * other[n - 1]);
    for (std::size_t i = 0; i < n; i++)
      u[i] = right[i] - share * other[i];
  }
  std::vector<double> face_, cell_; // A at the left face of each cell, and in it
  double dx_;
};

// 1 + bumps of height 2 and width 0.4 um at these places.
std::vector<double> bumps(const std::vector<double> &places, std::size_t cells, double dx) {
  std::vector<double> area(cells, 1.0);
  for (const double place : places)
    for (int k = -30; k <= 30; k++) {
      const double at = std::floor(place / dx) + k, off = (at * dx - place) / 0.4;
      const auto n = static_cast<std::ptrdiff_t>(cells);
      area[static_cast<std::size_t>(((static_cast<std::ptrdiff_t>(at) % n) + n) % n)] +=
          2.0 * std::exp(-0.5 * off * off);
    }
  return area;
}

void tubes() {
  constexpr double dx = 0.1, free = 2.0, spacing = 5.0;
  constexpr std::size_t cells = 200000;
  constexpr double length = dx * cells;
  std::vector<double> random, jittered;
  conceg_rng rng = conceg_rng_stream(1, "test.tube", 0);
  for (double at = spacing / 2; at < length; at += spacing) {
    random.push_back(length * conceg_rng_uniform(&rng));
    if (at < length / 4) jittered.push_back(at + 2.0 * (conceg_rng_uniform(&rng) - 0.5));
  }
  const std::vector<double> time = spaced(10, 200, 14);
  for (const double d : Tube(std::vector<double>(1000, 3.0), dx).diffusivity({0.1, 1, 10}, free))
    CHECK_NEAR(d, free, 1e-12);

  const Tube poisson(bumps(random, cells, dx), dx);
  const std::vector<double> found = poisson.diffusivity(time, free);
  const Tail any = fit_tail(exact_curve(time, found, 1e-4), 0.0),
             half = fit_tail(exact_curve(time, found, 1e-4), 0.5);
  const double limit = poisson.limit(free), amplitude = poisson.power(0.2) * std::sqrt(limit / pi);
  printf(
      "Poisson bumps: D %.4f .. %.4f; exponent %.3f; limit %.4f, free %.4f (%.4f), amplitude %.4f (%.4f)\n",
      found.front(), found.back(), any.exponent.value, half.limit.value, any.limit.value, limit,
      half.amplitude.value, amplitude);
  CHECK_NEAR(any.exponent.value, 0.5, 0.05);
  CHECK_NEAR(half.limit.value / limit, 1.0, 0.01);
  CHECK_NEAR(any.limit.value / limit, 1.0, 0.01);
  CHECK_NEAR(half.amplitude.value / amplitude, 1.0, 0.05);

  // Hyperuniform: no power at small q, so D(t) ends as 1 / t, the fastest that <x^2> / (2 t) shows.
  const Tube lattice(bumps(jittered, cells / 4, dx), dx);
  const std::vector<double> ordered = lattice.diffusivity(time, free);
  const Tail other = fit_tail(exact_curve(time, ordered, 1e-5), 0.0);
  printf("jittered lattice: D %.5f .. %.5f; exponent %.3f, limit %.4f (%.4f)\n", ordered.front(),
         ordered.back(), other.exponent.value, other.limit.value, lattice.limit(free));
  CHECK(other.exponent.value > 0.85 && other.exponent.value < 1.5);
  CHECK_NEAR(other.limit.value / lattice.limit(free), 1.0, 0.01);
  // The wrong exponent held is told by chi2.
  check_state(fit_tail(exact_curve(time, ordered, 1e-5), 0.5).state, "rejected");
}

void few_and_close_times() {
  const Made few = made_walkers(100, spaced(10, 40, 4), 1.0, 0.5, 1.0, 1);
  check_state(fit_tail(curve_of(few), 0.0).state, "void: too few times");
  CHECK(fit_tail(curve_of(few), 1.0).state.rfind("void", 0) != 0);
  check_state(fit_tail(curve_of(made_walkers(100, spaced(10, 29, 8), 1.0, 0.5, 1.0, 1)), 1.0).state,
              "void: times span less than a factor of 3");
  check_state(fit_tail(curve_of(made_walkers(5, spaced(10, 100, 8), 1.0, 0.5, 1.0, 1)), 1.0).state,
              "void: too few walkers");
  // An exponent, but no limit: the two go together.
  const std::vector<double> time = spaced(1, 10, 10);
  std::vector<double> value;
  for (const double t : time)
    value.push_back(0.1 + 0.7 * std::pow(t, -0.1));
  check_state(fit_tail(exact_curve(time, value, 1e-2), 0.0).state, "void: too few walkers for a limit");
}

// A cell and the space around it: which walkers are in which rows, the same for any number of threads.
void compartments_and_threads() {
  Made m = made_walkers(3000, spaced(1, 100, 12), 2.0, 0.0, 0.5, 7);
  const Made rattling = made_walkers(1000, spaced(1, 100, 12), 2.0, 1.0, 0.5, 8);
  for (std::size_t t = 0; t < m.time.size(); t++)
    std::copy(rattling.moved[t].begin(), rattling.moved[t].end(), m.moved[t].begin());
  Cells cells;
  cells.type_name = {"a", "b"}, cells.type_class = {"pyramidal", "astrocyte"}, cells.type = {0, 1};
  Displacements walked;
  walked.time = m.time, walked.moved = m.pointers(), walked.free_extra = 2.0;
  for (int w = 0; w < 3000; w++)
    walked.cell.push_back(w < 1000 ? w % 2 : -1),
        walked.compartment.push_back(w < 1000 ? w < 100 ? 1 : 3 : 0);
  Workers one(1), three(3);
  const TailRange range = {5, 100};
  const std::vector<Diffusivity> found = diffusivities(walked, cells, range, one);
  const std::vector<std::string> names = {"all",     "intra",           "extra",          "soma",
                                          "neurite", "class astrocyte", "class pyramidal"};
  const std::vector<std::uint64_t> sizes = {3000, 1000, 2000, 100, 900, 500, 500};
  CHECK_EQUAL(found.size(), names.size());
  for (std::size_t i = 0; i < std::min(found.size(), names.size()); i++) {
    CHECK_TEXT(found[i].compartment.c_str(), names[i].c_str());
    CHECK_EQUAL(found[i].walkers, sizes[i]);
  }
  const Spread &intra = found[1].spread.back(), &extra = found[2].spread.back();
  CHECK_NEAR(intra.msd.value, 3.0, 4.5 * intra.msd.error); // twice 0.5 along each axis
  CHECK_NEAR(extra.msd.value, 1200.0, 4.5 * extra.msd.error);
  const WalkedLambda lambda = walked_lambda(found, walked);
  check_state(lambda.state, "fitted");
  CHECK_NEAR(lambda.lambda.value, 1.0, 4.5 * lambda.lambda.error);
  const std::vector<Diffusivity> again = diffusivities(walked, cells, range, three);
  CHECK(diffusivity_table(found, walked.time).csv() == diffusivity_table(again, walked.time).csv());
  CHECK(diffusivity_fit_table(found, range).csv() == diffusivity_fit_table(again, range).csv());
  CHECK_EQUAL(diffusivity_table(found, walked.time).rows(), 7 * 12);
  CHECK_EQUAL(diffusivity_fit_table(found, range).rows(), 7 * 12);
  // Nothing is told where it cannot be known.
  Displacements leaky = walked;
  leaky.permeable = true;
  check_state(walked_lambda(found, leaky).state, "void: walkers pass membranes");
  walked.free_extra = 0.0;
  CHECK(walked_lambda(found, walked).state.rfind("void", 0) == 0);
  CHECK(walked_lambda({found[1]}, leaky).lambda.value == 0.0);
}

} // namespace

int main() {
  free_walkers();
  errors_are_right();
  ball();
  tubes();
  few_and_close_times();
  compartments_and_threads();
  return check_done();
}
