// SPDX-License-Identifier: BSD-3-Clause
// form=extracellular: one surface, in any of the mesh formats.
#include "extracellular.hpp"
#include "job.hpp"
#include "shapes.hpp"
#include "vtk.hpp"

#include <limits>

namespace conceg::exporting {

static ExtracellularSurface extracellular_of(Job &job) {
  ExtracellularSurface space(job.options.tiles.of(job.source.box()));
  for (std::size_t i = 0; i < job.cells.size(); i++) {
    report(job.progress, "export: extracellular surface", i, job.cells.size());
    const CellSurface cell = job.source.surface(job.cells[i].row, Form::closed, job.options.tiles);
    if (!cell.surface.face.empty()) space.add(cell.surface, cell.compartment);
  }
  space.close();
  return space;
}

void write_extracellular(Job &job, const std::string &format) {
  const ExtracellularSurface space = extracellular_of(job);
  const Surface &surface = space.surface();
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  const std::string name = "extracellular", folder = format + "/" + name;
  if (format == "ply")
    return write_ply_file(job, folder + ".ply", {&surface}, nullptr, job.options.ascii, "lengths in um",
                          "the box without its cells");
  Written row;
  row.file = folder + (format == "vtk" ? ".vtp" : format == "gltf" ? ".glb" : "." + format);
  row.what = "surface", row.points = surface.vertex.size(), row.faces = surface.face.size();
  if (format == "vtk") {
    write_surface_vtp(job.folder.at(row.file), {&surface, space.label(), {}, {}, none, none});
  } else {
    OutputFile output(job.folder.at(row.file));
    if (format == "stl")
      write_stl(output, surface);
    else if (format == "obj")
      write_obj(output, {{name, &surface}});
    else
      write_glb(output, {{name, &surface}});
    output.commit();
  }
  job.folder.add(std::move(row));
}

} // namespace conceg::exporting
