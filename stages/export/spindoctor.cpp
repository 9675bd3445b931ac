// SPDX-License-Identifier: BSD-3-Clause
// SpinDoctor: closed cells in um as TetGen's .node and .poly, and as STL. SpinDoctor reads the former by the
// places of their lines, comments among them, and asks for a marker of each facet and a point in each
// compartment; TetGen, which it calls, reads STL as text alone.
#include "job.hpp"
#include "shapes.hpp"

#include <glm/geometric.hpp>

namespace conceg::exporting {
namespace {

// Distance from a point to the nearest triangle that a ray along a unit vector meets, but for one; infinite
// when there is none.
double distance_along(const Surface &surface, const glm::dvec3 &from, const glm::dvec3 &along,
                      std::size_t but) {
  double nearest = INFINITY;
  for (std::size_t f = 0; f < surface.face.size(); f++) {
    const glm::dvec3 &a = surface.vertex[surface.face[f].x], ab = surface.vertex[surface.face[f].y] - a,
                     ac = surface.vertex[surface.face[f].z] - a, across = glm::cross(along, ac);
    const double determinant = glm::dot(ab, across);
    if (f == but || determinant == 0.0) continue;
    const glm::dvec3 q = glm::cross(from - a, ab);
    const double u = glm::dot(from - a, across) / determinant, v = glm::dot(q, along) / determinant,
                 t = glm::dot(q, ac) / determinant;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0) nearest = std::min(nearest, t);
  }
  return nearest;
}

// A point well inside of a closed surface: halfway between a triangle and what lies behind it, where that is
// thickest among some triangles.
glm::dvec3 point_inside(const Surface &surface) {
  constexpr std::size_t tries = 64;
  const std::size_t step = surface.face.size() / tries + 1;
  glm::dvec3 best = surface.vertex[surface.face[0].x];
  double thickest = 0.0;
  for (std::size_t f = 0; f < surface.face.size(); f += step) {
    const glm::dvec3 &a = surface.vertex[surface.face[f].x], &b = surface.vertex[surface.face[f].y],
                     &c = surface.vertex[surface.face[f].z];
    const glm::dvec3 normal = glm::cross(b - a, c - a), centre = (a + b + c) / 3.0;
    const double length = glm::length(normal);
    if (!(length > 0.0)) continue;
    const double thickness = distance_along(surface, centre, -normal / length, f);
    if (std::isfinite(thickness) && thickness > thickest)
      thickest = thickness, best = centre - normal / length * (0.5 * thickness);
  }
  return best;
}

std::string row_text(const glm::dvec3 &p) {
  return number_text(p.x) + " " + number_text(p.y) + " " + number_text(p.z);
}

void write_node(OutputFile &file, const Surface &surface) {
  std::string text = "# Points of a closed surface, um\n# number, dimensions, attributes, markers\n" +
                     std::to_string(surface.vertex.size()) + " 3 0 0\n# number, x, y, z\n";
  for (std::size_t i = 0; i < surface.vertex.size(); i++)
    text += std::to_string(i + 1) + " " + row_text(surface.vertex[i]) + "\n";
  file.write(text);
}

// Facet marker 1 = the membrane, region 1 = the cell. The size is that of SpinDoctor; TetGen takes no notice
// of it unless it is called with -a and no number.
void write_poly(OutputFile &file, const Surface &surface) {
  std::string text = "# Points\n# 0: they are in the .node file\n0\n# Facets\n# number, markers\n" +
                     std::to_string(surface.face.size()) + " 1\n# polygons, holes, marker; corners\n";
  for (const glm::uvec3 &face : surface.face)
    text += "1 0 1\n3 " + std::to_string(face.x + 1) + " " + std::to_string(face.y + 1) + " " +
            std::to_string(face.z + 1) + "\n";
  file.write(text + "# Holes\n0\n# Regions: number, a point inside, compartment, size\n1\n1 " +
             row_text(point_inside(surface)) + " 1 0.1\n");
}

} // namespace

void export_spindoctor(Job &job) {
  for (const Cell &cell : job.cells) {
    const Surface surface = job.source.surface(cell.row, Form::closed).surface;
    if (surface.face.empty()) continue;
    const std::string name = "spindoctor/" + name_of(cell);
    for (const char *ending : {".stl", ".node", ".poly"}) {
      Written row = job.about(cell, name + ending, "surface");
      row.points = surface.vertex.size(), row.faces = surface.face.size();
      OutputFile output(job.folder.at(row.file));
      if (ending[1] == 's')
        write_stl_text(output, surface);
      else if (ending[1] == 'n')
        write_node(output, surface);
      else
        write_poly(output, surface);
      output.commit();
      job.folder.add(std::move(row));
    }
  }
}

} // namespace conceg::exporting
