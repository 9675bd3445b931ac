// SPDX-License-Identifier: BSD-3-Clause
#include "read.hpp"

#include "conceg/swc.h"
#include "guard.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

namespace conceg::characterise {
namespace {

struct FreeSwc {
  void operator()(conceg_swc *swc) const { conceg_swc_free(swc); }
};
using Swc = std::unique_ptr<conceg_swc, FreeSwc>;

std::string stem_of(const std::string &path) {
  const std::size_t slash = path.rfind('/'), from = slash == std::string::npos ? 0 : slash + 1,
                    dot = path.rfind('.');
  return path.substr(from, dot == std::string::npos || dot < from ? std::string::npos : dot - from);
}
// A file of the table: an absolute name, else below the root, else beside the table.
std::string find_file(const Options &options, const std::string &path) {
  if (path[0] == '/') return path;
  const std::string below = options.root == "." ? path : options.root + "/" + path,
                    beside = options.table_folder + "/" + path;
  return !std::ifstream(below) && std::ifstream(beside) ? beside : below;
}

void log_problems(conceg_ctx *ctx, const std::string &path, const conceg_swc *swc) {
  std::uint32_t severity, line;
  const char *code, *text;
  for (std::uint32_t i = 0; conceg_swc_problem(swc, i, &severity, &line, &code, &text); i++)
    conceg_ctx_log(ctx, CONCEG_LOG_DEBUG, "%s:%u: %s: %s", path.c_str(), line, code, text);
}

Samples copy_samples(const conceg_swc *swc) {
  Samples s;
  const std::uint64_t count = conceg_swc_count(swc);
  const double *position = conceg_swc_position(swc), *radius = conceg_swc_radius(swc);
  for (std::uint64_t i = 0; i < count; i++) {
    s.position.emplace_back(position[3 * i], position[3 * i + 1], position[3 * i + 2]);
    s.radius.push_back(radius[i]);
    s.kind.push_back(conceg_swc_kind(swc)[i]);
    s.parent.push_back(conceg_swc_parent(swc)[i]);
    s.on_soma.push_back(conceg_swc_on_soma(swc)[i] != 0);
  }
  return s;
}

std::int64_t find_source(const TableRow &row, const Options &options) {
  if (options.sources_path.empty()) {
    if (row.source.empty()) return -1;
    fail(CONCEG_E_USAGE, "%s: source %s: no table of sources was given; name it with --sources FILE",
         row.file.c_str(), row.source.c_str());
  }
  for (std::size_t i = 0; i < options.sources.size(); i++)
    if (options.sources[i].name == row.source) return static_cast<std::int64_t>(i);
  fail(CONCEG_E_FORMAT, "%s: source: expected one of the rows of %s, got '%s'", row.file.c_str(),
       options.sources_path.c_str(), row.source.c_str());
}

// The row of a donor without what its cell must tell.
Donor new_donor(const TableRow &row, const Options &options) {
  Donor donor;
  donor.id = row.donor_id.empty() ? stem_of(row.file) : row.donor_id;
  donor.fold = static_cast<std::uint8_t>(row.fold);
  donor.source = find_source(row, options), donor.pooled_from = row.pooled_from;
  donor.frame_kind = "unknown";
  return donor;
}

// The direction of the pia in the file, by the table's word for it.
Donor make_donor(const TableRow &row, const Options &options, const Cell &cell, const std::string &path) {
  Donor donor = new_donor(row, options);
  if (row.frame == "unknown") return donor;
  glm::dvec3 axis(0.0);
  if (row.frame == "apical") {
    axis = apical_axis(cell);
    if (axis == glm::dvec3(0.0))
      fail(CONCEG_E_FORMAT, "%s: frame apical: expected samples of type 4, got none; give an axis or unknown",
           path.c_str());
    donor.frame_kind = "apical";
  } else {
    axis[row.frame[1] - 'x'] = row.frame[0] == '-' ? -1.0 : 1.0;
    donor.frame_kind = "axis";
  }
  donor.frame = rotation_to_z(axis);
  return donor;
}
// Radii of the dendrites or processes as traced.
Trace trace_of_dendrites(const Samples &samples) {
  std::vector<double> radii;
  for (std::size_t i = 0; i < samples.size(); i++)
    if (samples.kind[i] != neurite_axon) radii.push_back(samples.radius[i]);
  return trace_of(std::move(radii));
}

metrics::Metrics measure_dendrites(const Cell &cell) {
  Cell dendrites = cell;
  dendrites.trees.erase(std::remove_if(dendrites.trees.begin(), dendrites.trees.end(),
                                       [](const Tree &tree) { return tree.neurite == neurite_axon; }),
                        dendrites.trees.end());
  return metrics::measure(whole_cell(dendrites), sholl_step_um);
}

void check_cell(const Cell &cell, const TableRow &row, const std::string &path) {
  if (cell.trees.empty()) fail(CONCEG_E_FORMAT, "%s: expected trees on the soma, got none", path.c_str());
  const bool neuron = row.cell_class == "pyramidal" || row.cell_class == "interneuron";
  if (neuron && std::all_of(cell.trees.begin(), cell.trees.end(),
                            [](const Tree &tree) { return tree.neurite == neurite_axon; }))
    fail(CONCEG_E_FORMAT,
         "%s: expected dendrites (types 3 and 4) in a cell of class %s, got none; leave the file out, or "
         "give it "
         "the class axon",
         path.c_str(), row.cell_class.c_str());
}

// The figures of a cell that is made of bars: a bar is cut where others start on it.
CellRow row_of(const Astrocyte &cell) {
  CellRow out;
  double branches = 0.0, forks = 0.0, radius = 0.0;
  for (const BarTree &tree : cell.trees) {
    const double bars = static_cast<double>(tree.bars.size()), here = 2.0 * bars - 1.0;
    out.order += mean_order(tree.bars) * here, branches += here, out.tips += bars, out.stems++;
    for (const BarRow &bar : tree.bars) {
      out.cable_um += bar.death - bar.birth, radius += bar.radius * (bar.death - bar.birth);
      if (bar.parent >= 0) out.angle_degree += bar.angle * 57.29577951308232, forks++;
    }
  }
  out.order /= branches, out.length_um = out.cable_um / branches, out.radius_um = radius / out.cable_um;
  if (forks > 0.0) out.angle_degree /= forks;
  out.soma_radius_um = cell.soma_radius;
  return out;
}

} // namespace

std::string read_text(const std::string &path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  if (!in || !(out << in.rdbuf())) fail(CONCEG_E_IO, "%s: cannot be read; check the path", path.c_str());
  return out.str();
}

void add_reconstruction(conceg_ctx *ctx, Output &out, EntrySums &sums, std::vector<FileExtent> &extents,
                        const TableRow &row, const Options &options) {
  const std::string path = find_file(options, row.file);
  conceg_swc *raw = nullptr;
  const conceg_status status = conceg_swc_read(ctx, path.c_str(), options.swc_flags, &raw);
  const Swc swc(raw);
  must(status);
  log_problems(ctx, path, swc.get());

  Cell cell;
  double center[3];
  conceg_swc_soma(swc.get(), center, &cell.soma_radius);
  cell.soma = {center[0], center[1], center[2]};
  Cleaning rules = options.cleaning;
  rules.axons = rules.axons && row.whole_axon;
  rules.glia = row.cell_class == "microglia" || row.cell_class == "astrocyte";
  if (rules.glia) rules.twig_length_um = 0.0; // glia have no spines
  if (row.soma_radius_um > 0.0) cell.soma_radius = row.soma_radius_um, rules.clip_at_soma = true;
  if (!(cell.soma_radius > 0.0))
    fail(CONCEG_E_FORMAT, "%s: expected a soma, got none; give soma_radius_um in the table or another file",
         path.c_str());

  Cleaned left_out;
  const Samples samples = copy_samples(swc.get());
  cell.trees = clean_trees(samples, cell.soma, cell.soma_radius, rules, left_out);
  check_cell(cell, row, path);
  extents.push_back({path, extent_of(cell)});
  Donor donor = make_donor(row, options, cell, path);
  donor.trace = trace_of_dendrites(samples);
  const CellFigures f = add_cell(out.dictionary, sums, donor, cell);
  out.pictures.keep(out.dictionary, cell);
  const metrics::Metrics dendrites = measure_dendrites(cell);
  const metrics::Group &g = dendrites.groups.front();
  if (g.sections) out.summary.add(row_of(g, cell.soma_radius, f.radius));
  if (g.sections && !donor.pooled_from.empty()) out.summary.pool();
  if (options.metrics != "none") {
    const metrics::Samples measured =
        options.metrics == "read" ? whole_cell(samples, cell.soma, cell.soma_radius) : whole_cell(cell);
    out.measures.add(row.entry, donor.id, metrics::measure(measured, sholl_step_um));
  }
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "%s %s: %zu trees, %zu bars, %zu branches; order %.2f, branch %.1f um, angle %.1f degree, "
                 "straightness %.3f, radius %.3f um (%s), "
                 "cable %.0f um; left out: %zu twigs, %zu floating trees, %zu axon pieces, %zu short trees; "
                 "%zu radii raised; %zu axon pieces joined over %.0f um",
                 row.entry.c_str(), donor.id.c_str(), f.trees, f.bars, static_cast<std::size_t>(g.sections),
                 g.order.mean, g.section_length.mean, g.local_angle.mean * 57.29577951308232,
                 g.straightness_1um.mean, f.radius, name_of(donor.trace), f.cable, left_out.twigs,
                 left_out.floating, left_out.axon_pieces, left_out.short_trees, left_out.raised_radii,
                 left_out.joined_pieces, left_out.bridged_um);
  out.cleaned += left_out;
}

void add_astrocytes(conceg_ctx *ctx, Output &out, EntrySums &sums, const TableRow &row,
                    const Options &options) {
  const std::string path = find_file(options, row.file);
  const AstrocyteStatistics statistics = parse_astrocyte(read_text(path), path);
  for (std::uint64_t k = 0; k < options.astrocyte_donors; k++) {
    const Astrocyte cell = make_astrocyte(statistics, options.astrocyte, conceg_ctx_seed(ctx), k);
    Donor donor = new_donor(row, options);
    char number[24];
    std::snprintf(number, sizeof number, "_%02u", static_cast<unsigned>(k));
    donor.id += number;
    donor.fold = static_cast<std::uint8_t>(k % 5);
    add_bar_trees(out.dictionary, donor, cell.soma_radius, cell.trees);
    out.summary.add(row_of(cell));
    for (const BarTree &tree : cell.trees)
      for (const BarRow &bar : tree.bars)
        if (bar.parent >= 0) sums.angles.push_back(bar.angle);
  }
  sums.branches = 1, sums.straight = options.astrocyte.straightness;
  sums.straight_squared =
      sums.straight * sums.straight + options.astrocyte.straightness_sd * options.astrocyte.straightness_sd;
}

} // namespace conceg::characterise
