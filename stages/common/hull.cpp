// SPDX-License-Identifier: BSD-3-Clause
// The convex hull by Qhull (Barber, Dobkin, Huhdanpaa 1996).
#include "metrics.hpp"

#include <libqhull_r/qhull_ra.h>

#include <cstdio>

namespace conceg::metrics {

double hull_volume(const std::vector<glm::dvec3> &points, std::vector<glm::dvec3> *corners) {
  if (corners) *corners = points;
  if (points.size() < 4) return 0.0;
  qhT hull;
  QHULL_LIB_CHECK
  std::FILE *const silent = std::fopen("/dev/null", "w"); // flat sets are reported in many lines otherwise
  if (!silent) return 0.0;
  qh_zero(&hull, silent);
  std::vector<coordT> coordinates;
  coordinates.reserve(3 * points.size());
  for (const glm::dvec3 &p : points)
    coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
  double volume = 0.0;
  char command[] = "qhull FA Pp";
  if (qh_new_qhull(&hull, 3, static_cast<int>(points.size()), coordinates.data(), False, command, nullptr,
                   silent) == 0) {
    qh_getarea(&hull, hull.facet_list);
    volume = hull.totvol;
    if (corners) {
      corners->clear();
      for (const vertexT *v = hull.vertex_list; v && v->next; v = v->next)
        corners->emplace_back(v->point[0], v->point[1], v->point[2]);
    }
  }
  int unfreed = 0, blocks = 0;
  qh_freeqhull(&hull, !qh_ALL);
  qh_memfreeshort(&hull, &unfreed, &blocks);
  std::fclose(silent);
  return volume;
}

} // namespace conceg::metrics
