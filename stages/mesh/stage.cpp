// SPDX-License-Identifier: BSD-3-Clause
// mesh: descriptor and glue. Reads cells and skeletons, calls the mesher, writes /meshes and /volumes.
#include "conceg/conceg.h"

#include "final_check.hpp"
#include "finish.hpp"
#include "levels.hpp"
#include "output.hpp"
#include "pinch.hpp"
#include "smooth.hpp"
#include "space.hpp"
#include "view.hpp"
#include "volume_output.hpp"
#include "wrap.hpp"

#include <cmath>
#include <cstdio>

namespace {

using namespace conceg;
using namespace conceg::mesh;

constexpr char kVersion[] = "1.2.0";
constexpr double kGapReach = 1.5; // gaps are measured up to so many times the gap that is asked

const conceg_param parameters[] = {
    {"h_um", "um", "largest step of the common grid; tubes thinner than 0.92 of it may break", "0.16",
     nullptr, CONCEG_PARAM_F64, 0, 0.01, 100},
    {"gap_um", "um", "gap between cells in contact; the meshes keep at least half of it", "0.04", nullptr,
     CONCEG_PARAM_F64, 0, 0.001, 10},
    {"inflate_um", "um",
     "widens all cells before they are separated: packing control (at most a quarter of the radius)", "0",
     nullptr, CONCEG_PARAM_F64, 0, 0, 10},
    {"smooth_k", "1", "width of the fillet at forks and at the soma over the local radius", "0.3", nullptr,
     CONCEG_PARAM_F64, 0, 0, 2},
    {"cluster", "",
     "light mesh: crossings of the grid that lie nearest to one node become one vertex; false = base mesh",
     "true", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"tolerance_um", "um",
     "how far simplification may move a surface where no other is near; 0 = no simplification", "0.05",
     nullptr, CONCEG_PARAM_F64, 0, 0, 10},
    {"smooth", "",
     "one smooth surface of a single cell by OpenVDB instead of the grid's tetrahedra; not simplified",
     "false", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"volumes", "", "write label and distance volumes", "true", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"volume_step_um", "um", "largest voxel of the volumes; 0 = twice h_um", "0", nullptr, CONCEG_PARAM_F64,
     0, 0, 100},
    {"levels", "", "coarser versions of each surface beside it, for viewers; they may cross one another", "0",
     nullptr, CONCEG_PARAM_I64, 0, 0, 4},
    {"level_um", "um", "how far level 1 may lie from the surface; each further level three times as far",
     "0.2", nullptr, CONCEG_PARAM_F64, 0, 0.001, 100},
    {"space", "", "measure the extracellular space on the grid's tetrahedra, its pieces too (periodic boxes)",
     "false", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"checkpoint", "",
     "keeps finished surfaces in this file while the run goes on; after a kill the same command goes on from "
     "there",
     "", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"vdb", "", "also write the volumes as an OpenVDB file", "", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};

const char *const reads[] = {"domain", "types", "cells", "skeleton", nullptr};
const char *const writes[] = {"meshes", "volumes", nullptr};
const char *const drops[] = {nullptr};

// Everything that later code uses as an index or a length is checked here.
Tissue read_tissue(conceg_doc *doc) {
  Tissue tissue;
  tissue.box = read_box(doc);
  tissue.soma = vec3s<glm::dvec3>(doc, "/cells/soma");
  const View<float> soma_radius = view<float>(doc, "/cells/radius");
  tissue.soma_radius.assign(soma_radius.begin(), soma_radius.end());
  const View<std::uint64_t> offset = view<std::uint64_t>(doc, "/skeleton/cell_offset");
  tissue.offset.assign(offset.begin(), offset.end());
  tissue.point = vec3s<glm::dvec3>(doc, "/skeleton/position");
  const View<float> radius = view<float>(doc, "/skeleton/radius");
  tissue.radius.assign(radius.begin(), radius.end());
  const View<std::int64_t> parent = view<std::int64_t>(doc, "/skeleton/parent");
  tissue.parent.assign(parent.begin(), parent.end());
  const View<std::uint8_t> kind = view<std::uint8_t>(doc, "/skeleton/kind");
  tissue.kind.assign(kind.begin(), kind.end());
  if (has(doc, "/skeleton/branch")) {
    const View<std::uint32_t> branch = view<std::uint32_t>(doc, "/skeleton/branch");
    tissue.branch.assign(branch.begin(), branch.end());
  }
  const std::size_t points = tissue.point.size();
  if (tissue.soma_radius.size() != tissue.cells() || tissue.offset.size() != tissue.cells() + 1 ||
      tissue.radius.size() != points || tissue.parent.size() != points || tissue.kind.size() != points ||
      (!tissue.branch.empty() && tissue.branch.size() != points))
    fail(CONCEG_E_FORMAT,
         "/skeleton: expected one offset per cell and one value per point, got arrays of other lengths");
  for (std::size_t cell = 0; cell < tissue.cells(); cell++) {
    const std::uint64_t first = tissue.offset[cell], last = tissue.offset[cell + 1];
    if (last < first || last > points || (cell == 0 && first != 0))
      fail(CONCEG_E_FORMAT, "/skeleton/cell_offset[%zu]: expected ascending offsets up to %zu", cell, points);
    for (std::uint64_t i = first; i < last; i++) {
      if (tissue.parent[i] < -1 || tissue.parent[i] >= static_cast<std::int64_t>(i - first))
        fail(CONCEG_E_FORMAT, "/skeleton/parent[%zu]: expected -1 or an earlier point of the cell, got %lld",
             std::size_t(i), static_cast<long long>(tissue.parent[i]));
      const glm::dvec3 &p = tissue.point[i];
      if (!std::isfinite(p.x + p.y + p.z) || !(tissue.radius[i] > 0) || !std::isfinite(tissue.radius[i]))
        fail(CONCEG_E_RANGE, "/skeleton[%zu]: expected finite positions and radii above 0", std::size_t(i));
    }
  }
  return tissue;
}

// Of the faces that are marched, what simplification leaves at most; without it all of them.
constexpr double kSimplified = 0.5;
// Bytes a face: a chunk's half vertex and face; a finished surface in its file; its rows in the document.
constexpr double kChunkBytes = 11, kSurfaceBytes = 18, kDocumentBytes = 33;

// The room that files will take, from the area of the primitives: faces per step^2, which cells that press on
// one another only lessen.
void check_room(conceg_ctx *ctx, const Scene &scene, bool light, bool simplified,
                const std::string &side_file) {
  const double unit = scene.grid.unit, faces = (light ? 3 : 9) * primitive_area(scene),
               kept = simplified ? kSimplified * faces : faces;
  const double document = kDocumentBytes * kept > double(conceg_ctx_memory(ctx)) ? kDocumentBytes * kept : 0;
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "mesh: %.0f um2 of membrane on a grid of %.3f um: at most about %.2g faces before "
                 "simplification, %.1f GB of temporary files",
                 primitive_area(scene) * unit * unit, unit, faces,
                 1e-9 * (kChunkBytes * faces + kSurfaceBytes * kept + document));
  const double own = side_file.empty() ? kSurfaceBytes * kept : 0;
  need_free_space(conceg_ctx_tmpdir(ctx), kChunkBytes * faces + document + own, "unfinished meshes");
  if (side_file.empty()) return;
  const std::size_t slash = side_file.rfind('/');
  need_free_space(slash == std::string::npos ? "." : side_file.substr(0, slash + 1), 2 * kSurfaceBytes * kept,
                  "finished surfaces"); // once more where they are moved apart
}

void warn_thin(conceg_ctx *ctx, const Scene &scene) {
  std::size_t points = 0, cells = 0, worst = 0;
  for (std::size_t cell = 0; cell < scene.cells; cell++) {
    points += scene.thin_points[cell], cells += scene.thin_points[cell] > 0;
    if (scene.thin_points[cell] > scene.thin_points[worst]) worst = cell;
  }
  if (points)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "mesh: %zu skeleton points of %zu cells are thinner than %.3f um, which the grid of %.3f "
                   "um may break (most in cell %zu: %u); "
                   "a smaller h_um keeps them",
                   points, cells, kThinnestTube * scene.grid.unit, scene.grid.unit, worst,
                   scene.thin_points[worst]);
}

// Which cells the grid may break where a neighbour cuts into them.
void warn_pinches(conceg_ctx *ctx, const Scene &scene, const std::vector<Pinch> &pinches) {
  if (pinches.empty()) return;
  const auto worst = std::min_element(pinches.begin(), pinches.end(),
                                      [](const Pinch &l, const Pinch &r) { return l.left_um < r.left_um; });
  for (const Pinch &p : pinches)
    conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                   "mesh: cell %u may pinch off in %u segments: neighbours leave it %.3f um of %.3f um at "
                   "(%.2f, %.2f, %.2f)",
                   p.cell, p.segments, p.left_um, p.radius_um, p.where.x, p.where.y, p.where.z);
  conceg_ctx_log(
      ctx, CONCEG_LOG_WARNING,
      "mesh: %zu cells may pinch off where neighbours leave them less than the %.3f um that the grid of "
      "%.3f um holds (least in cell %u: %.3f um); -v names them, a smaller h_um keeps them",
      pinches.size(), kThinnestTube * scene.grid.unit, scene.grid.unit, worst->cell, worst->left_um);
}

// What the mesher knows to be lost.
std::vector<std::uint8_t> report_pieces(conceg_ctx *ctx, const std::vector<Pieces> &pieces,
                                        const Views &surfaces) {
  std::vector<std::uint8_t> there(pieces.size());
  for (const SurfaceView &surface : surfaces)
    there[surface.cell] = 1;
  for (std::size_t i = 0; i < pieces.size(); i++) {
    const Pieces &p = pieces[i];
    if (p.detached)
      conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                     "mesh: cell %zu: %u pieces of together %.2f um3 are cut off from the soma and left out",
                     i, p.detached, p.detached_volume);
    if (p.cavities)
      conceg_ctx_log(ctx, CONCEG_LOG_INFO, "mesh: cell %zu: %u cavities of together %.3f um3 are filled", i,
                     p.cavities, p.cavity_volume);
    if (!p.soma_found)
      conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                     "mesh: cell %zu: no piece holds the soma's centre; the largest one was kept", i);
    if (!there[i])
      conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "mesh: cell %zu: nothing of it is large enough for the grid",
                     i);
  }
  return there;
}

void report_result(conceg_ctx *ctx, const Finished &done, const FinalCheck &check, double total,
                   double icvf) {
  std::size_t faces = 0;
  std::size_t handles = 0, with_handles = 0;
  double cut = 0, area = 0, gap = check.surfaces.empty() ? 0 : check.result.min_gap[0];
  for (const SurfaceView &surface : check.surfaces)
    faces += surface.faces, area += area_of(surface);
  for (const SurfaceView &surface : check.surfaces) {
    const std::int64_t genus = (2 - euler_characteristic(surface)) / 2;
    handles += static_cast<std::size_t>(genus), with_handles += genus > 0;
  }
  for (const Pieces &p : done.pieces)
    cut += p.detached_volume;
  for (const double g : check.result.min_gap)
    gap = std::min(gap, g);
  conceg_ctx_log(
      ctx, CONCEG_LOG_INFO,
      "mesh: %zu surfaces, %zu faces (%.1f per um2; %llu before simplification), %llu vertices moved apart, "
      "%llu places repaired in %d rounds, cells fill %.4f of the box",
      check.surfaces.size(), faces, area > 0 ? double(faces) / area : 0.0,
      static_cast<unsigned long long>(done.base_faces), static_cast<unsigned long long>(done.moved_vertices),
      static_cast<unsigned long long>(done.repaired_pairs), done.rounds, icvf);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "mesh: final check: %llu pairs of faces in all images, 0 crossings, 0 folds, all closed and "
                 "outward; least gap %.4f um",
                 static_cast<unsigned long long>(check.result.pairs_checked), gap);
  if (handles)
    conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                   "mesh: %zu cells touch themselves and have %zu handles (/meshes/genus)", with_handles,
                   handles);
  if (cut > 0.01 * total)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "mesh: pieces cut off from their somas hold %.2f %% of the cell volume and are left out",
                   100 * cut / total);
}

void tell_levels(conceg_ctx *ctx, const std::vector<Level> &levels) {
  for (std::size_t i = 0; i < levels.size(); i++) {
    std::size_t faces = 0;
    for (const SurfaceView &surface : levels[i].surfaces)
      faces += surface.faces;
    conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                   "mesh: level %zu: %zu faces; %zu surfaces are those of the level before", i + 1, faces,
                   levels[i].unchanged);
  }
}

void report_space(conceg_ctx *ctx, const Space &space) {
  conceg_ctx_log(
      ctx, CONCEG_LOG_RESULT,
      "mesh: extracellular space: %.4f of the box in %llu pieces, %.4f %% of it in the largest; cells %.4f",
      space.volume, static_cast<unsigned long long>(space.pieces), 100 * space.largest, 1 - space.volume);
}

// A digest of everything that the surfaces follow from.
std::string key_of(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  std::vector<std::string> parts = {kVersion, conceg_version()};
  for (const char *group : {"/domain", "/cells", "/skeleton"}) {
    char hex[65];
    must(conceg_doc_digest(doc, group, hex));
    parts.push_back(hex);
  }
  for (const char *name : {"h_um", "gap_um", "inflate_um", "smooth_k", "tolerance_um"}) {
    char value[40];
    std::snprintf(value, sizeof value, "%a", conceg_params_f64(params, name));
    parts.push_back(value);
  }
  parts.push_back(conceg_params_bool(params, "cluster") ? "light" : "base");
  conceg_doc *list = nullptr;
  must(conceg_doc_new(ctx, &list));
  char hex[65] = "";
  put_texts(list, "/x_mesh/parts", parts);
  const conceg_status status = conceg_doc_digest(list, "/x_mesh", hex);
  must(conceg_doc_close(list));
  must(status);
  return hex;
}

// The last word: what stands in the document. Nothing is left of /meshes when it is not sound.
FinalCheck judge(conceg_doc *doc, const std::vector<std::uint8_t> &there, const FinishOptions &options,
                 Workers &workers, const Progress &progress) {
  FinalCheck check = check_document(doc, options.least_gap(), kGapReach * options.gap, options.check_memory,
                                    workers, progress);
  // Known to be lost and said so; all others must be there.
  auto &missing = check.missing;
  missing.erase(
      std::remove_if(missing.begin(), missing.end(), [&](std::uint32_t cell) { return !there[cell]; }),
      missing.end());
  const std::vector<std::string> lines = check.lines(1);
  if (lines.empty()) return check;
  must(conceg_doc_drop(doc, "/meshes"));
  fail(CONCEG_E_STAGE,
       "%s; %zu such places in all, no meshes were written: try a smaller h_um or tolerance_um=0",
       lines[0].c_str(), check.broken.size() + check.result.defects.size() + missing.size());
}

// A smooth cell in the place of what `finish` makes.
Finished finished_smooth(const Tissue &tissue, const SceneOptions &scene_options,
                         const FinishOptions &options, const glm::dvec3 &origin, Workers &workers,
                         const Progress &progress) {
  SmoothCell smooth = smooth_cell(tissue, scene_options, origin, workers, progress);
  Finished done;
  done.file = std::make_unique<SurfaceFile>(options.folder, 1);
  done.file->add(smooth.surface, nullptr);
  done.surfaces = done.file->views();
  done.pieces.push_back(smooth.pieces);
  done.repaired_pairs = smooth.repaired, done.rounds = smooth.rounds,
  done.base_faces = smooth.surface.face.size();
  return done;
}

// Tells which skeleton segments lie in pieces that are left out.
std::vector<std::uint8_t> make_meshes(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params,
                                      const Tissue &tissue, const SceneOptions &scene_options,
                                      Workers &workers, const Progress &progress, Phases &phases) {
  const std::string side_file = conceg_params_text(params, "checkpoint");
  const Scene scene = make_scene(tissue, scene_options);
  check_room(ctx, scene, scene_options.cluster, conceg_params_f64(params, "tolerance_um") > 0, side_file);
  warn_thin(ctx, scene);
  const Index index = make_index(scene, workers, progress);
  warn_pinches(ctx, scene, predict_pinches(scene, index, workers));
  workers.count(ctx, "mesh.index");
  phases.end("index");
  if (conceg_params_bool(params, "space"))
    report_space(ctx, extracellular_space(scene, index, workers, progress)), phases.end("space");
  std::vector<glm::dvec3> origin;
  for (const glm::dvec3 &soma : tissue.soma)
    origin.push_back(snap(soma));
  FinishOptions options;
  options.tolerance = conceg_params_f64(params, "tolerance_um");
  options.gap = scene_options.gap, options.cluster = scene_options.cluster;
  options.check_memory = std::min<std::size_t>(1u << 30, conceg_ctx_memory(ctx) / 4);
  options.folder = conceg_ctx_tmpdir(ctx), options.side_file = side_file;
  if (!side_file.empty()) options.key = key_of(ctx, doc, params);
  const Finished done = conceg_params_bool(params, "smooth")
                            ? finished_smooth(tissue, scene_options, options, origin[0], workers, progress)
                            : finish(scene, index, {origin, tissue.soma, tissue.soma_radius}, tissue.box,
                                     options, workers, progress);
  workers.count(ctx, "mesh.surfaces");
  phases.end("surfaces");
  if (done.taken_over)
    conceg_ctx_log(ctx, CONCEG_LOG_INFO, "mesh: %zu cells taken over from %s", done.taken_over,
                   side_file.c_str());
  const std::vector<std::uint8_t> there = report_pieces(ctx, done.pieces, done.surfaces);
  const std::vector<Level> levels =
      make_levels(done.surfaces, tissue.cells(), static_cast<int>(conceg_params_i64(params, "levels")),
                  conceg_params_f64(params, "level_um"), options.folder, workers, progress);
  tell_levels(ctx, levels);
  must(conceg_doc_drop(doc, "/meshes"));
  write_surfaces(doc, scene, index, done, levels, workers);
  workers.count(ctx, "mesh.faces");
  phases.end("write");
  const FinalCheck check = judge(doc, there, options, workers, progress);
  const double total =
      write_measures(doc, tissue.box, scene, check, done.pieces, levels, options.gap, workers);
  report_result(ctx, done, check, total, view<double>(doc, "/meshes@icvf")[0]);
  phases.end("final check");
  if (!side_file.empty()) std::remove(side_file.c_str());
  return left_out_segments(tissue, check.surfaces, done.pieces, workers);
}

void run_mesh(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const Tissue tissue = read_tissue(doc);
  SceneOptions options;
  options.h = conceg_params_f64(params, "h_um");
  options.gap = conceg_params_f64(params, "gap_um");
  options.inflate = conceg_params_f64(params, "inflate_um");
  options.smooth = conceg_params_f64(params, "smooth_k");
  options.cluster = conceg_params_bool(params, "cluster") != 0;
  Workers workers(conceg_ctx_threads(ctx));
  const Progress progress = progress_of(ctx);
  Phases phases;
  if (conceg_params_bool(params, "smooth") && tissue.cells() != 1)
    fail(CONCEG_E_RANGE, "smooth: expected a single cell, got %zu; leave smooth out", tissue.cells());
  VolumeOutput volume(ctx, params, tissue, options, workers);
  phases.end("volume laid out");
  volume.leave_out(ctx, tissue, make_meshes(ctx, doc, params, tissue, options, workers, progress, phases),
                   workers);

  must(conceg_doc_drop(doc, "/volumes"));
  volume.write(ctx, doc, workers);
  phases.end("volume");
  tell_phases(ctx, "mesh", phases, workers.busy_s(), workers.threads());
}

conceg_status check(conceg_ctx *ctx, conceg_doc *, const conceg_params *params) {
  return guard(ctx, "mesh", [&] {
    if (vdb_available()) return;
    if (*conceg_params_text(params, "vdb") || conceg_params_bool(params, "smooth"))
      fail(CONCEG_E_UNSUPPORTED, "vdb, smooth: this build has no OpenVDB; install libopenvdb-dev and build "
                                 "again, or leave both out");
  });
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "mesh", [&] { run_mesh(ctx, doc, params); });
}

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_mesh;
const conceg_stage conceg_stage_mesh = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "mesh",
    "tetrahedra",
    kVersion,
    "turns skeletons into closed surfaces that touch neither each other nor their own images",
    "conceg mesh --vdb cube.vdb < relaxed.cgx > cube.cgx",
    parameters,
    reads,
    writes,
    drops,
    CONCEG_STAGE_THREADED,
    check,
    run,
};
