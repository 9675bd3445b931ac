// SPDX-License-Identifier: BSD-3-Clause
#include "job.hpp"
#include "shapes.hpp"

#include <glm/geometric.hpp>

#include <cstring>

namespace conceg::exporting {

// 80 bytes, number of triangles, then per triangle its normal, three corners and two bytes of 0; all
// little-endian.
void write_stl(OutputFile &file, const Surface &surface) {
  char header[80] = "ConCeG, lengths in um"; // must not begin with "solid"
  const auto count = static_cast<std::uint32_t>(surface.face.size());
  std::string bytes(header, sizeof header);
  bytes.append(reinterpret_cast<const char *>(&count), 4);
  for (const glm::uvec3 &face : surface.face) {
    const glm::dvec3 &a = surface.vertex[face.x], &b = surface.vertex[face.y], &c = surface.vertex[face.z];
    const glm::dvec3 across = glm::cross(b - a, c - a);
    const double length = glm::length(across);
    const glm::vec3 rows[4] = {length > 0.0 ? glm::vec3(across / length) : glm::vec3(0.0f), glm::vec3(a),
                               glm::vec3(b), glm::vec3(c)};
    static_assert(sizeof rows == 48, "twelve floats");
    bytes.append(reinterpret_cast<const char *>(rows), sizeof rows);
    bytes.append(2, '\0');
  }
  file.write(bytes);
}

void write_stl_text(OutputFile &file, const Surface &surface) {
  std::string text = "solid ConCeG\n";
  const auto add = [&](const char *before, const glm::dvec3 &p) {
    text += before + number_text(p.x) + " " + number_text(p.y) + " " + number_text(p.z) + "\n";
  };
  for (const glm::uvec3 &face : surface.face) {
    const glm::dvec3 &a = surface.vertex[face.x], &b = surface.vertex[face.y], &c = surface.vertex[face.z];
    const glm::dvec3 across = glm::cross(b - a, c - a);
    const double length = glm::length(across);
    add("facet normal ", glm::dvec3(length > 0.0 ? glm::vec3(across / length) : glm::vec3(0.0f)));
    text += "outer loop\n";
    for (const glm::dvec3 &corner : {a, b, c})
      add("vertex ", corner);
    text += "endloop\nendfacet\n";
  }
  file.write(text + "endsolid ConCeG\n");
}

void export_stl(Job &job) {
  if (job.options.form == Form::extracellular) return write_extracellular(job, "stl");
  for (const Cell &cell : job.cells) {
    const Surface surface = job.surface_of(cell).surface;
    if (surface.face.empty()) continue;
    Written row = job.about(cell, "stl/" + name_of(cell) + ".stl", "surface");
    row.points = surface.vertex.size(), row.faces = surface.face.size();
    OutputFile output(job.folder.at(row.file));
    write_stl(output, surface);
    output.commit();
    job.folder.add(std::move(row));
  }
}

} // namespace conceg::exporting
