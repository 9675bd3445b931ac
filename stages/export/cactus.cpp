// SPDX-License-Identifier: BSD-3-Clause
// CACTUS strand list: side of the box, number of strands, for each its number of points and rows "x y z r",
// centred, um. A strand has no branches: a cell gives one for its soma and one for each run between forks,
// and strands.csv says which is which. Its mesher refuses strands of fewer than 4 points, so that segments of
// short runs are divided; the shape stays. CACTUS knows no periodic box: it grows strands in the voxel with
// 5 um around and clears what lies outside, so that all images which meet that cube are written, or on
// request the strands as they are stored.
#include "job.hpp"
#include "tile.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::exporting {
namespace {

constexpr std::size_t least_points = 4;
constexpr double grown_around_um = 5.0; // CACTUS grows in the voxel of side L + 10 um

struct Strand {
  std::vector<glm::dvec3> position;
  std::vector<double> radius;
};

// Points first to last of a strand, moved by whole sides of the box.
struct Image {
  Strand strand;
  std::size_t first, last;
  glm::ivec3 lift;
};

// Whether the round cone between two balls meets the box with the rim around along its periodic axes. What
// says that the ball at t stays clear of a side is linear in t, as its place and radius are.
bool meets(const conceg_box &box, const glm::dvec3 &a, double radius_a, const glm::dvec3 &b,
           double radius_b) {
  double from = 0.0, to = 1.0;
  for (int axis = 0; axis < 3; axis++) {
    if (!box.periodic[axis]) continue;
    const double low = box.lo[axis] - grown_around_um, high = box.hi[axis] + grown_around_um;
    const double within[2][2] = {{a[axis] + radius_a - low, b[axis] + radius_b - low},
                                 {high - a[axis] + radius_a, high - b[axis] + radius_b}};
    for (const double(&at)[2] : within) {
      if (at[0] <= 0.0 && at[1] <= 0.0) return false;
      if (at[0] < 0.0) from = std::max(from, at[0] / (at[0] - at[1]));
      if (at[1] < 0.0) to = std::min(to, at[0] / (at[0] - at[1]));
    }
  }
  return from < to;
}

// The longest parts of a strand of which every segment meets the box, at each image.
std::vector<Image> images_of(const Strand &whole, const conceg_box &box) {
  glm::dvec3 low = whole.position[0], high = low;
  for (std::size_t i = 0; i < whole.position.size(); i++)
    low = glm::min(low, whole.position[i] - whole.radius[i] - grown_around_um),
    high = glm::max(high, whole.position[i] + whole.radius[i] + grown_around_um);
  std::vector<Image> images;
  for_each_lift(box, low, high, [&](const glm::ivec3 &lift) {
    const glm::dvec3 shift = glm::dvec3(lift) * side(box);
    bool going_on = false;
    for (std::size_t i = 1; i < whole.position.size(); i++) {
      const glm::dvec3 a = whole.position[i - 1] + shift, b = whole.position[i] + shift;
      if (!meets(box, a, whole.radius[i - 1], b, whole.radius[i])) {
        going_on = false;
        continue;
      }
      if (!going_on) images.push_back({{{a}, {whole.radius[i - 1]}}, i - 1, i, lift});
      going_on = true;
      images.back().strand.position.push_back(b), images.back().strand.radius.push_back(whole.radius[i]);
      images.back().last = i;
    }
  });
  return images;
}

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

class StrandFile {
public:
  explicit StrandFile(Job &job)
      : job_(job), box_(job.source.box()),
        centre_(0.5 * glm::dvec3(box_.lo[0] + box_.hi[0], box_.lo[1] + box_.hi[1], box_.lo[2] + box_.hi[2])) {
  }

  // A strand of a cell, whole or at all its images; `points` are the numbers of its points in the cell. One
  // that came as a strand stays as it is.
  void add(const Cell &cell, const Strand &strand, bool whole, bool came_as_strand,
           const std::string &section, const std::vector<std::uint32_t> &points) {
    std::vector<Image> images;
    if (whole)
      images.push_back({strand, 0, strand.position.size() - 1, glm::ivec3(0)});
    else
      images = images_of(strand, box_);
    for (Image &image : images) {
      if (!(came_as_strand && image.strand.position.size() == strand.position.size())) divide(image.strand);
      row(cell, image, section, points);
    }
  }

  void write() {
    const glm::dvec3 sides = side(box_);
    job_.text_file("cactus/strands.txt", "strands",
                   number_text(std::max({sides.x, sides.y, sides.z})) + "\n" + std::to_string(strands_) +
                       "\n" + rows_);
    job_.text_file("cactus/strands.csv", "table", table_);
    if (short_)
      conceg_ctx_log(job_.ctx, CONCEG_LOG_WARNING,
                     "cactus: %zu of %zu strands have fewer than %zu points, as they came; the growth of "
                     "CACTUS takes them, its quick-mesh does not",
                     short_, strands_, least_points);
  }

private:
  void row(const Cell &cell, const Image &image, const std::string &section,
           const std::vector<std::uint32_t> &points) {
    const Strand &strand = image.strand;
    rows_ += std::to_string(strand.position.size()) + "\n";
    for (std::size_t i = 0; i < strand.position.size(); i++) {
      const glm::dvec3 p = strand.position[i] - centre_;
      rows_ += number_text(p.x) + " " + number_text(p.y) + " " + number_text(p.z) + " " +
               number_text(strand.radius[i]) + "\n";
    }
    short_ += strand.position.size() < least_points;
    table_ += std::to_string(strands_++) + "," + std::to_string(cell.row) + "," + std::to_string(cell.id) +
              "," + quoted_csv(cell.type_name) + "," + section + ",";
    if (points.empty())
      table_ += ",";
    else // a root of one point stands at both ends of its strand
      table_ += std::to_string(points[std::min(image.first, points.size() - 1)]) + "," +
                std::to_string(points[std::min(image.last, points.size() - 1)]);
    for (int axis = 0; axis < 3; axis++)
      table_ += "," + std::to_string(image.lift[axis]);
    table_ += "\n";
  }

  Job &job_;
  const conceg_box &box_;
  const glm::dvec3 centre_;
  std::string rows_, table_ = "strand,cell,id,type,section,first_point,last_point,lift_x,lift_y,lift_z\n";
  std::size_t strands_ = 0, short_ = 0;
};

} // namespace

void export_cactus(Job &job) {
  const conceg_box &box = job.source.box();
  const bool whole = job.options.whole || !(box.periodic[0] || box.periodic[1] || box.periodic[2]);
  job.cells_are = whole ? "whole, as they are stored" : "all their images that meet the box with 5 um around";
  StrandFile file(job);
  for (const Cell &cell : job.cells) {
    if (cell.soma_radius > 0.0) file.add(cell, ball(cell.soma, cell.soma_radius), whole, false, "soma", {});
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
      const bool came_as_strand = !(cell.soma_radius > 0.0) && lists.size() == 1;
      file.add(cell, strand, whole, came_as_strand, std::to_string(section), lists[section]);
    }
  }
  file.write();
}

} // namespace conceg::exporting
