// SPDX-License-Identifier: BSD-3-Clause
// Stands in for wmg.cpp in a build without JsonCpp.
#include "scene.hpp"

namespace conceg::importing {

void parse_wmg(const std::string &, const std::string &path, Scene &) {
  fail(CONCEG_E_UNSUPPORTED, "%s: this build reads no JSON; install libjsoncpp-dev and build again",
       path.c_str());
}

} // namespace conceg::importing
