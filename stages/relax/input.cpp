// SPDX-License-Identifier: BSD-3-Clause
#include "input.hpp"

#include "view.hpp"

#include <map>

namespace conceg::relax {

namespace {

template <class T> std::vector<T> values(conceg_doc *doc, const char *path) {
  const View<T> v = view<T>(doc, path);
  return std::vector<T>(v.begin(), v.end());
}

} // namespace

Skeletons read_skeletons(conceg_doc *doc) {
  Skeletons s;
  s.cell_offset = values<std::uint64_t>(doc, "/skeleton/cell_offset");
  s.position = vec3s<glm::dvec3>(doc, "/skeleton/position");
  s.radius = values<float>(doc, "/skeleton/radius");
  s.target_radius = values<float>(doc, "/skeleton/target_radius");
  s.parent = values<std::int64_t>(doc, "/skeleton/parent");
  s.soma = vec3s<glm::dvec3>(doc, "/cells/soma");
  s.soma_radius = values<float>(doc, "/cells/radius");
  return s;
}

Classes read_classes(conceg_doc *doc, std::size_t cells) {
  Classes out;
  const std::vector<std::string> of_type = texts(doc, "/types/class");
  const std::vector<std::uint32_t> type = values<std::uint32_t>(doc, "/cells/type");
  std::map<std::string, std::uint32_t> number;
  if (type.size() != cells)
    fail(CONCEG_E_FORMAT, "/cells/type: expected %zu values, got %zu", cells, type.size());
  for (std::size_t i = 0; i < cells; i++) {
    if (type[i] >= of_type.size())
      fail(CONCEG_E_RANGE, "/cells/type[%zu]: expected a type below %zu, got %u", i, of_type.size(), type[i]);
    const auto found = number.emplace(of_type[type[i]], static_cast<std::uint32_t>(number.size()));
    if (found.second) out.name.push_back(of_type[type[i]]);
    out.of_cell.push_back(found.first->second);
  }
  return out;
}

} // namespace conceg::relax
