// SPDX-License-Identifier: BSD-3-Clause
#include "job.hpp"

#include "conceg/conceg.h"
#include "ply.hpp"

#include <charconv>

namespace conceg::exporting {

Written Job::about(const Cell &cell, std::string file, const char *what) const {
  Written row;
  row.file = std::move(file), row.what = what, row.cell = static_cast<std::int64_t>(cell.row),
  row.id = cell.id;
  row.type = cell.type_name, row.layer = cell.layer;
  return row;
}

CellSurface Job::surface_of(const Cell &cell) const {
  return source.surface(cell.row, options.form, options.tiles);
}

Tree Job::tree_of(const Cell &cell) const {
  Tree tree = source.tree(cell.row);
  return options.wrapped ? split_at_box(tree, source.box()) : tree;
}

void Job::text_file(const std::string &file, const char *what, const std::string &text) {
  OutputFile output(folder.at(file));
  output.write(text);
  output.commit();
  Written row;
  row.file = file, row.what = what;
  folder.add(std::move(row));
}

void write_ply_file(Job &job, const std::string &file, const std::vector<const Surface *> &surfaces,
                    const Cell *cell, bool ascii, const char *unit, const char *more) {
  std::vector<std::string> comments = {"ConCeG " CONCEG_VERSION_TEXT ", " + std::string(unit) +
                                       ", triangles wound outward"};
  if (cell)
    comments.push_back("cell " + std::to_string(cell->row) + ", id " + std::to_string(cell->id) + ", type " +
                       cell->type_name);
  if (more) comments.push_back(more);
  OutputFile output(job.folder.at(file));
  write_ply(output, surfaces, ascii, comments);
  output.commit();
  Written row;
  if (cell) row = job.about(*cell, file, "surface");
  row.file = file, row.what = cell ? "surface" : "surfaces";
  for (const Surface *surface : surfaces)
    row.points += surface->vertex.size(), row.faces += surface->face.size();
  job.folder.add(std::move(row));
}

std::string name_of(const Cell &cell) {
  return cell_file_name(cell.row, cell.type_name);
}

std::string number_text(double value) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}

} // namespace conceg::exporting
