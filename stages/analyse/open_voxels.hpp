// SPDX-License-Identifier: BSD-3-Clause
// A medium of voxels, each open or closed, and the ways from a voxel to those around it.
#pragma once

#include "parallel.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace conceg::analyse {

// Voxels of a box, z fastest; 1 = open. At most 2^32 - 1 of them.
struct OpenVoxels {
  std::array<std::size_t, 3> shape;
  std::vector<std::uint8_t> open;
  std::array<double, 3> spacing;                       // um
  std::array<bool, 3> periodic = {{true, true, true}}; // else nothing is known beyond the faces of that axis
};

double largest_spacing(const OpenVoxels &voxels);
double open_fraction(const OpenVoxels &voxels);
// Of about one size along the axes that have more than one voxel: what distances on them need.
bool isotropic(const OpenVoxels &voxels);

// Voxels of twice the size, each of which is open where most of its eight are (the lowest one decides between
// halves). All sides must be even.
OpenVoxels coarser(const OpenVoxels &voxels);

// One plane of the medium across an axis, as a medium of its own.
OpenVoxels section(const OpenVoxels &voxels, std::size_t axis, std::size_t at);

// Pieces of the open voxels that hang together over faces.
struct OpenPieces {
  std::uint64_t pieces = 0;
  double largest = 0; // share of the open voxels that the largest holds
};
OpenPieces open_pieces(const OpenVoxels &voxels);

// Steps from voxel to voxel: offsets in the array, worked out once for voxels that are not near a face.
class Steps {
public:
  static constexpr std::size_t outside = std::numeric_limits<std::size_t>::max();
  using Step = std::array<long, 3>;

  // `reach`: the longest step along an axis.
  Steps(const OpenVoxels &voxels, std::vector<Step> steps, long reach);
  // All steps of at most one voxel along each axis that has several, over at most that many axes.
  static std::vector<Step> around(const OpenVoxels &voxels, long most_axes);

  std::size_t count() const { return step_.size(); }
  const Step &step(std::size_t k) const { return step_[k]; }
  double length(std::size_t k) const { return length_[k]; } // um
  bool near_face(std::size_t i) const { return near_face_[i] != 0; }
  // The voxel that step k leads to from voxel i; `outside` beyond a face that is not periodic.
  std::size_t to(std::size_t i, std::size_t k) const {
    return near_face_[i] ? over_faces(i, step_[k]) : i + static_cast<std::size_t>(offset_[k]);
  }
  std::size_t over_faces(std::size_t i, const Step &by) const;

  // visit(voxel, number of the step) for all steps that stay inside.
  template <class Visit> void from(std::size_t i, const Visit &visit) const {
    for (std::size_t k = 0; k < step_.size(); k++)
      if (const std::size_t j = to(i, k); j != outside) visit(j, k);
  }

private:
  std::array<std::size_t, 3> shape_;
  std::array<bool, 3> periodic_;
  std::vector<Step> step_;
  std::vector<long> offset_;
  std::vector<double> length_;
  std::vector<std::uint8_t> near_face_;
};

} // namespace conceg::analyse
