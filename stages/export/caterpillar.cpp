// SPDX-License-Identifier: BSD-3-Clause
// CATERPillar sphere table, layout B (9 columns) or C (10, with parent_component_id), and the growth_info
// file that holds the voxel. Spheres stand along each round cone at most max(r1, r2) / 4 apart, as its own
// do. A cell without soma and fork is an axon, any other a glial cell, which is the only type with branches.
// Branches are numbered from 1, so that parent 0 can mean the soma alone.
#include "job.hpp"
#include "view.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::exporting {
namespace {

constexpr double spacing_radii = 0.25;
constexpr std::size_t most_spheres_a_segment = 1000000;

class Table {
public:
  Table(Job &job)
      : job_(job), origin_(job.source.box().lo[0], job.source.box().lo[1], job.source.box().lo[2]),
        columns_(job.options.columns) {
    if (has(job.doc, "/x_interop/inner_radius")) inner_ = view<float>(job.doc, "/x_interop/inner_radius");
    if (inner_.data() && inner_.rows() != view<double>(job.doc, "/skeleton/position", 3).rows()) inner_ = {};
    offset_ = view<std::uint64_t>(job.doc, "/skeleton/cell_offset");
    text =
        columns_ == 10
            ? "cell_type cell_id component component_id parent_component_id X Y Z inner_radius outer_radius\n"
            : "cell_type cell_id component component_id X Y Z inner_radius outer_radius\n";
  }

  void add(const Cell &cell) {
    const Tree tree = job_.source.tree(cell.row);
    const auto lists = runs(tree);
    axon_ = !(cell.soma_radius > 0.0) && lists.size() <= 1;
    const std::size_t id = axon_ ? axons++ : glia++;
    if (!axon_) {
      // Without a soma the first point stands for it: a glial cell begins at its soma row.
      const bool soma = cell.soma_radius > 0.0;
      if (!soma && tree.size() == 0) return;
      const double r = soma ? cell.soma_radius : tree.radius[0];
      row(id, "soma", 0, 0, soma ? cell.soma : tree.position[0], r, r);
    }
    std::vector<std::size_t> branch_of(tree.size(),
                                       0); // number of the branch that has the point, 0 = none yet
    for (std::size_t i = 0; i < lists.size(); i++) {
      // A run that leaves a fork begins with the fork's point, which another branch has.
      const std::size_t parent = branch_of[lists[i][0]];
      for (const std::uint32_t point : lists[i])
        if (!branch_of[point]) branch_of[point] = i + 1;
      write_run(id, cell, tree, lists[i], axon_ ? 0 : i + 1, parent);
    }
  }

  std::string text;
  std::size_t axons = 0, glia = 0;

private:
  void write_run(std::size_t id, const Cell &cell, const Tree &tree, const std::vector<std::uint32_t> &list,
                 std::size_t component, std::size_t parent) {
    const auto inner = [&](std::uint32_t i) {
      return inner_.data() ? std::min(tree.radius[i], static_cast<double>(inner_[offset_[cell.row] + i]))
                           : tree.radius[i];
    };
    const char *name = axon_ ? "axon" : "branch";
    for (std::size_t k = 0; k < list.size(); k++) {
      const std::uint32_t b = list[k], a = k ? list[k - 1] : b;
      glm::dvec3 from = tree.position[a];
      // A root is joined to its soma as relax and mesh do: from one radius below its surface.
      if (k == 0 && tree.parent[b] < 0 && cell.soma_radius > 0.0) {
        const double distance = glm::length(tree.position[b] - cell.soma),
                     depth = std::max(0.0, cell.soma_radius - tree.radius[b]);
        if (distance > depth) from = cell.soma + (tree.position[b] - cell.soma) * (depth / distance);
      }
      const double length = glm::length(tree.position[b] - from),
                   widest = std::max(tree.radius[a], tree.radius[b]);
      const double pieces = std::max(1.0, std::ceil(length / (spacing_radii * widest)));
      if (!(pieces <= static_cast<double>(most_spheres_a_segment)))
        fail(CONCEG_E_RANGE, "caterpillar: a segment of %g um would take %g spheres", length, pieces);
      for (double i = k || length == 0.0 ? 1.0 : 0.0; i <= pieces; i++) {
        const double t = i / pieces;
        row(id, name, component, parent, glm::mix(from, tree.position[b], t), glm::mix(inner(a), inner(b), t),
            glm::mix(tree.radius[a], tree.radius[b], t));
      }
    }
  }

  void row(std::size_t id, const char *component, std::size_t number, std::size_t parent,
           const glm::dvec3 &at, double inner, double outer) {
    const glm::dvec3 p = at - origin_;
    char line[256];
    std::snprintf(line, sizeof line, " %.9g %.9g %.9g %.9g %.9g\n", p.x, p.y, p.z, inner, outer);
    text += (axon_ ? "axon " : "glial_cell ") + std::to_string(id) + " " + component + " " +
            std::to_string(number) + (columns_ == 10 ? " " + std::to_string(parent) : "") + line;
  }

  Job &job_;
  const glm::dvec3 origin_;
  const int columns_;
  bool axon_ = false;
  View<float> inner_;
  View<std::uint64_t> offset_;
};

} // namespace

void export_caterpillar(Job &job) {
  Table table(job);
  // Axons first, then the cells with branches.
  for (const bool axons : {true, false})
    for (const Cell &cell : job.cells) {
      const bool axon = !(cell.soma_radius > 0.0) && runs(job.source.tree(cell.row)).size() <= 1;
      if (axon == axons) table.add(cell);
    }
  const glm::dvec3 sides = side(job.source.box());
  job.text_file("caterpillar/voxel.csv", "spheres", table.text);
  job.text_file("caterpillar/voxel_growth_info.txt", "configuration",
                "Num_axons " + std::to_string(table.axons) + "\nNum_glial_cells " +
                    std::to_string(table.glia) + "\nVoxel Size " +
                    number_text(std::max({sides.x, sides.y, sides.z})) +
                    (sides.x == sides.y && sides.y == sides.z
                         ? std::string()
                         : "\nSmall voxel min limits 0 0 0\nSmall voxel max limits " + number_text(sides.x) +
                               " " + number_text(sides.y) + " " + number_text(sides.z)) +
                    "\n");
}

} // namespace conceg::exporting
