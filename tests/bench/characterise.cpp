// SPDX-License-Identifier: BSD-3-Clause
// CPU time per cell of its metrics and of its barcodes, reading left out, as one JSON array on standard
// output.  bench_characterise FILES
#include "dictionary.hpp"
#include "measures.hpp"
#include "tests/trees.hpp"

#include "conceg/swc.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <vector>

using namespace conceg;
using namespace conceg::characterise;

namespace {

constexpr double least_cpu_s = 0.5;   // of one figure
constexpr double batch_cpu_s = 0.002; // so that the clock's own time does not count

// User and system: the kernel divides the two by its ticks, too coarsely for one cell.
double cpu_s() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Times {
  double best_ms = 0.0, median_ms = 0.0;
  std::size_t runs = 0;
};

// Batches of equal work until both the time and a few batches are reached.
template <class Work> Times repeat(Work work) {
  std::size_t batch = 1;
  for (double spent = 0.0; spent < batch_cpu_s; batch *= 2) {
    const double start = cpu_s();
    for (std::size_t i = 0; i < batch; i++)
      work();
    spent = cpu_s() - start;
  }
  std::vector<double> per_run;
  for (double sum = 0.0; sum < least_cpu_s || per_run.size() < 9;) {
    const double start = cpu_s();
    for (std::size_t i = 0; i < batch; i++)
      work();
    const double spent = cpu_s() - start;
    per_run.push_back(1e3 * spent / static_cast<double>(batch)), sum += spent;
  }
  std::sort(per_run.begin(), per_run.end());
  return {per_run.front(), per_run[per_run.size() / 2], batch * per_run.size()};
}

void print(const char *name, const Times &t) {
  std::printf(", \"%s\": {\"best_ms\": %.4f, \"median_ms\": %.4f, \"runs\": %zu}", name, t.best_ms,
              t.median_ms, t.runs);
}

Samples samples_of(const conceg_swc *swc) {
  Samples s;
  const double *p = conceg_swc_position(swc);
  for (std::uint64_t i = 0; i < conceg_swc_count(swc); i++) {
    s.position.emplace_back(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
    s.radius.push_back(conceg_swc_radius(swc)[i]), s.kind.push_back(conceg_swc_kind(swc)[i]);
    s.parent.push_back(conceg_swc_parent(swc)[i]), s.on_soma.push_back(true);
  }
  return s;
}

bool measure_file(conceg_ctx *ctx, const char *path, bool first) {
  conceg_swc *swc = nullptr;
  const bool read = conceg_swc_read(ctx, path, 0, &swc) == CONCEG_OK;
  if (read) {
    const Samples samples = samples_of(swc);
    Cell cell;
    double center[3];
    conceg_swc_soma(swc, center, &cell.soma_radius);
    cell.soma = {center[0], center[1], center[2]}, cell.trees = whole_trees(swc);
    for (Tree &tree : cell.trees)
      for (double &r : tree.radius)
        r = std::max(r, 0.05); // as the stage's lowest_radius_um: the spread of ln r needs r > 0
    const metrics::Samples whole = whole_cell(samples, cell.soma, cell.soma_radius);

    std::size_t sections = 0, bars = 0, donor_bars = 0; // printed, so that no work is left out
    const Times all_metrics =
        repeat([&] { sections = metrics::measure(whole, sholl_step_um).sections.size(); });
    const Times barcode = repeat([&] {
      bars = 0;
      for (const Tree &tree : cell.trees)
        bars += find_bars(tree).size();
    });
    const Times donor = repeat([&] {
      Dictionary dictionary;
      EntrySums sums;
      donor_bars = add_cell(dictionary, sums, Donor{}, cell).bars;
    });
    const char *const slash = std::strrchr(path, '/');
    std::printf("%s\n {\"file\": \"%s\", \"samples\": %zu, \"sections\": %zu, \"bars\": %zu",
                first ? "" : ",", slash ? slash + 1 : path, samples.size(), sections, bars);
    print("metrics", all_metrics), print("barcode", barcode), print("donor", donor);
    std::printf("}");
    if (bars != donor_bars) return false;
  } else
    std::fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  conceg_swc_free(swc);
  return read;
}

} // namespace

int main(int argc, char **argv) {
  if (argc < 2) return 2;
  conceg_ctx *ctx = conceg_ctx_new();
  bool good = ctx;
  std::printf("[");
  for (int i = 1; i < argc && good; i++)
    good = measure_file(ctx, argv[i], i == 1);
  std::printf("\n]\n");
  conceg_ctx_free(ctx);
  return !good;
}
