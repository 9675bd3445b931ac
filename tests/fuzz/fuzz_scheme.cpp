// SPDX-License-Identifier: BSD-3-Clause
// Bytes as a protocol file of simulate: a scheme, or a bval and a bvec file with a bar between. What is
// accepted keeps what the header promises.
extern "C" {
#include "fuzz.h"
}

#include "guard.hpp"
#include "scheme_files.hpp"

#include <cmath>
#include <string>
#include <unistd.h>

using namespace conceg;
using namespace conceg::simulate;

namespace {

void save(const std::string &path, const uint8_t *data, size_t size) {
  FILE *file = fopen(path.c_str(), "wb");
  DEMAND(file && fwrite(data, 1, size, file) == size && fclose(file) == 0);
}

void check(const Protocol &p) {
  const size_t n = p.measurements(), intervals = p.timeline.intervals();
  DEMAND(n > 0 && p.direction.size() == n && p.b_tensor.size() == n && p.echo_time.size() == n);
  DEMAND(p.coefficient.size() == n * p.timeline.shapes &&
         p.timeline.shape.size() == p.timeline.shapes * intervals);
  for (size_t i = 0; i < n; i++)
    DEMAND(p.b[i] >= 0.0 && p.b[i] <= 1001.0 && std::isfinite(p.direction[i].x));
  for (size_t i = 0; i < intervals; i++)
    DEMAND(p.timeline.end[i] > (i ? p.timeline.end[i - 1] : 0.0));
  DEMAND(shells(p).size() == n);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const std::string base = "/tmp/conceg-fuzz-" + std::to_string(getpid());
  const auto *bar = static_cast<const uint8_t *>(size ? memchr(data, '|', size) : nullptr);
  const std::string path = base + (bar ? ".bval" : ".scheme");
  planted_bug(data, size);
  save(path, data, bar ? static_cast<size_t>(bar - data) : size);
  if (bar) save(base + ".bvec", bar + 1, static_cast<size_t>(data + size - bar - 1));
  try {
    check(read_protocol(path, Pulses()));
  } catch (const Error &error) {
    DEMAND(error.status() != CONCEG_OK && error.status() != CONCEG_E_INTERNAL && *error.what());
  }
  unlink(path.c_str());
  if (bar) unlink((base + ".bvec").c_str());
  return 0;
}
