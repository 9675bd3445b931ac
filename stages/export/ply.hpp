// SPDX-License-Identifier: BSD-3-Clause
// PLY files of triangle surfaces, made for the strictest readers: x y z and triangles only, no further
// property, comments without the words that MC/DC takes for keywords. Coordinates are doubles, so that the
// file holds the very values that the mesh stage checked.
#pragma once

#include "output.hpp"
#include "tile.hpp"

#include <string>
#include <vector>

namespace conceg::exporting {

// Writes the surfaces as one PLY, binary little-endian or ASCII (MC/DC reads ASCII only). Comments go into
// the header.
void write_ply(OutputFile &file, const std::vector<const Surface *> &surfaces, bool ascii,
               const std::vector<std::string> &comments);

} // namespace conceg::exporting
