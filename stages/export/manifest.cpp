// SPDX-License-Identifier: BSD-3-Clause
#include "manifest.hpp"

#include "conceg/conceg.h"
#include "simulation.hpp"
#include "surface_figures.hpp"

#include <cmath>

namespace conceg::exporting {
namespace {

std::string triple(const glm::dvec3 &v) {
  return "[" + triple_text(v) + "]";
}

std::string pair(const char *name, const std::string &value) {
  return quoted_json(name) + ": " + value;
}

// What is known of a cell's surface; nothing without meshes.
struct CellFigures {
  double volume = 0.0, area = 0.0;
  bool known = false;
};

CellFigures figures_of(const Job &job, const Cell &cell) {
  CellFigures figures;
  if (!job.source.has_meshes()) return figures;
  const Surface surface = job.source.surface(cell.row, Form::closed).surface;
  if (surface.face.empty()) return figures;
  const SurfaceFigures measured = measure_surface(surface);
  return {measured.volume, measured.area, true};
}

std::string cell_json(const Job &job, const Cell &cell, const CellFigures &figures, std::size_t first) {
  std::string text =
      "    {" + pair("cell", std::to_string(cell.row)) + ", " + pair("id", std::to_string(cell.id)) + ", " +
      pair("type", quoted_json(cell.type_name)) + ", " + pair("class", quoted_json(cell.class_name)) + ", " +
      pair("soma_um", triple(cell.soma)) + ", " + pair("soma_radius_um", number_text(cell.soma_radius));
  if (figures.known)
    text += ", " + pair("volume_um3", number_text(figures.volume)) + ", " +
            pair("area_um2", number_text(figures.area)) + ", " +
            pair("surface_to_volume_per_um", number_text(figures.area / figures.volume));
  std::string files;
  for (std::size_t i = first; i < job.folder.written().size(); i++) {
    const Written &row = job.folder.written()[i];
    if (row.cell == static_cast<std::int64_t>(cell.row))
      files += (files.empty() ? "" : ", ") + quoted_json(row.file.substr(row.file.find('/') + 1));
  }
  return text + (files.empty() ? "" : ", " + pair("files", "[" + files + "]")) + "}";
}

// Mean soma radius three ways (the last is what diffusion of long pulses sees), and the share of the balls in
// the cells' volume.
std::string truth_json(const Job &job, double volume) {
  double count = 0.0, r1 = 0.0, r3 = 0.0, r4 = 0.0, r7 = 0.0;
  for (const Cell &cell : job.cells) {
    const double r = cell.soma_radius;
    if (r > 0.0) count += 1.0, r1 += r, r3 += r * r * r, r4 += r * r * r * r, r7 += std::pow(r, 7);
  }
  std::string text;
  const auto add = [&](const char *name, double value) {
    text += (text.empty() ? "" : ", ") + pair(name, number_text(value));
  };
  conceg_array array = {};
  array.size = sizeof array;
  if (conceg_doc_has(job.doc, "/meshes@icvf") &&
      conceg_doc_read(job.doc, "/meshes@icvf", &array) == CONCEG_OK && array.dtype == CONCEG_F64 &&
      conceg_array_count(&array) == 1)
    add("intracellular_volume_fraction", *static_cast<const double *>(array.data));
  if (count > 0.0) {
    add("somas", count), add("soma_radius_mean_um", r1 / count),
        add("soma_radius_volume_weighted_um", r4 / r3), add("soma_radius_r7_r3_um", std::pow(r7 / r3, 0.25));
    if (volume > 0.0)
      add("soma_ball_volume_over_cell_volume", 4.0 / 3.0 * 3.14159265358979323846 * r3 / volume);
  }
  return "{" + text + "}";
}

} // namespace

void write_manifest(Job &job, const Format &format, std::size_t first) {
  const conceg_box &box = job.source.box();
  std::string text = "{\n  " + pair("manifest", "1") + ",\n  " + pair("format", quoted_json(format.name)) +
                     ",\n  " + pair("program", quoted_json(format.program)) + ",\n  " +
                     pair("made_by", quoted_json("ConCeG " CONCEG_VERSION_TEXT)) + ",\n  " +
                     pair("seed", std::to_string(job.source.seed())) + ",\n  " +
                     pair("units", "{" + pair("this_file", quoted_json("um")) + ", " +
                                       pair("files", quoted_json(format.unit)) + "}") +
                     ",\n  " + pair("frame", quoted_json(format.frame)) + ",\n  " +
                     pair("box_lo_um", triple({box.lo[0], box.lo[1], box.lo[2]})) + ",\n  " +
                     pair("box_hi_um", triple({box.hi[0], box.hi[1], box.hi[2]})) + ",\n  " +
                     pair("periodic", std::string("[") + (box.periodic[0] ? "true" : "false") + ", " +
                                          (box.periodic[1] ? "true" : "false") + ", " +
                                          (box.periodic[2] ? "true" : "false") + "]") +
                     ",\n";
  const Tiles &tiles = job.options.tiles;
  if (!tiles.one())
    text += "  " +
            pair("tiles", "[" + std::to_string(tiles.count[0]) + ", " + std::to_string(tiles.count[1]) +
                              ", " + std::to_string(tiles.count[2]) + "]") +
            ",\n";
  if (job.options.level) text += "  " + pair("level", std::to_string(job.options.level)) + ",\n";
  if (!job.cells_are.empty()) text += "  " + pair("cells_are", quoted_json(job.cells_are)) + ",\n";
  const double feature = feature_radius(job);
  if (feature > 0.0) text += "  " + pair("feature_radius_um", number_text(feature)) + ",\n";
  std::string cells;
  double volume = 0.0, area = 0.0;
  for (const Cell &cell : job.cells) {
    const CellFigures figures = figures_of(job, cell);
    volume += figures.volume, area += figures.area;
    cells += (cells.empty() ? "" : ",\n") + cell_json(job, cell, figures, first);
  }
  if (volume > 0.0)
    text += "  " + pair("volume_um3", number_text(volume)) + ",\n  " + pair("area_um2", number_text(area)) +
            ",\n  " + pair("surface_to_volume_per_um", number_text(area / volume)) + ",\n";
  text += "  " + pair("ground_truth", truth_json(job, volume)) + ",\n  " +
          pair("cells", "[\n" + cells + "\n  ]") + "\n}\n";
  job.text_file(std::string(format.name) + "/manifest.json", "manifest", text);
}

} // namespace conceg::exporting
