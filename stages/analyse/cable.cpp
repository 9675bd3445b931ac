// SPDX-License-Identifier: BSD-3-Clause
#include "cable.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::analyse {

std::vector<CellCable> measure_cable(const Skeletons &s) {
  std::vector<CellCable> cells(s.cell_offset.size() - 1);
  for (std::size_t cell = 0; cell < cells.size(); cell++)
    for (std::size_t i = s.cell_offset[cell]; i < s.cell_offset[cell + 1]; i++) {
      if (s.parent[i] < 0) continue;
      const std::size_t parent = s.cell_offset[cell] + static_cast<std::size_t>(s.parent[i]);
      const double length = glm::distance(s.position[i], s.position[parent]);
      const auto kind =
          std::find(neurite_kinds.begin() + 1, neurite_kinds.end(), static_cast<int>(s.kind[i]));
      const std::size_t place =
          kind == neurite_kinds.end() ? 0 : static_cast<std::size_t>(kind - neurite_kinds.begin());
      cells[cell][place].add(
          {length,
           length * 0.5 * (static_cast<double>(s.radius[i]) + static_cast<double>(s.radius[parent]))});
    }
  return cells;
}

} // namespace conceg::analyse
