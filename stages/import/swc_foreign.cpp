// SPDX-License-Identifier: BSD-3-Clause
// Plain SWC files of any origin -> a document of their cells, where they stand.
#include "swc_files.hpp"

#include "conceg/geom.h"
#include "view.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace conceg::importing {
namespace {

// A type-4 sample makes a pyramidal cell, a process of type 7 a glial one; the rest is other.
std::string class_of(const SwcFile &file, const ForeignOptions &options) {
  if (!options.cell_class.empty()) return options.cell_class;
  const std::int32_t *kind = conceg_swc_kind(file.swc.get());
  const std::uint64_t count = conceg_swc_count(file.swc.get());
  for (std::uint64_t i = 0; i < count; i++)
    if (kind[i] == CONCEG_SWC_APICAL) return "pyramidal";
  return std::any_of(kind, kind + count, [](std::int32_t k) { return k == CONCEG_SWC_GLIA; }) ? "astrocyte"
                                                                                              : "other";
}

bool is_glia(const std::string &cell_class) {
  return cell_class == "astrocyte" || cell_class == "microglia";
}

struct Tissue {
  std::vector<std::string> type;
  std::vector<std::uint64_t> id, placed, cell_offset{0};
  std::vector<std::uint32_t> cell_type, branch, tree;
  std::vector<double> soma, position;
  std::vector<float> soma_radius, radius;
  std::vector<std::int64_t> parent;
  std::vector<std::uint8_t> kind;
  std::size_t raised = 0;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  void include(const double *point, double r) {
    for (int axis = 0; axis < 3; axis++)
      low[axis] = std::min(low[axis], point[axis] - r), high[axis] = std::max(high[axis], point[axis] + r);
  }
};

std::uint32_t type_row(Tissue &tissue, const std::string &name) {
  const auto found = std::find(tissue.type.begin(), tissue.type.end(), name);
  if (found != tissue.type.end()) return static_cast<std::uint32_t>(found - tissue.type.begin());
  tissue.type.push_back(name), tissue.placed.push_back(0);
  return static_cast<std::uint32_t>(tissue.type.size() - 1);
}

void add_points(Tissue &tissue, const SwcFile &file, bool glia, const ForeignOptions &options) {
  const conceg_swc *swc = file.swc.get();
  const std::uint64_t count = conceg_swc_count(swc);
  const double *position = conceg_swc_position(swc), *radius = conceg_swc_radius(swc);
  const std::int64_t *parent = conceg_swc_parent(swc);
  std::vector<std::uint32_t> children(count, 0), branch(count), tree(count);
  for (std::uint64_t i = 0; i < count; i++)
    if (parent[i] >= 0) children[static_cast<std::size_t>(parent[i])]++;
  std::uint32_t branches = 0, trees = 0;
  for (std::uint64_t i = 0; i < count; i++) {
    double r = radius[i];
    if (!(r > 0.0) && !(options.radius_min_um > 0.0))
      fail(CONCEG_E_RANGE,
           "%s:%u: expected a radius above 0, got %g; give --radius-min-um, or mend the file with conceg swc "
           "repair",
           file.path.c_str(), conceg_swc_line(swc)[i], r);
    if (r < options.radius_min_um) r = options.radius_min_um, tissue.raised++;
    const auto up = static_cast<std::size_t>(parent[i]);
    const bool root = parent[i] < 0;
    branch[i] = root || children[up] > 1 ? branches++ : branch[up];
    tree[i] = root ? trees++ : tree[up];
    const int code = conceg_swc_kind(swc)[i];
    tissue.position.insert(tissue.position.end(), position + 3 * i, position + 3 * i + 3);
    tissue.radius.push_back(static_cast<float>(r));
    tissue.parent.push_back(root ? -1 : parent[i]);
    tissue.kind.push_back(static_cast<std::uint8_t>(code == 2 || code == 4 || code == 7 ? code
                                                    : glia                              ? 7
                                                                                        : 3));
    tissue.branch.push_back(branch[i]), tissue.tree.push_back(tree[i]);
    tissue.include(position + 3 * i, r);
  }
  tissue.cell_offset.push_back(tissue.radius.size());
}

void add_cell(Tissue &tissue, const SwcFile &file, const ForeignOptions &options) {
  const std::string cell_class = class_of(file, options);
  double center[3] = {0, 0, 0}, r = 0.0;
  const conceg_swc *swc = file.swc.get();
  if (conceg_swc_soma(swc, center, &r) == CONCEG_SOMA_NONE) {
    r = 0.0;
    if (conceg_swc_count(swc)) std::copy(conceg_swc_position(swc), conceg_swc_position(swc) + 3, center);
  }
  const std::uint32_t type = type_row(tissue, cell_class);
  tissue.placed[type]++;
  tissue.id.push_back(tissue.id.size()), tissue.cell_type.push_back(type);
  tissue.soma.insert(tissue.soma.end(), center, center + 3),
      tissue.soma_radius.push_back(static_cast<float>(std::max(0.0, r)));
  tissue.include(center, r);
  add_points(tissue, file, is_glia(cell_class), options);
}

// The box on the lattice of the format, with the margin on each side; open on all.
void write_domain(conceg_doc *doc, const Tissue &tissue, double margin) {
  static const std::uint8_t periodic[3] = {0, 0, 0};
  static const double pia[3] = {0, 0, 1};
  double lo[3], hi[3];
  for (int axis = 0; axis < 3; axis++) {
    lo[axis] = std::floor(tissue.low[axis] - margin), hi[axis] = std::ceil(tissue.high[axis] + margin);
    if (!(hi[axis] > lo[axis])) hi[axis] = lo[axis] + 1.0;
  }
  put(doc, "/domain@lo", lo, 3), put(doc, "/domain@hi", hi, 3), put(doc, "/domain@periodic", periodic, 3),
      put(doc, "/domain@pia", pia, 3);
  put_scalar(doc, "/domain@lattice_step", CONCEG_LATTICE_STEP_UM);
}

} // namespace

void make_document(conceg_ctx *ctx, conceg_doc *doc, const std::vector<SwcFile> &files,
                   const ForeignOptions &options) {
  Tissue tissue;
  for (const SwcFile &file : files)
    add_cell(tissue, file, options);
  if (tissue.raised)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "import: %zu radii below %g um were raised to it", tissue.raised,
                   options.radius_min_um);
  write_domain(doc, tissue, options.margin_um);
  put_texts(doc, "/types/name", tissue.type);
  put_texts(doc, "/types/class", tissue.type);
  put(doc, "/types/placed", tissue.placed);
  put(doc, "/cells/id", tissue.id), put(doc, "/cells/type", tissue.cell_type);
  put(doc, "/cells/soma", tissue.soma, 3), put(doc, "/cells/radius", tissue.soma_radius);
  put(doc, "/skeleton/cell_offset", tissue.cell_offset), put(doc, "/skeleton/position", tissue.position, 3);
  put(doc, "/skeleton/radius", tissue.radius), put(doc, "/skeleton/target_radius", tissue.radius);
  put(doc, "/skeleton/parent", tissue.parent), put(doc, "/skeleton/kind", tissue.kind);
  put(doc, "/skeleton/branch", tissue.branch), put(doc, "/skeleton/tree", tissue.tree);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "import: %zu cells, %zu points", files.size(), tissue.radius.size());
}

} // namespace conceg::importing
