// SPDX-License-Identifier: BSD-3-Clause
// mesh: descriptor and glue. Reads cells and skeletons, calls the mesher, writes /meshes and /volumes.
#include "conceg/conceg.h"

#include "components.hpp"
#include "extract.hpp"
#include "faces.hpp"
#include "finish.hpp"
#include "pinch.hpp"
#include "smooth.hpp"
#include "space.hpp"
#include "volume_output.hpp"
#include "wrap.hpp"

#include <algorithm>
#include <cmath>

namespace {

using namespace conceg;
using namespace conceg::mesh;

const conceg_param parameters[] = {
    {"h_um", "um", "largest step of the common grid; tubes thinner than 0.92 of it may break", "0.16",
     nullptr, CONCEG_PARAM_F64, 0, 0.01, 100},
    {"gap_um", "um", "gap between cells in contact; the meshes keep at least a third of it", "0.06", nullptr,
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
    {"space", "", "measure the extracellular space on the grid's tetrahedra, its pieces too (periodic boxes)",
     "false", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
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

// What the mesh will take, from the area of the primitives: faces per step^2, and bytes a face in all.
void predict_cost(conceg_ctx *ctx, const Scene &scene, bool light) {
  const double unit = scene.grid.unit, faces = (light ? 3 : 9) * primitive_area(scene),
               bytes = (light ? 60 : 100) * faces;
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "mesh: %.0f um2 of membrane on a grid of %.3f um: about %.2g faces before simplification",
                 primitive_area(scene) * unit * unit, unit, faces);
  if (bytes > double(conceg_ctx_memory(ctx)))
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "mesh: about %.1f GB of memory will be needed, more than the %.1f GB asked for; a larger "
                   "h_um needs less",
                   1e-9 * bytes, 1e-9 * double(conceg_ctx_memory(ctx)));
}

// Names the cells that the grid may break, narrowest first.
void warn_narrow(conceg_ctx *ctx, const Scene &scene, const std::vector<Narrow> &narrow) {
  constexpr std::size_t most = 5;
  std::vector<std::size_t> cells;
  for (std::size_t cell = 0; cell < narrow.size(); cell++)
    if (narrow[cell].places) cells.push_back(cell);
  if (cells.empty()) return;
  std::stable_sort(cells.begin(), cells.end(),
                   [&](std::size_t l, std::size_t r) { return narrow[l].least < narrow[r].least; });
  conceg_ctx_log(
      ctx, CONCEG_LOG_WARNING,
      "mesh: %zu cells have places with less than the %.3f um that a grid of %.3f um is sure to hold, "
      "and may break there; a smaller h_um keeps them. The narrowest:",
      cells.size(), kThinnestTube * scene.grid.unit, scene.grid.unit);
  for (std::size_t i = 0; i < std::min(most, cells.size()); i++) {
    const Narrow &place = narrow[cells[i]];
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "mesh: cell %zu: %.3f um at (%.2f, %.2f, %.2f) um, %llu places in all", cells[i],
                   std::max(0.0, place.least), place.where.x, place.where.y, place.where.z,
                   static_cast<unsigned long long>(place.places));
  }
}

void report_pieces(conceg_ctx *ctx, const std::vector<Pieces> &pieces, const std::vector<Surface> &surfaces) {
  std::vector<std::uint8_t> there(pieces.size());
  for (const Surface &surface : surfaces)
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
}

template <class T> T *fill(conceg_doc *doc, const char *path, std::uint64_t rows, std::uint64_t columns = 1) {
  const std::uint64_t shape[2] = {rows, columns};
  void *storage = nullptr;
  must(conceg_doc_new_array(doc, path, dtype_of<T>::value, columns == 1 ? 1 : 2, shape, &storage));
  return static_cast<T *>(storage);
}

void write_geometry(conceg_doc *doc, const std::vector<Surface> &surfaces) {
  std::vector<std::uint64_t> vertex_offset = {0}, face_offset = {0};
  std::vector<std::uint32_t> cell;
  std::vector<glm::dvec3> origin;
  for (const Surface &surface : surfaces) {
    cell.push_back(surface.cell), origin.push_back(surface.origin);
    vertex_offset.push_back(vertex_offset.back() + surface.vertex.size());
    face_offset.push_back(face_offset.back() + surface.face.size());
  }
  put(doc, "/meshes/cell", cell);
  put(doc, "/meshes/lod", std::vector<std::uint8_t>(surfaces.size()));
  put_texts(doc, "/meshes/form", std::vector<std::string>(surfaces.size(), "closed"));
  put3(doc, "/meshes/origin", origin);
  put(doc, "/meshes/lift", std::vector<std::int32_t>(surfaces.size() * 3), 3);
  put(doc, "/meshes/vertex_offset", vertex_offset);
  put(doc, "/meshes/face_offset", face_offset);
  double *vertex = fill<double>(doc, "/meshes/vertex", vertex_offset.back(), 3);
  for (const Surface &surface : surfaces)
    for (std::uint32_t v = 0; v < surface.vertex.size(); v++) {
      const glm::dvec3 p = surface.at(v);
      *vertex++ = p.x, *vertex++ = p.y, *vertex++ = p.z;
    }
  std::uint32_t *face = fill<std::uint32_t>(doc, "/meshes/face", face_offset.back(), 3);
  for (const Surface &surface : surfaces)
    for (const glm::uvec3 &f : surface.face)
      *face++ = f.x, *face++ = f.y, *face++ = f.z;
}

void write_faces(conceg_doc *doc, const Scene &scene, const Index &index,
                 const std::vector<Surface> &surfaces, Workers &workers) {
  std::vector<std::uint8_t> compartment;
  std::vector<std::uint32_t> section;
  for (const Surface &surface : surfaces) {
    const FaceLabels labels = label_faces(scene, index, surface, workers);
    compartment.insert(compartment.end(), labels.compartment.begin(), labels.compartment.end());
    section.insert(section.end(), labels.section.begin(), labels.section.end());
  }
  put(doc, "/meshes/compartment", compartment);
  put(doc, "/meshes/component", std::vector<std::uint32_t>(compartment.size())); // one piece per cell is kept
  put(doc, "/meshes/section", section);
}

void write_measures(conceg_doc *doc, const Tissue &tissue, const Scene &scene,
                    const std::vector<Surface> &surfaces, const CheckResult &check,
                    const std::vector<Pieces> &pieces, double gap) {
  std::vector<double> volumes, areas, detached;
  std::vector<std::int64_t> genus;
  double inside = 0;
  for (const Surface &surface : surfaces) {
    volumes.push_back(volume_of(surface));
    areas.push_back(area_of(surface));
    genus.push_back((2 - euler_characteristic(surface)) / 2);
    detached.push_back(pieces[surface.cell].detached_volume);
    inside += volume_inside(surface, tissue.box);
  }
  put(doc, "/meshes/volume", volumes);
  put(doc, "/meshes/area", areas);
  put(doc, "/meshes/genus", genus);
  put(doc, "/meshes/closed", check.closed);
  put(doc, "/meshes/min_gap", check.min_gap);
  put(doc, "/meshes/detached_volume", detached);
  put_scalar(doc, "/meshes@icvf", inside / volume(tissue.box));
  put_scalar(doc, "/meshes@grid_step", std::max({scene.grid.step.x, scene.grid.step.y, scene.grid.step.z}));
  put_scalar(doc, "/meshes@gap", gap);
  put_scalar(doc, "/meshes@crossings", check.crossings);
  put_scalar(doc, "/meshes@pairs_checked", check.pairs_checked);
}

void report_result(conceg_ctx *ctx, const Tissue &tissue, const Finished &done) {
  std::size_t faces = 0;
  double total = 0, cut = 0;
  for (const Surface &surface : done.surfaces)
    faces += surface.face.size(), total += volume_of(surface);
  for (const Pieces &p : done.pieces)
    cut += p.detached_volume;
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "mesh: %zu surfaces, %zu faces (%llu before simplification), %llu pairs checked, 0 "
                 "crossings, %llu places repaired "
                 "in %d rounds, "
                 "cells fill %.4f of the box",
                 done.surfaces.size(), faces, static_cast<unsigned long long>(done.base_faces),
                 static_cast<unsigned long long>(done.check.pairs_checked),
                 static_cast<unsigned long long>(done.repaired_pairs), done.rounds,
                 total / volume(tissue.box));
  if (cut > 0.01 * total)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "mesh: pieces cut off from their somas hold %.2f %% of the cell volume and are left out",
                   100 * cut / total);
}

void report_space(conceg_ctx *ctx, const Space &space) {
  conceg_ctx_log(
      ctx, CONCEG_LOG_RESULT,
      "mesh: extracellular space: %.4f of the box in %llu pieces, %.4f %% of it in the largest; cells %.4f",
      space.volume, static_cast<unsigned long long>(space.pieces), 100 * space.largest, 1 - space.volume);
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
  const bool smooth = conceg_params_bool(params, "smooth") != 0;
  if (smooth && tissue.cells() != 1)
    fail(CONCEG_E_RANGE, "smooth: expected a single cell, got %zu; leave smooth out", tissue.cells());
  const VolumeOutput volume(ctx, params, tissue, options, workers);
  const Scene scene = make_scene(tissue, options);
  predict_cost(ctx, scene, options.cluster);
  const Index index = make_index(scene, workers, progress);
  workers.count(ctx, "mesh.index");
  warn_narrow(ctx, scene, narrow_places(scene, index, workers));
  if (conceg_params_bool(params, "space"))
    report_space(ctx, extracellular_space(scene, index, workers, progress));
  std::vector<glm::dvec3> origin;
  for (const glm::dvec3 &soma : tissue.soma)
    origin.push_back(snap(soma));
  FinishOptions finish_options;
  finish_options.tolerance = conceg_params_f64(params, "tolerance_um");
  finish_options.gap = options.gap;
  finish_options.cluster = options.cluster;
  const Finished done = smooth ? smooth_cell(tissue, options, origin[0], workers, progress)
                               : finish(scene, index, {origin, tissue.soma, tissue.soma_radius}, tissue.box,
                                        finish_options, workers, progress);
  workers.count(ctx, "mesh.surfaces");
  report_pieces(ctx, done.pieces, done.surfaces);
  if (done.check.errors)
    for (const Defect &defect : done.check.defects)
      if (defect.flaw != Flaw::near)
        fail(CONCEG_E_STAGE,
             "%s; %llu such places in all, nothing was written: try a smaller h_um or tolerance_um=0",
             describe(defect, done.surfaces).c_str(), static_cast<unsigned long long>(done.check.errors));

  must(conceg_doc_drop(doc, "/meshes"));
  must(conceg_doc_drop(doc, "/volumes"));
  write_geometry(doc, done.surfaces);
  write_faces(doc, scene, index, done.surfaces, workers);
  write_measures(doc, tissue, scene, done.surfaces, done.check, done.pieces, options.gap);
  workers.count(ctx, "mesh.faces");
  report_result(ctx, tissue, done);
  volume.write(ctx, doc, workers);
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
    "1.0.0",
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
