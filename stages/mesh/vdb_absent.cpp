// SPDX-License-Identifier: BSD-3-Clause
// Stands in for vdb.cpp in a build without OpenVDB.
#include "volume.hpp"

namespace conceg::mesh {

bool vdb_available() {
  return false;
}

void write_vdb(const Volume &, const char *path) {
  fail(CONCEG_E_UNSUPPORTED,
       "%s: this build has no OpenVDB; install libopenvdb-dev and build again, or leave --vdb out", path);
}

} // namespace conceg::mesh
