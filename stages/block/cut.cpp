// SPDX-License-Identifier: BSD-3-Clause
#include "cut.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace conceg::block {
namespace {

constexpr std::size_t kNone = ~std::size_t{0};

struct Extent {
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  void add(double z, double radius) { lo = std::min(lo, z - radius), hi = std::max(hi, z + radius); }
};

// The sections of one cell, and which section each row is in.
struct Sections {
  std::vector<std::size_t> of_row;
  std::vector<std::int64_t> parent; // the row that each section hangs on, -1 = soma
  std::vector<Extent> extent;
};

Sections sections_of(const Tissue &tissue, std::size_t cell) {
  const std::uint64_t first = tissue.offset[cell], count = tissue.offset[cell + 1] - first;
  Sections out;
  out.of_row.resize(count);
  std::map<std::uint32_t, std::size_t> number;
  for (std::uint64_t row = 0; row < count; row++) {
    const std::int64_t parent = tissue.parent[first + row];
    const auto [at, is_new] = number.insert({tissue.branch[first + row], out.extent.size()});
    if (is_new) {
      out.parent.push_back(parent);
      out.extent.emplace_back();
      if (parent >= 0)
        out.extent.back().add(tissue.position[first + static_cast<std::uint64_t>(parent)].z,
                              static_cast<double>(tissue.radius[first + static_cast<std::uint64_t>(parent)]));
    }
    out.of_row[row] = at->second;
    out.extent[at->second].add(tissue.position[first + row].z,
                               static_cast<double>(tissue.radius[first + row]));
  }
  return out;
}

bool near_slab(const Extent &extent, double shift, const Slab &slab) {
  return extent.hi + shift >= slab.lo - slab.margin && extent.lo + shift <= slab.hi + slab.margin;
}

// The joined sections of one image: a number per section, kNone = left out.
std::vector<std::size_t> groups_of(const Sections &sections, const std::vector<std::uint8_t> &kept,
                                   bool soma_kept) {
  std::vector<std::size_t> group(kept.size(), kNone);
  std::map<std::int64_t, std::size_t> at_fork;    // of sections whose parent section is left out
  for (std::size_t s = 0; s < kept.size(); s++) { // parents come first
    if (!kept[s]) continue;
    const std::int64_t parent = sections.parent[s];
    const std::size_t above = parent < 0 ? kNone : sections.of_row[static_cast<std::size_t>(parent)];
    if (above != kNone && kept[above])
      group[s] = group[above];
    else if (parent < 0 && !soma_kept)
      group[s] = s;
    else
      group[s] = at_fork.insert({parent, s}).first->second;
  }
  return group;
}

// The last row of each kept section that the block needs: what follows when nothing that is kept hangs on its
// end may go, for a section's shape follows from its beginning.
std::vector<std::size_t> ends_of(const Tissue &tissue, std::size_t cell, const Sections &sections,
                                 const std::vector<std::uint8_t> &kept, double shift, const Slab &slab) {
  const std::uint64_t first = tissue.offset[cell];
  std::vector<std::size_t> end(kept.size(), 0);
  for (std::size_t row = 0; row < sections.of_row.size(); row++) {
    const std::size_t s = sections.of_row[row];
    const std::int64_t parent = tissue.parent[first + row];
    const double radius = static_cast<double>(tissue.radius[first + row]);
    Extent segment;
    segment.add(tissue.position[first + row].z, radius);
    if (parent >= 0) segment.add(tissue.position[first + static_cast<std::uint64_t>(parent)].z, radius);
    if (near_slab(segment, shift, slab)) end[s] = row;
  }
  for (std::size_t s = 0; s < kept.size(); s++)
    if (kept[s] && sections.parent[s] >= 0) { // the fork that it hangs on
      const auto fork = static_cast<std::size_t>(sections.parent[s]);
      end[sections.of_row[fork]] = std::max(end[sections.of_row[fork]], fork);
    }
  return end;
}

void cut_image(const Tissue &tissue, std::size_t cell, const Sections &sections, int lift, const Slab &slab,
               std::vector<Piece> &pieces) {
  const double shift = lift * slab.side, radius = static_cast<double>(tissue.soma_radius[cell]);
  Extent soma;
  soma.add(tissue.soma[cell].z, radius);
  const bool soma_kept = radius > 0.0 && near_slab(soma, shift, slab);
  std::vector<std::uint8_t> kept(sections.extent.size());
  for (std::size_t s = 0; s < kept.size(); s++)
    kept[s] = near_slab(sections.extent[s], shift, slab);
  const std::vector<std::size_t> group = groups_of(sections, kept, soma_kept),
                                 end = ends_of(tissue, cell, sections, kept, shift, slab);
  std::map<std::size_t, Piece> made; // by the first section
  const std::size_t of_soma = kNone;
  if (soma_kept) made[of_soma] = {cell, lift, true, {}};
  for (std::size_t row = 0; row < sections.of_row.size(); row++) {
    const std::size_t s = sections.of_row[row];
    if (!kept[s] || row > end[s]) continue;
    const std::size_t root = group[s]; // the section that the piece hangs on
    const bool on_soma = soma_kept && sections.parent[root] < 0;
    Piece &piece = made.insert({on_soma ? of_soma : root, {cell, lift, false, {}}}).first->second;
    if (piece.rows.empty() && !on_soma && sections.parent[root] >= 0)
      piece.rows.push_back(static_cast<std::uint32_t>(sections.parent[root]));
    piece.rows.push_back(static_cast<std::uint32_t>(row));
  }
  if (soma_kept) pieces.push_back(std::move(made[of_soma])), made.erase(of_soma);
  for (auto &[root, piece] : made)
    pieces.push_back(std::move(piece));
}

} // namespace

std::vector<Piece> cut(const Tissue &tissue, const Slab &slab) {
  std::vector<Piece> pieces;
  for (std::size_t cell = 0; cell < tissue.cells(); cell++) {
    const Sections sections = sections_of(tissue, cell);
    Extent all;
    all.add(tissue.soma[cell].z, static_cast<double>(tissue.soma_radius[cell]));
    for (const Extent &extent : sections.extent)
      all.lo = std::min(all.lo, extent.lo), all.hi = std::max(all.hi, extent.hi);
    int low = 0, high = 0;
    if (slab.side > 0.0) {
      low = static_cast<int>(std::ceil((slab.lo - slab.margin - all.hi) / slab.side));
      high = static_cast<int>(std::floor((slab.hi + slab.margin - all.lo) / slab.side));
    }
    for (int lift = low; lift <= high; lift++)
      cut_image(tissue, cell, sections, lift, slab, pieces);
  }
  return pieces;
}

} // namespace conceg::block
