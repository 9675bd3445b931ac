// SPDX-License-Identifier: BSD-3-Clause
// The volume fraction by three measures, the label volume, the extracellular space, and walkers.
#include "gates.hpp"
#include "rows.hpp"

#include "space.hpp"
#include "surface.hpp"
#include "wrap.hpp"

#include "conceg/query.h"
#include "conceg/rng.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numeric>

namespace conceg::gates {
namespace {

constexpr int kLeaf = 8;
constexpr std::size_t kLeafVoxels = kLeaf * kLeaf * kLeaf;
constexpr std::size_t kBatch = 4096;   // points located at once
constexpr double kFewVoxels = 2000;    // fewer do not tell a cell's volume
constexpr double kClear = 1.0;         // voxels from a membrane: nearer ones are not compared
constexpr double kMisplaced = 0.005;   // share of clear voxels with another label than their cell
constexpr std::uint64_t kSeed = 20261; // of the points
const char *const in_box = "volume fraction by points", *const by_labels = "volume fraction by labels",
                  *const of_cells = "volumes of cells by labels", *const in_place = "labels in place";

struct Voxels {
  View<std::int32_t> leaf;
  View<std::uint32_t> label;
  View<float> distance;
  View<double> origin, spacing;
  View<std::uint64_t> shape;
  bool whole = false;
  explicit Voxels(conceg_doc *doc)
      : leaf(rows_of<std::int32_t>(doc, "/volumes/leaf_origin", 3)),
        label(rows_of<std::uint32_t>(doc, "/volumes/label", kLeafVoxels)),
        distance(rows_of<float>(doc, "/volumes/distance", kLeafVoxels)),
        origin(rows_of<double>(doc, "/volumes@origin")), spacing(rows_of<double>(doc, "/volumes@spacing")),
        shape(rows_of<std::uint64_t>(doc, "/volumes@shape")) {
    whole = has(doc, "/volumes/label") && label.rows() == leaf.rows() && origin.rows() == 3 &&
            spacing.rows() == 3 && shape.rows() == 3;
    for (int axis = 0; whole && axis < 3; axis++)
      whole = spacing[axis] > 0 && shape[axis] > 0 && shape[axis] < 1u << 30;
  }
  double voxel() const { return spacing[0] * spacing[1] * spacing[2]; }
  double box() const {
    return voxel() * static_cast<double>(shape[0]) * static_cast<double>(shape[1]) *
           static_cast<double>(shape[2]);
  }
  // body(voxel of the leaf, centre in um) for those of a leaf that lie in the box.
  template <class Body> void each(std::size_t row, Body &&body) const {
    for (int k = 0; k < static_cast<int>(kLeafVoxels); k++) {
      const std::int64_t at[3] = {std::int64_t(leaf.row(row)[0]) + k / (kLeaf * kLeaf),
                                  std::int64_t(leaf.row(row)[1]) + k / kLeaf % kLeaf,
                                  std::int64_t(leaf.row(row)[2]) + k % kLeaf};
      double centre[3];
      bool inside = true;
      for (int axis = 0; axis < 3; axis++) {
        inside = inside && at[axis] >= 0 && at[axis] < static_cast<std::int64_t>(shape[axis]);
        centre[axis] = origin[axis] + spacing[axis] * static_cast<double>(at[axis]);
      }
      if (inside) body(k, centre);
    }
  }
};

struct Free {
  void operator()(conceg_substrate *s) const { conceg_substrate_free(s); }
  void operator()(conceg_query *q) const { conceg_query_free(q); }
};

// Surfaces of the document with a search structure; `why` says what keeps it from being made.
struct Search {
  std::unique_ptr<conceg_substrate, Free> substrate;
  std::unique_ptr<conceg_query, Free> query;
  std::string why;
  Search(conceg_ctx *ctx, conceg_doc *doc) {
    if (!has(doc, "/meshes/cell")) {
      why = "no /meshes";
      return;
    }
    conceg_substrate *opened = nullptr;
    conceg_query *made = nullptr;
    conceg_status status = conceg_substrate_open(doc, &opened);
    substrate.reset(opened);
    if (status == CONCEG_OK) status = conceg_query_new(ctx, opened, &made);
    query.reset(made);
    if (status == CONCEG_E_NOMEM || status == CONCEG_E_CANCELLED) must(status);
    if (status != CONCEG_OK) why = conceg_ctx_error(ctx);
  }
};

struct CellVolumes {
  std::vector<double> inside, detached; // um3, per cell
  double total = 0;                     // inside of the box
  bool known = false;
};

CellVolumes volumes_of(conceg_doc *doc, const Search &search, const conceg_box &box, Workers &workers) {
  CellVolumes out;
  if (!search.substrate) return out;
  const std::uint64_t meshes = conceg_substrate_meshes(search.substrate.get());
  const View<double> detached = rows_of<double>(doc, "/meshes/detached_volume");
  out.inside.resize(conceg_substrate_cells(search.substrate.get())), out.detached.resize(out.inside.size());
  std::vector<double> inside(meshes);
  std::vector<std::uint32_t> cell(meshes);
  workers.loop(meshes, 1, [&](std::size_t k, unsigned) {
    conceg_mesh_view found = {};
    found.size = sizeof found;
    must(conceg_substrate_mesh(search.substrate.get(), k, &found));
    mesh::SurfaceView surface;
    surface.cell = cell[k] = found.cell;
    surface.origin = {found.origin[0], found.origin[1], found.origin[2]};
    surface.absolute = reinterpret_cast<const glm::dvec3 *>(found.vertex);
    surface.face = reinterpret_cast<const glm::uvec3 *>(found.face);
    surface.vertices = found.vertex_count, surface.faces = found.face_count;
    inside[k] = volume_inside(surface, box);
  });
  for (std::size_t k = 0; k < meshes; k++) {
    out.inside[cell[k]] += inside[k], out.total += inside[k];
    if (k < detached.rows()) out.detached[cell[k]] += detached[k];
  }
  out.known = meshes > 0;
  return out;
}

void fraction_by_points(const Search &search, const conceg_box &box, double by_mesh, const Limits &limits,
                        Workers &workers, Gates &gates) {
  if (!search.query || !limits.points)
    return gates.not_judged("/meshes", in_box, search.query ? "points=0" : search.why);
  const std::size_t batches = (limits.points + kBatch - 1) / kBatch;
  std::vector<std::uint64_t> hits(batches);
  workers.loop(batches, 1, [&](std::size_t batch, unsigned) {
    const std::size_t first = batch * kBatch, count = std::min<std::size_t>(kBatch, limits.points - first);
    std::vector<double> point(3 * count);
    std::vector<std::int64_t> cell(count);
    for (std::size_t i = 0; i < count; i++) {
      conceg_rng rng = conceg_rng_stream(kSeed, "check.points", first + i);
      for (int axis = 0; axis < 3; axis++)
        point[3 * i + static_cast<std::size_t>(axis)] =
            box.lo[axis] + conceg_rng_uniform(&rng) * conceg_box_side(&box, axis);
    }
    must(conceg_query_locate(search.query.get(), count, point.data(), cell.data(), nullptr));
    for (const std::int64_t found : cell)
      hits[batch] += found >= 0;
  });
  const double count = static_cast<double>(limits.points),
               share =
                   static_cast<double>(std::accumulate(hits.begin(), hits.end(), std::uint64_t(0))) / count,
               error = std::sqrt(share * (1 - share) / count);
  if (3 * error > limits.icvf)
    return gates.not_judged("/meshes", in_box,
                            formatted("%.0f points tell the fraction to %.5f only", count, error));
  gates.at_most("/meshes", in_box, std::fabs(share - by_mesh), limits.icvf, "1",
                formatted("%.5f +- %.5f by %.0f located points, %.5f by the surfaces' volumes", share, error,
                          count, by_mesh));
}

void fraction_by_labels(const Voxels &voxels, const CellVolumes &mesh, double by_mesh, const Limits &limits,
                        Gates &gates) {
  std::vector<std::uint64_t> count(mesh.inside.size());
  std::uint64_t all = 0;
  for (std::size_t row = 0; row < voxels.leaf.rows(); row++)
    voxels.each(row, [&](int k, const double *) {
      const std::uint32_t label = voxels.label.row(row)[k];
      all += label > 0;
      if (label > 0 && label <= count.size()) count[label - 1]++;
    });
  const double share = static_cast<double>(all) * voxels.voxel() / voxels.box();
  gates.at_most("/volumes", by_labels, std::fabs(share - by_mesh), limits.icvf, "1",
                formatted("%.5f by voxels of %.3f um, %.5f by the surfaces' volumes", share,
                          voxels.spacing[0], by_mesh));
  double worst = 0;
  std::size_t compared = 0, worst_cell = 0;
  for (std::size_t cell = 0; cell < count.size(); cell++) {
    const double by_voxels = static_cast<double>(count[cell]) * voxels.voxel(), surface = mesh.inside[cell];
    if (surface < kFewVoxels * voxels.voxel()) continue;
    compared++;
    // Pieces that the meshes leave out may or may not be labelled.
    const double off =
        std::min(std::fabs(by_voxels - surface), std::fabs(by_voxels - surface - mesh.detached[cell])) /
        surface;
    if (off > worst) worst = off, worst_cell = cell;
  }
  if (!compared)
    return gates.not_judged("/volumes", of_cells, formatted("no cell has %.0f voxels", kFewVoxels));
  gates.at_most(
      "/volumes", of_cells, worst, limits.cell_volume, "1",
      formatted("relative difference from the surfaces; worst of %zu cells of %.0f voxels or more: cell %zu",
                compared, kFewVoxels, worst_cell));
}

void labels_in_place(const Search &search, const Voxels &voxels, Workers &workers, Gates &gates) {
  if (!search.query || voxels.distance.rows() != voxels.leaf.rows())
    return gates.not_judged("/volumes", in_place, search.query ? "no /volumes/distance" : search.why);
  const double clear = kClear * std::max({voxels.spacing[0], voxels.spacing[1], voxels.spacing[2]});
  const std::size_t leaves = voxels.leaf.rows();
  std::vector<std::uint32_t> other(leaves), looked(leaves);
  std::vector<std::string> first(leaves);
  workers.loop(leaves, 4, [&](std::size_t row, unsigned) {
    std::vector<double> point;
    std::vector<std::int64_t> label;
    voxels.each(row, [&](int k, const double *centre) {
      if (!(std::fabs(static_cast<double>(voxels.distance.row(row)[k])) > clear)) return;
      point.insert(point.end(), centre, centre + 3);
      label.push_back(static_cast<std::int64_t>(voxels.label.row(row)[k]) - 1);
    });
    std::vector<std::int64_t> cell(label.size());
    must(conceg_query_locate(search.query.get(), cell.size(), point.data(), cell.data(), nullptr));
    looked[row] = static_cast<std::uint32_t>(cell.size());
    for (std::size_t i = 0; i < cell.size(); i++)
      if (cell[i] != label[i] && !other[row]++)
        first[row] = formatted("label of cell %lld in cell %lld at (%.3f, %.3f, %.3f) um; -1 = outside",
                               static_cast<long long>(label[i]), static_cast<long long>(cell[i]),
                               point[3 * i], point[3 * i + 1], point[3 * i + 2]);
  });
  const double count = static_cast<double>(std::accumulate(looked.begin(), looked.end(), std::uint64_t(0))),
               found = static_cast<double>(std::accumulate(other.begin(), other.end(), std::uint64_t(0)));
  if (count == 0)
    return gates.not_judged("/volumes", in_place, "no voxel is farther than its own width from a membrane");
  std::string place;
  for (const std::string &text : first)
    if (place.empty()) place = text;
  gates.at_most(
      "/volumes", in_place, found / count, kMisplaced, "1",
      formatted("of %.0f voxels more than %.3f um from a membrane lie in another cell than their label's",
                count, clear) +
          (place.empty() ? "" : "; first: " + place));
}

// A number in the canonical parameters of the document's last run of the mesh stage; NaN when it is not
// there.
double mesh_parameter(conceg_doc *doc, const std::string &name) {
  const std::vector<std::string> stage = texts_of(doc, "/provenance/stage"),
                                 parameters = texts_of(doc, "/provenance/parameters");
  for (std::size_t i = std::min(stage.size(), parameters.size()); i-- > 0;) {
    if (stage[i] != "mesh") continue;
    for (const char *before : {"{", ", "}) {
      const std::string key = before + name + ": ";
      const std::size_t at = parameters[i].find(key);
      if (at != std::string::npos) return std::strtod(parameters[i].c_str() + at + key.size(), nullptr);
    }
  }
  return NAN;
}

mesh::Tissue tissue_of(const conceg_box &box, const Cells &cells, const Skeletons &s) {
  mesh::Tissue tissue;
  tissue.box = box;
  for (std::size_t i = 0; i < cells.rows(); i++) {
    const double *p = cells.soma.row(i);
    tissue.soma.emplace_back(p[0], p[1], p[2]), tissue.soma_radius.push_back(cells.radius[i]);
  }
  tissue.offset.assign(s.offset.begin(), s.offset.end());
  for (std::size_t i = 0; i < s.points(); i++)
    tissue.point.emplace_back(s.position.row(i)[0], s.position.row(i)[1], s.position.row(i)[2]);
  tissue.radius.assign(s.radius.begin(), s.radius.end());
  tissue.parent.assign(s.parent.begin(), s.parent.end());
  tissue.kind.assign(s.kind.begin(), s.kind.end());
  if (s.branch.rows() == s.points()) tissue.branch.assign(s.branch.begin(), s.branch.end());
  return tissue;
}

// The field may only be made of skeletons that keep their rules.
bool sound(const Gates &gates) {
  for (const Gate &gate : gates.all())
    if (gate.verdict == Verdict::failed && (gate.group == "/skeleton" || gate.name == "format")) return false;
  return true;
}

} // namespace

void volume_gates(conceg_ctx *ctx, conceg_doc *doc, const Limits &limits, Workers &workers, Gates &gates) {
  const conceg_box box = read_box(doc);
  const Search search(ctx, doc);
  const CellVolumes mesh = volumes_of(doc, search, box, workers);
  if (!mesh.known) {
    const std::string why = search.why.empty() ? "no surfaces" : search.why;
    gates.not_judged("/meshes", in_box, why);
    for (const char *name : {by_labels, of_cells, in_place})
      gates.not_judged("/volumes", name, why);
    return;
  }
  const double by_mesh = mesh.total / volume(box);
  fraction_by_points(search, box, by_mesh, limits, workers, gates);
  const Voxels voxels(doc);
  if (!voxels.whole) {
    for (const char *name : {by_labels, of_cells, in_place})
      gates.not_judged("/volumes", name,
                       has(doc, "/volumes/label") ? "/volumes cannot be read as leaves"
                                                  : "no /volumes/label");
    return;
  }
  fraction_by_labels(voxels, mesh, by_mesh, limits, gates);
  labels_in_place(search, voxels, workers, gates);
}

void space_gates(conceg_doc *doc, const Limits &limits, Workers &workers, const Progress &progress,
                 Gates &gates) {
  const char *const name = "extracellular space in one piece", *const g = "/skeleton";
  const conceg_box box = read_box(doc);
  const Cells cells(doc);
  const Skeletons s(doc, cells);
  mesh::SceneOptions options;
  options.h = mesh_parameter(doc, "h_um"), options.gap = mesh_parameter(doc, "gap_um");
  options.inflate = mesh_parameter(doc, "inflate_um"), options.smooth = mesh_parameter(doc, "smooth_k");
  const char *why = !limits.space               ? "space=false"
                    : !s.whole                  ? "no /skeleton that can be read"
                    : !has(doc, "/meshes/cell") ? "no /meshes"
                    : !sound(gates)             ? "the skeleton breaks a rule"
                    : !(box.periodic[0] && box.periodic[1] && box.periodic[2])
                        ? "the box has open sides, beyond which the space goes on"
                    : !(options.h > 0 && options.gap > 0 && options.inflate >= 0 && options.smooth >= 0)
                        ? "/provenance does not tell the mesh stage's parameters"
                        : nullptr;
  if (why) return gates.not_judged(g, name, why);
  const mesh::Scene scene = mesh::make_scene(tissue_of(box, cells, s), options);
  const mesh::Index index = mesh::make_index(scene, workers, progress);
  const mesh::Space space = mesh::extracellular_space(scene, index, workers, progress);
  gates.at_least(
      g, name, space.largest, 0.99, "1",
      formatted("of the space outside of all cells, %.4f of the box, in the largest of %llu pieces; by the "
                "skeletons' field on the grid of the meshes",
                space.volume, static_cast<unsigned long long>(space.pieces)));
}

void walk_gates(conceg_doc *doc, Gates &gates) {
  if (!has(doc, "/walkers@leaks")) return gates.not_judged("/walkers", "no walker leaks", "no /walkers");
  const std::uint64_t leaks = scalar_of<std::uint64_t>(doc, "/walkers@leaks", ~0ull);
  gates.none("/walkers", "no walker leaks", leaks,
             formatted("%zu walkers, found in another cell than their seed's and run again",
                       rows_of<std::int64_t>(doc, "/walkers/cell").rows()),
             "not stored which");
}

} // namespace conceg::gates
