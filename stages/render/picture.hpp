// SPDX-License-Identifier: BSD-3-Clause
// The finished pictures: a plot with a column beside it that holds the legend, a scale bar and the direction
// of the pia.
#pragma once

#include "cut.hpp"
#include "image.hpp"
#include "raycast.hpp"

namespace conceg::rendering {

struct PictureOptions {
  int size_px = 1200; // of the longer side
  int samples = 4;    // per pixel; the next square is taken
  double azimuth_deg = 35.0, elevation_deg = 22.0;
  int cut_axis = 1;          // 0 x, 1 y, 2 z
  double cut_position = 0.5; // share of the bounds
};

Image picture_of_cells(const Scene &scene, const PictureOptions &options, Workers &workers,
                       const Progress &progress);
Image picture_of_cut(const Scene &scene, const PictureOptions &options, Workers &workers,
                     const Progress &progress);

// The longest of 1, 2, 5 x 10^k um that is not longer than `longest_um`.
double scale_bar_um(double longest_um);

} // namespace conceg::rendering
