// SPDX-License-Identifier: BSD-3-Clause
// A document in the comment lines of SWC-plus files (spec/swc-plus.md, blocks): what belongs to one cell
// stands in the cell's file, what belongs to all in the first one. Lines are without the leading "# ".
#pragma once

#include "conceg/doc.h"
#include "conceg/swc.h"

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::swcdoc {

// Groups that have rows per cell. Those of /skeleton come from the samples themselves.
struct Slices {
  std::vector<std::uint64_t> bars, spheres, skeleton; // CSR offsets; empty without the group
  std::uint64_t cells = 0;
};
Slices slices_of(conceg_doc *doc);

// Groups that the files do not carry although the document has them.
std::vector<std::string> left_out(conceg_doc *doc);

// Lines of cell `cell` of `digest` = the document's, and of all that is not of one cell.
std::vector<std::string> cell_lines(conceg_doc *doc, const Slices &slices, std::uint64_t cell,
                                    const std::string &digest);
std::vector<std::string> document_lines(conceg_doc *doc, const Slices &slices, const std::string &digest);

// One array as it was read back; `texts` for text, else `bytes`.
struct Array {
  std::string path, unit;
  bool has_unit = false;
  conceg_dtype dtype = CONCEG_F64;
  std::uint32_t rank = 0;
  std::uint64_t shape[4] = {};
  std::vector<unsigned char> bytes;
  std::vector<std::string> texts;
  std::uint64_t count() const;
};

// The blocks of one file. A file without any has `present` false.
struct Blocks {
  bool present = false, has_document = false;
  std::string digest;
  std::uint64_t cell = 0, cells = 0, points = 0;
  std::vector<Array> of_cell, of_document;
};

// E_FORMAT naming the file and the array for lines that are not understood. No memory is taken for what a
// line claims.
Blocks read_blocks(const conceg_swc *swc, const std::string &file);

// Writes one array into a document.
void put_array(conceg_doc *doc, const Array &array);

} // namespace conceg::swcdoc
