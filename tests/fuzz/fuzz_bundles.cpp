// SPDX-License-Identifier: BSD-3-Clause
// A file of fibre bundles (.h5): the reader of import that stands on HDF5. What is accepted becomes a
// document that is valid.
extern "C" {
#include "fuzz.h"
}

#include "scene.hpp"

#include <unistd.h>

namespace {

using namespace conceg;
using namespace conceg::importing;

std::string put_file(const std::uint8_t *bytes, std::size_t count) {
  static std::string path;
  if (path.empty()) {
    path = "/dev/shm/conceg-fuzz-" + std::to_string(getpid()) + ".h5";
    std::atexit([] { unlink(path.c_str()); });
  }
  std::FILE *file = std::fopen(path.c_str(), "wb");
  DEMAND(file && std::fwrite(bytes, 1, count, file) == count);
  DEMAND(std::fclose(file) == 0);
  return path;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  conceg_ctx *ctx = fuzz_ctx();
  Request request = {};
  request.ctx = ctx, request.margin_um = 5.0;
  request.names = {put_file(data, size)};
  conceg_doc *doc = nullptr;
  DEMAND(conceg_doc_new(ctx, &doc) == CONCEG_OK);
  if (guard(ctx, "import", [&] { write_document(ctx, doc, read_fastpli(request), request.margin_um); }) ==
      CONCEG_OK)
    DEMAND(conceg_doc_validate(doc, nullptr, nullptr, nullptr) == CONCEG_OK);
  else
    DEMAND(*conceg_ctx_error(ctx));
  DEMAND(conceg_doc_close(doc) == CONCEG_OK);
  return 0;
}
