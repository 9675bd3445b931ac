// SPDX-License-Identifier: BSD-3-Clause
// The analyse stage: tables that say what is in the tissue.
#include "compare_input.hpp"
#include "compare_report.hpp"
#include "diffusivity_measure.hpp"
#include "experiment_tables.hpp"
#include "extracellular.hpp"
#include "spectrum.hpp"
#include "structure_stage.hpp"
#include "tables.hpp"

#include "conceg/stage.h"

#include <algorithm>
#include <optional>

namespace {

using namespace conceg;
using namespace conceg::analyse;

template <class T> std::vector<T> values(conceg_doc *doc, const char *path, std::size_t columns = 1) {
  const View<T> v = view<T>(doc, path, columns);
  return std::vector<T>(v.begin(), v.end());
}

Cells read_cells(conceg_doc *doc) {
  Cells c;
  c.type_name = texts(doc, "/types/name"), c.type_class = texts(doc, "/types/class");
  c.id = values<std::uint64_t>(doc, "/cells/id"), c.type = values<std::uint32_t>(doc, "/cells/type");
  c.soma = vec3s<glm::dvec3>(doc, "/cells/soma"), c.soma_radius = values<float>(doc, "/cells/radius");
  const View<double> pia = view<double>(doc, "/domain@pia", 3);
  c.pia = glm::dvec3(pia[0], pia[1], pia[2]);
  check(c);
  return c;
}

Skeletons read_skeletons(conceg_doc *doc, const Cells &cells) {
  Skeletons s;
  s.cell_offset = values<std::uint64_t>(doc, "/skeleton/cell_offset");
  s.position = vec3s<glm::dvec3>(doc, "/skeleton/position");
  s.radius = values<float>(doc, "/skeleton/radius"), s.parent = values<std::int64_t>(doc, "/skeleton/parent");
  s.kind = values<std::uint8_t>(doc, "/skeleton/kind");
  check(s, cells);
  return s;
}

// Closed surfaces of the finest level; `left_out` counts the others.
Meshes read_meshes(conceg_doc *doc, const Cells &cells, std::size_t &left_out) {
  Meshes all, chosen;
  all.cell = values<std::uint32_t>(doc, "/meshes/cell");
  all.vertex_offset = values<std::uint64_t>(doc, "/meshes/vertex_offset"),
  all.face_offset = values<std::uint64_t>(doc, "/meshes/face_offset");
  all.vertex = vec3s<glm::dvec3>(doc, "/meshes/vertex"),
  all.face = values<std::uint32_t>(doc, "/meshes/face", 3);
  check(all, cells);
  const std::size_t surfaces = all.cell.size();
  const std::vector<std::string> form =
      has(doc, "/meshes/form") ? texts(doc, "/meshes/form") : std::vector<std::string>(surfaces, "closed");
  const std::vector<std::uint8_t> lod = has(doc, "/meshes/lod") ? values<std::uint8_t>(doc, "/meshes/lod")
                                                                : std::vector<std::uint8_t>(surfaces, 0);
  if (form.size() != surfaces || lod.size() != surfaces)
    fail(CONCEG_E_FORMAT, "/meshes: expected %zu values of form and lod, got %zu and %zu", surfaces,
         form.size(), lod.size());
  const auto wanted = [&](std::size_t k) { return form[k] == "closed" && lod[k] == 0; };
  left_out = 0;
  for (std::size_t k = 0; k < surfaces; k++)
    left_out += !wanted(k);
  if (!left_out) return all;
  chosen.vertex_offset = chosen.face_offset = {0};
  for (std::size_t k = 0; k < surfaces; k++) {
    if (!wanted(k)) continue;
    const auto at = [](auto &vector, std::uint64_t i) {
      return vector.begin() + static_cast<std::ptrdiff_t>(i);
    };
    chosen.cell.push_back(all.cell[k]);
    chosen.vertex.insert(chosen.vertex.end(), at(all.vertex, all.vertex_offset[k]),
                         at(all.vertex, all.vertex_offset[k + 1]));
    chosen.face.insert(chosen.face.end(), at(all.face, 3 * all.face_offset[k]),
                       at(all.face, 3 * all.face_offset[k + 1]));
    chosen.vertex_offset.push_back(chosen.vertex.size()),
        chosen.face_offset.push_back(chosen.face.size() / 3);
  }
  return chosen;
}

Bars read_bars(conceg_doc *doc, const Cells &cells) {
  Bars b;
  b.cell_offset = values<std::uint64_t>(doc, "/bars/cell_offset");
  b.asked_start = values<double>(doc, "/bars/asked_start"),
  b.asked_end = values<double>(doc, "/bars/asked_end");
  b.achieved_start = values<double>(doc, "/bars/achieved_start"),
  b.achieved_end = values<double>(doc, "/bars/achieved_end");
  b.state = values<std::uint8_t>(doc, "/bars/state");
  check(b, cells);
  return b;
}

BarLinks read_links(conceg_doc *doc, const Bars &bars) {
  BarLinks links;
  links.parent = values<std::int64_t>(doc, "/bars/parent");
  links.neurite = values<std::uint8_t>(doc, "/bars/neurite"),
  links.angle = values<double>(doc, "/bars/angle");
  check(links, bars);
  return links;
}

// A type is compared with its entry; types without one are named.
std::vector<std::string> read_type_entries(conceg_ctx *ctx, conceg_doc *doc, const Cells &cells,
                                           const std::vector<Entry> &entries) {
  std::vector<std::string> names = has(doc, "/types/entry")
                                       ? texts(doc, "/types/entry")
                                       : std::vector<std::string>(cells.type_name.size());
  if (names.size() != cells.type_name.size())
    fail(CONCEG_E_FORMAT, "/types/entry: expected %zu values, got %zu", cells.type_name.size(), names.size());
  for (std::size_t type = 0; type < names.size(); type++)
    if (std::none_of(entries.begin(), entries.end(), [&](const Entry &e) { return e.name == names[type]; }))
      conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                     "analyse: compare: cells of type %s are left out: no entry \"%s\"",
                     cells.type_name[type].c_str(), names[type].c_str());
  return names;
}

void compare_document(conceg_ctx *ctx, conceg_doc *doc, const Cells &cells, Workers &workers) {
  CompareInput input;
  input.entries = read_entries(doc);
  if (!has(doc, "/skeleton/position"))
    fail(CONCEG_E_MISSING, "compare: the document has no /skeleton; give one with grown cells");
  input.type_name = cells.type_name, input.type = cells.type;
  input.type_entry = read_type_entries(ctx, doc, cells, input.entries);
  input.grown = grown_shapes(cells, read_skeletons(doc, cells), workers, progress_of(ctx));
  std::vector<BarsRow> bars;
  if (has(doc, "/bars/achieved_end")) {
    must(conceg_doc_validate(doc, "/bars", nullptr, nullptr));
    const Bars asked = read_bars(doc, cells);
    const BarLinks links = read_links(doc, asked);
    input.drawn = drawn_shapes(asked, links);
    bars = compare_bars(input, asked, links.parent);
  }
  const std::vector<ComparisonRow> rows = compare(input);
  for (const Table &table : {comparison_table(input, rows), comparison_bars_table(bars)})
    if (table.rows()) write_table(doc, table);
  for (const std::string &line : comparison_lines(input, rows, bars))
    conceg_ctx_log(ctx, CONCEG_LOG_RESULT, "%s", line.c_str());
}

void log_table(conceg_ctx *ctx, const Table &table) {
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "--- %s", table.name.c_str());
  for (const std::string &line : table.lines())
    conceg_ctx_log(ctx, CONCEG_LOG_INFO, "%s", line.c_str());
}

void measure_meshes(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params, const Cells &cells,
                    const conceg_box &box, Workers &workers, Measures &measures) {
  std::size_t left_out = 0;
  const Meshes meshes = read_meshes(doc, cells, left_out);
  if (left_out)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "analyse: %zu surfaces left out (not closed, or not of the finest level)", left_out);
  const std::vector<Size> surfaces = surface_sizes(meshes, box, workers);
  measures.sizes.resize(cells.type.size());
  for (std::size_t k = 0; k < surfaces.size(); k++) {
    measures.sizes[meshes.cell[k]].volume += surfaces[k].volume;
    measures.sizes[meshes.cell[k]].area += surfaces[k].area;
  }
  measures.points =
      locate_points(meshes, box, static_cast<std::uint64_t>(conceg_params_i64(params, "points")),
                    conceg_ctx_seed(ctx), workers, progress_of(ctx));
}

// Half of the meshes' grid, or 0.125 um when there is none, unless the parameter says otherwise.
double field_step(conceg_doc *doc, const conceg_params *params) {
  const double asked = conceg_params_f64(params, "field_step_um");
  if (asked > 0) return asked;
  const double grid = has(doc, "/meshes@grid_step") ? view<double>(doc, "/meshes@grid_step")[0] : 0.25;
  return grid > 0.02 && grid < 100 ? 0.5 * grid : 0.125;
}

LabelVolume read_volume(conceg_doc *doc, const Cells &cells, const conceg_box &box) {
  const View<double> origin = view<double>(doc, "/volumes@origin", 3),
                     spacing = view<double>(doc, "/volumes@spacing", 3);
  const View<std::uint64_t> shape = view<std::uint64_t>(doc, "/volumes@shape", 3);
  const View<std::int32_t> leaf = view<std::int32_t>(doc, "/volumes/leaf_origin", 3);
  const View<std::uint32_t> label = view<std::uint32_t>(doc, "/volumes/label", 512);
  if (label.rows() != leaf.rows())
    fail(CONCEG_E_FORMAT, "/volumes/label: expected %zu leaves, got %zu", leaf.rows(), label.rows());
  const LabelVolume volume = {{origin[0], origin[1], origin[2]},
                              {spacing[0], spacing[1], spacing[2]},
                              {shape[0], shape[1], shape[2]},
                              leaf.rows(),
                              leaf.data(),
                              label.data()};
  check(volume, cells, box);
  return volume;
}

void measure_pores(conceg_doc *doc, const Cells &cells, const conceg_box &box, Workers &workers,
                   Measures &measures) {
  const LabelVolume volume = read_volume(doc, cells, box);
  const View<float> distance = view<float>(doc, "/volumes/distance", 512);
  if (distance.rows() != volume.leaves)
    fail(CONCEG_E_FORMAT, "/volumes/distance: expected %zu leaves, got %zu", volume.leaves, distance.rows());
  measures.pores = pore_sizes(volume, distance.data(), workers);
}

// Paths of each class apart; classes without a path that is long enough are told.
void measure_spectra(conceg_ctx *ctx, conceg_doc *doc, const Cells &cells, Workers &workers) {
  if (!has(doc, "/skeleton/position"))
    fail(CONCEG_E_MISSING, "spectrum: the document has no /skeleton; give one with grown cells");
  const Skeletons skeletons = read_skeletons(doc, cells);
  SpectrumSettings settings;
  settings.seed = conceg_ctx_seed(ctx);
  std::vector<ClassSpectrum> found;
  for (const std::string &name : classes_of(cells)) {
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t cell = 0; cell < cells.type.size(); cell++)
      if (cells.type_class[cells.type[cell]] == name) chosen.push_back(cell);
    const AreaPaths paths = area_paths(skeletons, chosen, name == "axon", settings);
    if (paths.profiles.empty())
      conceg_ctx_log(
          ctx, CONCEG_LOG_WARNING,
          "analyse: spectrum: void for class %s: none of %llu paths from root to tip reaches %g um",
          name.c_str(), static_cast<unsigned long long>(paths.tips), settings.skip + settings.length);
    else
      found.push_back({name, paths.tips, paths.spacing, spectrum_of(paths, settings, workers)});
  }
  for (const Table &table : {spectrum_table(found), spectrum_fit_table(found)})
    if (table.rows()) write_table(doc, table);
  if (!found.empty()) log_table(ctx, spectrum_fit_table(found));
}

// From the labels of /volumes where their voxels are as small as those asked for, else from the skeletons.
void measure_field(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params, const Cells &cells,
                   const conceg_box &box, Workers &workers, Measures &measures) {
  measures.field_step = field_step(doc, params);
  if (has(doc, "/volumes/label") && has(doc, "/volumes@spacing")) {
    const View<double> spacing = view<double>(doc, "/volumes@spacing", 3);
    const double largest = std::max({spacing[0], spacing[1], spacing[2]});
    if (largest <= measures.field_step * (1 + 1e-9)) {
      measures.field_step = largest;
      measures.field = label_shares(read_volume(doc, cells, box), cells, box, workers);
      conceg_ctx_log(ctx, CONCEG_LOG_INFO, "analyse: the field's volume fraction is that of /volumes/label");
      return;
    }
  }
  if (!has(doc, "/skeleton/position")) return;
  measures.field =
      field_shares(cells, read_skeletons(doc, cells), box, measures.field_step, workers, progress_of(ctx));
}

void analyse_document(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const conceg_box box = read_box(doc);
  const Cells cells = read_cells(doc);
  Workers workers(conceg_ctx_threads(ctx));
  Measures measures;
  measures.box_volume = volume(box);
  const auto leave_out = [&](const char *group, const char *what) {
    conceg_ctx_log(ctx, CONCEG_LOG_INFO, "analyse: no %s, so without %s", group, what);
  };
  if (has(doc, "/skeleton/position")) {
    const Skeletons skeletons = read_skeletons(doc, cells);
    measures.cable = measure_cable(skeletons);
    measures.shape = measure_shape(cells, skeletons);
  } else {
    leave_out("/skeleton", "cable and morphometry");
  }
  measure_field(ctx, doc, params, cells, box, workers, measures);
  if (has(doc, "/volumes/label") && has(doc, "/volumes/distance") && has(doc, "/volumes@spacing"))
    measure_pores(doc, cells, box, workers, measures);
  if (!measures.field.voxels)
    leave_out("/skeleton or /volumes as fine as field_step_um", "the field's volume fraction");
  if (has(doc, "/meshes/vertex"))
    measure_meshes(ctx, doc, params, cells, box, workers, measures);
  else
    leave_out("/meshes", "mesh volumes, surfaces and located points");
  if (has(doc, "/bars/achieved_end"))
    measures.bars = count_bars(read_bars(doc, cells));
  else
    leave_out("/bars", "asked and achieved bars");

  for (const char *name : {"summary",         "class",    "type",         "neurite",         "bars",
                           "morphometry",     "cell",     "comparison",   "comparison_bars", "composition",
                           "composition_fit", "spectrum", "spectrum_fit", "transport",       "pore_space",
                           "paths",           "blocks",   "diffusivity",  "diffusivity_fit", "lambda"})
    must(conceg_doc_drop(doc, (std::string("/statistics/") + name).c_str()));
  for (const Table &table :
       {summary_table(cells, measures), class_table(cells, measures), type_table(cells, measures),
        neurite_table(cells, measures), bars_table(cells, measures), morphometry_table(cells, measures),
        cell_table(cells, measures)}) {
    if (!table.rows()) continue;
    write_table(doc, table);
    if (table.name != "cell" && table.name != "type") log_table(ctx, table);
  }
  if (conceg_params_bool(params, "compare")) compare_document(ctx, doc, cells, workers);
  const StructureOptions structure = {conceg_params_text(params, "structure"),
                                      conceg_params_text(params, "structure_pool"),
                                      conceg_params_text(params, "structure_dir")};
  drop_structure(doc);
  if (structure.asked()) {
    if (!has(doc, "/skeleton/position"))
      fail(CONCEG_E_MISSING, "structure: the document has no /skeleton; give one with grown cells");
    measure_structure(ctx, doc, structure, cells, read_skeletons(doc, cells), workers);
  }
  const bool labels = has(doc, "/volumes/label") && has(doc, "/volumes@spacing");
  const std::optional<SolvedTransport> solved = measure_extracellular(
      ctx, doc, params,
      {labels, has(doc, "/meshes/vertex"), measures.pores.voxels ? measures.pores.median : 0.0, box,
       [&] { return read_volume(doc, cells, box); },
       [&] {
         std::size_t left_out = 0;
         return read_meshes(doc, cells, left_out);
       }},
      workers);
  if (conceg_params_bool(params, "diffusivity"))
    measure_diffusivity(ctx, doc, params, cells, solved ? &solved->limit : nullptr,
                        solved ? &solved->fine : nullptr, workers);
  if (conceg_params_bool(params, "spectrum")) measure_spectra(ctx, doc, cells, workers);
  workers.count(ctx, "analyse.items");
  const double difference = largest_difference(measures),
               allowed = conceg_params_f64(params, "icvf_tolerance");
  if (difference > allowed)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "analyse: the volume fraction's measures differ by %.4f (allowed %.4f): mesh %.4f, field "
                   "%.4f, points %.4f",
                   difference, allowed, mesh_fraction(measures), measures.field.soma + measures.field.neurite,
                   measures.points.inside);
  if (measures.points.in_several)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "analyse: %llu of %llu points lie in more than one cell: the meshes are not disjoint",
                   static_cast<unsigned long long>(measures.points.in_several),
                   static_cast<unsigned long long>(measures.points.points));
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "analyse", [&] { analyse_document(ctx, doc, params); });
}

const conceg_param parameters[] = {
    {"points", "1", "random points located in the meshes (0 = none)", "1000000", nullptr, CONCEG_PARAM_I64, 0,
     0, 1e9},
    {"field_step_um", "um", "voxel of the field's volume fraction; 0 = half of the meshes' grid", "0",
     nullptr, CONCEG_PARAM_F64, 0, 0, 10},
    {"icvf_tolerance", "1", "difference of the three volume fractions that is not warned about", "0.005",
     nullptr, CONCEG_PARAM_F64, 0, 0, 1},
    {"compare", "", "hold the grown cells against what they were asked for and against the dictionary",
     "false", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"structure", "",
     "document of real cells (characterise) that no cell was grown from: the grown cells are held against "
     "them",
     "", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"structure_pool", "",
     "documents that were analysed so before, separated by commas: their cells are added", "", nullptr,
     CONCEG_PARAM_FILE, 0, 0, 0},
    {"structure_dir", "", "folder for its tables as comma-separated files and its figure; made when absent",
     "", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"composition", "",
     "composition scaling: the largest piece of one cell in cubes of 2 to 75 um, from /volumes", "false",
     nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"composition_cubes", "1", "cubes of each length", "200", nullptr, CONCEG_PARAM_I64, 0, 8, 100000},
    {"composition_from_um", "um", "shortest side of the cubes; the box must be twice as long", "2", nullptr,
     CONCEG_PARAM_F64, 0, 0.1, 15},
    {"pores", "",
     "sizes of the extracellular space by five definitions, in space and in sections, from /volumes", "false",
     nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"paths", "", "straightness of paths through the extracellular space, from /volumes", "false", nullptr,
     CONCEG_PARAM_BOOL, 0, 0, 0},
    {"transport", "", "transport tortuosity lambda of the extracellular space, from /volumes", "false",
     nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"path_um", "um", "paths: how far apart start and end are at least", "10", nullptr, CONCEG_PARAM_F64, 0,
     0.1, 1000},
    {"erode_to", "1",
     "draw labels that touch back from their membranes until this share of sections across z is "
     "extracellular "
     "(0 = not)",
     "0", nullptr, CONCEG_PARAM_F64, 0, 0, 0.9},
    {"blocks", "1",
     "cut so many blocks out of the meshes, for pores, paths and transport (0 = the whole box)", "0", nullptr,
     CONCEG_PARAM_I64, 0, 0, 1000},
    {"block_um", "um", "side of a block", "10", nullptr, CONCEG_PARAM_F64, 0, 1, 100},
    {"block_voxel_um", "um",
     "largest voxel of a block; 0 = an eighth of the median cleft of /volumes, or 0.05 um without", "0",
     nullptr, CONCEG_PARAM_F64, 0, 0, 1},
    {"spectrum", "", "power spectrum of the cross-section along paths of 100 um", "false", nullptr,
     CONCEG_PARAM_BOOL, 0, 0, 0},
    {"diffusivity", "",
     "D(t), K(t), structural exponent and lambda of the walkers, from /walkers/displacement", "false",
     nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"tail_from_ms", "ms", "where fits of D(t) begin; 0 = a tenth of the last time", "0", nullptr,
     CONCEG_PARAM_F64, 0, 0, 1e4},
    {"tail_to_ms", "ms", "where fits of D(t) end; 0 = the last time", "0", nullptr, CONCEG_PARAM_F64, 0, 0,
     1e4},
    {"csv", "", "folder for diffusivity.csv, diffusivity_fit.csv and lambda.csv; made when absent", "",
     nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};
const char *const reads[] = {"domain", "types", "cells", nullptr};
const char *const writes[] = {"statistics", nullptr};
const char *const drops[] = {nullptr};

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_analyse;
const conceg_stage conceg_stage_analyse = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "analyse",
    "tables",
    "1.0.0",
    "measures volumes, surfaces, cable, branches and bars, and writes them as tables",
    "conceg analyse < cube.cgx > analysed.cgx",
    parameters,
    reads,
    writes,
    drops,
    CONCEG_STAGE_THREADED,
    nullptr,
    run,
};
