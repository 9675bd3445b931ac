// SPDX-License-Identifier: BSD-3-Clause
// A stage in C++ whose run() throws: guard() turns the exception into a status and a line. UNGUARDED: it
// leaves run().
#include "conceg/stage.h"
#include "guard.hpp"

#include <stdexcept>

namespace {
#ifdef UNGUARDED
const char *const name = "thrown";
conceg_status run(conceg_ctx *, conceg_doc *, const conceg_params *) {
  throw std::runtime_error("the toy exploded");
}
#else
const char *const name = "throwing";
conceg_status run(conceg_ctx *ctx, conceg_doc *, const conceg_params *) {
  return conceg::guard(ctx, "relax", [] { throw std::runtime_error("the toy exploded"); });
}
#endif
} // namespace

extern "C" const conceg_stage *conceg_stage_entry(uint32_t, uint32_t index) {
  static conceg_stage stage = {};
  stage.abi = CONCEG_STAGE_ABI;
  stage.size = sizeof stage;
  stage.kind = "relax";
  stage.name = name;
  stage.version = "1.0.0";
  stage.run = run;
  return index == 0 ? &stage : nullptr;
}
