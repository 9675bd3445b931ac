// SPDX-License-Identifier: BSD-3-Clause
#include "dictionary_io.hpp"

#include "view.hpp"

#include <memory>

// data/mouse-visual-cortex.cgx, by embedded.S.
extern "C" const unsigned char conceg_default_dictionary[], conceg_default_dictionary_end[];

namespace conceg::place {
namespace {

template <class T> std::vector<T> read(conceg_doc *doc, const char *path, std::size_t columns = 1) {
  const View<T> v = view<T>(doc, path, columns);
  return std::vector<T>(v.begin(), v.end());
}
template <class T> std::vector<T> read_if(conceg_doc *doc, const char *path, std::size_t columns = 1) {
  return has(doc, path) ? read<T>(doc, path, columns) : std::vector<T>();
}
std::vector<std::string> texts_if(conceg_doc *doc, const char *path) {
  return has(doc, path) ? texts(doc, path) : std::vector<std::string>();
}
template <class T>
void put_if(conceg_doc *doc, const char *path, const std::vector<T> &values, std::size_t columns = 1) {
  if (!values.empty()) put(doc, path, values, columns);
}
void put_texts_if(conceg_doc *doc, const char *path, const std::vector<std::string> &values) {
  if (!values.empty()) put_texts(doc, path, values);
}

Dictionary read_dictionary(conceg_doc *doc) {
  Dictionary d;
  d.entry.name = texts(doc, "/dictionary/entry_name");
  d.entry.class_name = texts(doc, "/dictionary/entry_class");
  d.entry.note = texts_if(doc, "/dictionary/entry_note");
  d.entry.donor_offset = read<std::uint64_t>(doc, "/dictionary/entry_donor_offset");
  d.entry.angle_offset = read<std::uint64_t>(doc, "/dictionary/entry_angle_offset");
  d.entry.straightness = read_if<double>(doc, "/dictionary/entry_straightness");
  d.entry.straightness_sd = read_if<double>(doc, "/dictionary/entry_straightness_sd");
  d.angle = read_if<double>(doc, "/dictionary/angle");
  d.donor.id = texts(doc, "/dictionary/donor_id");
  d.donor.fold = read_if<std::uint8_t>(doc, "/dictionary/donor_fold");
  d.donor.frame = read_if<double>(doc, "/dictionary/donor_frame", 4);
  d.donor.frame_kind = texts_if(doc, "/dictionary/donor_frame_kind");
  d.donor.soma_radius = read<double>(doc, "/dictionary/donor_soma_radius");
  d.donor.tree_offset = read<std::uint64_t>(doc, "/dictionary/donor_tree_offset");
  d.tree.neurite = read<std::uint8_t>(doc, "/dictionary/tree_neurite");
  d.tree.trunk_direction = vec3s<glm::dvec3>(doc, "/dictionary/tree_trunk_direction");
  d.tree.bar_offset = read<std::uint64_t>(doc, "/dictionary/tree_bar_offset");
  d.bar.birth = read<double>(doc, "/dictionary/bar_birth");
  d.bar.death = read<double>(doc, "/dictionary/bar_death");
  d.bar.parent = read<std::int64_t>(doc, "/dictionary/bar_parent");
  d.bar.radius = read<double>(doc, "/dictionary/bar_radius");
  d.bar.taper = read<double>(doc, "/dictionary/bar_taper");
  d.bar.cv = read_if<double>(doc, "/dictionary/bar_cv");
  d.bar.correlation_length = read_if<double>(doc, "/dictionary/bar_correlation_length");
  d.bar.angle = read<double>(doc, "/dictionary/bar_angle");
  d.bar.tip_direction = vec3s<glm::dvec3>(doc, "/dictionary/bar_tip_direction");
  d.bar.tip_distance = read<double>(doc, "/dictionary/bar_tip_distance");
  return d;
}

} // namespace

Dictionary load_dictionary(conceg_ctx *ctx, const std::string &name) {
  conceg_doc *raw = nullptr;
  if (name == "default") {
    const auto size = static_cast<std::size_t>(conceg_default_dictionary_end - conceg_default_dictionary);
    must(conceg_doc_from_memory(ctx, conceg_default_dictionary, size, &raw));
  } else {
    must(conceg_doc_open(ctx, name.c_str(), &raw));
  }
  struct Close {
    void operator()(conceg_doc *doc) const { (void)conceg_doc_close(doc); } // only read from
  };
  const std::unique_ptr<conceg_doc, Close> doc(raw);
  if (!has(raw, "/dictionary"))
    fail(CONCEG_E_MISSING, "dictionary: %s has no /dictionary; make one with conceg characterise",
         name.c_str());
  must(conceg_doc_validate(raw, "/dictionary", nullptr, nullptr));
  return read_dictionary(raw);
}

void write_dictionary(conceg_doc *doc, const Dictionary &d) {
  put_texts(doc, "/dictionary/entry_name", d.entry.name);
  put_texts(doc, "/dictionary/entry_class", d.entry.class_name);
  put_texts_if(doc, "/dictionary/entry_note", d.entry.note);
  put(doc, "/dictionary/entry_donor_offset", d.entry.donor_offset);
  put(doc, "/dictionary/entry_angle_offset", d.entry.angle_offset);
  put_if(doc, "/dictionary/entry_straightness", d.entry.straightness);
  put_if(doc, "/dictionary/entry_straightness_sd", d.entry.straightness_sd);
  put(doc, "/dictionary/angle", d.angle);
  put_texts(doc, "/dictionary/donor_id", d.donor.id);
  put_if(doc, "/dictionary/donor_fold", d.donor.fold);
  put_if(doc, "/dictionary/donor_frame", d.donor.frame, 4);
  put_texts_if(doc, "/dictionary/donor_frame_kind", d.donor.frame_kind);
  put(doc, "/dictionary/donor_soma_radius", d.donor.soma_radius);
  put(doc, "/dictionary/donor_tree_offset", d.donor.tree_offset);
  put(doc, "/dictionary/tree_neurite", d.tree.neurite);
  put3(doc, "/dictionary/tree_trunk_direction", d.tree.trunk_direction);
  put(doc, "/dictionary/tree_bar_offset", d.tree.bar_offset);
  put(doc, "/dictionary/bar_birth", d.bar.birth);
  put(doc, "/dictionary/bar_death", d.bar.death);
  put(doc, "/dictionary/bar_parent", d.bar.parent);
  put(doc, "/dictionary/bar_radius", d.bar.radius);
  put(doc, "/dictionary/bar_taper", d.bar.taper);
  put_if(doc, "/dictionary/bar_cv", d.bar.cv);
  put_if(doc, "/dictionary/bar_correlation_length", d.bar.correlation_length);
  put(doc, "/dictionary/bar_angle", d.bar.angle);
  put3(doc, "/dictionary/bar_tip_direction", d.bar.tip_direction);
  put(doc, "/dictionary/bar_tip_distance", d.bar.tip_distance);
}

} // namespace conceg::place
