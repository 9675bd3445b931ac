// SPDX-License-Identifier: BSD-3-Clause
#include "entries.hpp"

#include "view.hpp"

#include <cmath>
#include <map>

namespace conceg::grow {

namespace {

// Row of each type's entry in the dictionary; none = the type names no entry, or there is no dictionary.
std::vector<std::uint32_t> entries_of_types(conceg_doc *doc, std::size_t types) {
  std::vector<std::uint32_t> found(types, none);
  if (!has(doc, "/types/entry") || !has(doc, "/dictionary/entry_name")) return found;
  const std::vector<std::string> asked = texts(doc, "/types/entry");
  const std::vector<std::string> name = texts(doc, "/dictionary/entry_name");
  if (asked.size() != types)
    fail(CONCEG_E_FORMAT, "/types/entry: expected %zu rows as in /types/name, got %zu", types, asked.size());
  for (std::size_t type = 0; type < types; type++) {
    if (asked[type].empty()) continue;
    const auto place = std::find(name.begin(), name.end(), asked[type]);
    if (place == name.end())
      fail(CONCEG_E_MISSING, "/types/entry[%zu]: expected an entry of /dictionary/entry_name, got \"%s\"",
           type, asked[type].c_str());
    found[type] = static_cast<std::uint32_t>(place - name.begin());
  }
  return found;
}

using Laws = std::map<std::pair<std::uint32_t, std::uint8_t>, CalibreLaw>; // by entry and neurite

Laws read_laws(conceg_doc *doc) {
  Laws laws;
  if (!has(doc, "/dictionary/calibre_entry")) return laws;
  const View<std::uint32_t> entry = view<std::uint32_t>(doc, "/dictionary/calibre_entry");
  const View<std::uint8_t> neurite = view<std::uint8_t>(doc, "/dictionary/calibre_neurite");
  const View<double> sd = view<double>(doc, "/dictionary/calibre_cv");
  const View<double> length = view<double>(doc, "/dictionary/calibre_correlation_length");
  const std::size_t rows = entry.rows();
  if (neurite.rows() != rows || sd.rows() != rows || length.rows() != rows)
    fail(CONCEG_E_FORMAT, "/dictionary/calibre_entry: expected as many rows as in the other calibre tables");
  for (std::size_t row = 0; row < rows; row++) {
    if (!(sd[row] >= 0.0 && sd[row] <= 2.0))
      fail(CONCEG_E_RANGE, "/dictionary/calibre_cv[%zu]: expected 0 to 2, got %g", row, sd[row]);
    if (!(length[row] >= 0.0 && length[row] < 1e5))
      fail(CONCEG_E_RANGE, "/dictionary/calibre_correlation_length[%zu]: expected 0 to 100 mm, got %g um",
           row, length[row]);
    // Without a length that it remembers over, a process has no meaning along a line.
    if (length[row] > 0.0) laws[{entry[row], neurite[row]}] = {sd[row], length[row]};
  }
  return laws;
}

void give_laws(const Laws &laws, const std::vector<std::uint32_t> &entry, Input &input) {
  Bars &bars = input.bars;
  bars.calibre.assign(bars.count, {});
  for (std::size_t cell = 0; cell < input.cells.count; cell++)
    for (std::uint64_t bar = bars.cell_offset[cell]; bar < bars.cell_offset[cell + 1]; bar++) {
      const auto law = laws.find({entry[input.types.of_cell[cell]], bars.neurite[bar]});
      if (law != laws.end()) bars.calibre[bar] = law->second;
    }
}

void ask_straightness(conceg_doc *doc, const std::vector<std::uint32_t> &entry, Types &types) {
  if (!has(doc, "/dictionary/entry_straightness")) return;
  const View<double> straightness = view<double>(doc, "/dictionary/entry_straightness");
  types.straightness.assign(entry.size(), 0.0);
  for (std::size_t type = 0; type < entry.size(); type++) {
    if (entry[type] == none) continue;
    if (entry[type] >= straightness.rows())
      fail(CONCEG_E_FORMAT, "/dictionary/entry_straightness: expected as many rows as in entry_name, got %zu",
           straightness.rows());
    const double asked = straightness[entry[type]];
    // 0 = the entry has no branch that could be measured.
    if (!(asked >= 0.0 && asked <= 1.0))
      fail(CONCEG_E_RANGE, "/dictionary/entry_straightness[%u]: expected 0 to 1, got %g", entry[type], asked);
    types.straightness[type] = asked;
  }
}

} // namespace

void read_entries(conceg_doc *doc, bool straightness, bool calibre, Input &input) {
  Types &types = input.types;
  types.name = texts(doc, "/types/name");
  const View<std::uint32_t> type = view<std::uint32_t>(doc, "/cells/type");
  if (type.rows() != input.cells.count)
    fail(CONCEG_E_FORMAT, "/cells/type: expected %zu rows as in /cells/id, got %zu", input.cells.count,
         type.rows());
  for (std::size_t cell = 0; cell < input.cells.count; cell++)
    if (type[cell] >= types.name.size())
      fail(CONCEG_E_RANGE, "/cells/type[%zu]: expected a type below %zu, got %u", cell, types.name.size(),
           type[cell]);
  types.of_cell = type.data();
  const std::vector<std::uint32_t> entry = entries_of_types(doc, types.name.size());
  if (straightness) ask_straightness(doc, entry, types);
  if (calibre) give_laws(read_laws(doc), entry, input);
}

} // namespace conceg::grow
