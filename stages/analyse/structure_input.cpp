// SPDX-License-Identifier: BSD-3-Clause
#include "structure_input.hpp"

#include "view.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace conceg::analyse {
namespace {

constexpr double degree = 57.29577951308232;
constexpr std::uint32_t no_donor = 4294967295u;

// A column of a table of another document, with the number of rows that the others have.
template <class T>
View<T> column(conceg_doc *doc, const std::string &table, const char *name, std::size_t rows) {
  const std::string path = "/statistics/" + table + "/" + name;
  const View<T> out = view<T>(doc, path.c_str());
  if (out.rows() != rows)
    fail(CONCEG_E_FORMAT, "%s: expected %zu values, got %zu", path.c_str(), rows, out.rows());
  for (std::size_t i = 0; i < rows; i++)
    if (!std::isfinite(static_cast<double>(out[i])))
      fail(CONCEG_E_FORMAT, "%s[%zu]: expected a finite number", path.c_str(), i);
  return out;
}
std::vector<std::string> words(conceg_doc *doc, const std::string &table, const char *name,
                               std::size_t rows) {
  const std::string path = "/statistics/" + table + "/" + name;
  std::vector<std::string> out = texts(doc, path.c_str());
  if (out.size() != rows)
    fail(CONCEG_E_FORMAT, "%s: expected %zu values, got %zu", path.c_str(), rows, out.size());
  return out;
}
std::size_t rows_of(conceg_doc *doc, const std::string &table, const char *name) {
  return texts(doc, ("/statistics/" + table + "/" + name).c_str()).size();
}

struct DictionaryDonors {
  std::vector<std::string> entry, donor; // per row of the donors
  std::vector<bool> held_back;
  bool any_held_back = false;
};

DictionaryDonors read_donors(conceg_doc *doc) {
  if (!has(doc, "/dictionary/entry_name"))
    fail(CONCEG_E_MISSING, "structure: the document has no /dictionary, which says of whom its cells were "
                           "grown; give one that place began, with its dictionary");
  must(conceg_doc_validate(doc, "/dictionary", nullptr, nullptr));
  DictionaryDonors out;
  const std::vector<std::string> entries = texts(doc, "/dictionary/entry_name");
  const View<std::uint64_t> offset = view<std::uint64_t>(doc, "/dictionary/entry_donor_offset");
  out.donor = texts(doc, "/dictionary/donor_id");
  for (std::size_t e = 0; e < entries.size(); e++)
    out.entry.insert(out.entry.end(), offset[e + 1] - offset[e], entries[e]);
  out.held_back.assign(out.donor.size(), false);
  if (has(doc, "/dictionary/donor_validation")) {
    const View<std::uint8_t> marked = view<std::uint8_t>(doc, "/dictionary/donor_validation");
    for (std::size_t d = 0; d < marked.rows(); d++)
      out.held_back[d] = marked[d] != 0, out.any_held_back = out.any_held_back || marked[d];
  }
  return out;
}

void add_grown(StructureInput &input, conceg_doc *doc, const Cells &cells, const Skeletons &skeletons,
               const DictionaryDonors &donors, Workers &workers, const Progress &progress) {
  const std::vector<std::string> entry = texts(doc, "/types/entry");
  if (entry.size() != cells.type_name.size())
    fail(CONCEG_E_FORMAT, "/types/entry: expected %zu values, got %zu", cells.type_name.size(), entry.size());
  const View<std::uint32_t> donor = view<std::uint32_t>(doc, "/cells/donor");
  if (donor.rows() != cells.type.size())
    fail(CONCEG_E_FORMAT, "/cells/donor: expected %zu values, got %zu", cells.type.size(), donor.rows());
  std::vector<std::vector<Branch>> found(cells.type.size());
  measure_grown(cells, skeletons, workers, progress, [&](std::size_t cell, const metrics::Metrics &measured) {
    found[cell] = branches_of(measured);
  });
  for (const std::string &name : entry)
    if (!name.empty()) input.group(name);
  for (std::size_t c = 0; c < cells.type.size(); c++) {
    if (entry[cells.type[c]].empty()) continue; // passing axons
    StructureCell cell;
    cell.set = input.sets, cell.branches = found[c];
    if (donor[c] != no_donor) {
      if (donor[c] >= donors.donor.size())
        fail(CONCEG_E_RANGE, "/cells/donor[%zu]: expected a row of the donors below %zu, got %u", c,
             donors.donor.size(), donor[c]);
      cell.donor = donors.donor[donor[c]];
    }
    input.group(entry[cells.type[c]]).grown.push_back(cell);
  }
}

// Cells of the entries that are grown, from the table of their branches.
void add_real(StructureInput &input, conceg_doc *real, const std::string &name) {
  const std::string table = "section_metrics";
  if (!has(real, ("/statistics/" + table + "/entry").c_str()))
    fail(CONCEG_E_MISSING,
         "structure: %s has no /statistics/section_metrics; make it with conceg characterise of the donors "
         "held back (metrics=cleaned)",
         name.c_str());
  const std::size_t rows = rows_of(real, table, "entry");
  const std::vector<std::string> entry = words(real, table, "entry", rows),
                                 donor = words(real, table, "donor", rows),
                                 neurite = words(real, table, "neurite", rows);
  const View<std::uint64_t> parent = column<std::uint64_t>(real, table, "parent", rows),
                            order = column<std::uint64_t>(real, table, "order", rows),
                            daughters = column<std::uint64_t>(real, table, "daughters", rows);
  const View<double> length = column<double>(real, table, "length", rows),
                     straightness = column<double>(real, table, "straightness_1um", rows),
                     angle = column<double>(real, table, "local_angle", rows),
                     path = column<double>(real, table, "path_distance", rows);
  std::size_t added = 0;
  StructureGroup *group = nullptr;
  bool wanted = false, axon = false;
  for (std::size_t i = 0; i < rows; i++) {
    if (!i || entry[i] != entry[i - 1] || donor[i] != donor[i - 1]) {
      wanted = false;
      for (StructureGroup &g : input.groups)
        if (g.entry == entry[i]) group = &g, wanted = true;
      if (wanted) {
        group->real.push_back({donor[i], input.sets, {}}), added++;
        input.donors.push_back({entry[i], donor[i], input.sets, true});
      }
    }
    if (parent[i] == 0) axon = neurite[i] == "axon"; // a tree starts
    if (wanted && !axon)
      group->real.back().branches.push_back({static_cast<double>(order[i]), length[i], straightness[i],
                                             angle[i] < 0 ? -1.0 : degree * angle[i],
                                             daughters[i] ? -1.0 : path[i]});
  }
  if (!added)
    fail(CONCEG_E_RANGE,
         "structure: %s: expected cells of the entries that were grown, got none; characterise the donors of "
         "the fold that was held back",
         name.c_str());
}

// Set, side, entry and donor of every row that stands for a cell.
struct CellRow {
  const StructureGroup *group;
  const StructureCell *cell;
  bool grown;
};
std::vector<CellRow> cell_rows(const StructureInput &input) {
  std::vector<CellRow> out;
  for (const StructureGroup &g : input.groups) {
    for (const StructureCell &cell : g.grown)
      out.push_back({&g, &cell, true});
    for (const StructureCell &cell : g.real)
      out.push_back({&g, &cell, false});
  }
  return out;
}

// The columns of one branch, in the order of Trait.
constexpr const char *branch_columns[] = {"order", "length", "straightness", "local_angle", "tip_path"};
constexpr const char *branch_units[] = {"1", "um", "1", "degree", "um"};

std::uint32_t set_of(std::uint64_t value, std::size_t row, const char *table) {
  if (value >= 1000000)
    fail(CONCEG_E_RANGE, "/statistics/%s/set[%zu]: expected a number below 1000000, got %llu", table, row,
         static_cast<unsigned long long>(value));
  return static_cast<std::uint32_t>(value);
}

} // namespace

StructureGroup &StructureInput::group(const std::string &entry) {
  for (StructureGroup &g : groups)
    if (g.entry == entry) return g;
  groups.push_back({entry, {}, {}});
  return groups.back();
}

void check_donors(const std::vector<StructureDonor> &donors) {
  std::set<std::pair<std::uint32_t, std::string>> held_back;
  for (const StructureDonor &d : donors)
    if (d.held_back) held_back.emplace(d.set, d.donor);
  std::set<std::string> both;
  for (const StructureDonor &d : donors)
    if (!d.held_back && held_back.count({d.set, d.donor})) both.insert(d.donor);
  if (both.empty()) return;
  std::string names;
  for (const std::string &name : both)
    names += (names.empty() ? "" : " ") + name;
  fail(CONCEG_E_RANGE,
       "structure: expected no donor on both sides, got %s among those of the grown and of the real cells; "
       "grow from a dictionary without them (or place with validation_fold)",
       names.c_str());
}

void add_document(StructureInput &input, conceg_doc *doc, const Cells &cells, const Skeletons &skeletons,
                  conceg_doc *real, const std::string &real_name, Workers &workers,
                  const Progress &progress) {
  const DictionaryDonors donors = read_donors(doc);
  add_grown(input, doc, cells, skeletons, donors, workers, progress);
  add_real(input, real, real_name);
  for (std::size_t d = 0; d < donors.donor.size(); d++)
    if (!donors.held_back[d]) input.donors.push_back({donors.entry[d], donors.donor[d], input.sets, false});
  input.told_of_all = input.told_of_all || donors.any_held_back;
  check_donors(input.donors);
  input.sets++;
}

void add_analysed(StructureInput &input, conceg_doc *analysed, const std::string &name) {
  if (!has(analysed, "/statistics/structure_branch/cell"))
    fail(CONCEG_E_MISSING,
         "structure_pool: %s has no /statistics/structure_branch; make it with conceg analyse --structure",
         name.c_str());
  const std::size_t cells = rows_of(analysed, "structure_cell", "entry");
  const std::vector<std::string> entry = words(analysed, "structure_cell", "entry", cells),
                                 side = words(analysed, "structure_cell", "side", cells),
                                 donor = words(analysed, "structure_cell", "donor", cells);
  const View<std::uint64_t> set = column<std::uint64_t>(analysed, "structure_cell", "set", cells);
  std::vector<StructureCell> found(cells);
  std::uint32_t sets = 0;
  for (std::size_t i = 0; i < cells; i++) {
    const std::uint32_t own = set_of(set[i], i, "structure_cell");
    sets = std::max(sets, own + 1);
    found[i] = {donor[i], input.sets + own, {}};
  }
  const View<std::uint64_t> cell = view<std::uint64_t>(analysed, "/statistics/structure_branch/cell");
  std::array<View<double>, 5> value;
  for (std::size_t k = 0; k < value.size(); k++)
    value[k] = column<double>(analysed, "structure_branch", branch_columns[k], cell.rows());
  for (std::size_t i = 0; i < cell.rows(); i++) {
    if (cell[i] >= cells)
      fail(CONCEG_E_RANGE, "/statistics/structure_branch/cell[%zu]: expected a row below %zu, got %llu", i,
           cells, static_cast<unsigned long long>(cell[i]));
    found[cell[i]].branches.push_back({value[0][i], value[1][i], value[2][i], value[3][i], value[4][i]});
  }
  for (std::size_t i = 0; i < cells; i++) {
    StructureGroup &group = input.group(entry[i]);
    (side[i] == "grown" ? group.grown : group.real).push_back(std::move(found[i]));
  }
  const std::size_t donors = rows_of(analysed, "structure_donor", "entry");
  const std::vector<std::string> donor_entry = words(analysed, "structure_donor", "entry", donors),
                                 id = words(analysed, "structure_donor", "donor", donors),
                                 use = words(analysed, "structure_donor", "use", donors);
  const View<std::uint64_t> donor_set = column<std::uint64_t>(analysed, "structure_donor", "set", donors);
  for (std::size_t i = 0; i < donors; i++)
    input.donors.push_back({donor_entry[i], id[i], input.sets + set_of(donor_set[i], i, "structure_donor"),
                            use[i] == "held back"});
  check_donors(input.donors);
  input.sets += sets;
}

std::vector<Table> structure_value_tables(const StructureInput &input) {
  Table cells("structure_cell"), branches("structure_branch"), donors("structure_donor");
  std::uint64_t row = 0;
  for (const CellRow &r : cell_rows(input)) {
    cells.put("entry", r.group->entry), cells.put("side", std::string(r.grown ? "grown" : "real"));
    cells.put("set", std::uint64_t{r.cell->set}), cells.put("donor", r.cell->donor);
    cells.put("branches", std::uint64_t{r.cell->branches.size()});
    for (std::size_t t = 0; t < traits; t++) {
      const auto trait = static_cast<Trait>(t);
      const std::vector<double> value = values_at(*r.cell, trait, Level::cell);
      cells.put(name_of(trait), value.empty() ? -1.0 : value[0], unit_of(trait));
    }
    for (const Branch &branch : r.cell->branches) {
      branches.put("cell", row);
      for (std::size_t k = 0; k < branch.size(); k++)
        branches.put(branch_columns[k], branch[k], branch_units[k]);
    }
    row++;
  }
  for (const StructureDonor &d : input.donors) {
    donors.put("entry", d.entry), donors.put("set", std::uint64_t{d.set});
    donors.put("use", std::string(d.held_back ? "held back" : "synthesis")), donors.put("donor", d.donor);
  }
  return {cells, branches, donors};
}

} // namespace conceg::analyse
