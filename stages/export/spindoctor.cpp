// SPDX-License-Identifier: BSD-3-Clause
// SpinDoctor: closed cells as STL, and as TetGen's .node and .poly (numbers from 1, text), in um.
#include "job.hpp"
#include "shapes.hpp"

namespace conceg::exporting {

void export_spindoctor(Job &job) {
  for (const Cell &cell : job.cells) {
    const Surface surface = job.source.surface(cell.row, Form::closed).surface;
    if (surface.face.empty()) continue;
    const std::string name = "spindoctor/" + name_of(cell);
    for (const char *ending : {".stl", ".node", ".poly"}) {
      Written row = job.about(cell, name + ending, "surface");
      row.points = surface.vertex.size(), row.faces = surface.face.size();
      OutputFile output(job.folder.at(row.file));
      if (ending[1] == 's') {
        write_stl(output, surface);
      } else if (ending[1] == 'n') {
        std::string text = std::to_string(surface.vertex.size()) + " 3 0 0\n";
        for (std::size_t i = 0; i < surface.vertex.size(); i++)
          text += std::to_string(i + 1) + " " + number_text(surface.vertex[i].x) + " " +
                  number_text(surface.vertex[i].y) + " " + number_text(surface.vertex[i].z) + "\n";
        output.write(text);
      } else { // points in the .node file, a polygon a facet, no holes, no regions
        std::string text = "0 3 0 0\n" + std::to_string(surface.face.size()) + " 0\n";
        for (const glm::uvec3 &face : surface.face)
          text += "1\n3 " + std::to_string(face.x + 1) + " " + std::to_string(face.y + 1) + " " +
                  std::to_string(face.z + 1) + "\n";
        output.write(text + "0\n0\n");
      }
      output.commit();
      job.folder.add(std::move(row));
    }
  }
}

} // namespace conceg::exporting
