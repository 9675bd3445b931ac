// SPDX-License-Identifier: BSD-3-Clause
// Damaged files of fibre bundles (.h5) by the thousand: a few bytes of a good one are changed at random
// places, and each result is imported in a process of its own. Same seed, same mutants. A crash that is not
// HDF5's own, or a hang, fails the test.
//   mutants_bundles [COUNT]
extern "C" {
#include "../fuzz/bundles_sample.h"
}

#include "scene.hpp"

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace {

using namespace conceg;
using namespace conceg::importing;

enum { READ = 0, REFUSED = 1, INVALID = 2, SILENT = 3, CRASHED = 4 };
constexpr unsigned seconds = 20;

std::uint64_t state = 88172645463325252u;
std::uint64_t next(std::uint64_t below) {
  state ^= state << 13, state ^= state >> 7, state ^= state << 17;
  return state % below;
}

std::vector<unsigned char> bytes_of(const std::string &path) {
  std::vector<unsigned char> bytes(1 << 20);
  std::FILE *file = std::fopen(path.c_str(), "rb");
  CHECK(file);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file));
  std::fclose(file);
  return bytes;
}

void put_bytes(const std::string &path, const std::vector<unsigned char> &bytes) {
  std::FILE *file = std::fopen(path.c_str(), "wb");
  CHECK(file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() && std::fclose(file) == 0);
}

int use(const std::string &path) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_memory(ctx, std::uint64_t{64} << 20);
  Request request = {};
  request.ctx = ctx, request.margin_um = 5.0, request.names = {path};
  conceg_doc *doc = nullptr;
  if (conceg_doc_new(ctx, &doc) != CONCEG_OK) return INVALID;
  if (guard(ctx, "import", [&] { write_document(ctx, doc, read_fastpli(request), request.margin_um); }) !=
      CONCEG_OK)
    return std::strstr(conceg_ctx_error(ctx), path.c_str()) ? REFUSED : SILENT; // a refusal names the file
  return conceg_doc_validate(doc, nullptr, nullptr, nullptr) == CONCEG_OK ? READ : INVALID;
}

void run(const char *name, const std::string &path, long mutants) {
  const std::vector<unsigned char> good = bytes_of(path);
  const std::string mutant = path + ".mutant.h5";
  CHECK_EQUAL(use(path), READ);
  long counts[5] = {0}, hung = 0;
  for (long i = 0; i < mutants; i++) {
    std::vector<unsigned char> bytes = good;
    for (std::uint64_t changes = 1 + next(4); changes; changes--)
      bytes[next(bytes.size())] = static_cast<unsigned char>(next(256));
    if (!next(10)) bytes.resize(next(bytes.size())); // cut short
    put_bytes(mutant, bytes);
    int status = 0;
    const pid_t pid = fork();
    if (pid == 0) {
      alarm(seconds);
      _exit(use(mutant));
    }
    waitpid(pid, &status, 0);
    counts[WIFEXITED(status) && WEXITSTATUS(status) < CRASHED ? WEXITSTATUS(status) : CRASHED]++;
    hung += WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
  }
  unlink(mutant.c_str());
  std::printf("%-8s %ld mutants of %zu bytes: %ld read, %ld refused, %ld invalid, %ld refused without a "
              "name, %ld crashed inside "
              "HDF5 (programs contain it), %ld hung\n",
              name, mutants, good.size(), counts[READ], counts[REFUSED], counts[INVALID], counts[SILENT],
              counts[CRASHED], hung);
  CHECK(counts[READ] && counts[REFUSED]);
  CHECK_EQUAL(counts[INVALID] + counts[SILENT] + hung, 0);
  CHECK(counts[CRASHED] * 100 <= mutants); // what is HDF5's own is rare
}

} // namespace

int main(int argc, char **argv) {
  const long mutants = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 500;
  char folder[] = "/tmp/conceg-bundles-XXXXXX";
  CHECK(mkdtemp(folder));
  for (const int packed : {0, 1}) {
    const std::string path = std::string(folder) + (packed ? "/packed.h5" : "/old.h5");
    bundles_save(path.c_str(), packed);
    run(packed ? "packed" : "old", path, mutants);
    unlink(path.c_str());
  }
  rmdir(folder);
  return check_done();
}
