// SPDX-License-Identifier: BSD-3-Clause
// Stands in for figure.cpp in a build without Cairo.
#include "guard.hpp"
#include "trace.hpp"

namespace conceg::relax {

void write_figure(const std::string &, const std::vector<Step> &) {
  fail(CONCEG_E_UNSUPPORTED,
       "pictures: this build has no Cairo; install libcairo2-dev and build again, or leave --pictures out");
}

} // namespace conceg::relax
