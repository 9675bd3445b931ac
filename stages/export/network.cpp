// SPDX-License-Identifier: BSD-3-Clause
// The node network as two plain tables, as import reads them: each edge once.
#include "job.hpp"
#include "view.hpp"

namespace conceg::exporting {

void export_network(Job &job) {
  const View<double> position = view<double>(job.doc, "/network/position", 3);
  const View<float> radius = view<float>(job.doc, "/network/radius");
  const View<std::uint64_t> offset = view<std::uint64_t>(job.doc, "/network/edge_offset");
  const View<std::uint32_t> edge = view<std::uint32_t>(job.doc, "/network/edge");
  View<std::int8_t> shift;
  if (has(job.doc, "/network/edge_shift")) shift = view<std::int8_t>(job.doc, "/network/edge_shift", 3);
  if (radius.rows() != position.rows() || offset.rows() != position.rows() + 1 ||
      offset[position.rows()] != edge.rows() || (shift.data() && shift.rows() != edge.rows()))
    fail(CONCEG_E_FORMAT, "/network: arrays of different lengths");
  const conceg_box &box = job.source.box();
  std::string nodes = "# box_um", edges = "# i j shift of j in box sides\n";
  for (const double *corner : {box.lo, box.hi})
    for (int axis = 0; axis < 3; axis++)
      nodes += " " + number_text(corner[axis]);
  nodes += " periodic";
  for (int axis = 0; axis < 3; axis++)
    nodes += box.periodic[axis] ? " 1" : " 0";
  nodes += "\n# id x y z rmax, um\n";
  for (std::size_t i = 0; i < position.rows(); i++) {
    const double *p = position.row(i);
    nodes += std::to_string(i) + " " + number_text(p[0]) + " " + number_text(p[1]) + " " + number_text(p[2]) +
             " " + number_text(static_cast<double>(radius[i])) + "\n";
    if (offset[i] > offset[i + 1] || offset[i + 1] > edge.rows())
      fail(CONCEG_E_FORMAT, "/network/edge_offset[%zu]: expected offsets that never fall", i + 1);
    for (std::uint64_t e = offset[i]; e < offset[i + 1]; e++) {
      static const std::int8_t none[3] = {0, 0, 0};
      const std::int8_t *s = shift.data() ? shift.row(e) : none;
      // Both directions are stored; the one from the lower row is taken, and of a node's own images the upper
      // one.
      const bool forward = s[0] > 0 || (s[0] == 0 && (s[1] > 0 || (s[1] == 0 && s[2] > 0)));
      if (edge[e] < i || (edge[e] == i && !forward)) continue;
      edges += std::to_string(i) + " " + std::to_string(edge[e]) + " " + std::to_string(s[0]) + " " +
               std::to_string(s[1]) + " " + std::to_string(s[2]) + "\n";
    }
  }
  job.text_file("network/nodes.txt", "network", nodes);
  job.text_file("network/edges.txt", "network", edges);
}

} // namespace conceg::exporting
