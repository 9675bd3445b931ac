// SPDX-License-Identifier: BSD-3-Clause
// Parameters that are lists in text, and arrays of more than two extents.
#pragma once

#include "view.hpp"

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

namespace conceg::simulate {

// "1, 2.5 3": numbers between low and high; E_PARAM names the parameter.
std::vector<double> numbers(const char *name, const std::string &text, double low, double high);
// Times of displacements (ms), ascending, each once: numbers, or "0.1:100:30" for 30 of them from 0.1 to 100,
// evenly spaced by their logarithm.
std::vector<double> displacement_times(const std::string &text);
// um/ms of each face by its compartment code: "0.02" for all, or "soma=0.02,axon=0.01"; empty when all are 0.
std::vector<double> face_permeability(const std::string &text, const std::vector<std::uint8_t> &code);

inline void put_table(conceg_doc *doc, const char *path, const double *data,
                      std::initializer_list<std::size_t> shape) {
  conceg_array array = {};
  array.size = sizeof array;
  array.dtype = CONCEG_F64;
  for (const std::size_t extent : shape)
    array.shape[array.rank++] = extent;
  array.data = data;
  must(conceg_doc_write(doc, path, &array));
}

} // namespace conceg::simulate
