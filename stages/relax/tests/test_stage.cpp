// SPDX-License-Identifier: BSD-3-Clause
// The relax stage as the host runs it: same bytes for any number of threads, topology kept, clear errors.
#include "../../common/tests/bytes.hpp"
#include "conceg/conceg.h"
#include "scene.hpp"
#include "view.hpp"

#include "check.h"

#include <cstring>
#include <string>

using namespace conceg;

extern "C" const conceg_stage conceg_stage_relax;

namespace {

constexpr double size = 16;

void put_tissue(conceg_doc *doc, const relax::Skeletons &s) {
  const double lo[3] = {0, 0, 0}, hi[3] = {size, size, size}, pia[3] = {0, 0, 1};
  const std::uint8_t periodic[3] = {1, 1, 1};
  put(doc, "/domain@lo", lo, 3);
  put(doc, "/domain@hi", hi, 3);
  put(doc, "/domain@periodic", periodic, 3);
  put(doc, "/domain@pia", pia, 3);
  put_scalar(doc, "/domain@lattice_step", CONCEG_LATTICE_STEP_UM);
  put_texts(doc, "/types/name", {"cell"});
  put_texts(doc, "/types/class", {"pyramidal"});
  std::vector<std::uint64_t> id(s.soma.size());
  for (std::size_t i = 0; i < id.size(); i++)
    id[i] = i;
  put(doc, "/cells/id", id);
  put(doc, "/cells/type", std::vector<std::uint32_t>(s.soma.size(), 0));
  put3(doc, "/cells/soma", s.soma);
  put(doc, "/cells/radius", s.soma_radius);
  put(doc, "/skeleton/cell_offset", s.cell_offset);
  put3(doc, "/skeleton/position", s.position);
  put(doc, "/skeleton/radius", s.radius);
  put(doc, "/skeleton/target_radius", s.target_radius);
  put(doc, "/skeleton/parent", s.parent);
  put(doc, "/skeleton/kind", std::vector<std::uint8_t>(s.position.size(), 3));
}

struct Run {
  conceg_status status = CONCEG_OK;
  std::string error, bytes;
  std::vector<glm::dvec3> position;
  std::vector<float> radius;
  std::vector<std::int64_t> parent;
  std::uint64_t items = 0, busiest = 0, spheres = 0;
};

Run run(const relax::Skeletons &s, std::uint32_t threads, const char *setting = nullptr,
        bool with_skeleton = true) {
  Run out;
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_threads(ctx, threads);
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  put_tissue(doc, s);
  if (!with_skeleton) CHECK_EQUAL(conceg_doc_drop(doc, "/skeleton"), CONCEG_OK);
  const char *sets[] = {"relax.iterations=30", setting, nullptr};
  out.status = conceg_params_new(ctx, &conceg_stage_relax, doc, nullptr, sets, nullptr, &params);
  if (out.status == CONCEG_OK) out.status = conceg_stage_run(ctx, &conceg_stage_relax, doc, params);
  out.error = conceg_ctx_error(ctx);
  if (out.status == CONCEG_OK) {
    out.bytes = conceg::testing::bytes_of(doc);
    out.position = vec3s<glm::dvec3>(doc, "/skeleton/position");
    const View<float> radius = view<float>(doc, "/skeleton/radius");
    const View<std::int64_t> parent = view<std::int64_t>(doc, "/skeleton/parent");
    out.radius.assign(radius.begin(), radius.end()), out.parent.assign(parent.begin(), parent.end());
    out.spheres = view<double>(doc, "/spheres/center", 3).rows();
    for (std::uint32_t i = 0; i < conceg_ctx_counters(ctx); i++) {
      const std::uint64_t *values = nullptr;
      std::uint32_t workers = 0;
      if (std::strcmp(conceg_ctx_counter(ctx, i, &values, &workers), "relax.items") != 0) continue;
      for (std::uint32_t w = 0; w < workers; w++)
        out.items += values[w], out.busiest = std::max(out.busiest, values[w]);
    }
  }
  conceg_params_free(params);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return out;
}

void same_bytes_and_topology() {
  const relax::Skeletons s = scene::random_cells(4, 4, 700, size, 1.5f, 0.35f);
  const Run one = run(s, 1), two = run(s, 2), three = run(s, 3);
  if (one.status != CONCEG_OK) fprintf(stderr, "%s\n", one.error.c_str());
  CHECK_EQUAL(one.status, CONCEG_OK);
  CHECK(one.bytes.size() > 1000);
  CHECK(one.bytes == two.bytes);
  CHECK(one.bytes == three.bytes);
  CHECK(one.items > 0 && one.busiest == one.items && two.items == one.items && two.busiest < two.items);
  CHECK(one.parent == s.parent);
  CHECK(one.spheres > s.position.size());
  double moved = 0;
  for (std::size_t i = 0; i < s.position.size(); i++) {
    if (s.parent[i] < 0) CHECK(one.position[i] == s.position[i]);
    CHECK(one.radius[i] > 0 && one.radius[i] <= s.target_radius[i]);
    moved += glm::distance(one.position[i], s.position[i]);
  }
  CHECK(moved > 1);
}

bool says(const Run &run, conceg_status status, const char *part) {
  if (run.status == status && run.error.find(part) != std::string::npos) return true;
  fprintf(stderr, "got %s: %s\n", conceg_status_name(run.status), run.error.c_str());
  return false;
}

void clear_errors() {
  const relax::Skeletons good = scene::random_cells(4, 2, 50, size, 1.5f, 0.35f);
  CHECK(says(run(good, 1, nullptr, false), CONCEG_E_MISSING, "skeleton"));
  CHECK(says(run(good, 1, "relax.gap_um=-1"), CONCEG_E_PARAM, "gap_um") ||
        says(run(good, 1, "relax.gap_um=-1"), CONCEG_E_RANGE, "gap_um"));
  relax::Skeletons bad = good;
  bad.radius[7] = 0;
  CHECK(says(run(bad, 1), CONCEG_E_RANGE, "/skeleton/radius[7]"));
  bad = good, bad.target_radius[8] = NAN;
  CHECK(says(run(bad, 1), CONCEG_E_RANGE, "/skeleton/target_radius[8]"));
  bad = good, bad.parent[20] = 33;
  CHECK(says(run(bad, 1), CONCEG_E_RANGE, "/skeleton/parent[20]"));
  bad = good, bad.position[9].x = 1e12;
  CHECK(says(run(bad, 1), CONCEG_E_RANGE, "/skeleton/position[9]"));
  bad = good, bad.soma[1] = bad.soma[0] + glm::dvec3(1, 0, 0);
  CHECK(says(run(bad, 1), CONCEG_E_RANGE, "somas overlap"));
  CHECK(says(run(good, 1, "relax.trace=/nonexistent/trace.csv"), CONCEG_E_IO, "/nonexistent/trace.csv"));
  bad = good, bad.position[9].x = 5e6; // a segment over 300 000 boxes
  CHECK(says(run(bad, 1), CONCEG_E_RANGE, "images"));
}

void empty_tissue() {
  relax::Skeletons none;
  none.cell_offset = {0, 0};
  none.soma = {{8, 8, 8}};
  none.soma_radius = {2};
  const Run result = run(none, 2);
  if (result.status != CONCEG_OK) fprintf(stderr, "%s\n", result.error.c_str());
  CHECK_EQUAL(result.status, CONCEG_OK);
  CHECK_EQUAL(result.spheres, 1);
}

} // namespace

int main() {
  same_bytes_and_topology();
  clear_errors();
  empty_tissue();
  return check_done();
}
