// SPDX-License-Identifier: BSD-3-Clause
// The render stage as the host runs it.
#include "conceg/conceg.h"
#include "tests/tissue.hpp"

#include "check.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <unistd.h>

using namespace conceg;
namespace fs = std::filesystem;

extern "C" const conceg_stage conceg_stage_render;

static std::string folder;
static std::string dir_of(const char *name) {
  return folder + "/" + name;
}

static conceg_status run(bool skeleton, bool meshes, const std::vector<std::string> &settings,
                         std::string *error = nullptr, conceg_progress_fn progress = nullptr) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  conceg_ctx_set_threads(ctx, 2);
  if (progress) conceg_ctx_set_progress(ctx, progress, nullptr);
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  testing::put_domain(doc);
  testing::put_cells(doc);
  if (skeleton) testing::put_skeleton(doc);
  if (meshes) testing::put_meshes(doc);
  std::vector<std::string> sets = {"render.size_px=240"};
  for (const std::string &setting : settings)
    sets.push_back("render." + setting);
  std::vector<const char *> pointers;
  for (const std::string &set : sets)
    pointers.push_back(set.c_str());
  pointers.push_back(nullptr);
  conceg_status status =
      conceg_params_new(ctx, &conceg_stage_render, doc, nullptr, pointers.data(), nullptr, &params);
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, &conceg_stage_render, doc, params);
  if (error)
    *error = conceg_ctx_error(ctx);
  else if (status != CONCEG_OK)
    std::fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  conceg_params_free(params);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return status;
}

// The picture's longer side and that it shows more than a few colours.
static void check_picture(const std::string &path, int size) {
  CHECK(fs::exists(path));
  if (!fs::exists(path)) return;
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData *data = reader->GetOutput();
  const int width = data->GetDimensions()[0], height = data->GetDimensions()[1];
  CHECK_EQUAL(std::max(width, height), size);
  std::set<int> colours;
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      int code = 0;
      for (int k = 0; k < 3; k++)
        code = 8 * code + static_cast<int>(data->GetScalarComponentAsDouble(x, y, 0, k)) / 32;
      colours.insert(code);
    }
  CHECK(colours.size() > 10);
}

static std::string contents(const std::string &path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

static std::string place_of_cell(std::size_t cell) {
  const glm::dvec3 &p = testing::centres[cell];
  return std::to_string(p.x) + "," + std::to_string(p.y) + "," + std::to_string(p.z);
}

static void pictures() {
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("both/deep")}), CONCEG_OK);
  check_picture(dir_of("both/deep/cells.png"), 240);
  check_picture(dir_of("both/deep/cut.png"), 240);
  CHECK_EQUAL(run(true, false, {"dir=" + dir_of("cones"), "what=cells", "size_px=150"}), CONCEG_OK);
  check_picture(dir_of("cones/cells.png"), 150);
  CHECK(!fs::exists(dir_of("cones/cut.png")));
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("single"), "cells=id:30", "of=skeleton"}), CONCEG_OK);
  check_picture(dir_of("single/cell_0002.png"), 240);
  CHECK(!fs::exists(dir_of("single/cell_0002_cut.png")));
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("single"), "cells=2", "what=cut", "cut_axis=z"}), CONCEG_OK);
  check_picture(dir_of("single/cell_0002_cut.png"), 240);
  CHECK_EQUAL(run(false, true, {"dir=" + dir_of("whole"), "whole=true", "samples=1", "elevation_deg=90"}),
              CONCEG_OK);
  check_picture(dir_of("whole/cells.png"), 240);
  CHECK_EQUAL(run(false, true, {"dir=" + dir_of("two"), "cells=0,id:30", "what=cells"}), CONCEG_OK);
  check_picture(dir_of("two/cells.png"), 240);
  // A corner of the box with one cell's soma in it, plain and with wires: two pictures that differ.
  CHECK_EQUAL(run(false, true, {"dir=" + dir_of("zoom"), "zoom_um=9", "zoom_at=" + place_of_cell(0)}),
              CONCEG_OK);
  check_picture(dir_of("zoom/cells.png"), 240);
  check_picture(dir_of("zoom/cut.png"), 240);
  CHECK_EQUAL(
      run(false, true, {"dir=" + dir_of("wire"), "zoom_um=9", "zoom_at=" + place_of_cell(0), "wire=true"}),
      CONCEG_OK);
  CHECK(contents(dir_of("zoom/cells.png")) != contents(dir_of("wire/cells.png")));
  CHECK(contents(dir_of("zoom/cut.png")) == contents(dir_of("wire/cut.png")));
}

static int cancel(void *, const char *, uint64_t, uint64_t) {
  return 1;
}

static void bad_input() {
  std::string error;
  CHECK_EQUAL(run(false, false, {"dir=" + dir_of("none")}, &error), CONCEG_E_MISSING);
  CHECK(error.find("grow") != std::string::npos && error.find('\n') == std::string::npos);
  CHECK_EQUAL(run(true, false, {"dir=" + dir_of("none"), "of=meshes"}, &error), CONCEG_E_MISSING);
  CHECK(error.find("mesh") != std::string::npos);
  CHECK_EQUAL(run(false, true, {"dir=" + dir_of("none"), "of=skeleton"}, &error), CONCEG_E_MISSING);
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("none"), "cells=9"}, &error), CONCEG_E_RANGE);
  CHECK(run(true, true, {"dir=" + dir_of("none"), "size_px=1"}, &error) != CONCEG_OK);
  CHECK(run(true, true, {"dir=" + dir_of("none"), "cut_position=1.5"}, &error) != CONCEG_OK);
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("none"), "zoom_um=5", "zoom_at=1,2"}, &error), CONCEG_E_PARAM);
  CHECK(error.find("zoom_at") != std::string::npos);
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("none")}, &error, cancel), CONCEG_E_CANCELLED);
  CHECK(!fs::exists(dir_of("none/cells.png")));
  std::ofstream(dir_of("plain")) << "x";
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("plain/below")}, &error), CONCEG_E_IO);
  CHECK(error.find("plain") != std::string::npos);
  fs::create_directories(dir_of("blocked/cut.png/x"));
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("blocked"), "what=cut"}, &error), CONCEG_E_IO);
  for (const auto &entry : fs::directory_iterator(dir_of("blocked")))
    CHECK(entry.path().string().find(".part") == std::string::npos);
}

int main() {
  folder = (fs::temp_directory_path() / ("conceg_render_stage_" + std::to_string(getpid()))).string();
  fs::create_directories(folder);
  pictures();
  bad_input();
  fs::remove_all(folder);
  return check_done();
}
