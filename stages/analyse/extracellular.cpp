// SPDX-License-Identifier: BSD-3-Clause
#include "extracellular.hpp"

#include "blocks.hpp"
#include "erosion.hpp"
#include "statistics_table.hpp"

#include <algorithm>
#include <array>

namespace conceg::analyse {

namespace {

constexpr std::size_t between = 8; // planes from one section to the next
constexpr std::size_t most_eroded_sections = 16;

// What is analysed: a whole box, a block, or sections alone.
struct Medium {
  std::uint64_t block = 0; // from 1 on; 0 = the whole box
  OpenVoxels voxels;       // none: sections alone
  std::vector<OpenVoxels> sections;
  double erosion = 0, ecs_fraction = 0; // um; of the sections when there is nothing else
  const OpenVoxels &first() const { return voxels.open.empty() ? sections.front() : voxels; }
};

struct Wanted {
  bool pores, paths, transport;
  bool any() const { return pores || paths || transport; }
};

class Extracellular {
public:
  Extracellular(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params,
                const ExtracellularInput &input, Workers &workers)
      : ctx_(ctx), doc_(doc), params_(params), input_(input),
        workers_(workers), wanted_{flag("pores"), flag("paths"), flag("transport")} {}

  void run() {
    const double erode_to = conceg_params_f64(params_, "erode_to");
    const auto blocks = static_cast<std::size_t>(conceg_params_i64(params_, "blocks"));
    if (!wanted_.any() && !flag("composition")) {
      if (erode_to > 0 || blocks)
        fail(CONCEG_E_PARAM, "%s: expected composition, pores, paths or transport beside it, got none",
             erode_to > 0 ? "erode_to" : "blocks");
      return;
    }
    if (erode_to > 0 && blocks)
      fail(CONCEG_E_PARAM, "erode_to: labels cannot be eroded in blocks of meshes; give one of the two");
    if (erode_to > 0)
      eroded(erode_to);
    else
      as_they_are(blocks);
    for (const Table &table : {blocks_, transport_, paths_, pores_})
      if (table.rows()) write(table);
  }

  const std::optional<SolvedTransport> &whole_box() const { return whole_box_; }

private:
  bool flag(const char *name) const { return conceg_params_bool(params_, name) != 0; }
  Progress progress() const { return progress_of(ctx_); }
  void write(const Table &table) const {
    write_table(doc_, table);
    conceg_ctx_log(ctx_, CONCEG_LOG_INFO, "--- %s", table.name.c_str());
    for (const std::string &line : table.lines())
      conceg_ctx_log(ctx_, CONCEG_LOG_INFO, "%s", line.c_str());
  }
  void need_labels(const char *what) const {
    if (!input_.has_labels)
      fail(CONCEG_E_MISSING, "%s: the document has no /volumes/label; mesh with mesh.volume_step_um=0.25",
           what);
  }
  const char *first_wanted() const { return wanted_.pores ? "pores" : wanted_.paths ? "paths" : "transport"; }

  void as_they_are(std::size_t blocks) {
    if (flag("composition")) {
      need_labels("composition");
      const LabelVolume volume = input_.volume();
      composition(LabelRuns(volume, workers_), volume.spacing, 0);
    }
    if (!wanted_.any()) return;
    if (blocks) return in_blocks(blocks);
    need_labels(first_wanted());
    Medium whole = {0, open_voxels(input_.volume()), {}, 0, 0};
    if (!isotropic(whole.voxels)) {
      conceg_ctx_log(ctx_, CONCEG_LOG_WARNING,
                     "analyse: %s: void: voxels of %g x %g x %g um are not of one size; import with "
                     "import.resample_um, or look at sections with analyse.erode_to",
                     first_wanted(), whole.voxels.spacing[0], whole.voxels.spacing[1],
                     whole.voxels.spacing[2]);
      return;
    }
    for (std::size_t z = 0; z < whole.voxels.shape[2]; z += between)
      whole.sections.push_back(section(whole.voxels, 2, z));
    const double median =
        input_.median_distance > 0 ? input_.median_distance : median_radius(whole.voxels, workers_);
    analyse(whole, median, "mesh with mesh.volume_step_um");
  }

  // Sections of labels that are drawn back from one another. The depth stands in every table and log line.
  void eroded(double erode_to) {
    need_labels("erode_to");
    const LabelVolume volume = input_.volume();
    LabelGrid grid = label_grid(volume);
    ErosionSettings settings;
    settings.open_fraction = erode_to;
    settings.between = std::max(between, (grid.shape[2] + most_eroded_sections - 1) / most_eroded_sections);
    Medium medium;
    {
      Erosion found = erode(grid, settings, workers_);
      conceg_ctx_log(
          ctx_, CONCEG_LOG_RESULT,
          "analyse: erosion: %.4f um off each membrane, in sections across z: extracellular space "
          "%.4f of %zu sections at voxels of %.4g um (asked %g; %.4f had no label), %.4f of the labels",
          found.depth, found.open_fraction, found.sections.size(), largest_in_plane(found.sections[0]),
          erode_to, found.without_label, found.labels_open_fraction);
      medium.sections = std::move(found.sections);
      medium.erosion = found.depth, medium.ecs_fraction = found.open_fraction;
    }
    if (flag("composition"))
      composition(LabelRuns(
                      {static_cast<std::uint32_t>(grid.shape[0]), static_cast<std::uint32_t>(grid.shape[1]),
                       static_cast<std::uint32_t>(grid.shape[2])},
                      [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
                        return grid.label[(x * grid.shape[1] + y) * grid.shape[2] + z];
                      },
                      workers_),
                  volume.spacing, medium.erosion);
    grid.label = {};
    if (wanted_.transport)
      conceg_ctx_log(ctx_, CONCEG_LOG_WARNING, "analyse: transport: void: eroded labels are sections alone");
    if (!wanted_.pores && !wanted_.paths) return;
    std::vector<double> medians;
    for (const OpenVoxels &s : medium.sections)
      medians.push_back(median_radius(s, workers_));
    std::sort(medians.begin(), medians.end());
    analyse(medium, medians[medians.size() / 2], "erode to more, or import smaller voxels: now");
  }

  void in_blocks(std::size_t count) {
    if (!input_.has_meshes)
      fail(CONCEG_E_MISSING, "blocks: the document has no /meshes; they are made by conceg mesh");
    const double side = conceg_params_f64(params_, "block_um"),
                 asked = conceg_params_f64(params_, "block_voxel_um"),
                 voxel = asked > 0                    ? asked
                         : input_.median_distance > 0 ? 0.5 * input_.median_distance
                                                      : 0.05;
    const auto voxels = 2 * static_cast<std::size_t>(std::ceil(0.5 * side / voxel - 1e-9));
    // Of the cell problem, which is the most: 190 bytes for an open voxel, and half of them open.
    const double bytes = 100.0 * std::pow(static_cast<double>(voxels), 3);
    if (bytes > static_cast<double>(conceg_ctx_memory(ctx_)))
      fail(CONCEG_E_NOMEM,
           "block_voxel_um: %zu voxels a side take %.3g GB, more than --memory; give smaller "
           "blocks or larger voxels",
           voxels, 1e-9 * bytes);
    const Meshes meshes = input_.meshes();
    std::uint64_t number = 0;
    for (const Block &block : choose_blocks(input_.box, count, side, conceg_ctx_seed(ctx_))) {
      report(progress(), "blocks", number, count);
      Medium medium;
      medium.block = ++number;
      medium.voxels = block_voxels(meshes, input_.box, block, voxels, workers_);
      for (std::size_t z = between / 2; z < voxels; z += between)
        medium.sections.push_back(section(medium.voxels, 2, z));
      const double median = median_radius(medium.voxels, workers_);
      const bool valid = analyse(medium, median, "give analyse.block_voxel_um");
      add_block(blocks_, medium.block, block.lo, side, medium.voxels, median, open_pieces(medium.voxels),
                valid);
    }
  }

  // False, and a line in the log, when the voxels are too coarse. In a flat cleft of width w distances to the
  // wall are spread evenly over 0 to w / 2: their median is w / 4.
  bool analyse(Medium &medium, double median, const char *remedy) {
    const OpenVoxels &first = medium.first();
    const double voxel = largest_in_plane(first);
    if (!medium.voxels.open.empty()) medium.ecs_fraction = open_fraction(medium.voxels);
    if (voxel > median) {
      conceg_ctx_log(
          ctx_, CONCEG_LOG_WARNING,
          "analyse: %s%s: void: voxels of %g um are wider than a quarter of the median cleft of %g "
          "um; %s=%.3g or smaller",
          first_wanted(), name_of(medium).c_str(), voxel, 4 * median, remedy, median);
      return false;
    }
    if (wanted_.transport && !medium.voxels.open.empty()) transport(medium);
    if (wanted_.paths) paths(medium);
    if (wanted_.pores) pores(medium);
    return true;
  }

  static double largest_in_plane(const OpenVoxels &v) {
    return v.shape[2] == 1 ? std::max(v.spacing[0], v.spacing[1]) : largest_spacing(v);
  }
  static std::string name_of(const Medium &medium) {
    return medium.block ? " of block " + std::to_string(medium.block) : std::string();
  }
  Source source_of(const Medium &medium) const {
    return {medium.block, medium.ecs_fraction, medium.erosion, largest_in_plane(medium.first())};
  }

  void transport(const Medium &medium) {
    const OpenVoxels &fine = medium.voxels;
    if (fine.shape[0] % 2 || fine.shape[1] % 2 || fine.shape[2] % 2)
      fail(CONCEG_E_RANGE, "transport: /volumes@shape: expected even numbers of voxels, got %zu %zu %zu",
           fine.shape[0], fine.shape[1], fine.shape[2]);
    const auto solved = [&](const OpenVoxels &voxels) {
      return transport_of(voxels, {true, true, true}, 1e-6, workers_, progress());
    };
    const Transport of_coarse = solved(coarser(fine)), of_fine = solved(fine);
    add_transport(transport_, medium.block, of_coarse, of_fine, largest_spacing(fine));
    if (!medium.block) whole_box_ = {extrapolated(of_coarse, of_fine), of_fine};
  }

  void pores(const Medium &medium) {
    const Source source = source_of(medium);
    if (!medium.voxels.open.empty()) add_pores(pores_, source, 3, pore_space({medium.voxels}, workers_));
    add_pores(pores_, source, 2, pore_space(medium.sections, workers_));
  }

  void paths(const Medium &medium) {
    PathSettings settings;
    settings.seed = conceg_ctx_seed(ctx_), settings.least = conceg_params_f64(params_, "path_um");
    const auto add = [&](std::uint64_t dimensions, const std::vector<OpenVoxels> &media) {
      const PathStraightness found = path_straightness(media, settings, workers_, progress());
      if (found.pairs) return add_paths(paths_, source_of(medium), dimensions, settings.least, found);
      conceg_ctx_log(ctx_, CONCEG_LOG_WARNING,
                     "analyse: paths%s: void: the box is too small for pairs %g um apart, or has nothing "
                     "outside of cells; analyse.path_um says how far",
                     name_of(medium).c_str(), settings.least);
    };
    if (!medium.voxels.open.empty()) add(3, {medium.voxels});
    settings.starts *= 2, settings.ends /= 2; // several in each section
    add(2, medium.sections);
  }

  void composition(const LabelRuns &runs, const glm::dvec3 &spacing, double erosion) {
    CompositionSettings settings;
    settings.cubes = static_cast<int>(conceg_params_i64(params_, "composition_cubes"));
    settings.smallest = conceg_params_f64(params_, "composition_from_um");
    settings.seed = conceg_ctx_seed(ctx_);
    const double voxel = std::max({spacing.x, spacing.y, spacing.z});
    if (voxel > 0.5 * (1 + 1e-9))
      conceg_ctx_log(ctx_, CONCEG_LOG_WARNING,
                     "analyse: composition: voxels of %g um lose what is thinner; 0.25 to 0.5 um are right "
                     "(mesh.volume_step_um)",
                     voxel);
    const std::array<bool, 3> periodic = {input_.box.periodic[0] != 0, input_.box.periodic[1] != 0,
                                          input_.box.periodic[2] != 0};
    const Composition found = composition_of(runs, spacing, periodic, settings, workers_, progress());
    if (!found.rows.empty() && found.rows.back().side < 0.99 * settings.largest)
      conceg_ctx_log(
          ctx_, CONCEG_LOG_WARNING, "analyse: composition: void beyond %g um, where the box ends%s",
          found.rows.back().side,
          found.beyond_somas.rows < 3 ? "; the box is too small for an exponent beyond somas (15 um)" : "");
    write(composition_table(found, erosion)), write(composition_fit_table(found, erosion));
  }

  // Voxels outside of all cells.
  OpenVoxels open_voxels(const LabelVolume &volume) const {
    OpenVoxels out = {};
    for (int a = 0; a < 3; a++) {
      const auto axis = static_cast<std::size_t>(a);
      out.shape[axis] = volume.shape[a], out.spacing[axis] = volume.spacing[a];
      out.periodic[axis] = input_.box.periodic[a] != 0;
    }
    out.open.assign(out.shape[0] * out.shape[1] * out.shape[2], 1);
    workers_.loop(volume.leaves, 64, [&](std::size_t leaf, unsigned) {
      visit_leaf(volume, leaf, [&](std::size_t x, std::size_t y, std::size_t z, std::uint32_t label) {
        out.open[(x * out.shape[1] + y) * out.shape[2] + z] = label == 0;
      });
    });
    return out;
  }

  LabelGrid label_grid(const LabelVolume &volume) const {
    LabelGrid out = {{volume.shape[0], volume.shape[1], volume.shape[2]},
                     {},
                     {volume.spacing.x, volume.spacing.y, volume.spacing.z}};
    out.label.assign(out.shape[0] * out.shape[1] * out.shape[2], 0);
    workers_.loop(volume.leaves, 64, [&](std::size_t leaf, unsigned) {
      visit_leaf(volume, leaf, [&](std::size_t x, std::size_t y, std::size_t z, std::uint32_t label) {
        out.label[(x * out.shape[1] + y) * out.shape[2] + z] = label;
      });
    });
    return out;
  }

  conceg_ctx *ctx_;
  conceg_doc *doc_;
  const conceg_params *params_;
  const ExtracellularInput &input_;
  Workers &workers_;
  Wanted wanted_;
  std::optional<SolvedTransport> whole_box_;
  Table blocks_{"blocks"}, transport_{"transport"}, paths_{"paths"}, pores_{"pore_space"};
};

} // namespace

std::optional<SolvedTransport> measure_extracellular(conceg_ctx *ctx, conceg_doc *doc,
                                                     const conceg_params *params,
                                                     const ExtracellularInput &input, Workers &workers) {
  Extracellular all(ctx, doc, params, input, workers);
  all.run();
  return all.whole_box();
}

} // namespace conceg::analyse
