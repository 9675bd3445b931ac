// SPDX-License-Identifier: BSD-3-Clause
#include "swc_files.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace conceg::importing {
namespace {

constexpr std::uint32_t most_logged = 10;

bool is_swc(const std::filesystem::path &path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".swc" && path.filename().string()[0] != '.';
}

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

std::vector<std::string> find_files(const std::vector<std::string> &names) {
  std::vector<std::string> files;
  for (const std::string &name : names) {
    std::error_code error;
    if (!std::filesystem::is_directory(name, error)) {
      files.push_back(name);
      continue;
    }
    std::vector<std::string> found;
    std::filesystem::recursive_directory_iterator entry(name, error), end;
    for (; !error && entry != end; entry.increment(error))
      if (entry->is_regular_file() && is_swc(entry->path())) found.push_back(entry->path().string());
    if (error) fail(CONCEG_E_IO, "%s: cannot be listed: %s", name.c_str(), error.message().c_str());
    if (found.empty()) fail(CONCEG_E_MISSING, "%s: expected files that end in .swc, got none", name.c_str());
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

std::vector<SwcFile> read_files(conceg_ctx *ctx, const std::vector<std::string> &paths, std::uint32_t flags) {
  std::vector<SwcFile> files;
  for (std::size_t i = 0; i < paths.size(); i++) {
    must(conceg_ctx_progress(ctx, "reading SWC files", i, paths.size()));
    SwcFile file;
    file.path = paths[i];
    conceg_swc *raw = nullptr;
    const conceg_status status = conceg_swc_read(ctx, file.path.c_str(), flags, &raw);
    file.swc.reset(raw);
    must(status);
    log_problems(ctx, file);
    file.blocks = swcdoc::read_blocks(raw, file.path);
    files.push_back(std::move(file));
  }
  must(conceg_ctx_progress(ctx, "reading SWC files", paths.size(), paths.size()));
  return files;
}

} // namespace conceg::importing
