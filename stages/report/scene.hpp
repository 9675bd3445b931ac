// SPDX-License-Identifier: BSD-3-Clause
// What the page draws in three dimensions: skeletons, somata and surfaces of a document within a number of
// bytes.
#pragma once

#include "json.hpp"
#include "skeleton.hpp"
#include "surface.hpp"

#include "conceg/doc.h"

#include <string>
#include <vector>

namespace conceg::reporting {

struct Scene {
  std::size_t cells = 0, points = 0;     // of the document
  std::uint64_t surfaces = 0, faces = 0; // of the document, at the level that is drawn
  std::vector<std::uint64_t> id;         // of the cells
  std::vector<std::uint32_t> type;       // of the cells
  std::vector<glm::dvec3> soma;          // um
  std::vector<float> soma_radius;        // um, 0 = none
  Thinned skeleton;
  Coarsened mesh;
  int level = 0;                     // of the surfaces
  std::vector<std::string> left_out; // sentences
};

// Reads and checks; E_FORMAT or E_RANGE names path[index] of what is wrong. Skeletons take at most half of
// `most` bytes, surfaces the rest.
Scene read_scene(conceg_doc *doc, std::size_t most);

// One block of bytes of the page.
struct Block {
  std::string name;
  std::vector<std::uint8_t> bytes;
};

// The scene as little-endian blocks (positions as u16 steps from a corner) and, in `json`, what they mean.
std::vector<Block> pack(const Scene &scene, Json &json);

} // namespace conceg::reporting
