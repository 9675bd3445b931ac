// SPDX-License-Identifier: BSD-3-Clause
#include "leaves.hpp"
#include "wide.hpp"

#include <cstring>

namespace conceg::mesh {

WIDE void compare_boxes(const Item &a, const Item &b, float far, BoxPairs &out) {
  const float farther = far > 0 ? far : 0;
  for (std::uint32_t i = 0; i < kLeaf; i++) {
    bool beyond = false; // the whole leaf
    for (int axis = 0; axis < 3; axis++)
      beyond |=
          (a.face_low[axis][i] - b.high[axis] > farther) | (b.low[axis] - a.face_high[axis][i] > farther);
    if (beyond) {
      std::memset(out.meet[i], 0, kLeaf), std::memset(out.near[i], 0, kLeaf);
      continue;
    }
    for (std::uint32_t j = 0; j < kLeaf; j++) {
      float d = -1e30f;
      for (int axis = 0; axis < 3; axis++) {
        const float above = a.face_low[axis][i] - b.face_high[axis][j],
                    below = b.face_low[axis][j] - a.face_high[axis][i];
        d = above > d ? above : d;
        d = below > d ? below : d;
      }
      out.meet[i][j] = d <= 0, out.near[i][j] = d <= far;
    }
  }
}

} // namespace conceg::mesh
