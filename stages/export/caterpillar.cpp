// SPDX-License-Identifier: BSD-3-Clause
// CATERPillar sphere table, layout B (9 columns) or C (10, with parent_component_id), the growth_info file
// that holds the voxel, and cells.csv, which says what each cell of the table is of. The format knows no
// periodic box: all images of a cell that meet the voxel are written, each connected piece as a cell, or on
// request the cells as they are stored. A piece without soma and fork is an axon, any other a glial cell,
// which is the only type with branches. Branches are numbered from 1, so that parent 0 can mean the soma
// alone.
#include "job.hpp"
#include "spheres.hpp"
#include "view.hpp"

#include <algorithm>

namespace conceg::exporting {
namespace {

// A cell of the table: where each of its spheres belongs.
struct Entry {
  std::size_t cell; // of job.cells
  SphereTree tree;
  bool axon;
  std::vector<std::vector<std::uint32_t>>
      branches;                     // numbers of spheres; those of an axon are all in the first
  std::vector<std::size_t> parents; // branch from which each begins, 0 = the soma
};

// The branches as runs between forks of what is left without the soma, the first sphere.
void divide(Entry &entry) {
  Tree rest;
  for (std::size_t i = 1; i < entry.tree.spheres.size(); i++) {
    rest.parent.push_back(entry.tree.spheres[i].parent - 1);
    rest.position.push_back(entry.tree.spheres[i].at);
  }
  std::vector<std::size_t> branch_of(rest.size(), 0); // from 1, 0 = none yet
  for (std::vector<std::uint32_t> &run : runs(rest)) {
    const std::size_t fork = branch_of[run[0]];
    if (fork) run.erase(run.begin()); // another branch has the fork's sphere
    for (std::uint32_t &sphere : run)
      branch_of[sphere] = entry.branches.size() + 1, sphere++;
    entry.branches.push_back(std::move(run));
    entry.parents.push_back(fork);
  }
}

Entry entry_of(std::size_t cell, SphereTree tree) {
  Entry entry = {cell, std::move(tree), !tree.soma, {}, {}};
  std::vector<std::uint32_t> all(entry.tree.spheres.size()), children(all.size(), 0);
  for (std::size_t i = 0; i < all.size(); i++) {
    all[i] = static_cast<std::uint32_t>(i);
    const std::int64_t parent = entry.tree.spheres[i].parent;
    if (parent >= 0 && ++children[static_cast<std::size_t>(parent)] > 1) entry.axon = false;
  }
  if (entry.axon)
    entry.branches.push_back(std::move(all)), entry.parents.push_back(0);
  else // without a soma the first sphere stands for it: a glial cell begins at its soma row
    divide(entry);
  return entry;
}

class Table {
public:
  explicit Table(Job &job)
      : job_(job), origin_(job.source.box().lo[0], job.source.box().lo[1], job.source.box().lo[2]) {
    if (has(job.doc, "/x_interop/inner_radius")) inner_ = view<float>(job.doc, "/x_interop/inner_radius");
    if (inner_.data() && inner_.rows() != view<double>(job.doc, "/skeleton/position", 3).rows()) inner_ = {};
    offset_ = view<std::uint64_t>(job.doc, "/skeleton/cell_offset");
  }

  void gather() {
    const conceg_box &box = job_.source.box();
    for (std::size_t i = 0; i < job_.cells.size(); i++) {
      report(job_.progress, "export: spheres", i, job_.cells.size());
      const Tree tree = job_.source.tree(job_.cells[i].row);
      std::vector<double> inner;
      if (inner_.data())
        for (std::size_t k = 0; k < tree.size(); k++)
          inner.push_back(inner_[offset_[job_.cells[i].row] + k]);
      for (SphereTree &whole : sphere_trees(job_.cells[i], tree, inner)) {
        if (job_.options.whole)
          entries_.push_back(entry_of(i, std::move(whole)));
        else
          for (SphereTree &piece : images_in_box(whole, box))
            entries_.push_back(entry_of(i, std::move(piece)));
      }
    }
    // Axons by their first radius, the largest first; then the cells with branches as they come.
    std::stable_sort(entries_.begin(), entries_.end(), [](const Entry &p, const Entry &q) {
      if (!p.axon || !q.axon) return p.axon && !q.axon;
      return p.tree.spheres[0].outer > q.tree.spheres[0].outer;
    });
    for (const Entry &entry : entries_)
      for (const Sphere &sphere : entry.tree.spheres) {
        const glm::dvec3 at = sphere.at - origin_, sides = side(box);
        balls_.push_back({at, sphere.outer, entry.axon});
        outside_ +=
            at.x < 0.0 || at.y < 0.0 || at.z < 0.0 || at.x > sides.x || at.y > sides.y || at.z > sides.z;
      }
  }

  void write_table() {
    const bool wide = job_.options.columns == 10;
    OutputFile file(job_.folder.at("caterpillar/voxel.csv"));
    file.write(std::string("cell_type cell_id component component_id ") +
               (wide ? "parent_component_id " : "") + "X Y Z inner_radius outer_radius\n");
    std::size_t id = 0;
    for (std::size_t i = 0; i < entries_.size(); i++, id++) {
      const Entry &entry = entries_[i];
      if (i && !entry.axon && entries_[i - 1].axon) id = 0;
      const std::string cell = (entry.axon ? "axon " : "glial_cell ") + std::to_string(id) + " ";
      const auto row = [&](const char *component, std::size_t number, std::size_t parent,
                           std::uint32_t sphere) {
        file.write(cell + component + " " + std::to_string(number) +
                   (wide ? " " + std::to_string(parent) : std::string()) +
                   numbers(entry, entry.tree.spheres[sphere]));
      };
      if (!entry.axon) row("soma", 0, 0, 0);
      for (std::size_t b = 0; b < entry.branches.size(); b++)
        for (const std::uint32_t sphere : entry.branches[b])
          row(entry.axon ? "axon" : "branch", entry.axon ? 0 : b + 1, entry.parents[b], sphere);
    }
    file.commit();
    Written written;
    written.file = "caterpillar/voxel.csv", written.what = "spheres", written.points = balls_.size();
    job_.folder.add(std::move(written));
  }

  void write_cells() {
    std::string text = "cell_type,cell_id,cell,id,type,lift_x,lift_y,lift_z,spheres\n";
    std::size_t id = 0;
    for (std::size_t i = 0; i < entries_.size(); i++, id++) {
      const Entry &entry = entries_[i];
      if (i && !entry.axon && entries_[i - 1].axon) id = 0;
      const Cell &cell = job_.cells[entry.cell];
      text += (entry.axon ? "axon," : "glial_cell,") + std::to_string(id) + "," + std::to_string(cell.row) +
              "," + std::to_string(cell.id) + "," + quoted_csv(cell.type_name);
      for (int axis = 0; axis < 3; axis++)
        text += "," + std::to_string(entry.tree.lift[axis]);
      text += "," + std::to_string(entry.tree.spheres.size()) + "\n";
    }
    job_.text_file("caterpillar/cells.csv", "table", text);
  }

  // Duration is how long CATERPillar grew, of which this table has nothing: 0.
  void write_info() {
    const glm::dvec3 sides = side(job_.source.box());
    const BallShares shares = ball_shares(balls_, sides);
    std::string text = "Duration 0\nNum_axons " + std::to_string(axons()) + "\nVoxel Size " +
                       six_digits(std::max({sides.x, sides.y, sides.z})) + "\nAxon icvf " +
                       six_digits(shares.axons) + "\nTotal icvf " + six_digits(shares.all) + "\n";
    if (sides.x != sides.y || sides.y != sides.z)
      text += "Small voxel min limits 0 0 0\nSmall voxel max limits " + six_digits(sides.x) + " " +
              six_digits(sides.y) + " " + six_digits(sides.z) + "\n";
    job_.text_file("caterpillar/voxel_growth_info.txt", "configuration", text);
  }

  void warn() {
    if (unsheathed_)
      conceg_ctx_log(job_.ctx, CONCEG_LOG_WARNING,
                     "caterpillar: %zu spheres of cells with soma or forks have an inner radius, which the "
                     "format has for axons alone: written with the outer one twice",
                     unsheathed_);
    const conceg_box &box = job_.source.box();
    if (job_.options.whole && outside_ && (box.periodic[0] || box.periodic[1] || box.periodic[2]))
      conceg_ctx_log(job_.ctx, CONCEG_LOG_WARNING,
                     "caterpillar: %zu of %zu centres lie outside of the voxel, and no reader of the format "
                     "wraps them; leave out --whole to get all that lies in it",
                     outside_, balls_.size());
  }

private:
  // As C++ streams print numbers.
  static std::string six_digits(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
  }
  std::string numbers(const Entry &entry, const Sphere &sphere) {
    const glm::dvec3 p = sphere.at - origin_;
    unsheathed_ += !entry.axon && sphere.inner < sphere.outer;
    char line[160];
    std::snprintf(line, sizeof line, " %.6g %.6g %.6g %.6g %.6g\n", p.x, p.y, p.z,
                  entry.axon ? sphere.inner : sphere.outer, sphere.outer);
    return line;
  }
  std::size_t axons() const {
    return static_cast<std::size_t>(
        std::count_if(entries_.begin(), entries_.end(), [](const Entry &entry) { return entry.axon; }));
  }

  Job &job_;
  const glm::dvec3 origin_;
  View<float> inner_;
  View<std::uint64_t> offset_;
  std::vector<Entry> entries_;
  std::vector<Ball> balls_;
  std::size_t outside_ = 0, unsheathed_ = 0;
};

} // namespace

void export_caterpillar(Job &job) {
  job.cells_are = job.options.whole ? "whole, as they are stored"
                                    : "all their images that meet the box, each connected piece as a cell";
  Table table(job);
  table.gather();
  table.write_table();
  table.write_cells();
  table.write_info();
  table.warn();
}

} // namespace conceg::exporting
