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
Run run(std::uint32_t threads, bool skeleton, bool meshes, Spoil spoil, const char *set = nullptr,
        const std::vector<const char *> &more = {}) {
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
  std::vector<const char *> sets = {"analyse.points=50000"};
  if (set) sets.push_back(set);
  sets.insert(sets.end(), more.begin(), more.end());
  sets.push_back(nullptr);
  CHECK_EQUAL(conceg_params_new(ctx, &conceg_stage_analyse, doc, nullptr, sets.data(), nullptr, &params),
              CONCEG_OK);
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

void experiments() {
  const Run missing = run(2, true, false, nothing, "analyse.composition=true");
  CHECK_EQUAL(missing.status, CONCEG_E_MISSING);
  CHECK(missing.error.find("mesh.volume_step_um") != std::string::npos);
  const auto put_volume = [](conceg_doc *doc) { // one cell fills the box: its exponent is 3
    const double origin[3] = {0.625, 0.625, 0.625}, spacing[3] = {1.25, 1.25, 1.25};
    const std::uint64_t shape[3] = {16, 16, 16};
    put(doc, "/volumes@origin", origin, 3);
    put(doc, "/volumes@spacing", spacing, 3);
    put(doc, "/volumes@shape", shape, 3);
    std::vector<std::int32_t> leaves;
    for (const std::int32_t x : {0, 8})
      for (const std::int32_t y : {0, 8})
        for (const std::int32_t z : {0, 8})
          leaves.insert(leaves.end(), {x, y, z});
    put(doc, "/volumes/leaf_origin", leaves, 3);
    put(doc, "/volumes/label", std::vector<std::uint32_t>(8 * 512, 2), 512);
  };
  const Run solid = run(2, true, false, put_volume, "analyse.composition=true");
  CHECK_EQUAL(solid.status, CONCEG_OK);
  CHECK(solid.log.find("--- composition_fit") != std::string::npos);
  CHECK(solid.log.find("void beyond 20 um") != std::string::npos);
  CHECK(solid.log.find("voxels of 1.25 um") != std::string::npos); // coarser than the protocol's
  CHECK(solid.bytes == run(3, true, false, put_volume, "analyse.composition=true").bytes);

  CHECK_EQUAL(run(2, true, false, nothing, "analyse.transport=true").status, CONCEG_E_MISSING);
  const auto put_slabs = [&](double median) { // half of the planes along x are open
    return [=](conceg_doc *doc) {
      put_volume(doc);
      std::vector<std::uint32_t> label(8 * 512);
      std::vector<float> distance(8 * 512);
      for (std::size_t i = 0; i < label.size(); i++)
        label[i] = i / 64 % 4 < 2, distance[i] = static_cast<float>(label[i] ? -median : median);
      put(doc, "/volumes/label", label, 512);
      put(doc, "/volumes/distance", distance, 512);
    };
  };
  const Run coarse = run(2, true, false, put_slabs(1.2), "analyse.transport=true");
  CHECK(coarse.log.find("transport: void: voxels of 1.25 um") != std::string::npos);
  const Run slabs = run(2, true, false, put_slabs(1.3), "analyse.transport=true");
  CHECK_EQUAL(slabs.status, CONCEG_OK);
  CHECK(slabs.log.find("--- transport") != std::string::npos);
  CHECK(slabs.log.find("1.2247") != std::string::npos); // sqrt(3 / 2): nothing goes across, two axes are free
  CHECK_EQUAL(run(2, true, false, nothing, "analyse.pores=true").status, CONCEG_E_MISSING);
  const Run pores = run(2, true, false, put_slabs(1.3), "analyse.pores=true");
  CHECK_EQUAL(pores.status, CONCEG_OK);
  CHECK(pores.log.find("thickness_radius") != std::string::npos);
  CHECK(pores.bytes == run(3, true, false, put_slabs(1.3), "analyse.pores=true").bytes);
  CHECK_EQUAL(run(2, true, false, nothing, "analyse.paths=true").status, CONCEG_E_MISSING);
  const Run small =
      run(2, true, false, put_slabs(1.3), "analyse.paths=true"); // 20 um: no pair is 10 um apart
  CHECK(small.log.find("paths: void: the box is too small") != std::string::npos);

  // Labels that touch, without distances: sections of them, drawn back.
  const auto put_touching = [&](conceg_doc *doc) {
    put_volume(doc);
    std::vector<std::uint32_t> label(8 * 512);
    for (std::size_t i = 0; i < label.size(); i++)
      label[i] = 1 + (i / 64 % 8 >= 4);
    put(doc, "/volumes/label", label, 512);
  };
  const std::vector<const char *> sections = {"analyse.erode_to=0.3", "analyse.path_um=2"};
  const Run eroded = run(2, true, false, put_touching, "analyse.pores=true", sections);
  CHECK_EQUAL(eroded.status, CONCEG_OK);
  CHECK(eroded.log.find("um off each membrane") != std::string::npos);
  CHECK(eroded.log.find("erosion [um]") != std::string::npos);
  CHECK(eroded.bytes == run(3, true, false, put_touching, "analyse.pores=true", sections).bytes);
  CHECK(eroded.bytes !=
        run(2, true, false, put_touching, "analyse.pores=true", {"analyse.erode_to=0.4"}).bytes);
  CHECK_EQUAL(run(2, true, false, put_touching, "analyse.erode_to=0.3").status,
              CONCEG_E_PARAM); // nothing to do
  CHECK_EQUAL(run(2, true, false, nothing, "analyse.pores=true", sections).status, CONCEG_E_MISSING);
  const auto flat = [&](conceg_doc *doc) { // voxels of another length along z
    put_touching(doc);
    const double origin[3] = {0.625, 0.625, 1.25}, spacing[3] = {1.25, 1.25, 2.5};
    const std::uint64_t shape[3] = {16, 16, 8};
    put(doc, "/volumes@origin", origin, 3);
    put(doc, "/volumes@spacing", spacing, 3);
    put(doc, "/volumes@shape", shape, 3);
    put(doc, "/volumes/leaf_origin", std::vector<std::int32_t>{0, 0, 0}, 3);
    put(doc, "/volumes/label", std::vector<std::uint32_t>(512, 0), 512);
  };
  CHECK(run(2, true, false, flat, "analyse.pores=true").log.find("import.resample_um") != std::string::npos);

  // Blocks between three balls.
  const std::vector<const char *> blocks = {"analyse.blocks=2", "analyse.block_um=5",
                                            "analyse.block_voxel_um=0.25"};
  const Run cut = run(2, false, true, nothing, "analyse.transport=true", blocks);
  CHECK_EQUAL(cut.status, CONCEG_OK);
  CHECK(cut.log.find("--- blocks") != std::string::npos &&
        cut.log.find("--- transport") != std::string::npos);
  CHECK(cut.bytes == run(3, false, true, nothing, "analyse.transport=true", blocks).bytes);
  const Run unmeshed = run(2, true, false, nothing, "analyse.pores=true", blocks);
  CHECK_EQUAL(unmeshed.status, CONCEG_E_MISSING);
  CHECK(unmeshed.error.find("conceg mesh") != std::string::npos);
  const Run still = run(2, true, false, nothing, "analyse.diffusivity=true");
  CHECK_EQUAL(still.status, CONCEG_E_MISSING);
  CHECK(still.error.find("run conceg simulate --times-ms") != std::string::npos);

  const Run none = run(2, true, false, nothing, "analyse.spectrum=true");
  CHECK_EQUAL(none.status, CONCEG_OK);
  CHECK(none.log.find("spectrum: void for class") != std::string::npos);
  const auto put_path = [](conceg_doc *doc) {
    std::vector<double> position;
    std::vector<float> radius;
    std::vector<std::int64_t> parent;
    for (int i = 0; i <= 120; i++) {
      position.insert(position.end(), {3.0 + i, 0, 0});
      radius.push_back(i % 7 ? 0.5f : 0.8f), parent.push_back(i - 1);
    }
    put(doc, "/skeleton/position", position, 3);
    put(doc, "/skeleton/radius", radius), put(doc, "/skeleton/parent", parent);
    put(doc, "/skeleton/kind", std::vector<std::uint8_t>(radius.size(), 3));
    put(doc, "/skeleton/cell_offset", std::vector<std::uint64_t>{0, 121, 121, 121});
  };
  const Run path = run(2, true, false, put_path, "analyse.spectrum=true");
  CHECK_EQUAL(path.status, CONCEG_OK);
  CHECK(path.log.find("--- spectrum_fit") != std::string::npos);
  CHECK(path.bytes != run(2, true, false, put_path).bytes);
  CHECK(path.bytes == run(3, true, false, put_path, "analyse.spectrum=true").bytes);
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
  experiments();
  passing_axons_are_no_cells();
  disagreement_is_warned_about();
  planted_defects();
  return check_done();
}
