// SPDX-License-Identifier: BSD-3-Clause
// Cells of a substrate as the stages that write files choose them: all, one row, or one id.
#pragma once

#include "conceg/model.h"
#include "guard.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace conceg {

struct CellInfo {
  std::uint64_t row = 0, id = 0;
  std::uint32_t type = 0;
  std::string type_name, class_name;
  glm::dvec3 soma = glm::dvec3(0.0); // um, in the box
  double soma_radius = 0.0;          // um, 0 = none
};

// "all", a row ("7") or an id ("id:12"); E_PARAM or E_RANGE otherwise.
inline std::vector<CellInfo> select_cells(const conceg_substrate *substrate, const std::string &cells) {
  const std::uint64_t count = conceg_substrate_cells(substrate);
  const bool all = cells == "all", by_id = cells.compare(0, 3, "id:") == 0;
  std::uint64_t wanted = 0;
  if (!all) {
    const std::string digits = by_id ? cells.substr(3) : cells;
    if (digits.empty() || digits.size() > 19 || digits.find_first_not_of("0123456789") != std::string::npos)
      fail(CONCEG_E_PARAM, "cells: expected all, a row such as 7 or an id such as id:7, got \"%s\"",
           cells.c_str());
    wanted = std::strtoull(digits.c_str(), nullptr, 10);
    if (!by_id && wanted >= count)
      fail(CONCEG_E_RANGE, "cells: expected a row below %llu, got %s", static_cast<unsigned long long>(count),
           cells.c_str());
  }
  std::vector<CellInfo> chosen;
  for (std::uint64_t row = 0; row < count; row++) {
    conceg_cell_view found = {};
    found.size = sizeof found;
    must(conceg_substrate_cell(substrate, row, &found));
    if (!all && wanted != (by_id ? found.id : row)) continue;
    CellInfo cell;
    cell.row = row, cell.id = found.id, cell.type = found.type;
    cell.type_name = found.type_name ? found.type_name : "",
    cell.class_name = found.class_name ? found.class_name : "";
    cell.soma = {found.soma[0], found.soma[1], found.soma[2]};
    cell.soma_radius = found.soma_radius;
    chosen.push_back(std::move(cell));
  }
  if (chosen.empty() && !all)
    fail(CONCEG_E_RANGE, "cells: /cells/id: expected a cell with the id %llu, got none",
         static_cast<unsigned long long>(wanted));
  return chosen;
}

} // namespace conceg
