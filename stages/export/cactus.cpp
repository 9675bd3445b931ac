// SPDX-License-Identifier: BSD-3-Clause
// CACTUS strand list: side of the box, number of strands, for each its number of points and rows "x y z r",
// centred, um. A strand has no branches: a cell gives one for its soma and one for each run between forks,
// and strands.csv says which is which. Its mesher refuses strands of fewer than 4 points, so that segments of
// short runs are divided; the shape stays.
#include "job.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::exporting {
namespace {

constexpr std::size_t least_points = 4;

struct Strand {
  std::vector<glm::dvec3> position;
  std::vector<double> radius;
};

// Points are put into the middle of the longest segment until there are enough.
void divide(Strand &strand) {
  while (strand.position.size() < least_points) {
    std::size_t widest = 1;
    double length = -1.0;
    for (std::size_t i = 1; i < strand.position.size(); i++) {
      const glm::dvec3 d = strand.position[i] - strand.position[i - 1];
      if (glm::dot(d, d) > length) length = glm::dot(d, d), widest = i;
    }
    const auto at = static_cast<std::ptrdiff_t>(widest);
    strand.position.insert(strand.position.begin() + at,
                           0.5 * (strand.position[widest - 1] + strand.position[widest]));
    strand.radius.insert(strand.radius.begin() + at,
                         0.5 * (strand.radius[widest - 1] + strand.radius[widest]));
  }
}

// A ball as a strand: spheres of radius R - |t| at c + t e_x lie in it, and the middle one is it.
Strand ball(const glm::dvec3 &centre, double radius) {
  Strand strand;
  for (const double t : {-0.2, -0.1, 0.0, 0.1, 0.2})
    strand.position.push_back(centre + glm::dvec3(t * radius, 0.0, 0.0)),
        strand.radius.push_back(radius * (1.0 - std::abs(t)));
  return strand;
}

} // namespace

void export_cactus(Job &job) {
  const conceg_box &box = job.source.box();
  const glm::dvec3 sides = side(box), centre = 0.5 * glm::dvec3(box.lo[0] + box.hi[0], box.lo[1] + box.hi[1],
                                                                box.lo[2] + box.hi[2]);
  std::string rows, table = "strand,cell,id,type,section,first_point,last_point\n";
  std::size_t strands = 0;
  const auto add = [&](const Strand &strand, const Cell &cell, const std::string &section,
                       const std::string &points) {
    rows += std::to_string(strand.position.size()) + "\n";
    for (std::size_t i = 0; i < strand.position.size(); i++) {
      const glm::dvec3 p = strand.position[i] - centre;
      rows += number_text(p.x) + " " + number_text(p.y) + " " + number_text(p.z) + " " +
              number_text(strand.radius[i]) + "\n";
    }
    table += std::to_string(strands++) + "," + std::to_string(cell.row) + "," + std::to_string(cell.id) +
             "," + quoted_csv(cell.type_name) + "," + section + "," + points + "\n";
  };
  for (const Cell &cell : job.cells) {
    if (cell.soma_radius > 0.0) add(ball(cell.soma, cell.soma_radius), cell, "soma", ",");
    const Tree tree = job.tree_of(cell);
    const auto lists = runs(tree);
    for (std::size_t section = 0; section < lists.size(); section++) {
      Strand strand;
      for (const std::uint32_t point : lists[section])
        strand.position.push_back(tree.position[point]), strand.radius.push_back(tree.radius[point]);
      if (strand.position.size() < 2) { // a root of one point: from the soma to it, or a ball
        if (cell.soma_radius > 0.0)
          strand.position.insert(strand.position.begin(), cell.soma),
              strand.radius.insert(strand.radius.begin(), strand.radius[0]);
        if (strand.position.size() < 2) strand = ball(strand.position[0], strand.radius[0]);
      }
      if (cell.soma_radius > 0.0 || lists.size() > 1)
        divide(strand); // a strand that came as one stays as it is
      add(strand, cell, std::to_string(section),
          std::to_string(lists[section].front()) + "," + std::to_string(lists[section].back()));
    }
  }
  job.text_file("cactus/strands.txt", "strands",
                number_text(std::max({sides.x, sides.y, sides.z})) + "\n" + std::to_string(strands) + "\n" +
                    rows);
  job.text_file("cactus/strands.csv", "table", table);
}

} // namespace conceg::exporting
