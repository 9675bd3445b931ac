// SPDX-License-Identifier: BSD-3-Clause
#include "job.hpp"
#include "shapes.hpp"

namespace conceg::exporting {

void write_obj(OutputFile &file, const std::vector<NamedSurface> &surfaces) {
  file.write("# ConCeG, lengths in um\n");
  std::uint64_t base = 1;
  for (const NamedSurface &named : surfaces) {
    std::string text = "o " + named.name + "\n";
    for (const glm::dvec3 &p : named.surface->vertex)
      text += "v " + number_text(p.x) + " " + number_text(p.y) + " " + number_text(p.z) + "\n";
    for (const glm::uvec3 &face : named.surface->face)
      text += "f " + std::to_string(base + face.x) + " " + std::to_string(base + face.y) + " " +
              std::to_string(base + face.z) + "\n";
    base += named.surface->vertex.size();
    file.write(text);
  }
}

// All surfaces in one file: obj and gltf.
static void write_joint(Job &job, const std::string &name,
                        void (*write)(OutputFile &, const std::vector<NamedSurface> &)) {
  std::vector<Surface> surfaces;
  std::vector<NamedSurface> named;
  std::vector<std::string> names;
  for (const Cell &cell : job.cells) {
    surfaces.push_back(job.surface_of(cell).surface);
    names.push_back(name_of(cell));
  }
  Written row;
  for (std::size_t i = 0; i < surfaces.size(); i++) {
    if (surfaces[i].face.empty()) continue;
    named.push_back({names[i], &surfaces[i]});
    row.points += surfaces[i].vertex.size(), row.faces += surfaces[i].face.size();
  }
  row.file = name, row.what = "surfaces";
  OutputFile output(job.folder.at(row.file));
  write(output, named);
  output.commit();
  job.folder.add(std::move(row));
}

void export_obj(Job &job) {
  if (job.options.form == Form::extracellular) return write_extracellular(job, "obj");
  write_joint(job, "obj/cells.obj", write_obj);
}
void export_gltf(Job &job) {
  if (job.options.form == Form::extracellular) return write_extracellular(job, "gltf");
  write_joint(job, "gltf/cells.glb", write_glb);
}

} // namespace conceg::exporting
