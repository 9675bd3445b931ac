// SPDX-License-Identifier: BSD-3-Clause
// lambda^2 = D_0 / D* by walkers against analyse's solver on voxels: cubic spheres as a document through both
// stages, a square lattice of cylinders by the parts alone. test_lambda [SEED].
#include "analyse/diffusivity.hpp"
#include "common/tests/bytes.hpp"
#include "common/tests/tissue.hpp"
#include "simulate/protocol.hpp"
#include "simulate/tests/shapes.hpp"

#include "conceg/conceg.h"

#include "check.h"

#include <numeric>

using namespace conceg;

extern "C" const conceg_stage conceg_stage_simulate;
extern "C" const conceg_stage conceg_stage_analyse;

namespace {

std::uint64_t seed = 1;

constexpr double side = 5.0;
constexpr std::size_t voxels = 64; // along a side

void keep_line(void *user, conceg_log_level, const char *line) {
  static_cast<std::string *>(user)->append(line).append("\n");
}

// One ball in the middle of a periodic box, as surface and as voxels.
void put_ball(conceg_doc *doc, double radius) {
  const double lo[3] = {0, 0, 0}, hi[3] = {side, side, side}, pia[3] = {0, 0, 1};
  const std::uint8_t wraps[3] = {1, 1, 1};
  put(doc, "/domain@lo", lo, 3), put(doc, "/domain@hi", hi, 3), put(doc, "/domain@pia", pia, 3);
  put(doc, "/domain@periodic", wraps, 3);
  put_scalar(doc, "/domain@lattice_step", CONCEG_LATTICE_STEP_UM);
  put_texts(doc, "/types/name", {"ball"}), put_texts(doc, "/types/class", {"other"});
  put_texts(doc, "/types/layer", {""});
  const glm::dvec3 centre(0.5 * side);
  put(doc, "/cells/id", std::vector<std::uint64_t>{1}),
      put(doc, "/cells/type", std::vector<std::uint32_t>{0});
  put3(doc, "/cells/soma", std::vector<glm::dvec3>{centre});
  put(doc, "/cells/radius", std::vector<float>{static_cast<float>(radius)});
  simulate::Membranes m;
  simulate::testing::add_sphere(m, centre, radius, 4);
  std::vector<std::uint32_t> face;
  for (const glm::uvec3 &f : m.face)
    face.insert(face.end(), {f.x, f.y, f.z});
  put(doc, "/meshes/cell", std::vector<std::uint32_t>{0}),
      put3(doc, "/meshes/origin", std::vector<glm::dvec3>{centre});
  put(doc, "/meshes/vertex_offset", std::vector<std::uint64_t>{0, m.vertex.size()});
  put(doc, "/meshes/face_offset", std::vector<std::uint64_t>{0, m.face.size()});
  put3(doc, "/meshes/vertex", m.vertex), put(doc, "/meshes/face", face, 3);
  put(doc, "/meshes/compartment", std::vector<std::uint8_t>(m.face.size(), 1));
  const double h = side / static_cast<double>(voxels), origin[3] = {0.5 * h, 0.5 * h, 0.5 * h},
               spacing[3] = {h, h, h};
  const std::uint64_t shape[3] = {voxels, voxels, voxels};
  put(doc, "/volumes@origin", origin, 3), put(doc, "/volumes@spacing", spacing, 3);
  put(doc, "/volumes@shape", shape, 3);
  std::vector<std::int32_t> leaf;
  std::vector<std::uint32_t> label;
  std::vector<float> distance;
  const auto n = static_cast<std::int32_t>(voxels);
  for (std::int32_t x = 0; x < n; x += 8)
    for (std::int32_t y = 0; y < n; y += 8)
      for (std::int32_t z = 0; z < n; z += 8) {
        leaf.insert(leaf.end(), {x, y, z});
        for (std::int32_t i = 0; i < 512; i++) {
          const glm::dvec3 p = h * (glm::dvec3(x + i / 64, y + i / 8 % 8, z + i % 8) + 0.5);
          const double d = glm::distance(p, centre) - radius;
          label.push_back(d < 0.0), distance.push_back(static_cast<float>(d));
        }
      }
  put(doc, "/volumes/leaf_origin", leaf, 3), put(doc, "/volumes/label", label, 512);
  put(doc, "/volumes/distance", distance, 512);
}

std::vector<double> column(conceg_doc *doc, const char *path) {
  const View<double> v = view<double>(doc, path);
  return std::vector<double>(v.begin(), v.end());
}

struct Found {
  std::vector<std::string> name, state;
  std::vector<double> lambda, error;
  std::string bytes, log;
};

Found through_stages(double filled, const char *walkers, std::uint32_t threads) {
  Found out;
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_threads(ctx, threads), conceg_ctx_set_seed(ctx, seed);
  conceg_ctx_set_log(ctx, CONCEG_LOG_INFO, keep_line, &out.log);
  conceg_doc *doc = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  put_ball(doc, side * std::cbrt(3.0 * filled / (4.0 * M_PI)));
  const auto run = [&](const conceg_stage &stage, std::vector<const char *> sets) {
    sets.push_back(nullptr);
    conceg_params *params = nullptr;
    CHECK_EQUAL(conceg_params_new(ctx, &stage, doc, nullptr, sets.data(), nullptr, &params), CONCEG_OK);
    CHECK_EQUAL(conceg_stage_run(ctx, &stage, doc, params), CONCEG_OK);
    conceg_params_free(params);
  };
  run(conceg_stage_simulate, {walkers, "simulate.compartment=extra", "simulate.b=0", "simulate.delta_ms=0.1",
                              "simulate.separation_ms=0.1", "simulate.times_ms=1:5:10"});
  run(conceg_stage_analyse, {"analyse.points=0", "analyse.transport=true", "analyse.diffusivity=true"});
  if (*conceg_ctx_error(ctx)) fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  out.name = texts(doc, "/statistics/lambda/name"), out.state = texts(doc, "/statistics/lambda/state");
  out.lambda = column(doc, "/statistics/lambda/lambda"),
  out.error = column(doc, "/statistics/lambda/lambda_error");
  out.bytes = testing::bytes_of(doc);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return out;
}

void spheres() {
  for (const double filled : {0.30, 0.45}) {
    const Found f = through_stages(filled, "simulate.walkers=20000", 2);
    CHECK_EQUAL(f.name.size(), 2);
    if (f.name.size() != 2) continue;
    CHECK_TEXT(f.name[0].c_str(), "lambda_walkers");
    CHECK_TEXT(f.name[1].c_str(), "lambda_solver");
    CHECK_TEXT(f.state[0].c_str(), "fitted");
    const double ratio = std::pow(f.lambda[0] / f.lambda[1], 2), error = 2.0 * f.error[0] / f.lambda[0];
    printf(
        "cubic spheres %.2f: lambda %.4f (%.4f) by walkers, %.4f by the solver; lambda^2 %.4f (%.4f) of it\n",
        filled, f.lambda[0], f.error[0], f.lambda[1], ratio, error);
    CHECK(error < 0.01);
    CHECK_NEAR(ratio, 1.0, 0.02);
  }
}

void threads() {
  const Found one = through_stages(0.30, "simulate.walkers=300", 1),
              three = through_stages(0.30, "simulate.walkers=300", 3);
  CHECK(!one.bytes.empty() && one.bytes == three.bytes);
}

// Square lattice of cylinders: across them as the solver says, along them free.
void cylinders() {
  constexpr double filled = 0.2;
  const double radius = side * std::sqrt(filled / M_PI);
  simulate::Membranes m;
  simulate::testing::add_cylinder(m, 0.5 * side, 0.5 * side, radius, side, 256);
  Workers workers(2);
  const simulate::Walls walls(simulate::testing::cube(side), m, 0.12, workers, {});
  std::vector<simulate::Start> start;
  for (std::uint64_t i = 0; i < 20000; i++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.start", i);
    glm::dvec3 p;
    do {
      for (int a = 0; a < 3; a++)
        p[a] = side * conceg_rng_uniform(&rng);
    } while (std::hypot(p.x - 0.5 * side, p.y - 0.5 * side) < 1.001 * radius);
    start.push_back({walls.local(p), false, i});
  }
  simulate::Timeline timeline;
  std::vector<double> times;
  for (int i = 0; i < 10; i++)
    times.push_back(std::pow(5.0, i / 9.0));
  simulate::record_at(timeline, times);
  std::vector<std::vector<glm::dvec3>> moved(times.size(), std::vector<glm::dvec3>(start.size()));
  constexpr std::size_t block = 64;
  workers.loop((start.size() + block - 1) / block, 1, [&](std::size_t b, unsigned) {
    const std::size_t first = b * block, many = std::min(block, start.size() - first);
    simulate::Tally tally;
    const std::vector<simulate::Walk> walks = walk(walls, timeline, {}, &start[first], many, seed, tally);
    for (std::size_t i = 0; i < many; i++)
      for (std::size_t t = 0; t < times.size(); t++)
        moved[t][first + i] = walks[i].displacement[t];
  });
  std::vector<const glm::dvec3 *> pointers;
  for (const auto &row : moved)
    pointers.push_back(row.data());
  std::vector<std::uint32_t> all(start.size());
  std::iota(all.begin(), all.end(), 0u);
  const auto solved = [&](std::size_t n) {
    analyse::OpenVoxels v = {{n, n, 2}, {}, {1.0, 1.0, 1.0}};
    const auto from = [&](std::size_t i) {
      return (static_cast<double>(i) + 0.5) / static_cast<double>(n) - 0.5;
    };
    for (std::size_t i = 0; i < n * n * 2; i++)
      v.open.push_back(std::hypot(from(i / 2 / n), from(i / 2 % n)) > radius / side);
    return transport_of(v, {true, true, true}, 1e-8, workers, {});
  };
  const analyse::Transport expected = analyse::extrapolated(solved(64), solved(128));
  for (int axis = 0; axis < 3; axis++) {
    const analyse::Tail tail = fit_tail(analyse::diffusivity_curve(pointers, times, all, axis), 1.0);
    const double d = tail.limit.value / 2.0, error = tail.limit.error / 2.0,
                 e = expected.ratio[static_cast<std::size_t>(axis)];
    printf("cylinders %.2f, axis %d: D* / D_0 %.4f (%.4f) by walkers, %.4f by the solver\n", filled, axis, d,
           error, e);
    CHECK_NEAR(d, e, 4.5 * error);
    CHECK_NEAR(d / e, 1.0, 0.03);
  }
  const analyse::Tail mean =
      fit_tail(analyse::diffusivity_curve(pointers, times, all, analyse::mean_axis), 1.0);
  const double ratio = std::pow(expected.lambda(), 2) * mean.limit.value / 2.0;
  printf("cylinders %.2f: lambda^2 of the solver is %.4f (%.4f) of that by walkers\n", filled, ratio,
         mean.limit.error * std::pow(expected.lambda(), 2) / 2.0);
  CHECK_NEAR(ratio, 1.0, 0.02);
}

} // namespace

int main(int argc, char **argv) {
  if (argc > 1) seed = std::strtoull(argv[1], nullptr, 10);
  spheres();
  threads();
  cylinders();
  return check_done();
}
