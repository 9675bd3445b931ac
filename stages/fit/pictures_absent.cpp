// SPDX-License-Identifier: BSD-3-Clause
// Stands in for pictures.cpp in a build without Cairo.
#include "guard.hpp"
#include "pictures.hpp"

namespace conceg::fit {

void check_pictures(const std::string &folder) {
  if (!folder.empty())
    fail(CONCEG_E_UNSUPPORTED,
         "pictures: this build has no Cairo; install libcairo2-dev and build again, or leave --pictures out");
}

void draw_pictures(const std::string &, const std::vector<Result> &) {}

} // namespace conceg::fit
