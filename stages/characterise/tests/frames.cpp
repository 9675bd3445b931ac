// SPDX-License-Identifier: BSD-3-Clause
// The pia frames of the default dictionary against the reconstructions themselves, read by the library: in
// its frame the mean apical direction of every pyramidal donor points to +z.
#include "check.h"

#include "view.hpp"

#include "conceg/conceg.h"

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

using namespace conceg;

namespace {

// Cosine between +z and the mean vector from the soma to the apical cable, each segment by its length, after
// the rotation w x y z, given as a matrix.
double z_cosine(const conceg_swc *swc, const double *q) {
  const double *at = conceg_swc_position(swc), *soma;
  double center[3], radius, mean[3] = {0, 0, 0};
  conceg_swc_soma(swc, center, &radius);
  soma = center;
  for (std::uint64_t i = 0; i < conceg_swc_count(swc); i++) {
    const std::int64_t up = conceg_swc_parent(swc)[i];
    if (up < 0 || conceg_swc_kind(swc)[i] != 4) continue;
    const double *a = at + 3 * up, *b = at + 3 * i;
    const double length = std::sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
                                    (b[2] - a[2]) * (b[2] - a[2]));
    for (int axis = 0; axis < 3; axis++)
      mean[axis] += length * (0.5 * (a[axis] + b[axis]) - soma[axis]);
  }
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double up =
      2 * (x * z - w * y) * mean[0] + 2 * (y * z + w * x) * mean[1] + (1 - 2 * (x * x + y * y)) * mean[2];
  return up / std::sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
}

// File of each donor, by its id, from the table.
std::map<std::string, std::string> files() {
  std::map<std::string, std::string> out;
  std::ifstream in(CONCEG_DATA "/mouse-visual-cortex.csv");
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    std::string file, entry, cell_class, id;
    std::getline(fields, file, ','), std::getline(fields, entry, ','), std::getline(fields, cell_class, ',');
    if (std::getline(fields, id, ',') && cell_class == "pyramidal" && !file.empty()) out[id] = file;
  }
  return out;
}

} // namespace

int main() {
  if (!check_shared()) SKIP("CONCEG_SHARED is not set: no reconstructions");
  const std::string cells = std::string(check_shared()) + "/morphologies/";
  if (!std::ifstream(cells + "mouse_vis_L4_pyr/313862022.swc"))
    SKIP("no reconstructions in CONCEG_SHARED/morphologies");
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = nullptr;
  CHECK_EQUAL(conceg_doc_open(ctx, CONCEG_DATA "/mouse-visual-cortex.cgx", &doc), CONCEG_OK);
  const std::map<std::string, std::string> file_of = files();
  const std::vector<std::string> id = texts(doc, "/dictionary/donor_id");
  const View<double> frame = view<double>(doc, "/dictionary/donor_frame", 4);
  const double unturned[4] = {1, 0, 0, 0};
  std::size_t checked = 0, up_already = 0;
  double lowest = 1.0;
  for (std::size_t donor = 0; donor < id.size(); donor++) {
    const auto found = file_of.find(id[donor]);
    if (found == file_of.end()) continue;
    conceg_swc *swc = nullptr;
    CHECK_EQUAL(conceg_swc_read(ctx, (cells + found->second).c_str(), 0, &swc), CONCEG_OK);
    const double cosine = z_cosine(swc, frame.row(donor));
    CHECK(cosine > 0.99);
    lowest = std::min(lowest, cosine), checked++;
    up_already += z_cosine(swc, unturned) > 0.99;
    conceg_swc_free(swc);
  }
  CHECK_EQUAL(checked, 42 + 10);
  CHECK(up_already < 5); // without the rotation the check fails
  printf("%zu pyramidal donors: lowest z-cosine of the mean apical direction %.6f\n", checked, lowest);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return check_done();
}
