// SPDX-License-Identifier: BSD-3-Clause
// BlueBrain h5v1 morphologies, for MorphIO and what builds on it. Sections are the runs between soma, forks
// and tips; one that leaves a fork begins with the fork's point. The soma, which the format wants as an
// outline, is three points that MorphIO reads as a ball of its radius: SWC's three-point soma.
#include "conceg/swc.h"
#include "h5_morphology.hpp"
#include "job.hpp"

#include <map>

namespace conceg::exporting {
namespace {

H5Morphology morphology_of(const Cell &cell, const Tree &tree) {
  H5Morphology out;
  const auto add = [&](const glm::dvec3 &p, double radius) {
    for (const double value : {p.x, p.y, p.z, 2.0 * radius})
      out.points.push_back(value);
  };
  const auto begin = [&](std::int32_t type, std::int32_t before) {
    for (const std::int32_t value : {static_cast<std::int32_t>(out.points.size() / 4), type, before})
      out.structure.push_back(value);
  };
  begin(CONCEG_SWC_SOMA, -1);
  const double r = cell.soma_radius > 0.0 ? cell.soma_radius : tree.size() ? tree.radius[0] : 0.0;
  for (const double step : {0.0, -1.0, 1.0})
    add(cell.soma + glm::dvec3(0.0, step * r, 0.0), r);
  std::map<std::uint32_t, std::int32_t> section_of; // that ends at, or holds, a point
  std::int32_t sections = 0;
  for (const std::vector<std::uint32_t> &run : runs(tree)) {
    const auto before = section_of.find(run[0]);
    const std::size_t own = before == section_of.end() ? 0 : 1; // the run's first own point
    begin(tree.kind[run[own]], before == section_of.end() ? 0 : before->second);
    // A section has two points at least: a root of one point begins at the soma.
    if (run.size() < 2) add(cell.soma, tree.radius[run[0]]);
    for (const std::uint32_t point : run)
      add(tree.position[point], tree.radius[point]);
    sections++;
    for (const std::uint32_t point : run)
      section_of.emplace(point, sections);
  }
  return out;
}

} // namespace

void export_h5v1(Job &job) {
  for (const Cell &cell : job.cells) {
    const Tree tree = job.tree_of(cell);
    if (tree.size() == 0 && !(cell.soma_radius > 0.0)) continue;
    if (tree.size() > 0x3fffffffu) fail(CONCEG_E_UNSUPPORTED, "h5v1: a file numbers at most 2^30 points");
    const H5Morphology morphology = morphology_of(cell, tree);
    Written row = job.about(cell, "h5v1/" + name_of(cell) + ".h5", "skeleton");
    row.points = morphology.points.size() / 4;
    OutputFile output(job.folder.at(row.file));
    output.write(h5v1_bytes(morphology));
    output.commit();
    job.folder.add(std::move(row));
  }
}

} // namespace conceg::exporting
