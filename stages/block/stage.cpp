// SPDX-License-Identifier: BSD-3-Clause
// block: descriptor and glue. Cuts a slab out of relaxed skeletons, as a document of its own.
#include "cut.hpp"

#include "conceg/geom.h"
#include "conceg/stage.h"
#include "view.hpp"
#include "wrap.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace {

using namespace conceg;
using namespace conceg::block;

constexpr std::uint64_t kPieceStep = std::uint64_t{1} << 40; // ids of further pieces of a cell

const conceg_param parameters[] = {
    {"lo_um", "um", "lower side of the block along z", "-1e6", nullptr, CONCEG_PARAM_F64, 0, -1e6, 1e6},
    {"hi_um", "um", "upper side of the block along z", "1e6", nullptr, CONCEG_PARAM_F64, 0, -1e6, 1e6},
    {"margin_um", "um", "sections that come as near to the block as this are kept too", "2", nullptr,
     CONCEG_PARAM_F64, 0, 0, 1000},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};

const char *const reads[] = {"domain", "cells", "skeleton", nullptr};
const char *const writes[] = {"domain", "cells", "skeleton", nullptr};
const char *const drops[] = {nullptr};

template <class T> std::vector<T> values(conceg_doc *doc, const char *path) {
  const View<T> all = view<T>(doc, path);
  return std::vector<T>(all.begin(), all.end());
}

// All that is used as an index later on is checked here.
Tissue read_tissue(conceg_doc *doc) {
  Tissue tissue;
  tissue.soma = vec3s<glm::dvec3>(doc, "/cells/soma");
  tissue.soma_radius = values<float>(doc, "/cells/radius");
  tissue.offset = values<std::uint64_t>(doc, "/skeleton/cell_offset");
  tissue.position = vec3s<glm::dvec3>(doc, "/skeleton/position");
  tissue.radius = values<float>(doc, "/skeleton/radius");
  tissue.parent = values<std::int64_t>(doc, "/skeleton/parent");
  if (!has(doc, "/skeleton/branch"))
    fail(CONCEG_E_MISSING, "block: needs /skeleton/branch, which grow and import write");
  tissue.branch = values<std::uint32_t>(doc, "/skeleton/branch");
  const std::size_t cells = tissue.cells(), points = tissue.position.size();
  if (tissue.soma_radius.size() != cells || tissue.offset.size() != cells + 1 || tissue.offset[0] != 0 ||
      tissue.offset[cells] != points || tissue.radius.size() != points || tissue.parent.size() != points ||
      tissue.branch.size() != points)
    fail(CONCEG_E_FORMAT, "/skeleton: expected one offset per cell and one value per point, got arrays of "
                          "other lengths");
  for (std::size_t cell = 0; cell < cells; cell++) {
    if (tissue.offset[cell + 1] < tissue.offset[cell] || tissue.offset[cell + 1] > points)
      fail(CONCEG_E_FORMAT, "/skeleton/cell_offset[%zu]: expected ascending offsets up to %zu", cell, points);
    for (std::uint64_t i = tissue.offset[cell]; i < tissue.offset[cell + 1]; i++)
      if (tissue.parent[i] < -1 || tissue.parent[i] >= static_cast<std::int64_t>(i - tissue.offset[cell]) ||
          !std::isfinite(tissue.position[i].z))
        fail(CONCEG_E_FORMAT,
             "/skeleton[%zu]: expected a finite place, and -1 or an earlier point of the cell as parent",
             static_cast<std::size_t>(i));
  }
  return tissue;
}

struct Block {
  conceg_box box; // of the block
  Slab slab;
};

Block block_of(conceg_doc *doc, const conceg_params *params) {
  Block out = {read_box(doc), {}};
  const double lo = out.box.lo[2], hi = out.box.hi[2],
               low = std::max(lo, conceg_snap(conceg_params_f64(params, "lo_um"))),
               high = std::min(hi, conceg_snap(conceg_params_f64(params, "hi_um")));
  if (!(high - low >= 1.0))
    fail(CONCEG_E_RANGE,
         "block: expected lo_um and hi_um that leave at least 1 um of the box from %g to %g um along z, got "
         "%g "
         "to %g",
         lo, hi, conceg_params_f64(params, "lo_um"), conceg_params_f64(params, "hi_um"));
  const bool whole = low == lo && high == hi;
  out.slab = {low, high, conceg_params_f64(params, "margin_um"),
              out.box.periodic[2] && !whole ? hi - lo : 0.0};
  if (whole) out.slab.lo = -HUGE_VAL, out.slab.hi = HUGE_VAL; // all of every cell, once
  out.box.lo[2] = low, out.box.hi[2] = high;
  if (!whole) out.box.periodic[2] = 0;
  return out;
}

// The place that stands for the piece: its soma, else its first point inside the block, else its first point.
glm::dvec3 place_of(const Tissue &tissue, const Piece &piece, const Block &block) {
  const double shift = piece.lift * block.slab.side;
  glm::dvec3 place = tissue.soma[piece.cell];
  if (!piece.has_soma && !piece.rows.empty()) {
    const std::uint64_t first = tissue.offset[piece.cell];
    const auto inside = std::find_if(piece.rows.begin(), piece.rows.end(), [&](std::uint32_t row) {
      const double z = tissue.position[first + row].z + shift;
      return z >= block.box.lo[2] && z < block.box.hi[2];
    });
    place = tissue.position[first + (inside == piece.rows.end() ? piece.rows[0] : *inside)];
  }
  place.z += shift;
  return place;
}

// Rows of the new document: piece by piece, by id.
struct Rows {
  std::vector<Piece> piece;
  std::vector<std::uint64_t> id;
  std::vector<glm::dvec3> soma; // in the box along x and y
  std::vector<glm::dvec3> move; // of the piece's points
};

Rows rows_of(conceg_doc *doc, const Tissue &tissue, std::vector<Piece> pieces, const Block &block) {
  const View<std::uint64_t> id = view<std::uint64_t>(doc, "/cells/id");
  if (id.rows() != tissue.cells()) fail(CONCEG_E_FORMAT, "/cells/id: expected one id per cell");
  std::vector<std::uint64_t> made(pieces.size()), count(tissue.cells());
  std::vector<std::uint8_t> taken(tissue.cells());
  // The piece with the cell's own soma at its own place keeps the id; the others follow in their order.
  for (std::size_t i = 0; i < pieces.size(); i++) {
    const std::size_t cell = pieces[i].cell;
    const bool own = !taken[cell] && (pieces[i].has_soma || !(tissue.soma_radius[cell] > 0.0f)) &&
                     pieces[i].lift == 0 &&
                     (pieces[i].rows.empty() || tissue.parent[tissue.offset[cell] + pieces[i].rows[0]] == -1);
    taken[cell] |= own;
    made[i] = id[cell] + (own ? 0 : kPieceStep * ++count[cell]);
  }
  std::vector<std::size_t> order(pieces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return made[a] < made[b]; });
  Rows rows;
  for (const std::size_t i : order) {
    if (!rows.id.empty() && rows.id.back() == made[i])
      fail(CONCEG_E_RANGE, "/cells/id: expected ids below 2^40, so that pieces of cells can have their own");
    const glm::dvec3 place = place_of(tissue, pieces[i], block);
    glm::dvec3 move(0.0, 0.0, pieces[i].lift * block.slab.side), soma = place;
    for (int axis = 0; axis < 2; axis++) {
      if (!block.box.periodic[axis]) continue;
      const double side = conceg_box_side(&block.box, axis);
      move[axis] = -side * std::floor((place[axis] - block.box.lo[axis]) / side);
      soma[axis] += move[axis];
    }
    rows.piece.push_back(std::move(pieces[i]));
    rows.id.push_back(made[i]), rows.soma.push_back(soma), rows.move.push_back(move);
  }
  return rows;
}

// One array of /cells or /skeleton, its rows taken anew in the order of `from`.
template <class T>
void take(conceg_doc *doc, const char *path, const std::vector<std::size_t> &from, std::size_t columns = 1) {
  if (!has(doc, path)) return;
  const View<T> old = view<T>(doc, path, columns);
  std::vector<T> out;
  out.reserve(from.size() * columns);
  for (const std::size_t row : from) {
    if (row >= old.rows()) fail(CONCEG_E_FORMAT, "%s: expected more rows, got %zu", path, old.rows());
    out.insert(out.end(), old.row(row), old.row(row) + columns);
  }
  put(doc, path, out, columns);
}

void write_cells(conceg_doc *doc, const Tissue &tissue, const Rows &rows) {
  std::vector<std::size_t> from;
  std::vector<float> radius;
  for (const Piece &piece : rows.piece) {
    from.push_back(piece.cell);
    radius.push_back(piece.has_soma ? tissue.soma_radius[piece.cell] : 0.0f);
  }
  take<std::uint32_t>(doc, "/cells/type", from);
  take<std::uint32_t>(doc, "/cells/donor", from);
  take<double>(doc, "/cells/rotation", from, 4);
  put(doc, "/cells/id", rows.id);
  put3(doc, "/cells/soma", rows.soma);
  put(doc, "/cells/radius", radius);
}

void write_skeleton(conceg_doc *doc, const Tissue &tissue, const Rows &rows) {
  std::vector<std::size_t> from;
  std::vector<std::uint64_t> offset = {0};
  std::vector<glm::dvec3> position;
  std::vector<std::int64_t> parent;
  for (std::size_t i = 0; i < rows.piece.size(); i++) {
    const Piece &piece = rows.piece[i];
    const std::uint64_t first = tissue.offset[piece.cell];
    std::vector<std::int64_t> number(tissue.offset[piece.cell + 1] - first, -1);
    for (const std::uint32_t row : piece.rows) {
      number[row] = static_cast<std::int64_t>(position.size() - offset.back());
      const std::int64_t above = tissue.parent[first + row];
      parent.push_back(above < 0 ? -1 : number[static_cast<std::size_t>(above)]);
      position.push_back(tissue.position[first + row] + rows.move[i]);
      from.push_back(first + row);
    }
    offset.push_back(position.size());
  }
  take<float>(doc, "/skeleton/radius", from);
  take<float>(doc, "/skeleton/target_radius", from);
  take<std::uint8_t>(doc, "/skeleton/kind", from);
  take<std::uint32_t>(doc, "/skeleton/branch", from);
  take<std::uint32_t>(doc, "/skeleton/tree", from);
  take<std::uint8_t>(doc, "/skeleton/status", from);
  must(conceg_doc_drop(doc, "/skeleton/bar")); // the bars are those of whole cells
  put(doc, "/skeleton/cell_offset", offset);
  put3(doc, "/skeleton/position", position);
  put(doc, "/skeleton/parent", parent);
}

void cut_document(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const Tissue tissue = read_tissue(doc);
  const Block block = block_of(doc, params);
  const Rows rows = rows_of(doc, tissue, cut(tissue, block.slab), block);
  if (rows.piece.empty())
    fail(CONCEG_E_RANGE, "block: expected a cell between %g and %g um along z, got none", block.box.lo[2],
         block.box.hi[2]);
  write_cells(doc, tissue, rows);
  write_skeleton(doc, tissue, rows);
  put(doc, "/domain@lo", block.box.lo, 3);
  put(doc, "/domain@hi", block.box.hi, 3);
  put(doc, "/domain@periodic", block.box.periodic, 3);
  const auto with_soma =
      std::count_if(rows.piece.begin(), rows.piece.end(), [](const Piece &piece) { return piece.has_soma; });
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "block: z from %g to %g um: %zu pieces of %zu cells, %td with their soma", block.box.lo[2],
                 block.box.hi[2], rows.piece.size(), tissue.cells(), with_soma);
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "block", [&] { cut_document(ctx, doc, params); });
}

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_block;
const conceg_stage conceg_stage_block = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "block",
    "sections",
    "1.0.0",
    "cuts a block along z out of the skeletons, to be meshed and simulated alone",
    "conceg block --lo-um 400 --hi-um 490 relaxed.cgx | conceg mesh > block.cgx",
    parameters,
    reads,
    writes,
    drops,
    0,
    nullptr,
    run,
};
