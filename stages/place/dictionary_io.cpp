// SPDX-License-Identifier: BSD-3-Clause
#include "dictionary_io.hpp"

#include "view.hpp"

#include <memory>

// data/mouse-visual-cortex.cgx, by embedded.S.
extern "C" const unsigned char conceg_default_dictionary[], conceg_default_dictionary_end[];

namespace conceg::place {
namespace {

template <class T>
void read_array(conceg_doc *doc, const char *path, std::size_t columns, std::vector<T> &values) {
  const View<T> v = view<T>(doc, path, columns);
  values.assign(v.begin(), v.end());
}
void read_array(conceg_doc *doc, const char *path, std::size_t, std::vector<std::string> &values) {
  values = texts(doc, path);
}
void read_array(conceg_doc *doc, const char *path, std::size_t, std::vector<glm::dvec3> &values) {
  values = vec3s<glm::dvec3>(doc, path);
}
template <class T>
void write_array(conceg_doc *doc, const char *path, std::size_t columns, const std::vector<T> &values) {
  put(doc, path, values, columns);
}
void write_array(conceg_doc *doc, const char *path, std::size_t, const std::vector<std::string> &values) {
  put_texts(doc, path, values);
}
void write_array(conceg_doc *doc, const char *path, std::size_t, const std::vector<glm::dvec3> &values) {
  put3(doc, path, values);
}

Dictionary read_dictionary(conceg_doc *doc) {
  const auto item = [doc](const char *path, Need need, std::size_t columns, auto &values) {
    if (need == Need::required || has(doc, path)) read_array(doc, path, columns, values);
  };
  Dictionary d;
  each_entry_item(item, d.entry);
  each_donor_item(item, d.donor);
  each_tree_item(item, d.tree);
  each_bar_item(item, d.bar);
  each_source_item(item, d.source);
  each_calibre_item(item, d.calibre);
  item("/dictionary/entry_donor_offset", Need::required, 1, d.entry.donor_offset);
  item("/dictionary/entry_angle_offset", Need::required, 1, d.entry.angle_offset);
  item("/dictionary/donor_tree_offset", Need::required, 1, d.donor.tree_offset);
  item("/dictionary/tree_bar_offset", Need::required, 1, d.tree.bar_offset);
  item("/dictionary/angle", Need::optional, 1, d.angle);
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
  const auto item = [doc](const char *path, Need need, std::size_t columns, const auto &values) {
    if (need == Need::required || !values.empty()) write_array(doc, path, columns, values);
  };
  each_entry_item(item, d.entry);
  each_donor_item(item, d.donor);
  each_tree_item(item, d.tree);
  each_bar_item(item, d.bar);
  each_source_item(item, d.source);
  each_calibre_item(item, d.calibre);
  item("/dictionary/entry_donor_offset", Need::required, 1, d.entry.donor_offset);
  item("/dictionary/entry_angle_offset", Need::required, 1, d.entry.angle_offset);
  item("/dictionary/donor_tree_offset", Need::required, 1, d.donor.tree_offset);
  item("/dictionary/tree_bar_offset", Need::required, 1, d.tree.bar_offset);
  item("/dictionary/angle", Need::required, 1, d.angle);
}

} // namespace conceg::place
