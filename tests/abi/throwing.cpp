// SPDX-License-Identifier: BSD-3-Clause
// A stage in C++ whose run() throws: guard() turns the exception into a status and a line.
#include "conceg/stage.h"
#include "guard.hpp"

#include <stdexcept>

namespace {
conceg_status run(conceg_ctx *ctx, conceg_doc *, const conceg_params *) {
  return conceg::guard(ctx, "relax", [] { throw std::runtime_error("the toy exploded"); });
}
} // namespace

extern "C" const conceg_stage *conceg_stage_entry(uint32_t, uint32_t index) {
  static conceg_stage stage = {};
  stage.abi = CONCEG_STAGE_ABI;
  stage.size = sizeof stage;
  stage.kind = "relax";
  stage.name = "throwing";
  stage.version = "1.0.0";
  stage.run = run;
  return index == 0 ? &stage : nullptr;
}
