// SPDX-License-Identifier: BSD-3-Clause
#include "compare_input.hpp"

#include "view.hpp"

namespace conceg::analyse {
namespace {

constexpr double sholl_step_um = 10.0;

metrics::Samples samples_of(const Cells &cells, const Skeletons &s, std::size_t cell) {
  metrics::Samples out;
  out.soma = cells.soma[cell], out.soma_radius = static_cast<double>(cells.soma_radius[cell]);
  for (std::size_t i = s.cell_offset[cell]; i < s.cell_offset[cell + 1]; i++) {
    out.position.push_back(s.position[i]), out.radius.push_back(static_cast<double>(s.radius[i]));
    out.kind.push_back(s.kind[i]), out.parent.push_back(s.parent[i]);
  }
  return out;
}

// The arrays of /dictionary that the comparison needs.
class Dictionary {
public:
  explicit Dictionary(conceg_doc *doc)
      : name(texts(doc, "/dictionary/entry_name")),
        entry_donor(view<std::uint64_t>(doc, "/dictionary/entry_donor_offset")),
        donor_tree(view<std::uint64_t>(doc, "/dictionary/donor_tree_offset")),
        tree_bar(view<std::uint64_t>(doc, "/dictionary/tree_bar_offset")),
        straightness(view<double>(doc, "/dictionary/entry_straightness")),
        straightness_sd(view<double>(doc, "/dictionary/entry_straightness_sd")),
        neurite_(view<std::uint8_t>(doc, "/dictionary/tree_neurite")),
        birth_(view<double>(doc, "/dictionary/bar_birth")),
        death_(view<double>(doc, "/dictionary/bar_death")),
        angle_(view<double>(doc, "/dictionary/bar_angle")),
        parent_(view<std::int64_t>(doc, "/dictionary/bar_parent")) {
    if (has(doc, "/dictionary/donor_validation"))
      held_back_ = view<std::uint8_t>(doc, "/dictionary/donor_validation");
  }

  Donor donor(std::size_t row) const {
    Donor out;
    out.held_back = held_back_.rows() && held_back_[row];
    for (std::size_t tree = donor_tree[row]; tree < donor_tree[row + 1]; tree++)
      add_tree(tree, out.shapes[neurite_[tree] == axon_code]);
    return out;
  }

  std::vector<std::string> name;
  View<std::uint64_t> entry_donor, donor_tree, tree_bar;
  View<double> straightness, straightness_sd;

private:
  void add_tree(std::size_t tree, Shape &sum) const {
    const std::size_t first = tree_bar[tree], count = tree_bar[tree + 1] - first;
    for (std::size_t i = 0; i < count; i++)
      if (parent_[first + i] < -1 || parent_[first + i] >= static_cast<std::int64_t>(i))
        fail(CONCEG_E_RANGE,
             "/dictionary/bar_parent[%zu]: expected -1 or a row of its tree below %zu, got %lld", first + i,
             i, static_cast<long long>(parent_[first + i]));
    add_bars(
        {birth_.data() + first, death_.data() + first, angle_.data() + first, parent_.data() + first, count},
        nullptr, sum);
  }

  View<std::uint8_t> neurite_, held_back_;
  View<double> birth_, death_, angle_;
  View<std::int64_t> parent_;
};

} // namespace

void measure_grown(const Cells &cells, const Skeletons &skeletons, Workers &workers, const Progress &progress,
                   const std::function<void(std::size_t, const metrics::Metrics &)> &take) {
  report(progress, "comparing cells", 0, cells.type.size());
  workers.loop(cells.type.size(), 1, [&](std::size_t cell, unsigned) {
    take(cell, metrics::measure(samples_of(cells, skeletons, cell), sholl_step_um));
  });
  report(progress, "comparing cells", cells.type.size(), cells.type.size());
}

std::vector<Shapes> grown_shapes(const Cells &cells, const Skeletons &skeletons, Workers &workers,
                                 const Progress &progress) {
  std::vector<Shapes> out(cells.type.size());
  measure_grown(cells, skeletons, workers, progress, [&](std::size_t cell, const metrics::Metrics &measured) {
    for (const Part part : {Part::dendrites, Part::axon})
      out[cell][static_cast<std::size_t>(part)] = shape_of(measured, part);
  });
  return out;
}

void check(const BarLinks &links, const Bars &bars) {
  const std::size_t rows = bars.state.size();
  const auto check_length = [&](const char *path, std::size_t got) {
    if (got != rows) fail(CONCEG_E_FORMAT, "%s: expected %zu values, got %zu", path, rows, got);
  };
  check_length("/bars/parent", links.parent.size()), check_length("/bars/neurite", links.neurite.size());
  check_length("/bars/angle", links.angle.size());
  for (std::size_t cell = 0; cell + 1 < bars.cell_offset.size(); cell++)
    for (std::size_t i = bars.cell_offset[cell]; i < bars.cell_offset[cell + 1]; i++) {
      const std::size_t row = i - bars.cell_offset[cell];
      if (links.parent[i] < -1 || links.parent[i] >= static_cast<std::int64_t>(row))
        fail(CONCEG_E_RANGE, "/bars/parent[%zu]: expected -1 or a row of the cell below %zu, got %lld", i,
             row, static_cast<long long>(links.parent[i]));
    }
}

std::vector<Shapes> drawn_shapes(const Bars &bars, const BarLinks &links) {
  std::vector<Shapes> out(bars.cell_offset.size() - 1);
  for (std::size_t cell = 0; cell < out.size(); cell++) {
    const std::size_t first = bars.cell_offset[cell], count = bars.cell_offset[cell + 1] - first;
    const BarList list = {bars.asked_start.data() + first, bars.asked_end.data() + first,
                          links.angle.data() + first, links.parent.data() + first, count};
    for (const Part part : {Part::dendrites, Part::axon}) {
      std::vector<std::uint8_t> chosen(count);
      for (std::size_t i = 0; i < count; i++)
        chosen[i] = (links.neurite[first + i] == axon_code) == (part == Part::axon);
      add_bars(list, chosen.data(), out[cell][static_cast<std::size_t>(part)]);
    }
  }
  return out;
}

std::vector<Entry> read_entries(conceg_doc *doc) {
  if (!has(doc, "/dictionary/entry_name"))
    fail(CONCEG_E_MISSING, "compare: the document has no /dictionary to compare its cells with; analyse it "
                           "without --compare, or give a document that place began");
  must(conceg_doc_validate(doc, "/dictionary", nullptr, nullptr));
  const Dictionary dictionary(doc);
  std::vector<Entry> out(dictionary.name.size());
  for (std::size_t e = 0; e < out.size(); e++) {
    out[e].name = dictionary.name[e];
    out[e].straightness = dictionary.straightness[e], out[e].straightness_sd = dictionary.straightness_sd[e];
    for (std::size_t row = dictionary.entry_donor[e]; row < dictionary.entry_donor[e + 1]; row++)
      out[e].donors.push_back(dictionary.donor(row));
  }
  return out;
}

} // namespace conceg::analyse
