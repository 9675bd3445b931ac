// SPDX-License-Identifier: BSD-3-Clause
// A figure per entry of the dictionary, as SVG files in a folder.
#pragma once

#include "dictionary.hpp"
#include "figure.hpp"
#include "metrics.hpp"

#include "conceg/ctx.h"

#include <map>
#include <string>

namespace conceg::characterise {

class Pictures {
public:
  // No folder = no pictures. The folder is made; E_UNSUPPORTED in a build without Cairo, E_PARAM for `beside`
  // without a folder.
  Pictures(std::string folder, std::string beside);
  // Keeps the newest donor's cell, for its picture.
  void keep(const Dictionary &dictionary, const Cell &cell);
  // One file per entry.
  void draw(conceg_ctx *ctx, const Dictionary &dictionary) const;

private:
  DrawnEntry gather(const Dictionary &dictionary, std::size_t row) const;
  std::string folder_, beside_;
  std::map<std::size_t, metrics::Samples> cells_; // by row of the donor, in its pia frame
};

} // namespace conceg::characterise
