// SPDX-License-Identifier: GPL-3.0-or-later
// The triangulate stage: descriptor, and glue between the document and the algorithm files.
#include "delaunay.hpp"
#include "nodes.hpp"
#include "radius.hpp"
#include "tissue.hpp"

#include "conceg/portable.h"
#include "conceg/stage.h"
#include "wrap.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace {

using namespace conceg;
using namespace conceg::triangulate;

// Mean edge in units of density^(-1/3), measured, and the longest edge that grow takes by default.
constexpr double kMeanEdgeBcc = 1.2, kMeanEdgeUniform = 1.29, kLongestStepUm = 2.0;

template <class T>
T *new_array(conceg_doc *doc, const char *path, std::uint64_t rows, std::uint64_t columns = 1) {
  const std::uint64_t shape[2] = {rows, columns};
  void *storage = nullptr;
  must(conceg_doc_new_array(doc, path, dtype_of<T>::value, columns == 1 ? 1 : 2, shape, &storage));
  return static_cast<T *>(storage);
}

// A network that growth cannot follow is legal, but hardly what was wanted.
void warn_if_sparse(conceg_ctx *ctx, const NodeOptions &options, double largest_target_um) {
  const double spacing = conceg_pow(options.density_per_um3, -1.0 / 3.0);
  const double edge = spacing * (options.set == NodeSet::uniform ? kMeanEdgeUniform : kMeanEdgeBcc);
  const auto density_for = [&](double factor) { return options.density_per_um3 * factor * factor * factor; };
  if (edge > kLongestStepUm)
    conceg_ctx_log(
        ctx, CONCEG_LOG_WARNING,
        "triangulate: density_per_um3: expected edges of at most %g um on average (the longest step of "
        "grow), got %.3g um; ask for %.2g um^-3 or more",
        kLongestStepUm, edge, density_for(edge / kLongestStepUm));
  if (largest_target_um > 0.0 && spacing > 2.0 * largest_target_um)
    conceg_ctx_log(
        ctx, CONCEG_LOG_WARNING,
        "triangulate: density_per_um3: expected nodes no further apart than the thickest process is wide "
        "(%.3g um), got %.3g um; ask for %.2g um^-3 or more",
        2.0 * largest_target_um, spacing, density_for(0.5 * spacing / largest_target_um));
}

std::vector<std::uint8_t> grade(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params,
                                const Lattice &lattice, const std::vector<Soma> &somas) {
  const auto finest = static_cast<unsigned>(conceg_params_i64(params, "grade_levels"));
  const double spacing = conceg_pow(conceg_params_f64(params, "density_per_um3"), -1.0 / 3.0);
  std::vector<Zone> zones = soma_zones(somas, finest, conceg_params_f64(params, "grade_distance_um"));
  const std::vector<Zone> thin =
      thin_zones(read_territories(doc, somas), spacing, conceg_params_f64(params, "grade_spacing_radii"),
                 conceg_params_f64(params, "grade_territory_um"), finest);
  zones.insert(zones.end(), thin.begin(), thin.end());
  std::vector<std::uint8_t> levels = grade_levels(lattice, zones, somas);
  const auto nodes = nodes_by_level(levels);
  conceg_ctx_log(
      ctx, CONCEG_LOG_INFO,
      "triangulate: graded for %zu somas and %zu territories of thin processes: %llu nodes of level 0, "
      "%llu of 1, %llu of 2",
      somas.size(), thin.size(), static_cast<unsigned long long>(nodes[0]),
      static_cast<unsigned long long>(nodes[1]), static_cast<unsigned long long>(nodes[2]));
  return levels;
}

NodeOptions read_node_options(conceg_ctx *ctx, const conceg_params *params) {
  NodeOptions options;
  options.set = std::strcmp(conceg_params_text(params, "nodes"), "uniform") ? NodeSet::bcc : NodeSet::uniform;
  options.density_per_um3 = conceg_params_f64(params, "density_per_um3");
  options.jitter = conceg_params_f64(params, "jitter");
  options.mirrored_faces = std::strcmp(conceg_params_text(params, "faces"), "mirrored") == 0;
  options.seed = conceg_ctx_seed(ctx);
  return options;
}

void triangulate_document(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const conceg_box box = read_lattice_box(doc);
  const std::vector<Soma> somas = read_somas(doc);
  const double largest_target = largest_target_um(doc);
  const double cap = largest_target + conceg_params_f64(params, "radius_margin_um");
  const Progress progress = progress_of(ctx);
  Workers workers(conceg_ctx_threads(ctx));
  Phases phases;

  NodeOptions node_options = read_node_options(ctx, params);
  warn_if_sparse(ctx, node_options, largest_target);
  check_nodes(box, node_options);
  if (std::strcmp(conceg_params_text(params, "nodes"), "graded") == 0)
    node_options.levels = grade(ctx, doc, params, lattice_of(box, node_options.density_per_um3), somas);
  const std::vector<glm::dvec3> nodes = make_nodes(box, node_options, workers, progress);
  workers.count(ctx, "triangulate.node_blocks");
  phases.end("nodes");
  put3(doc, "/network/position", nodes);
  put(doc, "/network/radius", allowed_radii(box, nodes, somas, cap, workers, progress));
  workers.count(ctx, "triangulate.radius_blocks");
  phases.end("radii");

  DelaunayOptions options;
  options.tile_um = conceg_params_f64(params, "tile_um");
  options.halo_um = first_halo_um(box, node_options);
  options.mirrored_faces = node_options.mirrored_faces;
  Edges edges = delaunay_edges(box, nodes, options, workers, progress);
  workers.count(ctx, "triangulate.tiles");
  phases.end("tiles");
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "triangulate: %zu nodes, %llu directed edges, %zu tiles, %llu redone with a wider halo",
                 nodes.size(), static_cast<unsigned long long>(edges.count), edges.tiles.size(),
                 static_cast<unsigned long long>(edges.widened));
  const std::uint64_t count = edges.count;
  auto *offset = new_array<std::uint64_t>(doc, "/network/edge_offset", nodes.size() + 1);
  auto *edge = new_array<std::uint32_t>(doc, "/network/edge", count);
  auto *shift = new_array<std::int8_t>(doc, "/network/edge_shift", count, 3);
  merge_tiles(std::move(edges), nodes.size(), offset, edge, shift);
  phases.end("merge");
  tell_phases(ctx, "triangulate", phases, workers.busy_s(), workers.threads());
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "triangulate", [&] { triangulate_document(ctx, doc, params); });
}

const conceg_param kParams[] = {
    {"nodes", "",
     "node set: body-centred cubic with a random shift, independent uniform nodes as in the paper, or bcc "
     "made "
     "finer near somas and where thin processes grow",
     "bcc", "bcc|uniform|graded", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"density_per_um3", "um^-3", "nodes per um3", "2", nullptr, CONCEG_PARAM_F64, 0, 1e-4, 1e3},
    {"jitter", "1",
     "bcc, graded: largest random shift along each axis, in sides of the cubic cell of two nodes", "0.2",
     nullptr, CONCEG_PARAM_F64, 0, 0, 0.24},
    {"grade_levels", "1", "graded: how often the node spacing may be halved", "1", nullptr, CONCEG_PARAM_I64,
     0, 0, kFinestLevel},
    {"grade_distance_um", "um",
     "graded: finest up to this distance from somas; each coarser level as far again", "2", nullptr,
     CONCEG_PARAM_F64, 0, 0, 100},
    {"grade_spacing_radii", "1",
     "graded: node spacing asked for where a compact cell grows, in mean radii of its processes", "2",
     nullptr, CONCEG_PARAM_F64, 0, 0.5, 10},
    {"grade_territory_um", "um",
     "graded: cells whose processes reach farther than this on average are no such place", "30", nullptr,
     CONCEG_PARAM_F64, 0, 0, 1000},
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
