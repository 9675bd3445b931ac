// SPDX-License-Identifier: BSD-3-Clause
// Composition scaling (the paper's section on structural validation, after Ansell and Kovacs 2024): how the
// volume of the largest piece of one cell in a sampling cube grows with the side of the cube.
#pragma once

#include "field.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <functional>
#include <vector>

namespace conceg::analyse {

// Rows of voxels along z as runs of one label; label 0 is left out.
class LabelRuns {
public:
  struct Run {
    std::uint32_t begin, end, label;
  };
  // `label` of voxel (x, y, z); called once for each voxel, rows by several workers.
  using LabelOf = std::function<std::uint32_t(std::uint32_t x, std::uint32_t y, std::uint32_t z)>;
  LabelRuns(const std::array<std::uint32_t, 3> &shape, const LabelOf &label, Workers &workers);
  // The labels of /volumes.
  LabelRuns(const LabelVolume &volume, Workers &workers);

  const std::array<std::uint32_t, 3> &shape() const { return shape_; }
  const Run *begin(std::uint32_t x, std::uint32_t y) const { return run_.data() + offset_[row(x, y)]; }
  const Run *end(std::uint32_t x, std::uint32_t y) const { return run_.data() + offset_[row(x, y) + 1]; }

private:
  void fill(const LabelOf &label, Workers &workers);
  std::size_t row(std::uint32_t x, std::uint32_t y) const {
    return static_cast<std::size_t>(x) * shape_[1] + y;
  }
  std::array<std::uint32_t, 3> shape_;
  std::vector<std::uint64_t> offset_;
  std::vector<Run> run_;
};

// Voxels of the largest piece in a cube, by both conventions for a cell that enters it in several places.
struct Largest {
  std::uint64_t fragment = 0; // 26-connected within the cube
  std::uint64_t cell = 0;     // all voxels of one label
};

// The cube of `side` voxels with its lowest corner at `corner`, which wraps round periodic axes; a side may
// not be longer than the volume's. Reads only: any thread.
Largest largest_piece(const LabelRuns &runs, const std::array<std::uint32_t, 3> &corner,
                      const std::array<std::uint32_t, 3> &side);

// One sampling length. Volumes in um3; the logarithmic mean leaves out cubes without any cell.
struct ScaleRow {
  double side = 0; // um, of whole voxels
  std::uint64_t cubes = 0, empty = 0;
  double fragment_mean = 0, fragment_sd = 0, fragment_geometric_mean = 0, cell_mean = 0, cell_sd = 0,
         cell_geometric_mean = 0;
  double fragment_slope = 0, cell_slope = 0; // d ln(mean) / d ln(side) to the next row; 0 in the last
};

// Exponent d_f of mean = c side^d_f over a range of sides: least squares of the logarithms.
struct ScaleFit {
  double from = 0, to = 0; // um
  std::size_t rows = 0;    // below 3: no fit
  double fragment = 0, fragment_error = 0, cell = 0,
         cell_error = 0; // error: bootstrap over the 8 octants of the box
};

struct Composition {
  std::vector<ScaleRow> rows;
  ScaleFit all, beyond_somas; // from 2 um, and from 15 um: smaller cubes lie inside somas
};

struct CompositionSettings {
  double smallest = 2, largest = 75; // um; at most the shortest side of the box
  int lengths = 12;                  // logarithmically spaced
  int cubes = 200;                   // of each length, at uniformly random places
  std::uint64_t seed = 1;
};

// `spacing` in um. Cubes wrap round periodic axes and stay within open ones. The result does not depend on
// the number of threads. E_RANGE when the box is smaller than twice the smallest length.
Composition composition_of(const LabelRuns &runs, const glm::dvec3 &spacing,
                           const std::array<bool, 3> &periodic, const CompositionSettings &settings,
                           Workers &workers, const Progress &progress);

// Slope of ln(y) on ln(x) by least squares.
double log_slope(const std::vector<double> &x, const std::vector<double> &y);

} // namespace conceg::analyse
