// SPDX-License-Identifier: BSD-3-Clause
// The analyse stage as the host runs it: tables of a small tissue, with and without meshes; clear errors.
#include "../../common/tests/bytes.hpp"
#include "../../common/tests/tissue.hpp"
#include "conceg/conceg.h"

#include "check.h"

#include <cmath>
#include <string>

using namespace conceg;

extern "C" const conceg_stage conceg_stage_analyse;

namespace {

struct Run {
  conceg_status status = CONCEG_OK;
  std::string error, bytes, log;
  std::vector<std::string> names;
  std::vector<double> values;
  double value(const char *name) const {
    for (std::size_t i = 0; i < names.size(); i++)
      if (names[i] == name) return values[i];
    return NAN;
  }
};

void keep_line(void *user, conceg_log_level, const char *line) {
  static_cast<std::string *>(user)->append(line).append("\n");
}

template <class Spoil>
Run run(std::uint32_t threads, bool skeleton, bool meshes, Spoil spoil, const char *set = nullptr) {
  Run out;
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_threads(ctx, threads);
  conceg_ctx_set_log(ctx, CONCEG_LOG_INFO, keep_line, &out.log);
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  testing::put_domain(doc);
  testing::put_cells(doc);
  if (skeleton) testing::put_skeleton(doc);
  if (meshes) testing::put_meshes(doc, 4);
  spoil(doc);
  const char *sets[] = {"analyse.points=50000", set, nullptr};
  CHECK_EQUAL(conceg_params_new(ctx, &conceg_stage_analyse, doc, nullptr, sets, nullptr, &params), CONCEG_OK);
  out.status = conceg_stage_run(ctx, &conceg_stage_analyse, doc, params);
  out.error = conceg_ctx_error(ctx);
  if (out.status == CONCEG_OK) {
    out.bytes = conceg::testing::bytes_of(doc);
    out.names = texts(doc, "/statistics/summary/name");
    const View<double> values = view<double>(doc, "/statistics/summary/value");
    out.values.assign(values.begin(), values.end());
  }
  conceg_params_free(params);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return out;
}

void nothing(conceg_doc *) {}

void tables() {
  const Run all = run(1, true, true, nothing);
  if (all.status != CONCEG_OK) fprintf(stderr, "%s\n", all.error.c_str());
  CHECK_EQUAL(all.status, CONCEG_OK);
  const double balls = 4.0 / 3 * 3.14159265358979323846 * (64 + 27 + 8) / 8000;
  CHECK_NEAR(all.value("icvf_mesh"), balls, 0.001);
  CHECK_NEAR(all.value("soma_fraction"), balls, 0.001);
  CHECK_NEAR(all.value("icvf_points"), balls, 5 * all.value("icvf_points_standard_error"));
  CHECK_NEAR(all.value("cells"), 3, 0);
  CHECK(all.value("cable") > 30);
  CHECK(all.value("neurite_fraction") > 0.001);
  CHECK(all.log.find("icvf_mesh") != std::string::npos);
  CHECK(all.log.find("no /bars") != std::string::npos); // what is missing is named
  CHECK(all.bytes == run(2, true, true, nothing).bytes);
  CHECK(all.bytes == run(3, true, true, nothing).bytes);
}

void without_meshes() {
  const Run plain = run(2, true, false, nothing);
  CHECK_EQUAL(plain.status, CONCEG_OK);
  CHECK(std::isnan(plain.value("icvf_mesh")) && plain.value("icvf_field") > 0.05);
  CHECK(plain.log.find("no /meshes") != std::string::npos);
  const Run bare = run(2, false, false, nothing);
  CHECK_EQUAL(bare.status, CONCEG_OK);
  CHECK_NEAR(bare.value("cells"), 3, 0);
  CHECK(std::isnan(bare.value("passing_axons")));
}

// One leaf of voxels of 2.5 um: read when that is fine enough, left alone when it is not.
void volumes_are_read_where_they_suffice() {
  const auto put_volume = [](conceg_doc *doc) {
    const double origin[3] = {1.25, 1.25, 1.25}, spacing[3] = {2.5, 2.5, 2.5};
    const std::uint64_t shape[3] = {8, 8, 8};
    put(doc, "/volumes@origin", origin, 3);
    put(doc, "/volumes@spacing", spacing, 3);
    put(doc, "/volumes@shape", shape, 3);
    put(doc, "/volumes/leaf_origin", std::vector<std::int32_t>{0, 0, 0}, 3);
    std::vector<std::uint32_t> label(512, 0);
    std::fill(label.begin(), label.begin() + 128, 1u);
    put(doc, "/volumes/label", label, 512);
  };
  const Run fine = run(2, true, false, put_volume, "analyse.field_step_um=2.5");
  CHECK_EQUAL(fine.status, CONCEG_OK);
  CHECK_NEAR(fine.value("icvf_field"), 0.25, 1e-12);
  CHECK_NEAR(fine.value("field_step"), 2.5, 1e-12);
  CHECK(fine.log.find("that of /volumes/label") != std::string::npos);
  const Run coarse = run(2, true, false, put_volume, "analyse.field_step_um=0.5");
  CHECK_NEAR(coarse.value("icvf_field"),
             run(2, true, false, nothing, "analyse.field_step_um=0.5").value("icvf_field"), 0);
  CHECK(std::isnan(fine.value("ecs_cleft_width")));
  const Run pores = run(2, true, false, [&](conceg_doc *doc) {
    put_volume(doc);
    std::vector<float> distance(512, -1.0f);
    for (std::size_t i = 128; i < 512; i++)
      distance[i] = i % 2 ? 0.1f : 0.3f;
    put(doc, "/volumes/distance", distance, 512);
  });
  CHECK_NEAR(pores.value("ecs_cleft_width"), 0.8, 1e-6);
  const Run alone = run(2, false, false, put_volume, "analyse.field_step_um=3");
  CHECK_NEAR(alone.value("icvf_field"), 0.25, 1e-12);
  const Run wrong = run(
      2, true, false,
      [&](conceg_doc *doc) {
        put_volume(doc);
        put(doc, "/volumes/label", std::vector<std::uint32_t>(512, 9), 512);
      },
      "analyse.field_step_um=3");
  CHECK_EQUAL(wrong.status, CONCEG_E_FORMAT);
  CHECK(wrong.error.find("/volumes/label[0]") != std::string::npos);
}

// Class axon without a soma is no cell of the box; class axon with one, and others without, are.
void passing_axons_are_no_cells() {
  const Run axons = run(2, true, false, [](conceg_doc *doc) {
    put_texts(doc, "/types/class", {"axon", "axon", "other"});
    put(doc, "/cells/radius", std::vector<float>{0, 3, 0});
  });
  CHECK_EQUAL(axons.status, CONCEG_OK);
  CHECK_NEAR(axons.value("cells"), 2, 0);
  CHECK_NEAR(axons.value("passing_axons"), 1, 0);
  CHECK_NEAR(axons.value("cell_density"), 2.0 / 8000, 1e-15);
}

void disagreement_is_warned_about() {
  // Spheres of the skeleton larger than the meshes by half.
  const Run off = run(1, true, true, [](conceg_doc *doc) {
    put(doc, "/cells/radius", std::vector<float>{6, 4, 3});
  });
  CHECK_EQUAL(off.status, CONCEG_OK);
  CHECK(off.log.find("measures differ") != std::string::npos);
}

void planted_defects() {
  const Run inside_out = run(1, true, true, [](conceg_doc *doc) {
    const View<std::uint32_t> face = view<std::uint32_t>(doc, "/meshes/face", 3);
    std::vector<std::uint32_t> turned(face.begin(), face.end());
    for (std::size_t f = 0; f < turned.size(); f += 3)
      std::swap(turned[f], turned[f + 1]);
    put(doc, "/meshes/face", turned, 3);
  });
  CHECK_EQUAL(inside_out.status, CONCEG_E_FORMAT);
  CHECK(inside_out.error.find("surface 0 (cell 0)") != std::string::npos);
  const Run beyond = run(1, true, true, [](conceg_doc *doc) {
    put(doc, "/meshes/cell", std::vector<std::uint32_t>{0, 1, 7});
  });
  CHECK(beyond.status != CONCEG_OK);
  CHECK(beyond.error.find("/meshes/cell[2]") != std::string::npos);
}

} // namespace

int main() {
  tables();
  without_meshes();
  volumes_are_read_where_they_suffice();
  passing_axons_are_no_cells();
  disagreement_is_warned_about();
  planted_defects();
  return check_done();
}
