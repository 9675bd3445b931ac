// SPDX-License-Identifier: BSD-3-Clause
// The stage as the host runs it: tables, the geometry's figures beside them, and what it refuses.
#include "../../common/tests/bytes.hpp"
#include "../../common/tests/tissue.hpp"
#include "conceg/conceg.h"

#include "check.h"

#include <cmath>
#include <functional>
#include <string>

using namespace conceg;

extern "C" const conceg_stage conceg_stage_fit;

namespace {

struct Run {
  conceg_status status = CONCEG_OK;
  std::string error, bytes, log;
  std::vector<std::string> signal, kernel, errors_from;
  std::vector<double> f_soma, f_soma_truth, radius, radius_truth, f_extra_truth, shell_b, shell_error;
};

void keep_line(void *user, conceg_log_level, const char *line) {
  static_cast<std::string *>(user)->append(line).append("\n");
}

void put2(conceg_doc *doc, const char *path, const std::vector<double> &values, std::size_t rows) {
  conceg_array array = {};
  array.size = sizeof array, array.dtype = CONCEG_F64, array.rank = 2;
  array.shape[0] = rows, array.shape[1] = values.size() / rows, array.data = values.data();
  CHECK_EQUAL(conceg_doc_write(doc, path, &array), CONCEG_OK);
}

struct Input {
  std::vector<double> b, duration, separation, intra, all;
  double error = 1e-4;
};

// Three directions a shell. Golden C, and golden A as the whole signal, with noise that averages out.
Input usual() {
  const double b[] = {0, 0.5, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15};
  const double c[] = {1,          0.76614914, 0.61840316, 0.44610210, 0.34953029, 0.28817778,
                      0.24631541, 0.21641228, 0.17748692, 0.15384624, 0.13808383, 0.12210622};
  const double a[] = {1,          0.72296307, 0.54987090, 0.35973097, 0.26498173, 0.21076873,
                      0.17628463, 0.15263129, 0.12269838, 0.10492435, 0.09332527, 0.08189592};
  Input in;
  for (int direction = 2; direction >= 0; direction--)
    for (int i = 0; i < 12; i++) {
      in.b.push_back(b[i] + 0.001 * (direction - 1) * (i > 0));
      in.intra.push_back(2.0 * (c[i] + 0.01 * (direction - 1) * (i > 0)));
      in.all.push_back(a[i]);
      in.duration.push_back(i ? 5 : 0), in.separation.push_back(i ? 20 : 0);
    }
  return in;
}

void put_signals(conceg_doc *doc, const Input &in) {
  const std::size_t n = in.b.size();
  std::vector<double> direction, coefficient(3 * n, 0.0), signal = in.intra;
  for (std::size_t i = 0; i < n; i++)
    direction.insert(direction.end(), {0, 0, 1});
  signal.insert(signal.end(), in.all.begin(), in.all.end());
  put(doc, "/protocol/b", in.b), put(doc, "/protocol/direction", direction, 3);
  put(doc, "/protocol/pulse_duration", in.duration), put(doc, "/protocol/pulse_separation", in.separation);
  put(doc, "/protocol/interval_end", std::vector<double>{5, 20, 25});
  put2(doc, "/protocol/shape", {1, 0, -1}, 1);
  conceg_array array = {};
  array.size = sizeof array, array.dtype = CONCEG_F64, array.rank = 3;
  array.shape[0] = n, array.shape[1] = 1, array.shape[2] = 3, array.data = coefficient.data();
  CHECK_EQUAL(conceg_doc_write(doc, "/protocol/coefficient", &array), CONCEG_OK);
  put_texts(doc, "/signals/compartment", {"intra", "all"});
  put(doc, "/signals/walkers", std::vector<std::uint64_t>{1000, 1000});
  put2(doc, "/signals/signal", signal, 2);
  put2(doc, "/signals/standard_error", std::vector<double>(2 * n, in.error), 2);
}

std::vector<double> column(conceg_doc *doc, const std::string &name) {
  const std::string path = "/statistics/" + name;
  if (!has(doc, path.c_str())) return {};
  const View<double> v = view<double>(doc, path.c_str());
  return std::vector<double>(v.begin(), v.end());
}

using Spoil = std::function<void(conceg_doc *)>;
Run run(std::uint32_t threads, const Input &input, std::vector<const char *> sets = {},
        const Spoil &spoil = nullptr) {
  Run out;
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_threads(ctx, threads);
  conceg_ctx_set_log(ctx, CONCEG_LOG_INFO, keep_line, &out.log);
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  put_signals(doc, input);
  put(doc, "/statistics/summary/value", std::vector<double>{1, 2}); // of another stage
  if (spoil) spoil(doc);
  sets.push_back(nullptr);
  CHECK_EQUAL(conceg_params_new(ctx, &conceg_stage_fit, doc, nullptr, sets.data(), nullptr, &params),
              CONCEG_OK);
  out.status = conceg_stage_run(ctx, &conceg_stage_fit, doc, params);
  out.error = conceg_ctx_error(ctx);
  if (out.status == CONCEG_OK) {
    out.bytes = conceg::testing::bytes_of(doc);
    out.signal = texts(doc, "/statistics/sandi/signal"), out.kernel = texts(doc, "/statistics/sandi/kernel");
    out.errors_from = texts(doc, "/statistics/sandi/errors_from");
    out.f_soma = column(doc, "sandi/f_soma"), out.radius = column(doc, "sandi/radius");
    out.f_soma_truth = column(doc, "sandi/f_soma_truth"),
    out.radius_truth = column(doc, "sandi/radius_truth");
    out.f_extra_truth = column(doc, "sandi/f_extracellular_truth");
    out.shell_b = column(doc, "sandi_shell/b"), out.shell_error = column(doc, "sandi_shell/error");
    CHECK(has(doc, "/statistics/summary/value"));
    CHECK_EQUAL(conceg_doc_validate(doc, "/statistics", nullptr, nullptr), CONCEG_OK);
  } else
    CHECK(!has(doc, "/statistics/sandi"));
  conceg_params_free(params);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return out;
}

void put_tissue(conceg_doc *doc) {
  testing::put_domain(doc), testing::put_cells(doc), testing::put_meshes(doc, 4);
}

void fits() {
  const Run r = run(1, usual(), {"fit.soma_diffusivity=2", "fit.kernel=gpd"});
  if (r.status != CONCEG_OK) fprintf(stderr, "%s\n", r.error.c_str());
  CHECK_EQUAL(r.signal.size(), 2);
  CHECK_NEAR(r.f_soma[0], 0.25, 1e-4);
  CHECK_NEAR(r.radius[0], 7, 2e-3);
  CHECK(r.signal[0] == "intra" && r.errors_from[0] == "signal");
  CHECK_EQUAL(r.shell_b.size(), 22); // 11 shells each
  CHECK(r.f_soma_truth.empty());
  const Run full = run(1, usual(), {"fit.compartment=all"});
  CHECK_EQUAL(full.signal.size(), 1);
  CHECK_NEAR(full.f_soma[0], 0.2, 1e-4);
  CHECK_NEAR(full.radius[0], 7, 2e-3);
  Input silent = usual();
  silent.error = 0; // unknown
  CHECK(run(1, silent).errors_from[0] == "residuals");
}

void truths() {
  const Run r = run(1, usual(), {"fit.soma_diffusivity=2"}, put_tissue);
  if (r.status != CONCEG_OK) fprintf(stderr, "%s\n", r.error.c_str());
  CHECK_EQUAL(r.f_soma_truth.size(), 2);
  if (r.f_soma_truth.size() != 2) return;
  const double balls = 4.0 / 3 * 3.14159265358979323846 * (64 + 27 + 8) / 8000;
  CHECK_NEAR(r.f_soma_truth[0], 1.0, 1e-9); // of the cells, which are all soma
  CHECK_NEAR(r.f_soma_truth[1], balls, 1e-3 * balls + 1e-4);
  CHECK_NEAR(r.f_extra_truth[1], 1 - balls, 1e-3);
  CHECK_NEAR(r.radius_truth[0], 3, 1e-6);
  CHECK(r.log.find("(truth 3.00 mean, 3.57 volume-weighted, 3.71 effective") != std::string::npos);
  const Run open =
      run(1, usual(), {}, [](conceg_doc *doc) { put_tissue(doc), testing::put_domain(doc, false); });
  CHECK(open.status == CONCEG_OK && open.f_soma_truth.empty() && !open.radius_truth.empty());
}

// The errors of averages that the simulation knows stand for those of independent directions.
void weights() {
  const auto known = [](conceg_doc *doc) {
    std::vector<std::uint32_t> shell;
    std::vector<double> b, error;
    for (std::uint32_t direction = 0; direction < 3; direction++)
      for (std::uint32_t i = 0; i < 12; i++)
        shell.push_back(i);
    for (int row = 0; row < 2; row++)
      for (int i = 0; i < 12; i++)
        error.push_back(1e-4 * (1 + i));
    for (int i = 0; i < 12; i++)
      b.push_back(i);
    put(doc, "/protocol/shell", shell), put(doc, "/signals/powder_b", b);
    put2(doc, "/signals/powder", error, 2), put2(doc, "/signals/powder_error", error, 2);
  };
  const Run r = run(1, usual(), {"fit.soma_diffusivity=2", "fit.weights=errors"}, known);
  if (r.status != CONCEG_OK) fprintf(stderr, "%s\n", r.error.c_str());
  CHECK_EQUAL(r.shell_error.size(), 22);
  for (std::size_t i = 0; i < 11 && r.shell_error.size() == 22; i++) {
    CHECK_NEAR(r.shell_error[i], 1e-4 * (2.0 + static_cast<double>(i)) / 2.0,
               1e-12); // over the signal at b = 0
    CHECK_NEAR(r.shell_error[11 + i], 1e-4 * (2.0 + static_cast<double>(i)), 1e-12);
  }
  CHECK_NEAR(r.radius[0], 7, 2e-3);
  const Run without = run(1, usual());
  CHECK_NEAR(without.shell_error[3], 1e-4 / std::sqrt(3.0) / 2.0, 1e-12);
  Input silent = usual();
  silent.error = 0;
  const Run none = run(1, silent, {"fit.weights=errors"});
  CHECK_EQUAL(none.status, CONCEG_E_MISSING);
  CHECK(none.error.find("use weights=none") != std::string::npos);
}

void same_bytes() {
  const std::vector<const char *> exact = {"fit.kernel=exact", "fit.soma_diffusivity=2", "fit.starts=6"};
  const Run one = run(1, usual(), exact, put_tissue);
  CHECK(one.status == CONCEG_OK && one.kernel[0] == "exact");
  CHECK(one.bytes == run(2, usual(), exact, put_tissue).bytes);
  CHECK(one.bytes == run(3, usual(), exact, put_tissue).bytes);
}

void variants() {
  const Run r = run(2, usual(), {"fit.variants=true", "fit.starts=8", "fit.compartment=intra"});
  CHECK_EQUAL(r.signal.size(), 4);
  CHECK(r.kernel[0] == "gpd" && r.kernel[3] == "exact");
}

void refused(const Input &input, std::vector<const char *> sets, conceg_status status, const char *words,
             const Spoil &spoil = nullptr) {
  const Run r = run(1, input, std::move(sets), spoil);
  CHECK_EQUAL(r.status, status);
  CHECK(r.error.find(words) != std::string::npos);
  if (r.error.find(words) == std::string::npos) fprintf(stderr, "  got: %s\n", r.error.c_str());
}

void bad_input() {
  Input in = usual();
  in.b[3] = 2e9;
  refused(in, {}, CONCEG_E_FORMAT, "is it in s/m^2? divide by 1e9");
  in.b[3] = 2000;
  refused(in, {}, CONCEG_E_FORMAT, "is it in s/mm^2? divide by 1000");
  in = usual();
  for (double &b : in.b)
    b += 0.1;
  refused(in, {}, CONCEG_E_FORMAT, "no measurement with b = 0");
  in = usual();
  in.intra[4] = NAN;
  refused(in, {}, CONCEG_E_FORMAT, "expected finite numbers");
  in = usual();
  in.b[3] = -1;
  refused(in, {}, CONCEG_E_FORMAT, "expected b of 0 or more");
  in = usual();
  for (double &s : in.intra)
    s = -s;
  refused(in, {}, CONCEG_E_FORMAT, "expected a signal above 0 at b = 0");
  refused(usual(), {"fit.shell_width=4"}, CONCEG_E_RANGE,
          "values of b above 0 or more to fit soma_share, radius");
  refused(usual(), {"fit.compartment=soma"}, CONCEG_E_MISSING, "/signals/compartment (intra, all)");
  refused(usual(), {"fit.free=neurites"}, CONCEG_E_PARAM, "expected some of neurite, extra, soma");
  refused(usual(), {"fit.radius_min_um=9", "fit.radius_max_um=8"}, CONCEG_E_PARAM,
          "expected less than radius_max_um");
  refused(usual(), {"fit.diffusivity_min=3"}, CONCEG_E_PARAM, "expected less than diffusivity_max");
  in = usual();
  in.duration.assign(in.b.size(), 0);
  refused(in, {}, CONCEG_E_FORMAT, "no pair of pulses");
  refused(usual(), {}, CONCEG_E_MISSING, "/signals",
          [](conceg_doc *doc) { (void)!conceg_doc_drop(doc, "/signals"); });
  refused(usual(), {}, CONCEG_E_FORMAT, "/meshes", [](conceg_doc *doc) {
    put_tissue(doc);
    put(doc, "/meshes/compartment", std::vector<std::uint8_t>{1, 2});
  });
}

} // namespace

int main() {
  fits();
  truths();
  weights();
  same_bytes();
  variants();
  bad_input();
  return check_done();
}
