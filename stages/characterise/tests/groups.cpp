// SPDX-License-Identifier: BSD-3-Clause
// What the donors of an entry give together: fluctuation of their radii, how finely they were traced, the
// summary beside the paper's table.
#include "check.h"

#include "dictionary.hpp"
#include "group.hpp"
#include "guard.hpp"
#include "summary.hpp"

#include "conceg/rng.h"

#include <cmath>
#include <string>

using namespace conceg;
using namespace conceg::characterise;

namespace {

// Radii whose logarithm is a Gaussian process of the given sd and an exponential autocorrelation, sampled
// every um.
std::vector<double> beaded(conceg_rng &rng, std::size_t count, double sd, double length_um) {
  const double keep = std::exp(-1.0 / length_um);
  std::vector<double> out;
  double value = sd * conceg_rng_normal(&rng);
  for (std::size_t i = 0; i < count; i++) {
    out.push_back(0.4 * std::exp(value));
    value = keep * value + sd * std::sqrt(1.0 - keep * keep) * conceg_rng_normal(&rng);
  }
  return out;
}

// Many bars of one length together.
CalibrePool pool_of(std::size_t bars, std::size_t samples, double sd, double length_um) {
  conceg_rng rng = conceg_rng_stream(1, "test.calibre", samples);
  CalibrePool pool;
  std::vector<double> path, residual;
  for (std::size_t i = 0; i < samples; i++)
    path.push_back(static_cast<double>(i));
  for (std::size_t bar = 0; bar < bars; bar++) {
    const Calibre calibre = measure_calibre(path, beaded(rng, samples, sd, length_um), &residual);
    pool.add(calibre, path.back(), residual);
  }
  return pool;
}

void check_pool() {
  CHECK_NEAR(CalibrePool().cv(), 0.0, 0);
  CHECK_NEAR(CalibrePool().correlation_length(), 0.0, 0);
  // Mean and taper of a bar are taken out: of 400 um bars the correlation at 5 um falls by about 4 * 5 / 400.
  CHECK_NEAR(pool_of(100, 400, 0.2, 5.0).correlation_length(), 4.6, 0.35);
  const CalibrePool pool = pool_of(20, 4000, 0.2, 5.0);
  CHECK_NEAR(pool.cv(), 0.2, 0.01);
  CHECK_NEAR(pool.correlation_length(), 5.0, 0.35);
  CHECK_NEAR(pool.radius(), 0.4 * std::exp(0.5 * 0.2 * 0.2), 0.01);
  CHECK(pool_of(100, 400, 0.2, 15.0).correlation_length() > 10.0); // another process is told apart
  CHECK_NEAR(pool_of(10, 9, 0.2, 5.0).cv(), 0.0, 0);               // too short to tell
  CalibrePool twice = pool;
  twice.add(pool);
  CHECK_NEAR(twice.cv(), pool.cv(), 1e-12);
  CHECK_NEAR(twice.radius(), pool.radius(), 1e-12);
}

void check_trace() {
  std::vector<double> radii;
  CHECK(trace_of(radii) == Trace::none);
  for (int i = 0; i < 2000; i++)
    radii.push_back(0.1 + 1e-4 * i);
  CHECK(trace_of(radii) == Trace::continuous);
  for (double &r : radii)
    r = 0.0127 * std::round(r / 0.0127); // whole pixels
  CHECK(trace_of(radii) == Trace::quantised);
  for (std::size_t i = 0; i < 1200; i++)
    radii[i] = 0.25;
  CHECK(trace_of(radii) == Trace::constant);
  CHECK(trace_of({0.2, 0.2, 0.2}) == Trace::continuous); // too few for a verdict
}

// Donors that were traced finely decide, where there are any.
void check_choice() {
  Dictionary d;
  EntrySums sums;
  open_entry(d, "A", "pyramidal", "");
  conceg_rng rng = conceg_rng_stream(2, "test.choice", 0);
  for (const Trace trace : {Trace::quantised, Trace::continuous, Trace::constant}) {
    Cell cell;
    cell.soma_radius = 5.0;
    Tree tree;
    for (double r : beaded(rng, 200, 0.3, 5.0)) {
      if (trace == Trace::quantised) r = std::max(0.1, 0.1 * std::round(r / 0.1)); // whole pixels
      if (trace == Trace::constant) r = 0.25;
      tree.parent.push_back(static_cast<std::int64_t>(tree.size()) - 1);
      tree.position.emplace_back(5.0 + static_cast<double>(tree.size()), 0.0, 0.0), tree.radius.push_back(r);
    }
    cell.trees = {tree};
    Donor donor;
    donor.id = name_of(trace), donor.frame_kind = "unknown", donor.trace = trace;
    donor.pooled_from = trace == Trace::constant ? "layer 4" : "";
    add_cell(d, sums, donor, cell);
  }
  close_entry(d, sums);
  CHECK_EQUAL(d.calibre_entry.size(), 1);
  CHECK_EQUAL(d.calibre_donors[0], 1);
  CHECK_TEXT(d.calibre_trace[0].c_str(), "continuous");
  CHECK_NEAR(d.calibre_cv[0], d.bar_cv[1], 1e-9); // of the one that was traced finely
  CHECK_TEXT(d.donor_trace[0].c_str(), "quantised");
  CHECK_TEXT(d.donor_pooled_from[2].c_str(), "layer 4");
  CHECK(d.donor_source.empty());
}

void check_unit_errors() {
  const auto error = [](const std::vector<FileExtent> &files) -> std::string {
    try {
      check_units("A", files);
    } catch (const Error &e) {
      return e.what();
    }
    return "";
  };
  CHECK(error({}).empty() && error({{"a.swc", 1.0}}).empty());
  CHECK(error({{"a.swc", 100.0}, {"b.swc", 900.0}, {"c.swc", 300.0}}).empty());
  CHECK(error({{"a.swc", 400.0}, {"b.swc", 300.0}, {"c.swc", 3.0e5}})
            .find("c.swc: expected a cell of about 346") == 0);
  CHECK(error({{"a.swc", 0.4}, {"b.swc", 300.0}, {"c.swc", 500.0}}).find("a.swc") == 0);
}

bool has_line(const std::vector<std::string> &lines, const char *first, const char *second) {
  for (const std::string &line : lines)
    if (line.find(first) != std::string::npos && line.find(second) != std::string::npos) return true;
  fprintf(stderr, "  no line with '%s' and '%s'\n", first, second);
  return false;
}

void check_summary() {
  CHECK_EQUAL(mean_of({}).count, 0);
  CHECK_NEAR(mean_of({2.0, 4.0}).sd, std::sqrt(2.0), 1e-12);
  Summary summary;
  CellRow a, b;
  a.order = 3.0, a.length_um = 40.0, a.angle_degree = 60.0, a.cable_um = 1000.0;
  a.straightness = {3, 0.8, 0.0};
  b.order = 5.0, b.length_um = 60.0, b.angle_degree = 70.0, b.cable_um = 3000.0;
  b.straightness = {1, 0.3, 0.0};
  summary.open("L4_pyramidal"), summary.add(a), summary.add(b), summary.pool();
  summary.open("mine"), summary.add(a);
  const Table table = summary.table();
  CHECK_EQUAL(table.rows(), 2);
  for (const Column &column : table.columns) {
    if (column.name == "order") CHECK_NEAR(column.reals[0], 4.0, 1e-12);
    if (column.name == "order_from_0") CHECK_NEAR(column.reals[0], 3.0, 1e-12);
    if (column.name == "branch_length_sd") CHECK_NEAR(column.reals[0], std::sqrt(200.0), 1e-12);
    if (column.name == "straightness") CHECK_NEAR(column.reals[0], 0.675, 1e-12); // of four branches
    if (column.name == "straightness_sd") CHECK_NEAR(column.reals[0], std::sqrt(0.046875), 1e-12);
    if (column.name == "pooled") CHECK_EQUAL(column.wholes[0], 1);
  }
  const std::vector<std::string> lines = summary.lines();
  CHECK(has_line(lines, "L4_pyramidal*", "4.00 +- 1.41"));
  CHECK(has_line(lines, "paper", "3.80 +- 0.63"));
  CHECK(has_line(lines, "difference", "+0.3 sd"));
  CHECK(has_line(lines, "difference", "(!) -1.2 sd")); // straightness
  CHECK(has_line(lines, "(!) more than 1 sd", "no difference of this kind"));
  CHECK(has_line(lines, "* with 1 of 2", "another group"));
  std::size_t papers = 0;
  for (const std::string &line : lines)
    papers += line.find("  paper") == 0;
  CHECK_EQUAL(papers, 1); // an entry of another name is compared with nothing
}

} // namespace

int main() {
  check_pool();
  check_trace();
  check_choice();
  check_unit_errors();
  check_summary();
  return check_done();
}
