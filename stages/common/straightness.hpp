// SPDX-License-Identifier: BSD-3-Clause
// Straightness of a branch: end-to-end distance over path length. Donors and synthetic cells are judged by
// this one function.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <vector>

namespace conceg {

// Path length of a line resampled every `step_um` along its path, fed point by point.
class ResampledPath {
public:
  ResampledPath(const glm::dvec3 &start, double step_um)
      : start_(start), end_(start), last_(start), step_(step_um), next_(step_um) {}
  void add(const glm::dvec3 &point) {
    const glm::dvec3 edge = point - end_;
    const double length = glm::length(edge);
    for (; length > 0.0 && next_ <= along_ + length; next_ += step_) {
      const glm::dvec3 sample = end_ + edge * ((next_ - along_) / length);
      path_ += glm::length(sample - last_);
      last_ = sample;
    }
    along_ += length;
    end_ = point;
  }
  // End-to-end / path, in [0, 1]; 1 for a line without length.
  double straightness() const {
    const double path = path_ + glm::length(end_ - last_);
    return path > 0.0 ? std::min(1.0, glm::length(end_ - start_) / path) : 1.0;
  }

private:
  glm::dvec3 start_, end_, last_;
  double step_, next_, along_ = 0.0, path_ = 0.0;
};

// Of a line resampled at `step_um` along its path, in [0, 1]; 1 for a line without length.
inline double straightness(const std::vector<glm::dvec3> &line, double step_um) {
  if (line.size() < 2) return 1.0;
  ResampledPath path(line.front(), step_um);
  for (std::size_t i = 1; i < line.size(); i++)
    path.add(line[i]);
  return path.straightness();
}

} // namespace conceg
