// SPDX-License-Identifier: BSD-3-Clause
// Stands in for pictures.cpp in a build without Cairo.
#include "guard.hpp"
#include "pictures.hpp"

namespace conceg::characterise {

Pictures::Pictures(std::string folder, std::string beside)
    : folder_(std::move(folder)), beside_(std::move(beside)) {
  if (!folder_.empty() || !beside_.empty())
    fail(CONCEG_E_UNSUPPORTED,
         "pictures: this build has no Cairo; install libcairo2-dev and build again, or leave --pictures out");
}

void Pictures::keep(const Dictionary &, const Cell &) {}

void Pictures::draw(conceg_ctx *, const Dictionary &) const {}

} // namespace conceg::characterise
