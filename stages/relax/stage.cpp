// SPDX-License-Identifier: BSD-3-Clause
// The relax stage: skeletons are moved so that they can have their target radii, and cut where they cannot.
#include "relax.hpp"
#include "separate.hpp"
#include "spheres.hpp"

#include "conceg/stage.h"

#include <glm/vec3.hpp>

#include <cmath>
#include <string>

namespace {

using namespace conceg;
using namespace conceg::relax;

template <class T> std::vector<T> values(conceg_doc *doc, const char *path) {
  const View<T> v = view<T>(doc, path);
  return std::vector<T>(v.begin(), v.end());
}

Skeletons read_skeletons(conceg_doc *doc) {
  Skeletons s;
  s.cell_offset = values<std::uint64_t>(doc, "/skeleton/cell_offset");
  s.position = vec3s<glm::dvec3>(doc, "/skeleton/position");
  s.radius = values<float>(doc, "/skeleton/radius");
  s.target_radius = values<float>(doc, "/skeleton/target_radius");
  s.parent = values<std::int64_t>(doc, "/skeleton/parent");
  s.soma = vec3s<glm::dvec3>(doc, "/cells/soma");
  s.soma_radius = values<float>(doc, "/cells/radius");
  return s;
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f %%",
                whole ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0.0);
  return text;
}

unsigned long long count(std::uint64_t n) {
  return n;
}

void log_certificate(conceg_ctx *ctx, conceg_log_level level, const char *when, const Certificate &c) {
  conceg_ctx_log(ctx, level,
                 "%s: %llu pairs looked at (%llu of different cells, %llu of own images), %llu overlap, %llu "
                 "are closer than the gap, largest overlap %.4f um, smallest gap %.4f um",
                 when, count(c.pairs), count(c.foreign), count(c.images), count(c.overlapping),
                 count(c.tight), c.largest_overlap, std::isfinite(c.smallest_gap) ? c.smallest_gap : 0.0);
}

void write_back(conceg_doc *doc, const Skeletons &s, const std::vector<std::uint8_t> &status,
                const Spheres &spheres) {
  put3(doc, "/skeleton/position", s.position);
  put(doc, "/skeleton/radius", s.radius);
  put(doc, "/skeleton/status", status);
  put(doc, "/spheres/cell_offset", spheres.cell_offset);
  put3(doc, "/spheres/center", spheres.center);
  put(doc, "/spheres/radius", spheres.radius);
  put(doc, "/spheres/segment_end", spheres.segment_end);
}

void relax_document(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const conceg_box box = read_box(doc);
  const glm::dvec3 sides = side(box);
  Skeletons skeletons = read_skeletons(doc);
  const Progress progress = progress_of(ctx);
  Workers workers(conceg_ctx_threads(ctx));
  Collider collider(workers.threads());

  Strength strength;
  strength.gap = conceg_params_f64(params, "gap_um");
  strength.repulsion = conceg_params_f64(params, "repulsion");
  strength.attraction = conceg_params_f64(params, "attraction");
  strength.attraction_range = conceg_params_f64(params, "attraction_range_um");
  strength.stretch = conceg_params_f64(params, "stretch");
  strength.bending = conceg_params_f64(params, "bending");
  Motion motion;
  motion.iterations = static_cast<int>(conceg_params_i64(params, "iterations"));
  motion.momentum = conceg_params_f64(params, "momentum");
  motion.step = conceg_params_f64(params, "step_um");
  motion.skin = conceg_params_f64(params, "skin_um");

  Bodies bodies = make_bodies(skeletons, conceg_params_f64(params, "radius_min_um"));
  const std::vector<double> target = bodies.radius;
  const auto close_pairs = [&](const std::vector<double> &radius) {
    return collider.find(bodies, radius, box, strength.gap, workers).pairs;
  };

  const std::vector<Pair> at_start = close_pairs(target);
  log_certificate(ctx, CONCEG_LOG_INFO, "before, at target radii",
                  certify(bodies, at_start, sides, strength.gap, target, workers));
  std::vector<double> unmoved = target;
  const Cut without = cut_radii(bodies, at_start, sides, strength.gap, unmoved, workers, progress);

  const Moved moved = move_bodies(bodies, box, strength, motion, collider, workers, progress);
  const std::vector<Pair> at_end = close_pairs(target);
  log_certificate(ctx, CONCEG_LOG_INFO, "moved, at target radii",
                  certify(bodies, at_end, sides, strength.gap, target, workers));
  std::vector<double> radius = target;
  const Cut cut = cut_radii(bodies, at_end, sides, strength.gap, radius, workers, progress);

  std::vector<std::uint8_t> status(bodies.points);
  for (std::size_t i = 0; i < bodies.points; i++) {
    skeletons.position[i] = bodies.position[i];
    skeletons.radius[i] = not_above(radius[i]);
    status[i] = skeletons.radius[i] < skeletons.target_radius[i];
    radius[i] = skeletons.radius[i];
  }
  // The certificate looks at what is written, over a list of its own.
  const Certificate final = certify(bodies, close_pairs(radius), sides, strength.gap, radius, workers);
  log_certificate(ctx, CONCEG_LOG_INFO, "written", final);
  if (final.overlapping)
    conceg_ctx_log(
        ctx, CONCEG_LOG_WARNING,
        "relax: %llu pairs still overlap at the least radius, by at most %.4f um (skeleton rows %u and %u); "
        "the mesh cuts them at their contact plane. Raise relax.iterations or lower relax.radius_min_um",
        count(final.overlapping), final.largest_overlap, final.worst_e, final.worst_f);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "points below 95 %% of their target radius: %s without moving, %s after it; mean share of "
                 "the target %.4f, then %.4f (%llu sweeps)",
                 percent(without.constricted, bodies.points).c_str(),
                 percent(cut.constricted, bodies.points).c_str(), without.mean_share, cut.mean_share,
                 count(cut.sweeps));
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "moved %zu points in %d iterations, %llu lists of pairs, pruned %llu times (%llu runs in the last): shift "
                 "%.3f um mean, %.3f um largest; cable %.1f -> %.1f um",
                 bodies.points, motion.iterations, count(moved.rebuilds), count(moved.prunes),
                 count(moved.runs),
                 moved.mean_shift, moved.largest_shift, moved.length_before, moved.length_after);
  workers.count(ctx, "relax.items");
  write_back(doc, skeletons, status, resample(skeletons, conceg_params_f64(params, "sphere_spacing")));
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "relax", [&] { relax_document(ctx, doc, params); });
}

const conceg_param parameters[] = {
    {"iterations", "1", "steps of the heavy ball", "80", nullptr, CONCEG_PARAM_I64, 0, 0, 100000},
    {"gap_um", "um", "space kept free between bodies", "0.04", nullptr, CONCEG_PARAM_F64, 0, 0, 1},
    {"radius_min_um", "um", "no radius is cut below this", "0.15", nullptr, CONCEG_PARAM_F64, 0, 0.001, 10},
    {"repulsion", "1", "share of an overlap that one step takes away", "0.3", nullptr, CONCEG_PARAM_F64, 0, 0,
     1},
    {"attraction", "1", "share of a small gap that one step closes, at most", "0.02", nullptr,
     CONCEG_PARAM_F64, 0, 0, 1},
    {"attraction_range_um", "um", "largest gap, beyond gap_um, across which bodies attract", "0.2", nullptr,
     CONCEG_PARAM_F64, 0, 0, 5},
    {"stretch", "1", "share of a change of segment length that one step takes back", "0.5", nullptr,
     CONCEG_PARAM_F64, 0, 0, 0.8},
    {"bending", "1", "share of a change of bend that one step takes back", "0.02", nullptr, CONCEG_PARAM_F64,
     0, 0, 0.5},
    {"momentum", "1", "share of the last step that goes on (heavy ball)", "0.8", nullptr, CONCEG_PARAM_F64, 0,
     0, 0.99},
    {"step_um", "um", "largest move of a point in one step", "0.05", nullptr, CONCEG_PARAM_F64, 0, 0.0001, 1},
    {"skin_um", "um", "slack of the list of pairs; changes the time only", "0.6", nullptr, CONCEG_PARAM_F64,
     0, 0.01, 5},
    {"sphere_spacing", "1", "distance of the spheres of /spheres in radii", "1", nullptr, CONCEG_PARAM_F64, 0,
     0.05, 2},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};
const char *const reads[] = {"domain", "types", "cells", "skeleton", nullptr};
const char *const writes[] = {"skeleton", "spheres", nullptr};
const char *const drops[] = {nullptr};

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_relax;
const conceg_stage conceg_stage_relax = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "relax",
    "spheres",
    "1.0.0",
    "moves the skeletons apart so that they reach their target radii, and cuts radii where they cannot",
    "conceg relax < grown.cgx > relaxed.cgx",
    parameters,
    reads,
    writes,
    drops,
    CONCEG_STAGE_THREADED,
    nullptr,
    run,
};
