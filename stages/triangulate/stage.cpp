// SPDX-License-Identifier: GPL-3.0-or-later
// The triangulate stage: descriptor, and glue between the document and the algorithm files.
#include "delaunay.hpp"
#include "nodes.hpp"
#include "radius.hpp"

#include "conceg/portable.h"
#include "conceg/stage.h"
#include "wrap.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace {

using namespace conceg;
using namespace conceg::triangulate;

// First halo in units of density^(-1/3): twice the largest empty sphere seen in 2 million nodes, and a tenth
// more.
constexpr double kHaloBcc = 2.2, kHaloUniform = 3.8;

constexpr double kFarthest = 1e7; // um

conceg_box lattice_box(conceg_doc *doc) {
  const conceg_box box = read_box(doc);
  for (int axis = 0; axis < 3; axis++)
    if (conceg_snap(box.lo[axis]) != box.lo[axis] || conceg_snap(box.hi[axis]) != box.hi[axis])
      fail(CONCEG_E_RANGE,
           "/domain: expected corners on the lattice of 2^-16 um, got %.9g and %.9g on axis %d; place rounds "
           "them",
           box.lo[axis], box.hi[axis], axis);
  return box;
}

std::vector<Soma> read_somas(conceg_doc *doc) {
  const View<double> center = view<double>(doc, "/cells/soma", 3);
  const View<float> radius = view<float>(doc, "/cells/radius");
  if (center.rows() != radius.rows())
    fail(CONCEG_E_FORMAT, "/cells/radius: expected %zu rows as in /cells/soma, got %zu", center.rows(),
         radius.rows());
  std::vector<Soma> somas(center.rows());
  for (std::size_t i = 0; i < somas.size(); i++) {
    somas[i] = {{center.row(i)[0], center.row(i)[1], center.row(i)[2]}, static_cast<double>(radius[i])};
    for (int axis = 0; axis < 3; axis++)
      if (!(std::fabs(somas[i].center[axis]) < kFarthest))
        fail(CONCEG_E_RANGE, "/cells/soma[%zu]: expected coordinates within %g um, got %g", i, kFarthest,
             somas[i].center[axis]);
    if (!(somas[i].radius >= 0.0 && somas[i].radius < kFarthest))
      fail(CONCEG_E_RANGE, "/cells/radius[%zu]: expected 0 um or more, got %g", i, somas[i].radius);
  }
  return somas;
}

// Largest radius that any bar asks for, um: r(pl) = max(radius + taper (pl - (start + end) / 2),
// radius_floor).
double largest_target(conceg_doc *doc) {
  const View<double> radius = view<double>(doc, "/bars/radius");
  const auto column = [&](const char *path) {
    const View<double> values = view<double>(doc, path);
    if (values.rows() != radius.rows())
      fail(CONCEG_E_FORMAT, "%s: expected %zu rows as in /bars/radius, got %zu", path, radius.rows(),
           values.rows());
    return values;
  };
  const View<double> start = column("/bars/asked_start"), end = column("/bars/asked_end");
  const View<double> taper = column("/bars/taper"), floor = column("/bars/radius_floor");
  double largest = 0.0;
  for (std::size_t i = 0; i < radius.rows(); i++)
    largest = std::max({largest, floor[i], radius[i] + std::fabs(taper[i]) * 0.5 * (end[i] - start[i])});
  return std::min(largest, kFarthest);
}

template <class T>
T *new_array(conceg_doc *doc, const char *path, std::uint64_t rows, std::uint64_t columns = 1) {
  const std::uint64_t shape[2] = {rows, columns};
  void *storage = nullptr;
  must(conceg_doc_new_array(doc, path, dtype_of<T>::value, columns == 1 ? 1 : 2, shape, &storage));
  return static_cast<T *>(storage);
}

void triangulate_document(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const conceg_box box = lattice_box(doc);
  const std::vector<Soma> somas = read_somas(doc);
  const double cap = largest_target(doc) + conceg_params_f64(params, "radius_margin_um");
  const Progress progress = progress_of(ctx);
  Workers workers(conceg_ctx_threads(ctx));

  NodeOptions node_options;
  node_options.set =
      std::strcmp(conceg_params_text(params, "nodes"), "uniform") ? NodeSet::bcc : NodeSet::uniform;
  node_options.density_per_um3 = conceg_params_f64(params, "density_per_um3");
  node_options.jitter = conceg_params_f64(params, "jitter");
  node_options.mirrored_faces = std::strcmp(conceg_params_text(params, "faces"), "mirrored") == 0;
  node_options.seed = conceg_ctx_seed(ctx);
  const std::vector<glm::dvec3> nodes = make_nodes(box, node_options, workers, progress);
  workers.count(ctx, "triangulate.node_blocks");
  put3(doc, "/network/position", nodes);
  put(doc, "/network/radius", allowed_radii(box, nodes, somas, cap, workers, progress));
  workers.count(ctx, "triangulate.radius_blocks");

  DelaunayOptions options;
  options.tile_um = conceg_params_f64(params, "tile_um");
  options.halo_um = (node_options.set == NodeSet::bcc ? kHaloBcc : kHaloUniform) *
                    conceg_pow(node_options.density_per_um3, -1.0 / 3.0);
  options.mirrored_faces = node_options.mirrored_faces;
  Edges edges = delaunay_edges(box, nodes, options, workers, progress);
  workers.count(ctx, "triangulate.tiles");
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "triangulate: %zu nodes, %llu directed edges, %zu tiles, %llu redone with a wider halo",
                 nodes.size(), static_cast<unsigned long long>(edges.count), edges.tiles.size(),
                 static_cast<unsigned long long>(edges.widened));
  const std::uint64_t count = edges.count;
  auto *offset = new_array<std::uint64_t>(doc, "/network/edge_offset", nodes.size() + 1);
  auto *edge = new_array<std::uint32_t>(doc, "/network/edge", count);
  auto *shift = new_array<std::int8_t>(doc, "/network/edge_shift", count, 3);
  merge_tiles(std::move(edges), nodes.size(), offset, edge, shift);
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "triangulate", [&] { triangulate_document(ctx, doc, params); });
}

const conceg_param kParams[] = {
    {"nodes", "",
     "node set: body-centred cubic with a random shift, or independent uniform nodes as in the paper", "bcc",
     "bcc|uniform", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"density_per_um3", "um^-3", "nodes per um3", "2", nullptr, CONCEG_PARAM_F64, 0, 1e-4, 1e3},
    {"jitter", "1", "bcc: largest random shift along each axis, in sides of the cubic cell of two nodes",
     "0.2", nullptr, CONCEG_PARAM_F64, 0, 0, 0.24},
    {"faces", "", "periodic sides: seamless, or the paper's nodes on the faces, mirrored on opposing sides",
     "seamless", "seamless|mirrored", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"radius_margin_um", "um",
     "what the cap on the largest allowed radius exceeds the largest target radius by", "0.1", nullptr,
     CONCEG_PARAM_F64, 0, 0, 10},
    {"tile_um", "um", "largest side of a tile; decides memory and speed, not the result", "50", nullptr,
     CONCEG_PARAM_F64, 0, 4, 1000},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0},
};
const char *const kReads[] = {"domain", "cells", "bars", nullptr};
const char *const kWrites[] = {"network", nullptr};
const char *const kDrops[] = {nullptr};

} // namespace

extern "C" {
extern CONCEG_EXPORT const conceg_stage conceg_stage_triangulate;
const conceg_stage conceg_stage_triangulate = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "triangulate",
    "delaunay",
    "1.0.0",
    "fills the box with nodes and joins them by a periodic Delaunay triangulation (CGAL)",
    "conceg place -p recipe.yaml | conceg triangulate > network.cgx",
    kParams,
    kReads,
    kWrites,
    kDrops,
    CONCEG_STAGE_THREADED,
    nullptr,
    run,
};
}
