// SPDX-License-Identifier: BSD-3-Clause
#include "write.hpp"

#include "output.hpp"
#include "view.hpp"

namespace conceg::characterise {

void write_sources(conceg_doc *doc, const std::vector<Source> &sources,
                   const std::vector<std::uint32_t> &of_donor) {
  if (sources.empty()) return;
  const auto column = [&](const char *path, std::string Source::*what) {
    std::vector<std::string> values;
    for (const Source &source : sources)
      values.push_back(source.*what);
    put_texts(doc, path, values);
  };
  column("/dictionary/source_name", &Source::name),
      column("/dictionary/source_repository", &Source::repository);
  column("/dictionary/source_licence", &Source::licence), column("/dictionary/source_terms", &Source::terms);
  put(doc, "/dictionary/donor_source", of_donor);
}

void write_dictionary(conceg_doc *doc, const Dictionary &d) {
  put_texts(doc, "/dictionary/entry_name", d.entry_name);
  put_texts(doc, "/dictionary/entry_class", d.entry_class);
  put_texts(doc, "/dictionary/entry_note", d.entry_note);
  put(doc, "/dictionary/entry_donor_offset", d.entry_donor_offset);
  put(doc, "/dictionary/entry_angle_offset", d.entry_angle_offset);
  put(doc, "/dictionary/entry_straightness", d.entry_straightness);
  put(doc, "/dictionary/entry_straightness_sd", d.entry_straightness_sd);
  put(doc, "/dictionary/angle", d.angle);
  put_texts(doc, "/dictionary/donor_id", d.donor_id);
  put(doc, "/dictionary/donor_fold", d.donor_fold);
  put(doc, "/dictionary/donor_frame", d.donor_frame.empty() ? nullptr : d.donor_frame[0].data(),
      d.donor_frame.size(), 4);
  put_texts(doc, "/dictionary/donor_frame_kind", d.donor_frame_kind);
  put(doc, "/dictionary/donor_soma_radius", d.donor_soma_radius);
  put(doc, "/dictionary/donor_tree_offset", d.donor_tree_offset);
  put(doc, "/dictionary/tree_neurite", d.tree_neurite);
  put3(doc, "/dictionary/tree_trunk_direction", d.tree_trunk_direction);
  put(doc, "/dictionary/tree_bar_offset", d.tree_bar_offset);
  put(doc, "/dictionary/bar_birth", d.bar_birth);
  put(doc, "/dictionary/bar_death", d.bar_death);
  put(doc, "/dictionary/bar_parent", d.bar_parent);
  put(doc, "/dictionary/bar_radius", d.bar_radius);
  put(doc, "/dictionary/bar_taper", d.bar_taper);
  put(doc, "/dictionary/bar_cv", d.bar_cv);
  put(doc, "/dictionary/bar_correlation_length", d.bar_correlation_length);
  put(doc, "/dictionary/bar_angle", d.bar_angle);
  put3(doc, "/dictionary/bar_tip_direction", d.bar_tip_direction);
  put(doc, "/dictionary/bar_tip_distance", d.bar_tip_distance);
  put_texts(doc, "/dictionary/donor_pooled_from", d.donor_pooled_from);
  put_texts(doc, "/dictionary/donor_trace", d.donor_trace);
  if (d.calibre_entry.empty()) return; // only cells without a trace
  put(doc, "/dictionary/calibre_entry", d.calibre_entry);
  put(doc, "/dictionary/calibre_neurite", d.calibre_neurite);
  put(doc, "/dictionary/calibre_donors", d.calibre_donors);
  put_texts(doc, "/dictionary/calibre_trace", d.calibre_trace);
  put(doc, "/dictionary/calibre_radius", d.calibre_radius);
  put(doc, "/dictionary/calibre_cv", d.calibre_cv);
  put(doc, "/dictionary/calibre_correlation_length", d.calibre_correlation_length);
}

void write_measures(conceg_doc *doc, const Measures &measures, const Table &summary,
                    const std::string &folder) {
  if (!folder.empty()) make_folder(folder);
  std::vector<const Table *> tables{&summary};
  if (measures.cells().rows()) // none of cells that are made of barcodes
    tables.insert(tables.end(), {&measures.sections(), &measures.cells(), &measures.sholl()});
  for (const Table *table : tables) {
    write_table(doc, *table);
    if (folder.empty()) continue;
    OutputFile file(folder + "/" + table->name + ".csv");
    file.write(table->csv());
    file.commit();
  }
}
void log_result(conceg_ctx *ctx, const Cleaning &rules, const Output &out) {
  for (const std::string &line : out.summary.lines())
    conceg_ctx_log(ctx, CONCEG_LOG_RESULT, "%s", line.c_str());
  const Cleaned &all = out.cleaned;
  conceg_ctx_log(
      ctx, CONCEG_LOG_RESULT,
      "left out: %zu spine-like twigs (ends shorter than %g um and thinner than %g um), %zu floating trees, "
      "%zu pieces of axons, %zu trees below %g um; %zu radii raised to %g um; %zu pieces of axons joined "
      "over gaps of at most %g um, %.0f um in all (-v: cell by cell)",
      all.twigs, rules.twig_length_um, rules.twig_radius_um, all.floating, all.axon_pieces, all.short_trees,
      rules.tree_length_um, all.raised_radii, rules.lowest_radius_um, all.joined_pieces, rules.axon_gap_um,
      all.bridged_um);
}

} // namespace conceg::characterise
