// SPDX-License-Identifier: BSD-3-Clause
#include "swc_files.hpp"

#include "parallel.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

namespace conceg::importing {
namespace {

constexpr std::uint32_t most_logged = 10;

// Warnings of the reader; what strict mode would refuse is said aloud, matters of style with -v.
void log_problems(conceg_ctx *ctx, SwcFile &file) {
  static const char *const style[] = {"W_ZEROLEN", "W_TRAILING", "W_ENCODING",   "W_EOL",
                                      "W_BOM",     "W_COLUMNS",  "W_TYPECHANGE", "W_NO_SOMA"};
  std::uint32_t severity, line, said = 0, all = 0;
  const char *code, *text;
  for (std::uint32_t i = 0; conceg_swc_problem(file.swc.get(), i, &severity, &line, &code, &text); i++) {
    file.stale = file.stale || !std::strcmp(code, "W_STALE");
    const bool quiet =
        std::any_of(std::begin(style), std::end(style), [&](const char *s) { return !std::strcmp(s, code); });
    all += !quiet;
    if (quiet)
      conceg_ctx_log(ctx, CONCEG_LOG_INFO, "%s:%u: %s: %s", file.path.c_str(), line, code, text);
    else if (++said <= most_logged)
      conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "%s:%u: %s: %s", file.path.c_str(), line, code, text);
  }
  if (all > most_logged)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "%s: %u more warnings; conceg swc check lists all",
                   file.path.c_str(), all - most_logged);
}

} // namespace

std::vector<SwcFile> read_files(conceg_ctx *ctx, const std::vector<std::string> &paths, std::uint32_t flags) {
  std::vector<SwcFile> files(paths.size());
  const auto read = [&](std::size_t i) {
    conceg_swc *raw = nullptr;
    files[i].path = paths[i];
    const conceg_status status = conceg_swc_read(ctx, paths[i].c_str(), flags, &raw);
    files[i].swc.reset(raw);
    must(status);
    files[i].blocks = swcdoc::read_blocks(raw, files[i].path);
  };
  // Of several bad files the first is named, whichever was seen first: those before it are all read, and it
  // is read once more at the end.
  std::atomic<std::size_t> first_bad{paths.size()}, done{0};
  Workers workers(conceg_ctx_threads(ctx));
  workers.loop(paths.size(), 1, [&](std::size_t i, unsigned) {
    if (i >= first_bad) return;
    try {
      read(i);
      must(conceg_ctx_progress(ctx, "reading SWC files", ++done, paths.size()));
    } catch (const Error &) {
      for (std::size_t before = first_bad; i < before && !first_bad.compare_exchange_weak(before, i);) {
      }
    }
  });
  for (std::size_t i = 0; i < paths.size(); i++) {
    if (i == first_bad || !files[i].swc) {
      must(conceg_ctx_progress(ctx, "reading SWC files", i, paths.size()));
      read(i);
    }
    log_problems(ctx, files[i]);
  }
  return files;
}

} // namespace conceg::importing
