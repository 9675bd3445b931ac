// SPDX-License-Identifier: BSD-3-Clause
// The relax stage: skeletons are moved so that they can have their target radii, and cut where they cannot.
#include "inflate.hpp"
#include "input.hpp"
#include "pack.hpp"
#include "spheres.hpp"
#include "trace.hpp"

#include "conceg/stage.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

namespace {

using namespace conceg;
using namespace conceg::relax;

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

constexpr std::size_t sample_points = 200000;

Strength strength_of(const conceg_params *params) {
  Strength strength;
  strength.gap = conceg_params_f64(params, "gap_um");
  strength.repulsion = conceg_params_f64(params, "repulsion");
  strength.attraction = conceg_params_f64(params, "attraction");
  strength.attraction_range = conceg_params_f64(params, "attraction_range_um");
  strength.stretch = conceg_params_f64(params, "stretch");
  strength.bending = conceg_params_f64(params, "bending");
  strength.forking = conceg_params_f64(params, "forking");
  strength.tension = conceg_params_f64(params, "tension");
  strength.straightening = conceg_params_f64(params, "straightening");
  return strength;
}

Motion motion_of(const conceg_params *params) {
  Motion motion;
  motion.iterations = static_cast<int>(conceg_params_i64(params, "iterations"));
  motion.momentum = conceg_params_f64(params, "momentum");
  motion.step = conceg_params_f64(params, "step_um");
  motion.skin = conceg_params_f64(params, "skin_um");
  return motion;
}

Rounds rounds_of(const conceg_params *params) {
  Rounds rounds;
  rounds.count = static_cast<int>(conceg_params_i64(params, "rounds"));
  rounds.widening = conceg_params_f64(params, "widening_um");
  rounds.most = conceg_params_f64(params, "swelling");
  return rounds;
}

void log_state(conceg_ctx *ctx, conceg_log_level level, int iteration, const State &s) {
  conceg_ctx_log(
      ctx, level,
      "iteration %d: energy %.4g um2 of contacts, %.4g of shape; %llu pairs overlap, by %.4g um in "
      "all, %.4f at most",
      iteration, s.contact_energy, s.shape_energy, count(s.overlapping), s.overlap_sum, s.largest_overlap);
}

void log_classes(conceg_ctx *ctx, const Classes &classes, const std::vector<ClassRadii> &radii) {
  for (std::size_t k = 0; k < radii.size(); k++)
    if (radii[k].target_mean > 0)
      conceg_ctx_log(
          ctx, CONCEG_LOG_INFO,
          "%s: mean radius %.4f um, %.3f of its target; volume-weighted CV %.3f, %.3f of its target",
          classes.name[k].c_str(), radii[k].mean, radii[k].mean_ratio(), radii[k].cv, radii[k].cv_ratio());
}

void log_shape(conceg_ctx *ctx, const ShapeChange &c) {
  constexpr double degrees = 180 / 3.14159265358979323846;
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "shape: %.2f %% of %zu sections within 3 %% of their length (mean ratio %.4f, worst change "
                 "%.1f %% beyond 2 um); "
                 "straightness %.4f -> %.4f; fork angle %.2f -> %.2f degrees, %.1f %% of %zu forks within 3",
                 100 * c.length_within, c.sections, c.mean_length_ratio, 100 * c.worst_length_change,
                 c.straightness_before, c.straightness_after, degrees * c.mean_angle_before,
                 degrees * c.mean_angle_after, 100 * c.angle_within, c.forks);
}

void log_parted(conceg_ctx *ctx, const Parted &p, double gap) {
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "parted: %llu pairs were nearer than %.3f um at the least radii, by %.4f um at most; pushed "
                 "aside by up to %.3f um %llu are, by %.4f um at most",
                 count(p.before), gap, p.deepest_before, p.largest_move, count(p.after), p.deepest_after);
}

// Widens `radius` until the cells fill `asked` of the box behind their contact planes, or where it may
// narrows it, and says how far it came.
void fill_box(conceg_ctx *ctx, const Bodies &bodies, const conceg_box &box, const std::vector<double> &target,
              const Classes &classes, double gap, double asked, bool shrinks, std::vector<double> &radius,
              Workers &workers) {
  std::vector<double> most = inflated(bodies, radius, 1e9);
  const Sample sample = make_sample(bodies, most, box, sample_points, gap, workers);
  const double before = fractions_of(bodies, radius, side(box), sample, gap, workers).planes;
  const Inflation done = shrinks && before > asked
                             ? deflate_to(bodies, radius, side(box), sample, gap, asked, workers)
                             : inflate_to(bodies, radius, target, classes.of_cell, classes.name.size(),
                                          side(box), sample, gap, asked, Tolerance(), workers);
  radius = inflated(bodies, radius, done.c);
  conceg_ctx_log(
      ctx, CONCEG_LOG_INFO,
      "volume fraction behind contact planes: %.4f without inflation, %.4f with %.4f um; asked %.4f", before,
      done.fraction, done.c, asked);
  if (done.stop == Inflation::Stop::none) return;
  const std::string name = classes.name[done.of_class];
  const std::string why =
      done.stop == Inflation::Stop::quarter ? "no radius may change by more than a quarter"
      : done.stop == Inflation::Stop::mean
          ? "the mean radius of class " + name + " may not be more than 15 % above its target"
          : "the coefficient of variation of the radii of class " + name +
                " may not be more than 10 % off its target";
  conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                 "relax: icvf: asked %.4f, reached %.4f: %s; ask for %s in the recipe", asked, done.fraction,
                 why.c_str(),
                 done.c < 0 ? "a lower perturb.ecs, or for less cable" : "more cable or thicker processes");
}

// Of the extracellular volume, from the recipe's `perturb`; 1 = unperturbed.
double ecs_factor(conceg_ctx *ctx, conceg_doc *doc) {
  double factor = 1;
  if (!has(doc, "/recipe")) return factor;
  conceg_recipe *raw = nullptr;
  must(conceg_recipe_from_doc(ctx, doc, &raw));
  const std::unique_ptr<conceg_recipe, decltype(&conceg_recipe_free)> recipe(raw, conceg_recipe_free);
  if (const conceg_node *node = conceg_node_get(conceg_recipe_root(raw), "perturb.ecs"))
    must(conceg_node_f64(ctx, node, &factor));
  return factor;
}

void relax_document(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const conceg_box box = read_box(doc);
  const glm::dvec3 sides = side(box);
  Skeletons skeletons = read_skeletons(doc);
  const Classes classes = read_classes(doc, skeletons.soma.size());
  const Progress progress = progress_of(ctx);
  Workers workers(conceg_ctx_threads(ctx));
  Collider collider(workers.threads());
  const Strength strength = strength_of(params);
  const Motion motion = motion_of(params);
  const double contact = conceg_params_f64(params, "contact_overlap_um"), ecs = ecs_factor(ctx, doc);
  double asked = conceg_params_f64(params, "icvf");
  Phases phases;
  const std::string table = conceg_params_text(params, "trace"),
                    pictures = conceg_params_text(params, "pictures");
  std::vector<Step> trace;

  Bodies bodies = make_bodies(skeletons, conceg_params_f64(params, "radius_min_um"));
  const std::vector<double> target = bodies.radius;
  const auto close_pairs = [&](const std::vector<double> &radius, double reach) {
    return collider.find(bodies, radius, box, reach, workers).pairs;
  };
  const auto fractions = [&](const std::vector<double> &radius) {
    const Sample sample = make_sample(bodies, radius, box, sample_points, strength.gap, workers);
    return fractions_of(bodies, radius, sides, sample, strength.gap, workers);
  };

  const std::vector<Pair> at_start = close_pairs(target, strength.gap);
  const Certificate before = certify(bodies, at_start, sides, strength.gap, target, workers);
  log_certificate(ctx, CONCEG_LOG_INFO, "before, at target radii", before);
  if (before.overlapping_somas)
    fail(CONCEG_E_RANGE,
         "/cells/soma: %llu pairs of somas overlap, by up to %.3f um (cells %u and %u); somas do not move: "
         "raise "
         "place.soma_gap_um",
         count(before.overlapping_somas), before.deepest_somas, before.soma_e, before.soma_f);
  const Sections sections = make_sections(bodies);
  const Shape shape = measure_shape(bodies, sections, workers);
  phases.end("input and search");
  std::vector<double> unmoved = target;
  const Cut without = cut_radii(bodies, at_start, sides, strength.gap, target, unmoved, workers, progress);

  phases.end("cut before");
  const Moved moved =
      move_bodies(bodies, sections, box, strength, motion, collider, workers, progress,
                  [&](int iteration, const State &state) {
                    log_state(ctx, iteration % 20 ? CONCEG_LOG_DEBUG : CONCEG_LOG_INFO, iteration, state);
                    if (!(table.empty() && pictures.empty()) && iteration % 5 == 0)
                      trace.push_back({iteration, state, fractions(target)});
                  });
  if (!table.empty()) write_table(table, trace);
  if (!pictures.empty()) write_figure(pictures, trace);
  phases.end("move");
  if (!moved.states.empty()) log_state(ctx, CONCEG_LOG_INFO, motion.iterations, moved.states.back());
  const Packed packed =
      pack(bodies, sections, box, strength, motion, rounds_of(params), collider, workers, progress);
  std::vector<double> radius = packed.radius;
  const Cut &cut = packed.cut;
  log_parted(ctx, packed.parted, strength.gap);
  log_shape(ctx, compare_shapes(shape, measure_shape(bodies, sections, workers)));
  const Fractions strict = fractions(radius);
  phases.end("cut and pack");
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "volume fraction of disjoint round cones, %.3f um apart: %.4f",
                 strength.gap, strict.united);
  if (contact > 0) {
    radius = target;
    cut_radii(bodies, close_pairs(target, 0), sides, -contact, target, radius, workers, progress);
  }
  // What the unperturbed run would fill: asked for, or what the cells come to by themselves.
  if (ecs != 1) asked = 1 - ecs * (1 - (asked > 0 ? asked : fractions(radius).planes));
  if (asked < 0)
    fail(CONCEG_E_RANGE, "perturb.ecs: expected an extracellular space of at most the box, got %.3f of it",
         1 - asked);
  if (asked > 0) fill_box(ctx, bodies, box, target, classes, strength.gap, asked, ecs != 1, radius, workers);

  phases.end("fill");
  std::vector<std::uint8_t> status(bodies.points);
  for (std::size_t i = 0; i < bodies.points; i++) {
    skeletons.position[i] = bodies.position[i];
    skeletons.radius[i] = not_above(radius[i]);
    status[i] = skeletons.radius[i] < skeletons.target_radius[i];
    radius[i] = skeletons.radius[i];
  }
  // The certificate looks at what is written, over a list of its own.
  const Search last = collider.find(bodies, radius, box, strength.gap, workers);
  const Certificate final = certify(bodies, last.pairs, sides, strength.gap, radius, workers);
  const bool chained = std::any_of(bodies.chunks.begin(), bodies.chunks.end(),
                                   [](const Chunk &chunk) { return chunk.count > 1; });
  if (!last.visited && chained)
    fail(CONCEG_E_STAGE, "the last search visited no pair of %zu round cones: nothing is proven",
         bodies.elements.size());
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "certificate: %llu pairs of %zu round cones visited",
                 count(last.visited), bodies.elements.size());
  log_certificate(ctx, CONCEG_LOG_INFO, "written", final);
  const bool left_to_planes = contact > 0 || asked > 0;
  if (final.overlapping && !left_to_planes)
    conceg_ctx_log(
        ctx, CONCEG_LOG_WARNING,
        "relax: %llu pairs still overlap at the least radius, by at most %.4f um (skeleton rows %u and %u); "
        "the mesh cuts them at their contact plane. Raise relax.iterations or lower relax.radius_min_um",
        count(final.overlapping), final.largest_overlap, final.worst_e, final.worst_f);
  if (final.overlapping && left_to_planes)
    conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                   "%llu pairs overlap, by at most %.4f um: left to the contact planes of the mesh",
                   count(final.overlapping), final.largest_overlap);
  const double step = conceg_params_f64(params, "mesh_step_um");
  const std::vector<Pair> near_planes = close_pairs(radius, strength.gap + 2 * step);
  if (const std::uint64_t pinched =
          count_pinched(bodies, near_planes, sides, strength.gap, step, radius, workers))
    conceg_ctx_log(ctx, left_to_planes ? CONCEG_LOG_WARNING : CONCEG_LOG_INFO,
                   "relax: at %llu points (%s) contact planes leave less than a mesh grid of %.3f um can "
                   "hold; a smaller "
                   "mesh.h_um or relax.contact_overlap_um keeps them",
                   count(pinched), percent(pinched, bodies.points).c_str(), step);
  const Fractions written = fractions(radius);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "written: volume fraction %.4f, %.4f of it in several cells; %.4f behind contact planes",
                 written.united, written.several, written.planes);
  log_classes(ctx, classes, class_radii(bodies, radius, target, classes.of_cell, classes.name.size()));
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "points below 95 %% of their target radius: %s without moving, %s after it; mean share of "
                 "the target %.4f, then %.4f (%llu sweeps)",
                 percent(without.constricted, bodies.points).c_str(),
                 percent(cut.constricted, bodies.points).c_str(), without.mean_share, cut.mean_share,
                 count(cut.sweeps));
  conceg_ctx_log(
      ctx, CONCEG_LOG_INFO,
      "moved %zu points in %d iterations, %llu lists of pairs, pruned %llu times (%llu runs in the last): "
      "shift %.3f um mean, %.3f um largest; cable %.1f -> %.1f um",
      bodies.points, motion.iterations, count(moved.rebuilds), count(moved.prunes), count(moved.runs),
      moved.mean_shift, moved.largest_shift, moved.length_before, moved.length_after);
  phases.end("certify");
  workers.count(ctx, "relax.items");
  tell_phases(ctx, "relax", phases, workers.busy_s(), workers.threads());
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
    {"forking", "1",
     "share of a change of the distance between the first points of a fork's two daughters that one step "
     "takes "
     "back",
     "0.25", nullptr, CONCEG_PARAM_F64, 0, 0, 0.5},
    {"tension", "1", "share of a section's change of length that one step adds to what its segments want",
     "0.1", nullptr, CONCEG_PARAM_F64, 0, 0, 1},
    {"straightening", "1",
     "share of what the ends of a section are too near for its straightness that one step adds to the pull "
     "on them",
     "0.01", nullptr, CONCEG_PARAM_F64, 0, 0, 1},
    {"momentum", "1", "share of the last step that goes on (heavy ball)", "0.8", nullptr, CONCEG_PARAM_F64, 0,
     0, 0.99},
    {"step_um", "um", "largest move of a point in one step", "0.05", nullptr, CONCEG_PARAM_F64, 0, 0.0001, 1},
    {"skin_um", "um", "slack of the list of pairs; changes the time, and the result by rounding", "0.6",
     nullptr, CONCEG_PARAM_F64, 0, 0.01, 5},
    {"rounds", "1", "after the iterations, rounds of cutting, widening and moving that pack without overlap",
     "0", nullptr, CONCEG_PARAM_I64, 0, 0, 1000},
    {"widening_um", "um", "of every radius at the beginning of the first round, falling to 0.3 of it", "0.12",
     nullptr, CONCEG_PARAM_F64, 0, 0, 1},
    {"swelling", "1",
     "how far a radius may pass its target in the rounds where there is room, times the target", "1", nullptr,
     CONCEG_PARAM_F64, 0, 1, 1.25},
    {"icvf", "1", "volume fraction to fill behind the mesh's contact planes by widening all radii; 0 = off",
     "0", nullptr, CONCEG_PARAM_F64, 0, 0, 0.95},
    {"contact_overlap_um", "um",
     "overlap that is left to the contact planes of the mesh; 0 = none, cells keep gap_um", "0", nullptr,
     CONCEG_PARAM_F64, 0, 0, 1},
    {"mesh_step_um", "um", "grid step of the mesh for which thin places are warned about", "0.16", nullptr,
     CONCEG_PARAM_F64, 0, 0.01, 10},
    {"trace", "", "table of energy, overlap and volume fraction every fifth iteration, a CSV file", "",
     nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"pictures", "", "folder for relaxation.svg: overlap and volume fraction by iteration", "", nullptr,
     CONCEG_PARAM_FILE, 0, 0, 0},
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
