// SPDX-License-Identifier: BSD-3-Clause
// The stage on a document: valid output, the same bytes for any number of threads, clear errors for broken
// input.
#include "check.h"
#include "conceg/run.h"
#include "view.hpp"
#include "world.hpp"

#include <functional>
#include <string>

extern "C" const conceg_stage conceg_stage_grow;

namespace {

World small_world() {
  World world;
  world.make_box(20, true);
  world.add_cell({5, 5, 5}, 2.5);
  world.add_random_trees(3, 5, 40, 0.4, 1);
  world.add_cell({14, 14, 14}, 2.5);
  world.add_random_trees(3, 5, 40, 0.4, 2);
  world.make_network(1.0, 0.2, 1.25);
  return world;
}

void fill(conceg_doc *doc, const World &world) {

  conceg::put(doc, "/domain@lo", world.box.lo, 3);
  conceg::put(doc, "/domain@hi", world.box.hi, 3);
  conceg::put(doc, "/domain@periodic", world.box.periodic, 3);
  const double pia[3] = {0, 0, 1};
  conceg::put(doc, "/domain@pia", pia, 3);
  conceg::put_scalar(doc, "/domain@lattice_step", CONCEG_LATTICE_STEP_UM);
  conceg::put_texts(doc, "/types/name", {"made up"});
  conceg::put_texts(doc, "/types/class", {"other"});
  conceg::put(doc, "/cells/id", world.cell_id);
  conceg::put(doc, "/cells/type", std::vector<std::uint32_t>(world.cell_id.size(), 0));
  conceg::put(doc, "/cells/soma", world.soma, 3);
  conceg::put(doc, "/cells/radius", world.soma_radius);
  conceg::put(doc, "/bars/cell_offset", world.bar_offset);
  conceg::put(doc, "/bars/tree", world.tree);
  conceg::put(doc, "/bars/parent", world.parent);
  conceg::put(doc, "/bars/neurite", world.neurite);
  conceg::put(doc, "/bars/asked_start", world.start);
  conceg::put(doc, "/bars/asked_end", world.end);
  conceg::put(doc, "/bars/attractor", world.attractor, 3);
  conceg::put(doc, "/bars/angle", world.angle);
  conceg::put(doc, "/bars/radius", world.radius);
  conceg::put(doc, "/bars/taper", world.taper);
  conceg::put(doc, "/bars/radius_floor", world.floor);
  conceg::put(doc, "/bars/state", std::vector<std::uint8_t>(world.tree.size(), 0));
  conceg::put(doc, "/network/position", world.node, 3);
  conceg::put(doc, "/network/radius", world.node_radius);
  conceg::put(doc, "/network/edge_offset", world.edge_offset);
  conceg::put(doc, "/network/edge", world.edge);
  conceg::put(doc, "/network/edge_shift", world.edge_shift, 3);
}

// Two entries; the type takes the second one, and only its basal rows are for the bars here.
void fill_dictionary(conceg_doc *doc) {
  conceg::put_texts(doc, "/types/entry", {"wavy"});
  conceg::put_texts(doc, "/dictionary/entry_name", {"smooth", "wavy"});
  conceg::put_texts(doc, "/dictionary/entry_class", {"other", "other"});
  conceg::put(doc, "/dictionary/entry_donor_offset", std::vector<std::uint64_t>{0, 0, 0});
  conceg::put(doc, "/dictionary/entry_angle_offset", std::vector<std::uint64_t>{0, 0, 0});
  conceg::put(doc, "/dictionary/calibre_entry", std::vector<std::uint32_t>{0, 1, 1});
  conceg::put(doc, "/dictionary/calibre_neurite", std::vector<std::uint8_t>{3, 4, 3});
  conceg::put(doc, "/dictionary/calibre_cv", std::vector<double>{0.5, 0.4, 0.3});
  conceg::put(doc, "/dictionary/calibre_correlation_length", std::vector<double>{1, 2, 3});
}

struct Outcome {
  conceg_status status;
  std::string error, skeleton, bars;
  bool network_left = false, valid = false;
  std::uint32_t workers = 0;
};

using Change = std::function<void(conceg_doc *)>;

Outcome run(const World &world, std::uint32_t threads, conceg_progress_fn progress = nullptr,
            const Change &more = nullptr, const char *set = nullptr) {
  Outcome outcome;
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_threads(ctx, threads);
  if (progress) conceg_ctx_set_progress(ctx, progress, nullptr);
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  fill(doc, world);
  if (more) more(doc);
  const char *const sets[] = {set, nullptr};
  outcome.status = conceg_params_new(ctx, &conceg_stage_grow, doc, nullptr, sets, nullptr, &params);
  if (outcome.status == CONCEG_OK) outcome.status = conceg_stage_run(ctx, &conceg_stage_grow, doc, params);
  outcome.error = conceg_ctx_error(ctx);
  if (outcome.status == CONCEG_OK) {
    char hex[65];
    CHECK_EQUAL(conceg_doc_digest(doc, "/skeleton", hex), CONCEG_OK);
    outcome.skeleton = hex;
    CHECK_EQUAL(conceg_doc_digest(doc, "/bars", hex), CONCEG_OK);
    outcome.bars = hex;
    outcome.network_left = conceg_doc_has(doc, "/network") != 0;
    outcome.valid = conceg_doc_validate(doc, "/skeleton", nullptr, nullptr) == CONCEG_OK &&
                    conceg_doc_validate(doc, "/bars", nullptr, nullptr) == CONCEG_OK;
    const std::uint64_t *values = nullptr;
    for (std::uint32_t i = 0; i < conceg_ctx_counters(ctx); i++)
      if (std::string(conceg_ctx_counter(ctx, i, &values, &outcome.workers)) == "grow.steps") break;
  }
  conceg_params_free(params);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return outcome;
}

void breaks(const char *says, conceg_status expected, const std::function<void(World &)> &change) {
  World world = small_world();
  change(world);
  const Outcome outcome = run(world, 1);
  CHECK_EQUAL(outcome.status, expected);
  if (outcome.error.find(says) == std::string::npos)
    fprintf(stderr, "expected \"%s\" in \"%s\"\n", says, outcome.error.c_str());
  CHECK(outcome.error.find(says) != std::string::npos);
}

void breaks_with(const char *says, conceg_status expected, const Change &more, const char *set = nullptr) {
  const Outcome outcome = run(small_world(), 1, nullptr, more, set);
  CHECK_EQUAL(outcome.status, expected);
  if (outcome.error.find(says) == std::string::npos)
    fprintf(stderr, "expected \"%s\" in \"%s\"\n", says, outcome.error.c_str());
  CHECK(outcome.error.find(says) != std::string::npos);
}

// The dictionary's calibre is used where it is asked for; without it the taper alone stands.
void calibre() {
  const World world = small_world();
  const Outcome plain = run(world, 1), waves = run(world, 1, nullptr, fill_dictionary);
  CHECK_EQUAL(waves.status, CONCEG_OK);
  CHECK(waves.valid && waves.skeleton != plain.skeleton);
  CHECK(waves.skeleton == run(world, 2, nullptr, fill_dictionary).skeleton);
  CHECK(plain.skeleton == run(world, 1, nullptr, fill_dictionary, "grow.calibre=taper").skeleton);
  const auto set_row = [](std::size_t row, double cv) {
    return [=](conceg_doc *doc) {
      fill_dictionary(doc);
      std::vector<double> all = {0.5, 0.4, 0.3};
      all[row] = cv;
      conceg::put(doc, "/dictionary/calibre_cv", all);
    };
  };
  CHECK(waves.skeleton == run(world, 1, nullptr, set_row(0, 0.1)).skeleton); // another entry
  CHECK(waves.skeleton == run(world, 1, nullptr, set_row(1, 0.1)).skeleton); // another neurite
  CHECK(waves.skeleton != run(world, 1, nullptr, set_row(2, 0.1)).skeleton);
  breaks_with("/dictionary/calibre_cv[2]", CONCEG_E_RANGE, set_row(2, -0.1));
  breaks_with("/types/entry[0]", CONCEG_E_MISSING, [](conceg_doc *doc) {
    fill_dictionary(doc);
    conceg::put_texts(doc, "/types/entry", {"unknown"});
  });
}

// A type's straightness is what its entry asks, unless it is left free.
void straightness() {
  const World world = small_world();
  const auto ask = [](double value) {
    return [=](conceg_doc *doc) {
      fill_dictionary(doc);
      conceg::put(doc, "/dictionary/entry_straightness", std::vector<double>{0.9, value});
    };
  };
  const Outcome steered = run(world, 1, nullptr, ask(0.8)), plain = run(world, 1, nullptr, fill_dictionary);
  CHECK_EQUAL(steered.status, CONCEG_OK);
  CHECK(steered.valid && steered.skeleton != plain.skeleton);
  CHECK(steered.skeleton == run(world, 2, nullptr, ask(0.8)).skeleton);
  CHECK(plain.skeleton == run(world, 1, nullptr, ask(0.0)).skeleton); // nothing was measured
  CHECK(plain.skeleton == run(world, 1, nullptr, ask(0.8), "grow.straightness=free").skeleton);
  breaks_with("/dictionary/entry_straightness[1]", CONCEG_E_RANGE, ask(1.5));
}

// A skeleton that growth did not write is not carried on; without one, finish grows all; without finish it is
// gone.
void finish() {
  const World world = small_world();
  CHECK(run(world, 1).skeleton == run(world, 1, nullptr, nullptr, "grow.finish=true").skeleton);
  const auto points = [](std::vector<std::int64_t> parent, std::vector<std::uint32_t> bar, double place = 1.0,
                         double end = 1.0) {
    return [=](conceg_doc *doc) {
      const std::size_t rows = parent.size();
      conceg::put(doc, "/skeleton/cell_offset", std::vector<std::uint64_t>{0, rows, rows});
      conceg::put(doc, "/skeleton/position", std::vector<double>(3 * rows, place).data(), rows, 3);
      conceg::put(doc, "/skeleton/radius", std::vector<float>(rows, 0.3f));
      conceg::put(doc, "/skeleton/target_radius", std::vector<float>(rows, 0.3f));
      conceg::put(doc, "/skeleton/parent", parent);
      conceg::put(doc, "/skeleton/bar", bar);
      const std::size_t bars = conceg::view<std::uint32_t>(doc, "/bars/tree").rows();
      conceg::put(doc, "/bars/achieved_start", std::vector<double>(bars, 0.0));
      conceg::put(doc, "/bars/achieved_end", std::vector<double>(bars, end));
    };
  };
  breaks_with("/skeleton/bar[1]", CONCEG_E_RANGE, points({-1, 0, 1}, {0, 999, 0}), "grow.finish=true");
  breaks_with("/skeleton/bar[2]", CONCEG_E_RANGE, points({-1, 0, 0}, {0, 0, 0}), "grow.finish=true");
  breaks_with("/skeleton/parent[1]", CONCEG_E_RANGE, points({-1, 1, 1}, {0, 0, 0}), "grow.finish=true");
  breaks_with("/skeleton/position[0]", CONCEG_E_RANGE, points({-1, 0, 1}, {0, 0, 0}, 1e300),
              "grow.finish=true");
  breaks_with("/bars/achieved_end[0]", CONCEG_E_RANGE, points({-1, 0, 1}, {0, 0, 0}, 1.0, 1e300),
              "grow.finish=true");
  breaks_with("one point", CONCEG_E_RANGE, points({-1}, {0}), "grow.finish=true");
  CHECK(run(world, 1).skeleton == run(world, 1, nullptr, points({-1, 0, 1}, {0, 999, 0})).skeleton);
}

void parameters_out_of_range() {
  for (const char *set : {"grow.lambda_per_um=0", "grow.lambda_per_um=-1", "grow.f=-1", "grow.g0_um=0",
                          "grow.r_min_um=0", "grow.retries=-1", "grow.calibre=none"})
    breaks_with(std::string(set).substr(0, std::string(set).find('=')).c_str(), CONCEG_E_PARAM, nullptr, set);
}

} // namespace

int main() {
  const World world = small_world();
  const Outcome one = run(world, 1), two = run(world, 2), three = run(world, 3);
  CHECK_EQUAL(one.status, CONCEG_OK);
  CHECK(one.valid);
  CHECK(!one.network_left);
  CHECK(one.skeleton == two.skeleton && one.skeleton == three.skeleton);
  CHECK(one.bars == two.bars && one.bars == three.bars);
  CHECK_EQUAL(two.workers, 2);

  const auto stop = [](void *, const char *, std::uint64_t, std::uint64_t) { return 1; };
  CHECK_EQUAL(run(world, 2, stop).status, CONCEG_E_CANCELLED);

  breaks("/network/edge[7]", CONCEG_E_RANGE, [](World &w) { w.edge[7] = 4000000000u; });
  breaks("/network/edge_offset[4]", CONCEG_E_RANGE, [](World &w) { w.edge_offset[4] = 0; });
  breaks("/network/position[3]", CONCEG_E_RANGE, [](World &w) { w.node[10] = 21.0; });
  breaks("/bars/parent[1]", CONCEG_E_RANGE, [](World &w) { w.parent[1] = 1; });
  breaks("/bars/parent[1]", CONCEG_E_RANGE, [](World &w) { w.parent[1] = -1; });
  breaks("/bars/asked_end[2]", CONCEG_E_RANGE, [](World &w) { w.end[2] = w.start[2]; });
  breaks("/bars/attractor[5]", CONCEG_E_RANGE, [](World &w) { w.attractor[5] = 0.0 / 0.0 * w.attractor[5]; });
  breaks("/bars/cell_offset[2]", CONCEG_E_RANGE, [](World &w) { w.bar_offset[2]++; });
  breaks("/cells/soma[1]", CONCEG_E_RANGE, [](World &w) { w.soma[4] = -1.0; });
  breaks("/cells/radius[1]", CONCEG_E_RANGE, [](World &w) { w.soma_radius[1] = 10.1f; });
  breaks("/domain", CONCEG_E_RANGE, [](World &w) { w.box.hi[2] = 7.9; });
  breaks("/bars/radius[2]", CONCEG_E_RANGE, [](World &w) { w.radius[2] = 0.0; });
  breaks_with("too sparse", CONCEG_E_RANGE, nullptr, "grow.max_edge_um=0.5");
  breaks_with("/cells/type[1]", CONCEG_E_RANGE, [](conceg_doc *doc) {
    conceg::put(doc, "/cells/type", std::vector<std::uint32_t>{0, 7});
  });
  calibre();
  straightness();
  finish();
  parameters_out_of_range();
  return check_done();
}
