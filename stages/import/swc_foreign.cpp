// SPDX-License-Identifier: BSD-3-Clause
// Plain SWC files of any origin -> their cells, where they stand.
#include "swc_files.hpp"

#include <algorithm>
#include <cstring>

namespace conceg::importing {
namespace {

// A type-4 sample makes a pyramidal cell, a process of type 7 a glial one; the rest is other.
std::string class_of(const SwcFile &file, const Request &request) {
  if (!request.cell_class.empty()) return request.cell_class;
  const std::int32_t *kind = conceg_swc_kind(file.swc.get());
  const std::uint64_t count = conceg_swc_count(file.swc.get());
  for (std::uint64_t i = 0; i < count; i++)
    if (kind[i] == CONCEG_SWC_APICAL) return "pyramidal";
  return std::any_of(kind, kind + count, [](std::int32_t k) { return k == CONCEG_SWC_GLIA; }) ? "astrocyte"
                                                                                              : "other";
}

// Row of each point's root.
std::vector<std::size_t> roots_of(const conceg_swc *swc) {
  std::vector<std::size_t> root(conceg_swc_count(swc));
  for (std::size_t i = 0; i < root.size(); i++) {
    const std::int64_t parent = conceg_swc_parent(swc)[i];
    root[i] = parent < 0 ? i : root[static_cast<std::size_t>(parent)];
  }
  return root;
}

double radius_of(const SwcFile &file, std::uint64_t i, const Request &request, std::size_t &raised) {
  double r = conceg_swc_radius(file.swc.get())[i];
  if (!(r > 0.0) && !(request.radius_min_um > 0.0))
    fail(CONCEG_E_RANGE,
         "%s:%u: expected a radius above 0, got %g; give --radius-min-um, or mend the file with conceg swc "
         "repair",
         file.path.c_str(), conceg_swc_line(file.swc.get())[i], r);
  if (r < request.radius_min_um) r = request.radius_min_um, raised++;
  return r;
}

// The cells of a file: one, or with `roots_are_cells` one of the soma and one of each tree that is not on it.
void add_cells(Scene &scene, const SwcFile &file, const Request &request, std::size_t &raised) {
  const conceg_swc *swc = file.swc.get();
  const std::string cell_class = class_of(file, request);
  const bool glia = cell_class == "astrocyte" || cell_class == "microglia";
  SceneCell first;
  first.type = first.cell_class = cell_class;
  const bool has_soma = conceg_swc_soma(swc, &first.soma.x, &first.soma_radius) != CONCEG_SOMA_NONE;
  first.soma_radius = has_soma ? std::max(0.0, first.soma_radius) : 0.0;
  const double *position = conceg_swc_position(swc);
  const std::uint64_t count = conceg_swc_count(swc);
  if (!has_soma && count) first.soma = {position[0], position[1], position[2]};

  const std::vector<std::size_t> root = roots_of(swc);
  std::vector<SceneCell> cells = {first};
  std::vector<std::size_t> cell_of_root(count, 0);
  std::vector<std::int64_t> row(count); // of each point within its cell
  for (std::size_t i = 0; i < count; i++) {
    const bool begins = root[i] == i && request.roots_are_cells && !(has_soma && conceg_swc_on_soma(swc)[i]);
    if (begins && (has_soma || i > 0)) {
      cell_of_root[i] = cells.size();
      cells.push_back(first);
      cells.back().soma_radius = 0.0,
      cells.back().soma = {position[3 * i], position[3 * i + 1], position[3 * i + 2]};
    }
    SceneCell &cell = cells[cell_of_root[root[i]]];
    const std::int64_t parent = conceg_swc_parent(swc)[i];
    row[i] = static_cast<std::int64_t>(cell.position.size());
    cell.radius.push_back(radius_of(file, i, request, raised));
    cell.position.emplace_back(position[3 * i], position[3 * i + 1], position[3 * i + 2]);
    cell.parent.push_back(parent < 0 ? -1 : row[static_cast<std::size_t>(parent)]);
    const int code = conceg_swc_kind(swc)[i];
    cell.kind.push_back(static_cast<std::uint8_t>(code == 2 || code == 4 || code == 7 ? code : glia ? 7 : 3));
  }
  std::move(cells.begin(), cells.end(), std::back_inserter(scene.cells));
}

} // namespace

Scene read_foreign_swc(const std::vector<SwcFile> &files, const Request &request) {
  Scene scene;
  std::size_t raised = 0;
  for (const SwcFile &file : files)
    add_cells(scene, file, request, raised);
  if (raised)
    conceg_ctx_log(request.ctx, CONCEG_LOG_WARNING, "import: %zu radii below %g um were raised to it", raised,
                   request.radius_min_um);
  return scene;
}

void import_swc(const Request &request, conceg_doc *doc, bool *restored) {
  std::vector<SwcFile> files =
      read_files(request.ctx, find_files(request.names, {".swc"}), request.swc_flags);
  const bool blocks =
      std::any_of(files.begin(), files.end(), [](const SwcFile &file) { return file.blocks.present; });
  if (blocks && request.box_um > 0.0)
    fail(CONCEG_E_PARAM, "box_um: %s and its like carry the box of their document; leave box_um out",
         files[0].path.c_str());
  if (blocks) {
    *restored = restore_document(request.ctx, doc, files);
    return;
  }
  Scene scene = read_foreign_swc(files, request);
  if (request.box_um > 0.0) scene.corner_box(request.box_um);
  check_frame(scene, files[0].path, "the files are taken to be in um and --box-um to begin at the origin");
  write_document(request.ctx, doc, scene, request.margin_um);
}

} // namespace conceg::importing
