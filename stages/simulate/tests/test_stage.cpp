// SPDX-License-Identifier: BSD-3-Clause
// The simulate stage as the host runs it: same bytes for any number of threads and after a resumed run, what
// the document then holds, protocols from files, clear errors for bad ones.
#include "../../common/tests/bytes.hpp"
#include "../../common/tests/tissue.hpp"
#include "conceg/conceg.h"

#include "check.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <unistd.h>

using namespace conceg;

extern "C" const conceg_stage conceg_stage_simulate;

namespace {

std::string folder;

struct Run {
  conceg_status status = CONCEG_OK;
  std::string error, bytes, log;
  std::vector<std::string> compartment;
  std::vector<double> signal, error_bar, fraction, vector, coefficient, b, diffusivity;
  std::vector<std::int64_t> cell;
  std::vector<std::uint8_t> code;
  double value(const std::string &name, std::size_t measurement) const {
    for (std::size_t c = 0; c < compartment.size(); c++)
      if (compartment[c] == name) return signal[c * b.size() + measurement];
    return NAN;
  }
};

void keep_line(void *user, conceg_log_level, const char *line) {
  static_cast<std::string *>(user)->append(line).append("\n");
}

template <class T> std::vector<T> flat(conceg_doc *doc, const char *path) {
  conceg_array array = {};
  array.size = sizeof array;
  CHECK_EQUAL(conceg_doc_read(doc, path, &array), CONCEG_OK);
  const T *data = static_cast<const T *>(array.data);
  return std::vector<T>(data, data + conceg_array_count(&array));
}

using Spoil = std::function<void(conceg_doc *)>;
const Spoil nothing = [](conceg_doc *) {};

Run run(std::uint32_t threads, std::vector<std::string> sets, const Spoil &spoil = nothing,
        conceg_progress_fn stop = nullptr) {
  Run out;
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_threads(ctx, threads);
  conceg_ctx_set_log(ctx, CONCEG_LOG_INFO, keep_line, &out.log);
  if (stop) conceg_ctx_set_progress(ctx, stop, nullptr);
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  testing::put_domain(doc), testing::put_cells(doc), testing::put_skeleton(doc), testing::put_meshes(doc);
  spoil(doc);
  std::vector<const char *> words;
  for (std::string &s : sets) {
    s = "simulate." + s;
    words.push_back(s.c_str());
  }
  words.push_back(nullptr);
  out.status = conceg_params_new(ctx, &conceg_stage_simulate, doc, nullptr, words.data(), nullptr, &params);
  if (out.status == CONCEG_OK) out.status = conceg_stage_run(ctx, &conceg_stage_simulate, doc, params);
  out.error = conceg_ctx_error(ctx);
  if (out.status == CONCEG_OK) {
    for (const char *group : {"/walkers", "/protocol", "/signals"})
      CHECK_EQUAL(conceg_doc_validate(doc, group, nullptr, nullptr), CONCEG_OK);
    out.bytes = testing::bytes_of(doc);
    out.compartment = texts(doc, "/signals/compartment"), out.signal = flat<double>(doc, "/signals/signal");
    out.error_bar = flat<double>(doc, "/signals/standard_error"),
    out.fraction = flat<double>(doc, "/signals/volume_fraction");
    out.vector = flat<double>(doc, "/walkers/vector"),
    out.coefficient = flat<double>(doc, "/protocol/coefficient");
    out.b = flat<double>(doc, "/protocol/b"), out.cell = flat<std::int64_t>(doc, "/walkers/cell");
    out.code = flat<std::uint8_t>(doc, "/walkers/compartment");
    if (has(doc, "/signals/diffusivity")) out.diffusivity = flat<double>(doc, "/signals/diffusivity");
  }
  conceg_params_free(params);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return out;
}

std::string file(const char *name, const std::string &text) {
  const std::string path = folder + "/" + name;
  std::FILE *f = std::fopen(path.c_str(), "wb");
  CHECK(f != nullptr);
  if (!f) return path;
  std::fwrite(text.data(), 1, text.size(), f);
  std::fclose(f);
  return path;
}

const std::vector<std::string> small = {"walkers=300", "b=0,1,3", "directions=3", "delta_ms=1",
                                        "separation_ms=2"};
std::vector<std::string> with(std::vector<std::string> more) {
  std::vector<std::string> out = small;
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

void test_results() {
  const Run one = run(1, with({"times_ms=0.5,3"})), two = run(3, with({"times_ms=0.5,3"}));
  CHECK_EQUAL(one.status, CONCEG_OK);
  if (one.status != CONCEG_OK) std::fprintf(stderr, "%s\n", one.error.c_str());
  CHECK(!one.bytes.empty() && one.bytes == two.bytes);
  CHECK(one.log.find("leaks: 0\n") != std::string::npos);
  CHECK_EQUAL(one.b.size(), 7); // b = 0 once
  CHECK_NEAR(one.value("all", 0), 1.0, 0.0);
  // Any signal follows from the stored vectors.
  double sum = 0.0, intra = 0.0;
  for (std::size_t w = 0; w < 300; w++) {
    double phase = 0.0;
    for (std::size_t k = 0; k < 3; k++)
      phase += one.coefficient[3 * 4 + k] * one.vector[3 * w + k];
    sum += std::cos(phase) / 300.0;
    intra += one.cell[w] >= 0;
    CHECK_EQUAL(one.cell[w] >= 0, one.code[w] != 0);
  }
  CHECK_NEAR(one.value("all", 4), sum, 1e-12);
  CHECK_NEAR(intra / 300.0 * one.value("intra", 4) + (1.0 - intra / 300.0) * one.value("extra", 4), sum,
             1e-12);
  // The balls' share of the box.
  const double share = 4.0 / 3.0 * M_PI * (64.0 + 27.0 + 8.0) / 8000.0;
  CHECK_NEAR(intra / 300.0, share, 4.5 * std::sqrt(share / 300.0));
  for (const double d : one.diffusivity)
    CHECK(d > 0.0 && d < 3.0);
  // Times by their logarithm are the same run as the list of them.
  const Run spaced = run(2, with({"times_ms=0.5:2:3"})), listed = run(1, with({"times_ms=2,1,0.5,1"}));
  CHECK_EQUAL(spaced.diffusivity.size(), 3 * 3 * spaced.compartment.size());
  CHECK_EQUAL(listed.diffusivity.size(), spaced.diffusivity.size());
  for (std::size_t i = 0; i < std::min(listed.diffusivity.size(), spaced.diffusivity.size()); i++)
    CHECK_NEAR(spaced.diffusivity[i], listed.diffusivity[i], 1e-9);
  const Run cell = run(1, with({"compartment=intra", "cells=id:20", "walkers=64"})),
            kind = run(1, with({"compartment=intra", "kind=astrocyte", "walkers=64"}));
  for (const std::int64_t c : cell.cell)
    CHECK_EQUAL(c, 1);
  for (const std::int64_t c : kind.cell)
    CHECK_EQUAL(c, 2);
  CHECK(cell.compartment == std::vector<std::string>({"intra", "soma", "type L4 interneuron"}));
  const Run relaxed = run(1, with({"t2_intra_ms=3", "compartment=intra"}));
  CHECK_NEAR(relaxed.value("intra", 0), std::exp(-1.0), 1e-12);
  const Run steps = run(1, with({"method=steps", "walkers=2000"})), jumps = run(1, with({"walkers=2000"}));
  for (std::size_t m = 1; m < 7; m++)
    CHECK_NEAR(steps.value("all", m), jumps.value("all", m),
               4.5 * std::hypot(steps.error_bar[m], jumps.error_bar[m]));
  const Run leaky = run(1, with({"permeability=soma=0,basal dendrite=0.05"}));
  CHECK_EQUAL(leaky.status, CONCEG_OK);
}

int rounds_left = 0;
int stop_later(void *, const char *what, std::uint64_t, std::uint64_t) {
  return std::strcmp(what, "walking") == 0 && rounds_left-- == 0;
}

void test_resume() {
  const std::string path = folder + "/kept.cgx", keep = "checkpoint=" + path;
  const std::vector<std::string> many = with({"walkers=12000", "step_ms=0.02", keep});
  const Run whole = run(2, with({"walkers=12000", "step_ms=0.02"}));
  CHECK_EQUAL(whole.status, CONCEG_OK);
  rounds_left = 100; // of 188 blocks
  CHECK_EQUAL(run(2, many, nothing, stop_later).status, CONCEG_E_CANCELLED);
  CHECK(access(path.c_str(), F_OK) == 0);
  const Run resumed = run(1, many);
  CHECK(resumed.bytes == whole.bytes);
  const std::size_t at = resumed.log.find("going on with ");
  CHECK(at != std::string::npos);
  const int done = at == std::string::npos ? 0 : std::atoi(resumed.log.c_str() + at + 14);
  CHECK(done >= 100 && done < 188);
  CHECK(run(2, many).bytes == whole.bytes); // of a run that had ended
  const Run other = run(1, with({"walkers=12000", "step_ms=0.02", "b=0,2", keep}));
  CHECK_EQUAL(other.status, CONCEG_E_PARAM);
  CHECK(other.error.find("is of another run") != std::string::npos);
  CHECK_EQUAL(run(1, with({"checkpoint=" + file("text.cgx", "no document")})).status, CONCEG_E_FORMAT);
}

void test_protocols() {
  // 1 ms/um2 by Camino's gamma; 0 as no gradient.
  const std::string scheme =
      file("a.scheme", "VERSION: STEJSKALTANNER\n0 0 0 0 0.02 0.005 0.026\n1 0 0 0.1746066 0.02 0.005 "
                       "0.026\n0 0 1 0.6762486 0.02 0.005 0.026\n");
  const Run camino = run(1, {"walkers=10", "step_ms=0.01", "protocol=" + scheme});
  CHECK_EQUAL(camino.status, CONCEG_OK);
  CHECK_EQUAL(camino.b.size(), 3);
  if (camino.b.size() == 3) {
    CHECK_NEAR(camino.b[0], 0.0, 0.0);
    CHECK_NEAR(camino.b[1], 1.0, 1e-6);
    CHECK_NEAR(camino.b[2], 15.0, 1e-5);
  }
  const std::string bval = file("p.bval", "0 1000 2000\n");
  file("p.bvec", "0 1 0\n0 0 0.6\n0 0 0.8\n");
  const Run fsl = run(1, with({"walkers=10", "protocol=" + bval}));
  CHECK_EQUAL(fsl.status, CONCEG_OK);
  CHECK(fsl.b == std::vector<double>({0.0, 1.0, 2.0}));
  // The same pair of pulses as samples of 0.5 ms: the same signals to rounding, as the walk is the same.
  std::string wave = "VERSION: GRADIENT_WAVEFORM\n50 0.0005", still = "50 0.0005";
  for (int i = 0; i < 50; i++) {
    wave += i < 10 ? " 0.1746066 0 0" : i >= 40 ? " -0.1746066 0 0" : " 0 0 0";
    still += " 0 0 0";
  }
  const std::string two = file("w.scheme", wave + "\n" + still + "\n");
  const Run sampled = run(1, {"walkers=50", "step_ms=0.01", "protocol=" + two});
  const Run pulses =
      run(1, {"walkers=50", "step_ms=0.01",
              "protocol=" + file("b.scheme", "VERSION: STEJSKALTANNER\n1 0 0 0.1746066 0.02 0.005 0.025\n")});
  CHECK_EQUAL(sampled.status, CONCEG_OK);
  if (sampled.b.size() == 2) {
    CHECK_NEAR(sampled.b[0], 1.0, 1e-6);
    CHECK_NEAR(sampled.value("all", 0), pulses.value("all", 0), 1e-9);
  }
  struct Bad {
    const char *name, *text;
    conceg_status status;
    const char *says;
  };
  for (const Bad &bad :
       {Bad{"columns.scheme", "VERSION: STEJSKALTANNER\n1 0 0 0.17 0.02 0.005\n", CONCEG_E_FORMAT,
            ":2: expected 7 columns"},
        Bad{"milli.scheme", "VERSION: STEJSKALTANNER\n1 0 0 174.6 0.02 0.005 0.026\n", CONCEG_E_RANGE,
            ":2: expected b below"},
        Bad{"ms.scheme", "VERSION: STEJSKALTANNER\n1 0 0 0.17 20 5 26\n", CONCEG_E_RANGE,
            ":2: expected times in s"},
        Bad{"order.scheme", "VERSION: STEJSKALTANNER\n1 0 0 0.17 0.004 0.005 0.026\n", CONCEG_E_RANGE,
            "delta <= Delta"},
        Bad{"echo.scheme", "VERSION: STEJSKALTANNER\n1 0 0 0.17 0.02 0.005 0.02\n", CONCEG_E_RANGE,
            "expected TE"},
        Bad{"long.scheme", "VERSION: STEJSKALTANNER\n2 0 0 0.17 0.02 0.005 0.026\n", CONCEG_E_FORMAT,
            "direction of length 1"},
        Bad{"word.scheme", "VERSION: STEJSKALTANNER\n1 0 x 0.17 0.02 0.005 0.026\n", CONCEG_E_FORMAT,
            ":2: expected finite numbers"},
        Bad{"nan.scheme", "VERSION: STEJSKALTANNER\n1 0 nan 0.17 0.02 0.005 0.026\n", CONCEG_E_FORMAT,
            ":2: expected finite numbers"},
        Bad{"other.scheme", "VERSION: APGSE\n1 0 0 1 1 1 1 1 1\n", CONCEG_E_UNSUPPORTED, "got APGSE"},
        Bad{"empty.scheme", "VERSION: STEJSKALTANNER\n", CONCEG_E_FORMAT, "expected measurements"},
        Bad{"wave.scheme", "VERSION: GRADIENT_WAVEFORM\n3 0.001 1 0 0 -1 0 0\n", CONCEG_E_FORMAT,
            ":2: expected n, dt"},
        Bad{"moment.scheme", "VERSION: GRADIENT_WAVEFORM\n2 0.001 0.1 0 0 0.1 0 0\n", CONCEG_E_FORMAT,
            "integral is 0"},
        Bad{"units.bval", "0 1e9\n", CONCEG_E_RANGE, "b-values in s/mm^2?"}}) {
    if (std::string(bad.name) == "units.bval") file("units.bvec", "1 1\n0 0\n0 0\n");
    const Run refused = run(1, with({"protocol=" + file(bad.name, bad.text)}));
    CHECK_EQUAL(refused.status, bad.status);
    CHECK(refused.error.find(bad.says) != std::string::npos);
    if (refused.error.find(bad.says) == std::string::npos)
      std::fprintf(stderr, "%s: %s\n", bad.name, refused.error.c_str());
  }
  CHECK_EQUAL(run(1, with({"protocol=" + folder + "/absent.scheme"})).status, CONCEG_E_IO);
}

void test_refused() {
  const auto says = [](const Run &r, conceg_status status, const char *words) {
    CHECK_EQUAL(r.status, status);
    CHECK(r.error.find(words) != std::string::npos);
    if (r.error.find(words) == std::string::npos)
      std::fprintf(stderr, "\"%s\" is not in: %s\n", words, r.error.c_str());
  };
  says(run(1, with({"kind=neuron"})), CONCEG_E_PARAM,
       "expected the type or class of a cell (\"pyramidal\", \"L2/3 pyramidal\"");
  says(run(1, with({"cells=9"})), CONCEG_E_RANGE, "expected a row below 3");
  says(run(1, with({"cells=0", "kind=astrocyte"})), CONCEG_E_RANGE, "expected a cell of kind");
  says(run(1, with({"margin_um=10"})), CONCEG_E_RANGE, "less than half of the box");
  says(run(1, with({"b=0,x"})), CONCEG_E_PARAM, "expected numbers with commas");
  for (const char *times :
       {"times_ms=1:2", "times_ms=2:1:5", "times_ms=1:2:1.5", "times_ms=1:2:1", "times_ms=1:2:3:4"})
    says(run(1, with({times})), CONCEG_E_PARAM, "times_ms: expected FIRST:LAST:COUNT");
  says(run(1, with({"times_ms=0:2:3"})), CONCEG_E_PARAM, "times_ms: expected numbers from 1e-06 to 10000");
  says(run(1, with({"b=-1"})), CONCEG_E_PARAM, "from 0 to 1000");
  says(run(1, with({"echo_ms=1"})), CONCEG_E_PARAM, "at least delta + Delta");
  says(run(1, with({"permeability=wall=1"})), CONCEG_E_PARAM, "expected a compartment");
  says(run(1, with({"permeability=100"})), CONCEG_E_RANGE, "use a shorter step_ms");
  // The margin leaves the middle of one cell.
  says(run(1, with({"compartment=extra", "margin_um=9.5"})), CONCEG_E_RANGE,
       "expected room for walkers, found none");
  says(run(1, small,
           [](conceg_doc *doc) {
             std::vector<std::uint32_t> face = flat<std::uint32_t>(doc, "/meshes/face");
             face[3] = face[4]; // one corner moved: its face no longer closes the surface
             put(doc, "/meshes/face", face, 3);
           }),
       CONCEG_E_FORMAT, "expected closed surfaces");
  says(run(1, small, [](conceg_doc *doc) { CHECK_EQUAL(conceg_doc_drop(doc, "/meshes"), CONCEG_OK); }),
       CONCEG_E_MISSING, "run conceg mesh");
  const Run coarse = run(1, with({"step_ms=0.05"}));
  CHECK(coarse.log.find("a step is 0.775 um long, the thinnest process has a radius of 0.500 um") !=
        std::string::npos);
}

} // namespace

int main() {
  char name[] = "simulate_stage_XXXXXX";
  if (!mkdtemp(name)) return 1;
  folder = name;
  test_results();
  test_resume();
  test_protocols();
  test_refused();
  std::filesystem::remove_all(folder);
  return check_done();
}
