// SPDX-License-Identifier: BSD-3-Clause
#include "swc.hpp"

#include "conceg/swc.h"
#include "folder.hpp"
#include "guard.hpp"

#include <cstdio>
#include <numeric>

namespace conceg::exporting {
namespace {

std::string numbers(const double *values) {
  char text[128];
  std::snprintf(text, sizeof text, "[%.17g,%.17g,%.17g]", values[0], values[1], values[2]);
  return text;
}

std::string header_json(const Cell &cell, const conceg_box &box, std::uint64_t seed, bool wrapped) {
  std::string json = "@conceg {\"cell\":" + std::to_string(cell.row) + ",\"id\":" + std::to_string(cell.id);
  json += ",\"type\":" + quoted_json(cell.type_name) + ",\"class\":" + quoted_json(cell.class_name) +
          ",\"layer\":" + quoted_json(cell.layer);
  json += ",\"length_unit\":\"um\",\"box_lo\":" + numbers(box.lo) + ",\"box_hi\":" + numbers(box.hi) +
          ",\"periodic\":[";
  for (int axis = 0; axis < 3; axis++)
    json += std::string(axis ? "," : "") + (box.periodic[axis] ? "true" : "false");
  json +=
      "],\"wrapped\":" + std::string(wrapped ? "true" : "false") + ",\"seed\":" + std::to_string(seed) + "}";
  return json;
}

} // namespace

void write_swc(conceg_ctx *ctx, const std::string &path, const Cell &cell, const Tree &tree,
               const conceg_box &box, std::uint64_t seed, bool wrapped,
               const std::vector<std::string> &footer) {
  // Pieces that were cut at the box must not be joined to the soma.
  std::vector<std::int64_t> parent = tree.parent;
  for (std::size_t i = 0; i < parent.size(); i++)
    if (parent[i] < 0 && !tree.on_soma[i]) parent[i] = CONCEG_SWC_FLOATING;
  const std::string json = header_json(cell, box, seed, wrapped);
  const char *const header[] = {json.c_str(), nullptr};
  std::vector<const char *> names;
  std::vector<const double *> columns;
  const auto add = [&](const char *name, const std::vector<double> &column) {
    if (column.size() != tree.size() || column.empty()) return;
    names.push_back(name), columns.push_back(column.data());
  };
  add("target_radius", tree.target_radius), add("bar", tree.bar), add("branch", tree.branch),
      add("tree", tree.tree), add("status", tree.status);
  std::vector<double> row(footer.empty() ? 0 : tree.size());
  std::iota(row.begin(), row.end(), 0.0); // the file is in preorder; this is the order of the document
  add("row", row);
  // What the plain columns say of the links and the types, so that an edit of them is seen.
  std::vector<double> kind, parent_row;
  if (!footer.empty()) {
    kind.assign(tree.kind.begin(), tree.kind.end());
    parent_row.assign(tree.parent.begin(), tree.parent.end());
  }
  add("kind", kind), add("parent_row", parent_row);
  std::vector<const char *> lines;
  for (const std::string &line : footer)
    lines.push_back(line.c_str());
  lines.push_back(nullptr);

  conceg_swc_cell out = {};
  out.size = sizeof out;
  out.count = tree.size();
  out.position = tree.position.empty() ? nullptr : &tree.position[0].x;
  out.radius = tree.radius.data();
  out.kind = tree.kind.data();
  out.parent = parent.data();
  for (int axis = 0; axis < 3; axis++)
    out.soma[axis] = cell.soma[axis];
  out.soma_radius = cell.soma_radius;
  out.header = header;
  out.footer = lines.data();
  out.column_count = static_cast<std::uint32_t>(names.size());
  out.column_name = names.data();
  out.column = columns.data();
  must(conceg_swc_write(ctx, path.c_str(), &out));
}

} // namespace conceg::exporting
