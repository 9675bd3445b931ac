// SPDX-License-Identifier: BSD-3-Clause
// What is in a meshed document, from C++17: the cells, their volumes by class, and whether the volume
// fraction that the meshes state is the one that random points find.
//
//   inspect FILE [POINTS]
//
// Exit code: 0 when both fractions agree within four standard errors, 1 when they do not, 2 on errors.
#include <conceg/conceg.h>
#include <conceg/query.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

// The C handles with their destructors, and statuses as exceptions.
struct Free {
  void operator()(conceg_ctx *ctx) const { conceg_ctx_free(ctx); }
  void operator()(conceg_substrate *substrate) const { conceg_substrate_free(substrate); }
  void operator()(conceg_query *query) const { conceg_query_free(query); }
};
using Context = std::unique_ptr<conceg_ctx, Free>;

void check(conceg_status status, const conceg_ctx *ctx) {
  if (status == CONCEG_OK) return;
  const std::string detail = ctx ? conceg_ctx_error(ctx) : "";
  throw std::runtime_error(detail.empty() ? conceg_status_text(status) : detail);
}

class Substrate {
public:
  Substrate(conceg_ctx *ctx, const char *path) {
    conceg_substrate *substrate = nullptr;
    check(conceg_substrate_open_file(ctx, path, &substrate), ctx);
    substrate_.reset(substrate);
    conceg_query *query = nullptr;
    check(conceg_query_new(ctx, substrate, &query), ctx);
    query_.reset(query);
  }
  uint64_t cells() const { return conceg_substrate_cells(substrate_.get()); }
  uint64_t meshes() const { return conceg_substrate_meshes(substrate_.get()); }
  conceg_cell_view cell(uint64_t index) const {
    conceg_cell_view view = {};
    view.size = sizeof view;
    check(conceg_substrate_cell(substrate_.get(), index, &view), nullptr);
    return view;
  }
  conceg_mesh_view mesh(uint64_t index) const {
    conceg_mesh_view view = {};
    view.size = sizeof view;
    check(conceg_substrate_mesh(substrate_.get(), index, &view), nullptr);
    return view;
  }
  conceg_box box() const {
    conceg_box box = {};
    conceg_substrate_box(substrate_.get(), box.lo, box.hi, box.periodic);
    return box;
  }
  std::vector<int64_t> locate(const std::vector<double> &points) const {
    std::vector<int64_t> cell(points.size() / 3);
    check(conceg_query_locate(query_.get(), cell.size(), points.data(), cell.data(), nullptr), nullptr);
    return cell;
  }

private:
  std::unique_ptr<conceg_substrate, Free> substrate_;
  std::unique_ptr<conceg_query, Free> query_; // after what it borrows, so that it goes first
};

double box_volume(const conceg_box &box) {
  return conceg_box_side(&box, 0) * conceg_box_side(&box, 1) * conceg_box_side(&box, 2);
}

std::vector<double> random_points(const conceg_box &box, uint64_t count) {
  std::vector<double> points(3 * count);
  conceg_rng rng = conceg_rng_stream(1, "inspect", 0);
  for (size_t i = 0; i < points.size(); i++) {
    const int axis = static_cast<int>(i % 3);
    points[i] = box.lo[axis] + conceg_box_side(&box, axis) * conceg_rng_uniform(&rng);
  }
  return points;
}

int inspect(const char *path, uint64_t count) {
  Context ctx(conceg_ctx_new());
  if (!ctx) throw std::bad_alloc();
  const Substrate substrate(ctx.get(), path);
  const conceg_box box = substrate.box();
  std::printf("box %g x %g x %g um, %llu cells, %llu surfaces\n", conceg_box_side(&box, 0),
              conceg_box_side(&box, 1), conceg_box_side(&box, 2),
              static_cast<unsigned long long>(substrate.cells()),
              static_cast<unsigned long long>(substrate.meshes()));

  double stated = 0;
  std::map<std::string, double> by_class, by_points;
  for (uint64_t i = 0; i < substrate.meshes(); i++) {
    const conceg_mesh_view mesh = substrate.mesh(i);
    const conceg_cell_view cell = substrate.cell(mesh.cell);
    std::printf("cell %llu: %s, %llu faces, %.2f um3, %.2f um2, %s\n",
                static_cast<unsigned long long>(cell.id), cell.type_name,
                static_cast<unsigned long long>(mesh.face_count), mesh.volume, mesh.area,
                mesh.closed ? "closed" : "not known to be closed");
    by_class[cell.class_name] += mesh.volume / box_volume(box);
    stated += mesh.volume / box_volume(box);
  }

  uint64_t inside = 0;
  for (const int64_t cell : substrate.locate(random_points(box, count))) {
    if (cell < 0) continue;
    by_points[substrate.cell(static_cast<uint64_t>(cell)).class_name] += 1.0 / static_cast<double>(count);
    inside++;
  }
  for (const auto &[name, fraction] : by_class)
    std::printf("class %s: fraction %.4f by the meshes, %.4f by points\n", name.c_str(), fraction,
                by_points[name]);
  const double found = static_cast<double>(inside) / static_cast<double>(count);
  const double error = std::sqrt(stated * (1 - stated) / static_cast<double>(count));
  const bool agree = std::fabs(found - stated) < 4 * error;
  std::printf("intracellular fraction: %.4f by the meshes, %.4f +- %.4f by points: %s\n", stated, found,
              error, agree ? "agree" : "DO NOT AGREE");
  return agree ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: inspect FILE [POINTS]\n");
    return 2;
  }
  try {
    return inspect(argv[1], argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 200000);
  } catch (const std::exception &error) {
    std::fprintf(stderr, "inspect: %s\n", error.what());
    return 2;
  }
}
