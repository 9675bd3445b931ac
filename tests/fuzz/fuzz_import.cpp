// SPDX-License-Identifier: BSD-3-Clause
// The first byte chooses a format, the rest is a file of it (of two, with a NUL between them): the readers of
// import. What is accepted becomes a document that is valid.
extern "C" {
#include "fuzz.h"
}

#include "labels.hpp"
#include "scene.hpp"
#include "signal_document.hpp"
#include "signal_files.hpp"

#include <cstring>
#include <unistd.h>

namespace {

using namespace conceg;
using namespace conceg::importing;

struct Format {
  const char *file, *second;
  Scene (*read)(const Request &); // null: network, signal, labels
};
Scene read_wmg_file(const Request &request) {
  Scene scene;
  parse_wmg(read_bytes(request.ctx, request.names[0]), request.names[0], scene);
  return scene;
}
// In the order of the letters that make_seeds of fuzz.sh puts first: A cactus, B caterpillar, ...
const Format formats[] = {
    {"s.init", nullptr, read_cactus},    {"voxel.csv", "growth_info.txt", read_caterpillar},
    {"f.dat", nullptr, read_fastpli},    {"strand_00-r0.001000.txt", nullptr, read_nfg},
    {"w.json", nullptr, read_wmg_file},  {"c.ply", nullptr, read_ply_folder},
    {"nodes.txt", "edges.txt", nullptr}, {"signals.csv", nullptr, nullptr},
    {"l.npz", nullptr, nullptr}};
constexpr std::size_t network_row = 6, labels_row = 8;

const std::string &folder() {
  static std::string name;
  if (name.empty()) {
    char pattern[] = "/dev/shm/conceg-fuzz-XXXXXX";
    DEMAND(mkdtemp(pattern));
    name = pattern;
    std::atexit([] {
      for (const Format &format : formats)
        for (const char *file : {format.file, format.second})
          if (file) unlink((folder() + "/" + file).c_str());
      rmdir(folder().c_str());
    });
  }
  return name;
}

std::string put_file(const char *name, const char *bytes, std::size_t count) {
  const std::string path = folder() + "/" + name;
  std::FILE *file = std::fopen(path.c_str(), "wb");
  DEMAND(file && std::fwrite(bytes, 1, count, file) == count);
  DEMAND(std::fclose(file) == 0);
  return path;
}

void import_file(conceg_ctx *ctx, conceg_doc *doc, std::size_t which, const Request &request) {
  if (formats[which].read)
    write_document(ctx, doc, formats[which].read(request), request.margin_um);
  else if (which == network_row)
    import_network(request, doc);
  else if (which == labels_row)
    write_labels(ctx, doc, parse_numpy(read_bytes(ctx, request.names[0]), request.names[0], "", 1e8),
                 {{1.0, 1.0, 2.0}, 0.0, false});
  else
    write_signals(doc, read_signal_table(request.names[0], {"", "", "all", 5.0, 20.0}));
}

void demand_valid(conceg_ctx *ctx, conceg_doc *doc) {
  if (conceg_doc_validate(doc, nullptr, nullptr, nullptr) == CONCEG_OK) return;
  std::fprintf(stderr, "an invalid document: %s\n", conceg_ctx_error(ctx));
  DEMAND(!"valid");
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  planted_bug(data, size);
  if (size < 2) return 0;
  const std::size_t which = (data[0] - 'A') % (sizeof formats / sizeof *formats);
  const char *bytes = reinterpret_cast<const char *>(data) + 1;
  const auto *end =
      formats[which].second ? static_cast<const char *>(std::memchr(bytes, 0, size - 1)) : nullptr;
  const std::size_t first = end ? static_cast<std::size_t>(end - bytes) : size - 1;
  conceg_ctx *ctx = fuzz_ctx();
  Request request = {};
  request.ctx = ctx, request.margin_um = 5.0;
  request.names = {put_file(formats[which].file, bytes, first)};
  if (formats[which].second) {
    const std::string second = end ? put_file(formats[which].second, end + 1, size - 2 - first)
                                   : put_file(formats[which].second, "", 0);
    if (which == network_row)
      request.names.push_back(second);
    else
      request.info = second;
  }
  conceg_doc *doc = nullptr;
  DEMAND(conceg_doc_new(ctx, &doc) == CONCEG_OK);
  if (guard(ctx, "import", [&] { import_file(ctx, doc, which, request); }) == CONCEG_OK)
    demand_valid(ctx, doc);
  else
    DEMAND(*conceg_ctx_error(ctx));
  DEMAND(conceg_doc_close(doc) == CONCEG_OK);
  return 0;
}
