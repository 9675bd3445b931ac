// SPDX-License-Identifier: BSD-3-Clause
// NumPy's files: an array of whole numbers in a .npy, or in a .npz (a ZIP of .npy, stored or deflated).
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace conceg::importing {

// Whole numbers of 1, 2, 4 or 8 bytes on up to three axes, as they lie in the file.
struct NpyArray {
  std::string bytes;                   // of the values alone
  std::array<std::uint64_t, 3> shape;  // values along each axis; 1 beyond the array's own axes
  std::array<std::uint64_t, 3> stride; // in values
  std::uint32_t width;                 // bytes of a value
  bool is_signed, big_endian;
  std::string where; // "FILE" or "FILE: NAME.npy", for messages

  std::uint64_t at(std::uint64_t x, std::uint64_t y, std::uint64_t z) const; // refuses negative values
};

// `bytes` of a .npy file of formats 1 to 3, in C or Fortran order. E_FORMAT for anything else than whole
// numbers on two or three axes, and where the values are not exactly as many as the shape says.
NpyArray parse_npy(std::string bytes, const std::string &where);

// The .npy of that name in a .npz; "" = the only one, or `labels`. `most_bytes`: larger ones are refused.
NpyArray parse_npz(const std::string &bytes, const std::string &path, const std::string &name,
                   double most_bytes);

// By the first bytes of the file.
NpyArray parse_numpy(std::string bytes, const std::string &path, const std::string &name, double most_bytes);

} // namespace conceg::importing
