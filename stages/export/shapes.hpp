// SPDX-License-Identifier: BSD-3-Clause
// Writers of triangle surfaces for any mesh program. VTK's own write OBJ with six digits, and its glTF writer
// wants a scene.
#pragma once

#include "output.hpp"
#include "tile.hpp"

#include <string>
#include <vector>

namespace conceg::exporting {

// A surface with the name of its object or node.
struct NamedSurface {
  std::string name;
  const Surface *surface;
};

// Binary STL: single precision, normals of the faces.
void write_stl(OutputFile &file, const Surface &surface);
// STL as text, with all digits, for readers that take no other (TetGen).
void write_stl_text(OutputFile &file, const Surface &surface);
// OBJ: an object per surface.
void write_obj(OutputFile &file, const std::vector<NamedSurface> &surfaces);
// Binary glTF 2.0: a node per surface, its single-precision vertices about the node's place; the root turns
// +z up into glTF's +y up.
void write_glb(OutputFile &file, const std::vector<NamedSurface> &surfaces);

} // namespace conceg::exporting
