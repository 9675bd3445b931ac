// SPDX-License-Identifier: BSD-3-Clause
// Walkers that are done, in a file of their own, so that a run that was ended can go on.
#pragma once

#include "simulation.hpp"

#include "conceg/params.h"

#include <string>

namespace conceg::simulate {

class Checkpoint {
public:
  // What the file must agree with: the surfaces and the protocol of `doc`, the parameters and the seed.
  // `path` empty: nothing is kept.
  Checkpoint(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params, const std::string &path);
  // False when there is no such file. E_PARAM when it is of another run, E_FORMAT when it is none of ours.
  bool read(Walked &walked) const;
  void write(const Walked &walked) const;

private:
  conceg_ctx *ctx_;
  std::string path_, key_;
  std::uint64_t walkers_ = 0, shapes_ = 0, records_ = 0;
};

} // namespace conceg::simulate
