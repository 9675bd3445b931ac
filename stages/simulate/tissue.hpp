// SPDX-License-Identifier: BSD-3-Clause
// What a simulation takes from a document, as plain arrays, with the query that locates points in it.
#pragma once

#include "seeds.hpp"
#include "walls.hpp"

#include "conceg/model.h"
#include "conceg/query.h"

#include <memory>
#include <string>
#include <vector>

namespace conceg::simulate {

struct Soma {
  glm::dvec3 centre = glm::dvec3(0.0);
  double radius = 0.0;
};

class Tissue {
public:
  // Errors: E_FORMAT for surfaces that are not closed, E_MISSING without surfaces; those of
  // conceg_substrate_open and conceg_query_new.
  Tissue(conceg_ctx *ctx, conceg_doc *doc);

  conceg_box box;
  Membranes membranes;
  std::vector<Soma> soma;                         // per cell
  std::vector<std::string> type_name, class_name; // per cell
  double cell_volume = 0.0;                       // um^3, by the surfaces, periodic images counted once
  double thinnest_um = 0.0;                       // least skeleton radius; 0 = no skeleton
  Locate locate() const;
  // 1 for the cells that both words ask for: "all", a row or an id; "" or the name of a type or a class.
  std::vector<std::uint8_t> chosen(const std::string &cells, const std::string &kind) const;

private:
  std::unique_ptr<conceg_substrate, void (*)(conceg_substrate *)> substrate_;
  std::unique_ptr<conceg_query, void (*)(conceg_query *)> query_;
};

} // namespace conceg::simulate
