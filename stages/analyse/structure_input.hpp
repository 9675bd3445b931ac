// SPDX-License-Identifier: BSD-3-Clause
// Grown and real cells of documents, for the structural comparison.
#pragma once

#include "compare_input.hpp"
#include "statistics_table.hpp"
#include "structure.hpp"

namespace conceg::analyse {

struct StructureDonor {
  std::string entry, donor;
  std::uint32_t set = 0;
  bool held_back = false; // else it may have given a grown cell its form
};

struct StructureInput {
  std::vector<StructureGroup> groups; // by entry, in the order of the types
  std::vector<StructureDonor> donors;
  bool told_of_all = false; // growth was told the straightness of the donors held back, too
  std::uint32_t sets = 0;

  StructureGroup &group(const std::string &entry); // made when it is new
};

// The grown cells of `doc` and the donors that they may be made of, and the real cells of `real` (a document
// of characterise), as the next set. Throws E_MISSING and says what makes what is missing, E_RANGE with the
// ids of donors that are on both sides or when `real` has no cell of the entries.
void add_document(StructureInput &input, conceg_doc *doc, const Cells &cells, const Skeletons &skeletons,
                  conceg_doc *real, const std::string &real_name, Workers &workers, const Progress &progress);

// The sets of an earlier analysis of this kind, from its tables.
void add_analysed(StructureInput &input, conceg_doc *analysed, const std::string &name);

// Those tables: a row per cell, per branch and per donor.
std::vector<Table> structure_value_tables(const StructureInput &input);

// Throws E_RANGE when a donor stands on both sides of a set, whatever its entry.
void check_donors(const std::vector<StructureDonor> &donors);

} // namespace conceg::analyse
