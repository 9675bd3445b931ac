// SPDX-License-Identifier: BSD-3-Clause
// The surface of the extracellular space in the box: what bounds the box without its cells.
#pragma once

#include "cut.hpp"

namespace conceg::exporting {

// A closed surface, outward seen from the space: the cells' surfaces turned round and cut at all six sides,
// and the sides less the cells' cuts. Of closed surfaces that do not touch, one call of `add` each; labels
// are those of faces, 0 on the sides.
class ExtracellularSurface {
public:
  explicit ExtracellularSurface(const conceg_box &box) : box_(box) {}
  // All images of a cell; `label` per face of `closed`, or empty for 1.
  void add(const Surface &closed, const std::vector<std::uint8_t> &label);
  // Adds the sides. E_UNSUPPORTED where cells touch on a side, or where a surface is open.
  void close();
  const Surface &surface() const { return surface_; }
  const std::vector<std::uint8_t> &label() const { return label_; }

private:
  conceg_box box_;
  Surface surface_;
  std::vector<std::uint8_t> label_;
};

} // namespace conceg::exporting
