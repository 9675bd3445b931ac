// SPDX-License-Identifier: BSD-3-Clause
#include "simulation.hpp"

#include "conceg/query.h"
#include "conceg/rng.h"
#include "cut.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace conceg::exporting {
namespace {

constexpr double margin_um = 1.0; // between a cell and an open side
constexpr std::uint64_t draws_a_point = 1000, batch = 4096;

// NPY 1.0: magic, header padded to a multiple of 64 bytes, values little-endian in C order.
void write_npy_bytes(Job &job, const std::string &file, const char *what, const char *type, std::size_t rows,
                     const void *values, std::size_t bytes) {
  std::string header = "{'descr': '" + std::string(type) + "', 'fortran_order': False, 'shape': (" +
                       std::to_string(rows) + ", 3), }";
  header.append(64 - (10 + header.size() + 1) % 64, ' ');
  header += '\n';
  OutputFile output(job.folder.at(file));
  const unsigned char start[10] = {0x93,
                                   'N',
                                   'U',
                                   'M',
                                   'P',
                                   'Y',
                                   1,
                                   0,
                                   static_cast<unsigned char>(header.size() & 255u),
                                   static_cast<unsigned char>(header.size() >> 8)};
  output.write(start, sizeof start);
  output.write(header);
  output.write(values, bytes);
  output.commit();
  Written row;
  row.file = file, row.what = what, row.points = rows;
  job.folder.add(std::move(row));
}

} // namespace

SimulationBox simulation_box(const Job &job) {
  const conceg_box &box = job.source.box();
  glm::dvec3 low = {box.lo[0], box.lo[1], box.lo[2]}, high = {box.hi[0], box.hi[1], box.hi[2]};
  SimulationBox out = {low, high - low, true, true};
  for (int axis = 0; axis < 3; axis++)
    (box.periodic[axis] ? out.open : out.periodic) = false;
  if (out.periodic) return out;
  for (const Cell &cell : job.cells)
    for (const glm::dvec3 &p : job.source.surface(cell.row, Form::closed).surface.vertex)
      for (int axis = 0; axis < 3; axis++) {
        if (box.periodic[axis]) continue;
        low[axis] = std::min(low[axis], std::floor(p[axis] - margin_um)),
        high[axis] = std::max(high[axis], std::ceil(p[axis] + margin_um));
      }
  out.origin = low, out.sides = high - low;
  return out;
}

Surface simulation_surface(const Job &job, const SimulationBox &box, const Cell &cell, SurfaceForm form) {
  const Surface whole = job.source.surface(cell.row, Form::closed).surface;
  const conceg_box &periods = job.source.box();
  const Surface part = form == SurfaceForm::cut     ? Surface(cut_at_box(periods, whole))
                       : form == SurfaceForm::tiled ? Surface(tile(periods, whole))
                                                    : whole;
  return placed(part, box.origin, 1.0);
}

Surface joint_surface(const Job &job, const SimulationBox &box, SurfaceForm form) {
  Surface all;
  for (std::size_t i = 0; i < job.cells.size(); i++) {
    report(job.progress, "export: surfaces", i, job.cells.size());
    append(all, simulation_surface(job, box, job.cells[i], form));
  }
  return all;
}

Positions draw_positions(const Job &job, const SimulationBox &box) {
  conceg_query *raw = nullptr;
  must(conceg_query_new(job.ctx, job.source.substrate(), &raw));
  const std::unique_ptr<conceg_query, void (*)(conceg_query *)> query(raw, conceg_query_free);
  std::vector<bool> chosen(conceg_substrate_cells(job.source.substrate()), false);
  for (const Cell &cell : job.cells)
    chosen[cell.row] = true;
  Positions positions;
  conceg_rng rng = conceg_rng_stream(conceg_ctx_seed(job.ctx), "export.positions", 0);
  const std::uint64_t wanted = job.options.walkers;
  std::vector<glm::dvec3> point(batch);
  std::vector<std::int64_t> cell(batch);
  for (std::uint64_t drawn = 0; drawn < draws_a_point * wanted &&
                                (positions.inside.size() < wanted || positions.outside.size() < wanted);
       drawn += batch) {
    must(conceg_ctx_progress(job.ctx, "export: starting points",
                             std::min(positions.inside.size(), positions.outside.size()), wanted));
    for (glm::dvec3 &p : point)
      for (int axis = 0; axis < 3; axis++)
        p[axis] = box.origin[axis] +
                  box.sides[axis] * (static_cast<double>(conceg_rng_u64(&rng) >> 11) + 0.5) * 0x1p-53;
    must(conceg_query_locate(query.get(), batch, &point[0].x, cell.data(), nullptr));
    for (std::size_t i = 0; i < batch; i++) {
      if (cell[i] >= 0 && chosen[static_cast<std::size_t>(cell[i])] && positions.inside.size() < wanted)
        positions.inside.push_back(point[i] - box.origin);
      if (cell[i] < 0 && positions.outside.size() < wanted)
        positions.outside.push_back(point[i] - box.origin);
    }
  }
  if (positions.inside.size() < wanted || positions.outside.size() < wanted)
    conceg_ctx_log(job.ctx, CONCEG_LOG_WARNING,
                   "export: only %zu starting points inside and %zu outside were found of %llu each",
                   positions.inside.size(), positions.outside.size(),
                   static_cast<unsigned long long>(wanted));
  return positions;
}

double feature_radius(const Job &job) {
  if (!job.source.has_skeleton()) return 0.0;
  double least = INFINITY;
  for (const Cell &cell : job.cells) {
    for (const double r : job.source.tree(cell.row).radius)
      least = std::min(least, r);
    if (cell.soma_radius > 0.0) least = std::min(least, cell.soma_radius);
  }
  return std::isfinite(least) ? least : 0.0;
}

void write_npy(Job &job, const std::string &file, const char *what, const std::vector<glm::dvec3> &rows) {
  write_npy_bytes(job, file, what, "<f8", rows.size(), rows.data(), rows.size() * sizeof rows[0]);
}
void write_npy(Job &job, const std::string &file, const char *what, const std::vector<glm::uvec3> &rows) {
  write_npy_bytes(job, file, what, "<u4", rows.size(), rows.data(), rows.size() * sizeof rows[0]);
}

std::string rows_text(const std::vector<glm::dvec3> &rows, double scale) {
  std::string text;
  char line[128];
  for (const glm::dvec3 &row : rows) {
    std::snprintf(line, sizeof line, "%.12g %.12g %.12g\n", row.x * scale, row.y * scale, row.z * scale);
    text += line;
  }
  return text;
}

std::string triple_text(const glm::dvec3 &values, const char *comma) {
  return number_text(values.x) + comma + number_text(values.y) + comma + number_text(values.z);
}

} // namespace conceg::exporting
