// SPDX-License-Identifier: BSD-3-Clause
// The structural comparison: verdicts on cells of one distribution and on planted differences, its weights
// by hand, and analyse --structure as the host runs it, with what it refuses.
#include "../../common/tests/bytes.hpp"
#include "../structure_input.hpp"
#include "barcodes.hpp"
#include "check.h"
#include "conceg/conceg.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <unistd.h>

using namespace conceg;
using namespace conceg::analyse;

extern "C" const conceg_stage conceg_stage_analyse;

namespace {

// ---- Cells made of random branches ----

struct Planted {
  double length = 50, length_sd = 6, straightness = 0.83, angle = 70;
};

// Cells differ by their own means, branches by more.
StructureCell cell_of(conceg_rng &rng, const Planted &planted, const std::string &donor, std::uint32_t set) {
  StructureCell cell;
  cell.donor = donor, cell.set = set;
  const double length = planted.length + planted.length_sd * conceg_rng_normal(&rng),
               angle = planted.angle + 5 * conceg_rng_normal(&rng), order = 3 + 0.5 * conceg_rng_normal(&rng);
  for (int b = 0; b < 25; b++) {
    const bool tip = b % 2;
    cell.branches.push_back({std::max(1.0, std::round(order + conceg_rng_normal(&rng))),
                             length * (0.4 + 1.2 * conceg_rng_uniform(&rng)),
                             planted.straightness + 0.1 * (conceg_rng_uniform(&rng) - 0.5),
                             tip ? -1.0 : angle + 10 * conceg_rng_normal(&rng),
                             tip ? 3 * length + 20 * conceg_rng_normal(&rng) : -1.0});
  }
  return cell;
}

// As by cross-validation: a real cell of each donor in one of five sets, grown ones of the other donors.
StructureGroup group_of(std::size_t donors, std::size_t grown, const Planted &planted, std::uint64_t id) {
  StructureGroup group;
  group.entry = "entry";
  conceg_rng rng = conceg_rng_stream(3, "test.structure", id);
  for (std::size_t d = 0; d < donors; d++)
    group.real.push_back(cell_of(rng, {}, "donor " + std::to_string(d), static_cast<std::uint32_t>(d % 5)));
  for (std::size_t g = 0; g < grown; g++) {
    const std::size_t set = g % 5, donor = (set + 1 + g / 5 % 4) % 5; // not of its own set
    group.grown.push_back(
        cell_of(rng, planted, "donor " + std::to_string(donor), static_cast<std::uint32_t>(set)));
  }
  return group;
}

StructureResult compared(const StructureGroup &group, unsigned threads = 2) {
  Workers workers(threads);
  StructureSettings settings;
  settings.bootstraps = settings.splits = 300;
  return compare_structure(group, settings, workers, {});
}

const StructureJudgement &found(const StructureResult &r, Level level, Trait trait, Statistic statistic) {
  for (const StructureJudgement &j : r.judgements)
    if (j.level == level && j.trait == trait && j.statistic == statistic) return j;
  CHECK(!"a judgement");
  return r.judgements.front();
}
const StructureJudgement &auc_of(const StructureResult &r) {
  return r.judgements.back();
}

void one_distribution() {
  const StructureResult r = compared(group_of(30, 60, {}, 1));
  CHECK_EQUAL(r.donors, 30);
  CHECK_EQUAL(r.judgements.size(), (6 + 5) * 4 + 1);
  double above = 0;
  for (const StructureJudgement &j : r.judgements) {
    CHECK(j.verdict != "outside");
    CHECK(j.halves < j.floor && j.low <= j.high);
    above += j.above / static_cast<double>(r.judgements.size());
  }
  CHECK(above < 0.10); // chance: 0.05
  const StructureJudgement &d = found(r, Level::cell, Trait::branch_length, Statistic::cohens_d);
  CHECK(d.low < 0 && d.high > 0 && std::abs(d.value) < 0.6);
  CHECK(auc_of(r).all_traits && std::abs(auc_of(r).value - 0.5) < 0.2);
}

void planted_differences() {
  Planted crooked, narrow;
  crooked.straightness = 0.78; // branches spread by 0.03
  const StructureResult r = compared(group_of(30, 60, crooked, 2));
  for (const Level level : {Level::cell, Level::branch}) {
    const StructureJudgement &j = found(r, level, Trait::straightness, Statistic::cohens_d);
    CHECK_TEXT(j.verdict.c_str(), "outside");
    CHECK(j.high < -1 && j.halves > j.floor && j.above > 0.9);
    CHECK_TEXT(found(r, level, Trait::straightness, Statistic::kolmogorov).verdict.c_str(), "outside");
    CHECK_TEXT(found(r, level, Trait::straightness, Statistic::wasserstein).verdict.c_str(), "outside");
    CHECK(found(r, level, Trait::local_angle, Statistic::cohens_d).verdict != "outside");
  }
  CHECK_TEXT(auc_of(r).verdict.c_str(), "outside");
  CHECK(auc_of(r).value > 0.95);
  narrow.length_sd = 0.5; // the same mean, a tenth of the spread
  const StructureResult same_mean = compared(group_of(30, 60, narrow, 3));
  const StructureJudgement &ratio = found(same_mean, Level::cell, Trait::branch_length, Statistic::sd_ratio);
  CHECK_TEXT(ratio.verdict.c_str(), "outside");
  CHECK(ratio.value < 0.6 && ratio.high < 1 && ratio.floor > 1 && ratio.halves > ratio.floor);
  CHECK(found(same_mean, Level::cell, Trait::branch_length, Statistic::cohens_d).verdict != "outside");
}

void few_donors() {
  const StructureResult wide = compared(group_of(5, 20, {}, 4));
  CHECK(wide.wide());
  for (const StructureJudgement &j : wide.judgements)
    CHECK(j.verdict != "within");
  for (const StructureJudgement &j : wide.judgements)
    CHECK(j.verdict == (j.above > 0.95 ? "outside" : "unsure"));
  Planted crooked;
  crooked.straightness = 0.67; // the paper's
  const StructureResult far = compared(group_of(6, 20, crooked, 7));
  CHECK_TEXT(found(far, Level::branch, Trait::straightness, Statistic::cohens_d).verdict.c_str(), "outside");
  for (const std::size_t donors : {1, 2, 3}) {
    const StructureResult few = compared(group_of(donors, 20, {}, 5));
    CHECK_EQUAL(few.donors, donors);
    for (const StructureJudgement &j : few.judgements)
      CHECK_TEXT(j.verdict.c_str(), "-");
  }
  StructureGroup nobody = group_of(0, 20, {}, 6);
  const StructureResult alone = compared(nobody);
  CHECK(alone.judgements.empty() && !alone.means.empty());
  CHECK_NEAR(alone.means[0].grown.count, 20, 0);
  nobody.grown.clear();
  CHECK(compared(nobody).means.empty());
}

// Each set counts as its real cells do, whatever the number of grown ones.
void weights_of_sets() {
  const auto cell = [](double length, const char *donor, std::uint32_t set) {
    StructureCell out;
    out.donor = donor, out.set = set;
    out.branches.push_back({1, length, -1, -1, length});
    return out;
  };
  StructureGroup group;
  group.entry = "entry";
  group.real = {cell(10, "a", 0), cell(20, "b", 0), cell(30, "c", 1), cell(99, "e", 7)}; // set 7 grew nothing
  group.grown = {cell(1, "c", 0), cell(2, "a", 1), cell(2, "a", 1), cell(2, "b", 1), cell(50, "a", 3)};
  const StructureResult r = compared(group);
  CHECK_EQUAL(r.grown, 4);
  CHECK_EQUAL(r.donors, 3);
  CHECK_EQUAL(r.grown_left_out, 1);
  CHECK_EQUAL(r.real_left_out, 1);
  const StructureMeans &length = r.means[1];
  CHECK(length.trait == Trait::branch_length && length.level == Level::cell);
  CHECK_NEAR(length.grown.mean, (2 * 1.0 + 1 * 2.0) / 3, 1e-12);
  CHECK_NEAR(length.grown.count, 4, 1e-12);
  CHECK_NEAR(length.real.mean, 20, 1e-12);
  CHECK_NEAR(length.wasserstein, 20 - 4.0 / 3, 1e-12);
  CHECK_NEAR(length.grown_quantiles.front(), 1, 0);
  CHECK_NEAR(length.grown_quantiles.back(), 2, 0);
  CHECK_NEAR(length.real_quantiles[10], 20, 0);
  CHECK_NEAR(r.means[2].grown.count, 0, 0); // no branch is judged straight
  CHECK(std::isnan(found(r, Level::cell, Trait::straightness, Statistic::kolmogorov).value));
}

// A dendrite with a fork of two, and an axon; -1 where a branch has no such value.
void branches_of_dendrites() {
  metrics::Metrics cell;
  const auto section = [&](std::int64_t parent, std::uint32_t tree, int kind, int order, double length) {
    metrics::Section s;
    s.parent = parent, s.tree = tree, s.kind = kind, s.order = order, s.length = s.path_distance = length;
    cell.sections.push_back(s);
  };
  section(-1, 0, 3, 1, 5), section(0, 0, 3, 2, 1), section(0, 0, 3, 2, 4), section(-1, 1, axon_code, 1, 700);
  cell.sections[0].children = 2, cell.sections[0].local_angle = 1.5707963267948966;
  cell.sections[0].straightness_1um = 0.9;
  const std::vector<Branch> found = branches_of(cell);
  CHECK_EQUAL(found.size(), 3);
  CHECK(found[0] == (Branch{1, 5, 0.9, found[0][3], -1}) && found[1] == (Branch{2, 1, -1, -1, 1}));
  CHECK_NEAR(found[0][3], 90, 1e-12);
  StructureCell one;
  one.branches = found;
  CHECK_NEAR(values_at(one, Trait::cable, Level::cell).at(0), 10, 0);
  CHECK_NEAR(values_at(one, Trait::branch_length, Level::cell).at(0), 10.0 / 3, 1e-12);
  CHECK_EQUAL(values_at(one, Trait::local_angle, Level::branch).size(), 1);
  one.branches.clear();
  CHECK(values_at(one, Trait::order, Level::cell).empty() &&
        values_at(one, Trait::cable, Level::cell)[0] == 0);
}

void same_for_any_threads() {
  const StructureGroup group = group_of(12, 24, {}, 8);
  const StructureResult one = compared(group, 1), three = compared(group, 3);
  for (std::size_t i = 0; i < one.judgements.size(); i++) {
    const StructureJudgement &a = one.judgements[i], &b = three.judgements[i];
    CHECK(a.low == b.low && a.high == b.high && a.halves == b.halves && a.floor == b.floor);
  }
}

template <class Body> std::string refusal(Body body) {
  try {
    body();
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}
void refused(const std::string &line, const char *piece) {
  if (line.find(piece) == std::string::npos) {
    CHECK(!"a refusal");
    fprintf(stderr, "expected %s in: %s\n", piece, line.c_str());
  }
}

void shared_donors() {
  StructureGroup group = group_of(10, 20, {}, 9);
  group.grown[0].donor = group.real[0].donor;
  CHECK_EQUAL(group.grown[0].set, group.real[0].set);
  refused(refusal([&] { compared(group); }), "donor 0 on both sides");
  group = group_of(10, 20, {}, 10);
  group.real.push_back(group.real[3]);
  refused(refusal([&] { compared(group); }), "donor 3 twice");
  refused(refusal([] {
            check_donors({{"x", "one", 0, true}, {"y", "one", 0, false}, {"x", "two", 0, false}});
          }),
          "got one among");
  CHECK_TEXT(refusal([] { check_donors({{"x", "one", 0, true}, {"x", "one", 1, false}}); }).c_str(), "");
}

// ---- The stage ----

const std::filesystem::path folder =
    std::filesystem::temp_directory_path() / ("conceg_analyse_structure_" + std::to_string(getpid()));

std::string path_of(const char *name) {
  return (folder / name).string();
}

// A document of characterise: two cells of one fork each, the second with an axon.
void write_real(const char *name, const std::function<void(conceg_doc *)> &spoil,
                const std::vector<std::string> &donor) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  const auto table = [](const char *column) { return std::string("/statistics/section_metrics/") + column; };
  const auto numbers = [&](const char *column, const std::vector<double> &v) {
    put(doc, table(column).c_str(), v);
  };
  const auto wholes = [&](const char *column, const std::vector<std::uint64_t> &v) {
    put(doc, table(column).c_str(), v);
  };
  const std::string entry = "L23_pyramidal", &a = donor[0], &b = donor[1];
  put_texts(doc, table("entry").c_str(), std::vector<std::string>(7, entry));
  put_texts(doc, table("donor").c_str(), {a, a, a, b, b, b, b});
  put_texts(doc, table("neurite").c_str(), {"basal", "basal", "basal", "apical", "apical", "apical", "axon"});
  wholes("parent", {0, 1, 1, 0, 1, 1, 0}), wholes("order", {1, 2, 2, 1, 2, 2, 1});
  wholes("daughters", {2, 0, 0, 2, 0, 0, 0});
  numbers("length", {3, 5, 4, 6, 1, 8, 500}), numbers("straightness_1um", {1, 0.9, 0.8, 0.9, -1, 0.7, 0.1});
  numbers("local_angle", {1.2, -1, -1, 1.5, -1, -1, -1});
  numbers("path_distance", {3, 8, 7, 6, 7, 14, 500});
  spoil(doc);
  CHECK_EQUAL(conceg_doc_save(doc, path_of(name).c_str()), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
}

struct Run {
  conceg_status status = CONCEG_OK;
  std::string error, bytes, log;
  std::vector<std::string> verdict, statistic;
  std::vector<double> value, real_mean;
};

void keep_line(void *user, conceg_log_level level, const char *line) {
  if (level <= CONCEG_LOG_RESULT) static_cast<std::string *>(user)->append(line).append("\n");
}

Run run(std::uint32_t threads, const std::function<void(conceg_doc *)> &build,
        const std::vector<std::string> &options, const char *save = nullptr) {
  Run out;
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_threads(ctx, threads);
  conceg_ctx_set_log(ctx, CONCEG_LOG_INFO, keep_line, &out.log);
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  conceg::testing::put_domain(doc), conceg::testing::put_cells(doc);
  build(doc);
  std::vector<const char *> sets = {"analyse.field_step_um=1"};
  for (const std::string &option : options)
    sets.push_back(option.c_str());
  sets.push_back(nullptr);
  CHECK_EQUAL(conceg_params_new(ctx, &conceg_stage_analyse, doc, nullptr, sets.data(), nullptr, &params),
              CONCEG_OK);
  out.status = conceg_stage_run(ctx, &conceg_stage_analyse, doc, params);
  out.error = conceg_ctx_error(ctx);
  if (out.status == CONCEG_OK) {
    out.bytes = conceg::testing::bytes_of(doc);
    out.verdict = texts(doc, "/statistics/structure/verdict");
    out.statistic = texts(doc, "/statistics/structure/statistic");
    const View<double> value = view<double>(doc, "/statistics/structure/value"),
                       real = view<double>(doc, "/statistics/structure_means/real_mean");
    out.value.assign(value.begin(), value.end()), out.real_mean.assign(real.begin(), real.end());
    if (save) CHECK_EQUAL(conceg_doc_save(doc, path_of(save).c_str()), CONCEG_OK);
  }
  conceg_params_free(params);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return out;
}

// Two pyramidal cells of the donors one and two, and an astrocyte of three.
void put_grown(conceg_doc *doc) {
  conceg::testing::put_skeleton(doc);
  barcodes::put_dictionary(doc, barcodes::simple, 0.9);
  put(doc, "/cells/type", std::vector<std::uint32_t>{0, 0, 2});
  put(doc, "/cells/donor", std::vector<std::uint32_t>{0, 1, 2});
  put_texts(doc, "/types/entry", {"L23_pyramidal", "", "astrocyte"});
}

void nothing(conceg_doc *) {}

void stage() {
  write_real("real.cgx", nothing, {"held one", "held two"});
  const std::string real = "analyse.structure=" + path_of("real.cgx");
  const Run one = run(1, put_grown, {real}, "analysed.cgx");
  CHECK_TEXT(one.error.c_str(), "");
  CHECK_EQUAL(one.status, CONCEG_OK);
  CHECK(one.bytes == run(3, put_grown, {real}).bytes);
  // Cell level: order, length, straightness, angle, path to tips, cable of the real cells, without the axon.
  const double expected[] = {5.0 / 3,          (4.0 + 5.0) / 2,  (0.9 + 0.8) / 2, 57.29577951308232 * 1.35,
                             (7.5 + 10.5) / 2, (12.0 + 15.0) / 2};
  for (std::size_t t = 0; t < 6; t++)
    CHECK_NEAR(one.real_mean[t], expected[t], 1e-12);
  for (const std::string &verdict : one.verdict)
    CHECK_TEXT(verdict.c_str(), "-"); // two donors bound nothing
  for (const char *piece :
       {"L23_pyramidal: 2 donors: wide", "grown from one two; held back held one held two", "paper, real",
        "astrocyte: no real cell; against the published row"})
    if (one.log.find(piece) == std::string::npos) {
      CHECK(!"a piece of the printed table");
      fprintf(stderr, "missing: %s\n%s", piece, one.log.c_str());
    }
  // Another fold is pooled: four donors, which can be split.
  write_real("other.cgx", nothing, {"held three", "held four"});
  const std::string other = "analyse.structure=" + path_of("other.cgx"),
                    pool = "analyse.structure_pool=" + path_of("analysed.cgx"),
                    dir = "analyse.structure_dir=" + path_of("tables");
  const Run pooled = run(2, put_grown, {other, pool, dir}, "pooled.cgx");
  CHECK_TEXT(pooled.error.c_str(), "");
  CHECK(pooled.log.find("L23_pyramidal: 4 donors: wide") != std::string::npos);
  CHECK(pooled.log.find("set 1: grown from one two; held back held one held two") != std::string::npos);
  CHECK_NEAR(pooled.real_mean[5], 13.5, 1e-12);
  for (const char *name :
       {"structure.csv", "structure_means.csv", "structure_branch.csv", "structure_cell.csv",
        "structure_donor.csv", "structure_quantile.csv", "structure.txt"})
    CHECK(std::filesystem::file_size(folder / "tables" / name) > 50);
  // A pool of pools keeps its sets apart.
  write_real("third.cgx", nothing, {"held five", "held six"});
  const Run twice =
      run(2, put_grown,
          {"analyse.structure=" + path_of("third.cgx"), "analyse.structure_pool=" + path_of("pooled.cgx")});
  CHECK(twice.log.find("L23_pyramidal: 6 donors: wide") != std::string::npos);
}

void stage_refuses() {
  const std::string real = "analyse.structure=" + path_of("real.cgx");
  const auto error_of = [&](const std::function<void(conceg_doc *)> &build,
                            const std::vector<std::string> &options, conceg_status status) {
    const Run r = run(1, build, options);
    CHECK_EQUAL(r.status, status);
    return r.error;
  };
  refused(error_of([](conceg_doc *doc) { conceg::testing::put_skeleton(doc); }, {real}, CONCEG_E_MISSING),
          "no /dictionary, which says of whom its cells were grown; give one that place began");
  refused(error_of(nothing, {real}, CONCEG_E_MISSING), "no /skeleton");
  refused(error_of(put_grown, {"analyse.structure_dir=" + path_of("tables")}, CONCEG_E_PARAM),
          "expected structure, the document of real cells");
  refused(error_of(put_grown, {"analyse.structure=" + path_of("nowhere.cgx")}, CONCEG_E_IO), "nowhere.cgx");
  // Donors on both sides are named, whatever their entry.
  write_real("shared.cgx", nothing, {"held one", "three"});
  const std::string shared = "analyse.structure=" + path_of("shared.cgx");
  refused(error_of(put_grown, {shared}, CONCEG_E_RANGE),
          "got three among those of the grown and of the real");
  // Marked as held back it is none of those grown from; what the entry says is still of it, which is told.
  const Run marked = run(1,
                         [](conceg_doc *doc) {
                           put_grown(doc);
                           put(doc, "/cells/donor", std::vector<std::uint32_t>{0, 1, 0});
                           put(doc, "/dictionary/donor_validation", std::vector<std::uint8_t>{0, 0, 1});
                         },
                         {shared});
  CHECK_TEXT(marked.error.c_str(), "");
  CHECK(marked.log.find("growth was told the straightness of all") != std::string::npos);
  write_real("astray.cgx",
             [](conceg_doc *doc) {
               put_texts(doc, "/statistics/section_metrics/entry",
                         std::vector<std::string>(7, "L6_pyramidal"));
             },
             {"held one", "held two"});
  refused(error_of(put_grown, {"analyse.structure=" + path_of("astray.cgx")}, CONCEG_E_RANGE),
          "astray.cgx: expected cells of the entries that were grown, got none");
  refused(error_of(put_grown, {"analyse.structure=" + path_of("analysed.cgx")}, CONCEG_E_MISSING),
          "has no /statistics/section_metrics; make it with conceg characterise");
  refused(error_of(put_grown, {real, "analyse.structure_pool=" + path_of("real.cgx")}, CONCEG_E_MISSING),
          "make it with conceg analyse --structure");
  refused(error_of(put_grown, {real, "analyse.structure_pool=" + path_of("analysed.cgx")}, CONCEG_E_RANGE),
          "held one twice");
  write_real("short.cgx",
             [](conceg_doc *doc) {
               put(doc, "/statistics/section_metrics/length", std::vector<double>{1, 2});
             },
             {"held one", "held two"});
  refused(error_of(put_grown, {"analyse.structure=" + path_of("short.cgx")}, CONCEG_E_FORMAT), "length");
  write_real(
      "nan.cgx",
      [](conceg_doc *doc) {
        put(doc, "/statistics/section_metrics/path_distance", std::vector<double>{3, NAN, 7, 6, 7, 14, 500});
      },
      {"held one", "held two"});
  refused(error_of(put_grown, {"analyse.structure=" + path_of("nan.cgx")}, CONCEG_E_FORMAT),
          "path_distance[1]: expected a finite");
}

} // namespace

int main(void) {
  one_distribution();
  planted_differences();
  few_donors();
  weights_of_sets();
  branches_of_dendrites();
  same_for_any_threads();
  shared_donors();
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  stage();
  stage_refuses();
  std::filesystem::remove_all(folder);
  return check_done();
}
