// SPDX-License-Identifier: BSD-3-Clause
// Stands in for vdb.cpp in a build without OpenVDB.
#include "vdb.hpp"

#include "guard.hpp"

namespace conceg {

bool vdb_available() {
  return false;
}

void write_vdb(const LeafVolume &, const std::string &path) {
  fail(CONCEG_E_UNSUPPORTED, "%s: this build has no OpenVDB; install libopenvdb-dev and build again",
       path.c_str());
}

VdbSurface vdb_surface(const LeafVolume &, unsigned) {
  fail(CONCEG_E_UNSUPPORTED,
       "smooth: this build has no OpenVDB; install libopenvdb-dev and build again, or leave smooth out");
}

} // namespace conceg
