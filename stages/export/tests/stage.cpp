// SPDX-License-Identifier: BSD-3-Clause
// The export stage as the host runs it: which files appear, what they hold, and what happens on bad input.
#include "conceg/conceg.h"
#include "tests/tissue.hpp"

#include "check.h"

#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLMultiBlockDataReader.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <unistd.h>

using namespace conceg;
namespace fs = std::filesystem;

extern "C" const conceg_stage conceg_stage_export;

static std::string folder;

static std::string contents(const std::string &path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

// Runs export with "key=value" settings on a fresh document that holds what was asked for.
static conceg_status run(bool skeleton, bool meshes, const std::vector<std::string> &settings,
                         std::string *error = nullptr, void (*change)(conceg_doc *) = nullptr) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  testing::put_domain(doc);
  testing::put_cells(doc);
  if (skeleton) testing::put_skeleton(doc);
  if (meshes) testing::put_meshes(doc, 2);
  if (change) change(doc);
  std::vector<std::string> sets;
  for (const std::string &setting : settings)
    sets.push_back("export." + setting);
  std::vector<const char *> pointers;
  for (const std::string &set : sets)
    pointers.push_back(set.c_str());
  pointers.push_back(nullptr);
  conceg_status status =
      conceg_params_new(ctx, &conceg_stage_export, doc, nullptr, pointers.data(), nullptr, &params);
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, &conceg_stage_export, doc, params);
  if (error)
    *error = conceg_ctx_error(ctx);
  else if (status != CONCEG_OK)
    std::fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  conceg_params_free(params);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return status;
}

static std::string dir_of(const char *name) {
  return folder + "/" + name;
}

static void everything() {
  const std::string dir = dir_of("all/deep");
  CHECK_EQUAL(run(true, true, {"dir=" + dir}), CONCEG_OK);
  for (const char *file : {"index.csv", "swc/cell_0000_L23_pyramidal.swc", "swc/cell_0002_astrocyte.swc",
                           "ply/cell_0001_L4_interneuron.ply", "ply/all_cells.ply", "vtk/skeletons.vtp",
                           "vtk/surfaces.vtm", "vtk/surfaces/cell_0002_astrocyte.vtp"})
    CHECK(fs::exists(dir + "/" + file));
  std::istringstream index(contents(dir + "/index.csv"));
  std::string line;
  int rows = 0;
  while (std::getline(index, line)) {
    if (rows++ == 0) continue;
    CHECK(fs::exists(dir + "/" + line.substr(0, line.find(','))));
  }
  CHECK_EQUAL(rows, 1 + 3 + 1 + 3 + 3 + 2 + 3); // and a manifest of each format
  vtkNew<vtkXMLMultiBlockDataReader> reader;
  reader->SetFileName((dir + "/vtk/surfaces.vtm").c_str());
  reader->Update();
  auto *blocks = vtkMultiBlockDataSet::SafeDownCast(reader->GetOutput());
  CHECK(blocks && blocks->GetNumberOfBlocks() == 3);
  for (unsigned i = 0; blocks && i < blocks->GetNumberOfBlocks(); i++) {
    auto *block = vtkPolyData::SafeDownCast(blocks->GetBlock(i));
    CHECK(block && block->GetNumberOfPolys() == 320);
  }
}

static void read_swc(const std::string &path, bool wrapped) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_swc *swc = nullptr;
  CHECK_EQUAL(conceg_swc_read(ctx, path.c_str(), 0, &swc), CONCEG_OK);
  if (!swc) return;
  double centre[3], radius;
  CHECK(conceg_swc_soma(swc, centre, &radius) != CONCEG_SOMA_NONE);
  CHECK_NEAR(centre[0], 14.0, 1e-6);
  CHECK_NEAR(radius, 2.0, 1e-6);
  const char *header = conceg_swc_header(swc, "@conceg");
  CHECK(header && std::strstr(header, "\"id\":30") &&
        std::strstr(header, wrapped ? "\"wrapped\":true" : "\"wrapped\":false"));
  const double *position = conceg_swc_position(swc), *target = conceg_swc_column(swc, "target_radius");
  CHECK(target && target[0] == 0.625);
  double length = 0.0, farthest = 0.0;
  for (std::uint64_t i = 0; i < conceg_swc_count(swc); i++) {
    const std::int64_t parent = conceg_swc_parent(swc)[i];
    farthest = std::max(farthest, position[3 * i]);
    if (parent < 0) continue;
    double sum = 0.0;
    for (int axis = 0; axis < 3; axis++)
      sum += std::pow(position[3 * i + axis] - position[3 * parent + axis], 2);
    length += std::sqrt(sum);
  }
  CHECK_NEAR(length,
             3.0 + 2.0 * std::sqrt(2.0) + 2.0 * std::sqrt(2.0) + std::sqrt(2.0) + 3.0 - std::sqrt(2.0), 1e-4);
  if (wrapped)
    CHECK(farthest <= 20.0 + 1e-6);
  else
    CHECK_EQUAL(conceg_swc_count(swc), testing::points_per_cell);
  if (!wrapped) CHECK_NEAR(farthest, 22.0, 1e-6);
  conceg_swc_free(swc);
  conceg_ctx_free(ctx);
}

static void swc() {
  CHECK_EQUAL(run(true, false, {"dir=" + dir_of("swc"), "to=swc", "cells=id:30"}), CONCEG_OK);
  CHECK(!fs::exists(dir_of("swc/swc/cell_0000_L23_pyramidal.swc")));
  read_swc(dir_of("swc/swc/cell_0002_astrocyte.swc"), false);
  CHECK_EQUAL(run(true, false, {"dir=" + dir_of("wrapped"), "to=swc", "cells=2", "wrapped=true"}), CONCEG_OK);
  read_swc(dir_of("wrapped/swc/cell_0002_astrocyte.swc"), true);
}

static void wrapped_surfaces() {
  CHECK_EQUAL(run(false, true, {"dir=" + dir_of("tiled"), "to=ply", "cells=1", "wrapped=true", "ascii=true"}),
              CONCEG_OK);
  const std::string text = contents(dir_of("tiled/ply/cell_0001_L4_interneuron.ply"));
  CHECK(text.find("format ascii 1.0") != std::string::npos);
  std::size_t faces = 0;
  std::istringstream(text.substr(text.find("element face ") + 13)) >> faces;
  CHECK(faces > 320 && faces < 3 * 320);
}

static void bad_input() {
  std::string error;
  CHECK_EQUAL(run(false, false, {"dir=" + dir_of("none")}, &error), CONCEG_E_MISSING);
  CHECK(error.find("grow") != std::string::npos && error.find('\n') == std::string::npos);
  CHECK_EQUAL(run(false, true, {"dir=" + dir_of("none"), "to=swc"}, &error), CONCEG_E_MISSING);
  CHECK(error.find("grow") != std::string::npos);
  CHECK_EQUAL(run(true, false, {"dir=" + dir_of("none"), "to=ply"}, &error), CONCEG_E_MISSING);
  CHECK(error.find("mesh") != std::string::npos);
  CHECK(!fs::exists(dir_of("none")));
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("none"), "cells=3"}, &error), CONCEG_E_RANGE);
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("none"), "cells=id:7"}, &error), CONCEG_E_RANGE);
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("none"), "cells=first"}, &error), CONCEG_E_PARAM);
  for (const char *tiles : {"2x2", "0x1x1", "2x1x1x1", "2x1x1001", "axbxc", "-1x1x1", ""})
    CHECK_EQUAL(run(true, true, {"dir=" + dir_of("none"), std::string("tiles='") + tiles + "'"}, &error),
                CONCEG_E_PARAM);
  CHECK(error.find("tiles: expected three whole numbers") != std::string::npos);
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("none"), "to=mcdc", "tiles=2x1x1"}, &error), CONCEG_E_PARAM);
  CHECK(error.find("got mcdc") != std::string::npos);
  const auto open = [](conceg_doc *doc) { testing::put_domain(doc, false); };
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("none"), "to=ply", "tiles=1x2x1"}, &error, open),
              CONCEG_E_PARAM);
  CHECK(error.find("along y, where the box is open") != std::string::npos);
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("none"), "form=extracellular"}, &error), CONCEG_E_PARAM);
  CHECK_EQUAL(run(true, false, {"dir=" + dir_of("none"), "to=vtk", "form=extracellular"}, &error),
              CONCEG_E_MISSING);
  CHECK(!fs::exists(dir_of("none")));
  std::ofstream(dir_of("plain")) << "x";
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("plain/below")}, &error), CONCEG_E_IO);
  CHECK(error.find("plain") != std::string::npos);
  // A folder stands where a file should go: the run fails and leaves no temporary file.
  fs::create_directories(dir_of("blocked/ply/cell_0000_L23_pyramidal.ply/x"));
  CHECK_EQUAL(run(true, true, {"dir=" + dir_of("blocked"), "to=ply"}, &error), CONCEG_E_IO);
  for (const auto &entry : fs::recursive_directory_iterator(dir_of("blocked")))
    CHECK(entry.path().string().find(".part") == std::string::npos);
}

// A passing axon that found no start has neither soma nor samples, and no file; the document goes along in
// the first file that there is.
static void first_cell_empty() {
  const std::string dir = dir_of("empty");
  const auto change = [](conceg_doc *doc) {
    put(doc, "/cells/radius", std::vector<float>{0, 3, 2});
    put(doc, "/skeleton/cell_offset", std::vector<std::uint64_t>{0, 0, 12, 18});
  };
  CHECK_EQUAL(run(true, false, {"dir=" + dir}, nullptr, change), CONCEG_OK);
  CHECK(!fs::exists(dir + "/swc/cell_0000_L23_pyramidal.swc"));
  CHECK(fs::exists(dir + "/vtk/skeletons.vtp"));
  const std::string first = contents(dir + "/swc/cell_0001_L4_interneuron.swc"),
                    second = contents(dir + "/swc/cell_0002_astrocyte.swc");
  CHECK(first.find("/types/class") != std::string::npos);
  CHECK(!second.empty() && second.find("/types/class") == std::string::npos);
}

int main() {
  folder = (fs::temp_directory_path() / ("conceg_export_stage_" + std::to_string(getpid()))).string();
  fs::create_directories(folder);
  everything();
  swc();
  first_cell_empty();
  wrapped_surfaces();
  bad_input();
  fs::remove_all(folder);
  return check_done();
}
