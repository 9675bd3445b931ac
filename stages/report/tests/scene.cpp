// SPDX-License-Identifier: BSD-3-Clause
// Runs and thinning of skeletons, clustered surfaces, the packed bytes, and documents that cannot be trusted.
#include "../scene.hpp"
#include "tests/tissue.hpp"

#include "check.h"

#include <cstring>
#include <set>

using namespace conceg;
using namespace conceg::reporting;

// One cell: a stem of 11 points along x, 1 um apart, that forks at x = 10 into two daughters of 5 points.
struct Tree {
  std::vector<double> position;
  std::vector<float> radius;
  std::vector<std::int64_t> parent;
  std::vector<std::uint8_t> kind;
  std::vector<std::uint64_t> offset{0};
  void add(double x, double y, std::int64_t before, std::uint8_t type = 3) {
    position.insert(position.end(), {x, y, 0.0}), radius.push_back(0.5f), parent.push_back(before),
        kind.push_back(type);
  }
  void cell() {
    const auto first = static_cast<std::int64_t>(parent.size());
    for (std::int64_t i = 0; i <= 10; i++)
      add(static_cast<double>(i), 0, i - 1);
    for (const double way : {1.0, -1.0})
      for (std::int64_t i = 1; i <= 5; i++)
        add(10.0 + static_cast<double>(i), way * static_cast<double>(i),
            i == 1 ? 10 : static_cast<std::int64_t>(parent.size()) - first - 1);
    offset.push_back(parent.size());
  }
  SkeletonView view() const {
    return {offset.data(), position.data(),   radius.data(), parent.data(),
            kind.data(),   offset.size() - 1, parent.size()};
  }
};

static void runs() {
  Tree tree;
  tree.cell();
  const Runs all = runs_of(tree.view(), 0, 1);
  CHECK_EQUAL(all.cell.size(), 3);           // stem and two daughters,
  CHECK_EQUAL(all.position.size(), 11 + 12); // which begin with the fork's point
  CHECK_NEAR(all.position[11].x, 10, 0);
  CHECK_NEAR(all.position[17].x, 10, 0);
  CHECK_NEAR(all.position[22].y, -5, 0);
  const Runs thinned = runs_of(tree.view(), 4, 1);
  CHECK_EQUAL(thinned.cell.size(), 3);
  CHECK_NEAR(thinned.position[0].x, 0, 0);
  CHECK_NEAR(thinned.position[1].x, 4, 0);
  CHECK_NEAR(thinned.position[3].x, 10, 0);
  CHECK_NEAR(thinned.position.back().x, 15, 0); // the tip stays
}

static void budget() {
  Tree forest;
  for (int i = 0; i < 12; i++)
    forest.cell();
  const std::size_t every = runs_of(forest.view(), 0, 1).position.size();
  CHECK_NEAR(thin(forest.view(), every).spacing_um, 0, 0);
  const Thinned fewer = thin(forest.view(), every / 2);
  CHECK(fewer.spacing_um > 0 && fewer.stride == 1 && fewer.runs.position.size() <= every / 2);
  const Thinned least = thin(forest.view(), 30);
  CHECK(least.stride > 1 && least.runs.position.size() <= 30 && !least.runs.cell.empty());
  const Thinned none = thin(forest.view(), 2);
  CHECK_EQUAL(none.stride, 0);
  CHECK_EQUAL(none.runs.position.size(), 0);
  CHECK_EQUAL(thin(SkeletonView{}, 10).runs.cell.size(), 0);
}

static reporting::Surface ball() {
  const conceg::Surface fine = testing::moved(testing::icosphere(4), {5, 5, 5}, 3.0);
  reporting::Surface out;
  out.vertex = fine.vertex, out.face = fine.face;
  return out;
}

static void clusters() {
  const reporting::Surface fine = ball(), coarse = clustered(fine, 0.8);
  CHECK(coarse.face.size() < fine.face.size() / 2 && coarse.face.size() > 50);
  for (const glm::dvec3 &p : coarse.vertex)
    CHECK(std::abs(glm::length(p - glm::dvec3(5)) - 3.0) < 0.2);
  for (const glm::uvec3 &f : coarse.face)
    CHECK(f.x < coarse.vertex.size() && f.y < coarse.vertex.size() && f.z < coarse.vertex.size());
  const std::size_t bytes = surface_bytes({fine});
  CHECK_NEAR(coarsen({fine}, bytes).step_um, 0, 0);
  const Coarsened smaller = coarsen({fine}, bytes / 2);
  CHECK(smaller.step_um > 0 && surface_bytes(smaller.surfaces) <= bytes / 2);
  CHECK_EQUAL(coarsen({fine}, 40).surfaces.size(), 0);
}

template <class Fill>
static conceg_status read_with(Fill &&fill, Scene *out = nullptr, std::size_t most = 1'000'000,
                               std::string *line = nullptr) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  testing::put_domain(doc), testing::put_cells(doc), testing::put_skeleton(doc), testing::put_meshes(doc);
  fill(doc);
  const conceg_status status = guard(ctx, "report", [&] {
    Scene scene = read_scene(doc, most);
    if (out) *out = std::move(scene);
  });
  if (line) *line = conceg_ctx_error(ctx);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return status;
}

static void packed() {
  Scene scene;
  CHECK_EQUAL(read_with([](conceg_doc *) {}, &scene), CONCEG_OK);
  CHECK_EQUAL(scene.cells, 3);
  CHECK_EQUAL(scene.mesh.surfaces.size(), 3);
  CHECK(scene.left_out.empty());
  Json json;
  json.open('{');
  const std::vector<Block> blocks = pack(scene, json), again = pack(scene, json);
  std::set<std::string> names;
  for (std::size_t i = 0; i < blocks.size(); i++) {
    names.insert(blocks[i].name);
    CHECK(blocks[i].bytes == again[i].bytes);
  }
  CHECK_EQUAL(names.size(), 9);
  const Runs &drawn = scene.skeleton.runs;
  CHECK_EQUAL(blocks[0].bytes.size(), 6 * drawn.position.size());
  // A point read back from its steps is where it was, to half a step.
  double lo = 0, step = 0;
  const char *at = std::strstr(json.str().c_str(), "\"lo\":[");
  CHECK(at && std::sscanf(at, "\"lo\":[%lf", &lo) == 1);
  at = std::strstr(json.str().c_str(), "\"step\":");
  CHECK(at && std::sscanf(at, "\"step\":%lf", &step) == 1 && step > 0 && step < 0.01);
  for (std::size_t i = 0; i < drawn.position.size(); i++) {
    std::uint16_t steps = 0;
    std::memcpy(&steps, &blocks[0].bytes[6 * i], 2);
    CHECK_NEAR(lo + step * steps, drawn.position[i].x, 0.51 * step);
  }
  Scene small;
  CHECK_EQUAL(read_with([](conceg_doc *) {}, &small, 4000), CONCEG_OK);
  CHECK(!small.left_out.empty() && small.skeleton.runs.position.size() * 8 <= 2000);
}

// Each is refused by name, none is trusted.
static void damaged() {
  const auto refused = [](auto fill, const char *words) {
    std::string line;
    CHECK(read_with(fill, nullptr, 1'000'000, &line) != CONCEG_OK);
    if (line.find(words) == std::string::npos)
      std::fprintf(stderr, "expected %s in: %s\n", words, line.c_str());
    CHECK(line.find(words) != std::string::npos);
  };
  refused(
      [](conceg_doc *d) {
        put(d, "/cells/type", std::vector<std::uint32_t>{0, 99, 0});
      },
      "/cells/type[1]");
  refused(
      [](conceg_doc *d) {
        put(d, "/cells/radius", std::vector<float>{1, 2});
      },
      "/cells/radius: expected 3 rows");
  refused(
      [](conceg_doc *d) {
        put(d, "/cells/soma", std::vector<double>{0, 0, 0, 1e300, 0, 0, 0, 0, 0}, 3);
      },
      "/cells/soma[1]");
  refused(
      [](conceg_doc *d) {
        put(d, "/skeleton/cell_offset", std::vector<std::uint64_t>{0, 1u << 30, 2, 3});
      },
      "/skeleton/cell_offset");
  refused(
      [](conceg_doc *d) {
        auto parent = view<std::int64_t>(d, "/skeleton/parent");
        std::vector<std::int64_t> other(parent.begin(), parent.end());
        other[1] = 1;
        put(d, "/skeleton/parent", other);
      },
      "/skeleton/parent[1]");
  refused(
      [](conceg_doc *d) {
        put(d, "/meshes/cell", std::vector<std::uint32_t>{0, 1, 7});
      },
      "/meshes/cell[2]");
  refused(
      [](conceg_doc *d) {
        auto face = view<std::uint32_t>(d, "/meshes/face", 3);
        std::vector<std::uint32_t> other(face.begin(), face.end());
        other[3] = 4'000'000'000u;
        put(d, "/meshes/face", other, 3);
      },
      "/meshes/face[1]");
}

static void nothing() {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  const Scene scene = read_scene(doc, 1000);
  CHECK_EQUAL(scene.cells, 0);
  Json json;
  json.open('{');
  CHECK_EQUAL(pack(scene, json).size(), 9);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
}

int main() {
  runs(), budget(), clusters(), packed(), damaged(), nothing();
  return check_done();
}
