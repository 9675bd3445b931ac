// SPDX-License-Identifier: BSD-3-Clause
#include "pictures.hpp"

#include "grown.hpp"
#include "measures.hpp"
#include "output.hpp"

#include "conceg/portable.h"

#include <algorithm>
#include <set>

namespace conceg::characterise {
namespace {

std::vector<DrawnBar> bars_of(const Dictionary &d, std::size_t donor) {
  std::vector<DrawnBar> out;
  for (std::size_t tree = d.donor_tree_offset[donor]; tree < d.donor_tree_offset[donor + 1]; tree++)
    for (std::size_t bar = d.tree_bar_offset[tree]; bar < d.tree_bar_offset[tree + 1]; bar++)
      out.push_back({d.tree_neurite[tree], d.bar_birth[bar], d.bar_death[bar]});
  return out;
}

// The turn about z by which a cell shows its broad side along x: azimuth means nothing in a pia frame,
// and slices are thin.
Rotation broad_side(const metrics::Samples &samples) {
  glm::dvec3 mean(0.0);
  for (const glm::dvec3 &p : samples.position)
    mean += p / static_cast<double>(samples.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const glm::dvec3 &p : samples.position) {
    const double x = p.x - mean.x, y = p.y - mean.y;
    xx += x * x, xy += x * y, yy += y * y;
  }
  double sine, cosine;
  conceg_sincos(-0.25 * conceg_atan2(2.0 * xy, xx - yy), &sine, &cosine);
  return {cosine, 0.0, 0.0, sine};
}

void turn(metrics::Samples &samples, const Rotation &rotation) {
  for (glm::dvec3 &p : samples.position)
    p = rotate(rotation, p);
}

// The donor with the median number of bars; with grown cells, among those of which one has grown, so that
// like stands beside like.
std::size_t typical_donor(const DrawnEntry &entry, const std::set<std::string> &grown) {
  std::vector<std::size_t> rows, all;
  for (std::size_t i = 0; i < entry.donors.size(); i++) {
    all.push_back(i);
    if (grown.count(entry.donors[i].id)) rows.push_back(i);
  }
  if (rows.empty()) rows = all;
  std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
    return entry.donors[a].bars.size() < entry.donors[b].bars.size();
  });
  return rows[(rows.size() - 1) / 2];
}

// The grown cell that is shown: the first one of the typical donor, else the first one of the entry.
const GrownCell *shown_cell(const DrawnEntry &entry, const std::vector<GrownCell> &cells) {
  const GrownCell *shown = nullptr;
  const std::string &wanted = entry.donors[entry.typical].id;
  for (const GrownCell &cell : cells)
    if (cell.entry == entry.name && (!shown || (cell.donor == wanted && shown->donor != wanted)))
      shown = &cell;
  return shown;
}

// Both cells show the side that is the donor's broad one, where the grown cell stands in that donor's frame.
void show_cells(DrawnEntry &entry, const GrownCell *grown) {
  DrawnDonor &donor = entry.donors[entry.typical];
  const bool traced = donor.cell.samples.size() != 0;
  const Rotation side = traced ? broad_side(donor.cell.samples) : Rotation{1.0, 0.0, 0.0, 0.0};
  turn(donor.cell.samples, side);
  entry.grown.title = "grown cell";
  if (!grown) return;
  entry.grown.samples = grown->samples;
  if (grown->turned_back)
    turn(entry.grown.samples, traced && grown->donor == donor.id ? side : broad_side(grown->samples));
  entry.grown.title += ", id " + std::to_string(grown->id) +
                       (grown->donor.empty() ? "" : ", of donor " + grown->donor) +
                       (grown->turned_back ? "" : ", as in the box");
  for (const DrawnDonor &own : entry.donors)
    if (own.id == grown->donor) entry.grown.pia_up = grown->turned_back && own.cell.pia_up;
}

void add_grown(DrawnEntry &entry, const std::vector<GrownCell> &cells) {
  std::set<std::string> donors;
  for (const GrownCell &cell : cells) {
    if (cell.entry != entry.name) continue;
    donors.insert(cell.donor);
    entry.grown_branches.push_back(measure_branches(cell.samples));
  }
  entry.typical = typical_donor(entry, donors);
  show_cells(entry, shown_cell(entry, cells));
}

// XML and file systems take any of these characters.
std::string file_name(const std::string &entry) {
  std::string out = entry;
  for (char &c : out)
    if (!(c >= '0' && c <= '9') && !(c >= 'A' && c <= 'Z') && !(c >= 'a' && c <= 'z') && c != '_' && c != '-')
      c = '_';
  return out;
}

} // namespace

Pictures::Pictures(std::string folder, std::string beside)
    : folder_(std::move(folder)), beside_(std::move(beside)) {
  if (folder_.empty() && !beside_.empty())
    fail(CONCEG_E_PARAM, "beside: expected a folder in pictures too, got none");
  if (!folder_.empty()) make_folder(folder_);
}

void Pictures::keep(const Dictionary &dictionary, const Cell &cell) {
  if (folder_.empty()) return;
  metrics::Samples samples = whole_cell(cell);
  for (glm::dvec3 &p : samples.position)
    p = rotate(dictionary.donor_frame.back(), p - samples.soma);
  samples.soma = glm::dvec3(0.0);
  cells_[dictionary.donor_id.size() - 1] = std::move(samples);
}

DrawnEntry Pictures::gather(const Dictionary &d, std::size_t row) const {
  DrawnEntry entry;
  entry.name = d.entry_name[row], entry.cell_class = d.entry_class[row], entry.compared = !beside_.empty();
  for (std::size_t donor = d.entry_donor_offset[row]; donor < d.entry_donor_offset[row + 1]; donor++) {
    DrawnDonor out{d.donor_id[donor], bars_of(d, donor), {}};
    out.cell.title = "donor " + out.id, out.cell.pia_up = d.donor_frame_kind[donor] != "unknown";
    const auto kept = cells_.find(donor);
    if (kept != cells_.end()) {
      out.cell.samples = kept->second;
      entry.donor_branches.push_back(measure_branches(kept->second));
    }
    entry.donors.push_back(std::move(out));
  }
  return entry;
}

void Pictures::draw(conceg_ctx *ctx, const Dictionary &d) const {
  if (folder_.empty()) return;
  const std::vector<GrownCell> grown = beside_.empty() ? std::vector<GrownCell>() : read_grown(ctx, beside_);
  std::set<std::string> names;
  for (std::size_t row = 0; row < d.entry_name.size(); row++) {
    must(conceg_ctx_progress(ctx, "drawing entries", row, d.entry_name.size()));
    DrawnEntry entry = gather(d, row);
    if (entry.donors.empty()) continue;
    add_grown(entry, grown);
    std::string name = file_name(entry.name);
    if (!names.insert(name).second) name += "-" + std::to_string(row + 1);
    OutputFile file(folder_ + "/" + name + ".svg");
    file.write(draw_entry(entry));
    file.commit();
  }
}

} // namespace conceg::characterise
