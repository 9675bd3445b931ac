// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "image.hpp"

namespace conceg::rendering {

// Writes an 8-bit RGB PNG, whole or not at all; E_IO with the path.
void write_png(const std::string &path, const Image &image);

} // namespace conceg::rendering
