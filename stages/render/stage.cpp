// SPDX-License-Identifier: BSD-3-Clause
// The render stage: PNG pictures of the tissue on a machine without a display.
#include "cells.hpp"
#include "conceg/conceg.h"
#include "guard.hpp"
#include "output.hpp"
#include "picture.hpp"
#include "png.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace {

using namespace conceg;
using namespace conceg::rendering;

const conceg_param parameters[] = {
    {"what", "",
     "pictures to make: the cells in the box, a cut through it, or both (of a single cell only the first)",
     "both", "both|cells|cut", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"dir", "", "folder to write into; made when absent", "pictures", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"cells", "", "all, or rows such as 7 and ids such as id:12 with commas between; these are drawn whole",
     "all", nullptr, CONCEG_PARAM_TEXT, 0, 0, 0},
    {"whole", "", "draw whole cells instead of what lies in the box", "false", nullptr, CONCEG_PARAM_BOOL, 0,
     0, 0},
    {"of", "",
     "draw the surfaces of /meshes or the round cones of /skeleton; auto = meshes where there are any",
     "auto", "auto|meshes|skeleton", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"size_px", "px", "longer side of a picture", "1200", nullptr, CONCEG_PARAM_I64, 0, 64, 8192},
    {"samples", "1", "samples per pixel, raised to the next square", "4", nullptr, CONCEG_PARAM_I64, 0, 1,
     64},
    {"azimuth_deg", "deg", "direction of view about z, from +x towards +y", "35", nullptr, CONCEG_PARAM_F64,
     0, -360, 360},
    {"elevation_deg", "deg", "direction of view above the x y plane", "22", nullptr, CONCEG_PARAM_F64, 0, -90,
     90},
    {"cut_axis", "", "axis normal to the cut", "y", "x|y|z", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"cut_position", "1", "place of the cut between the lower (0) and the upper (1) end", "0.5", nullptr,
     CONCEG_PARAM_F64, 0, 0, 1},
    {"zoom_um", "um", "draw only a cube of this side; 0 = all", "0", nullptr, CONCEG_PARAM_F64, 0, 0, 1e6},
    {"zoom_at", "um", "middle of that cube, as x,y,z; empty = middle of what there is", "", nullptr,
     CONCEG_PARAM_TEXT, 0, 0, 0},
    {"wire", "", "draw the edges of the triangles", "false", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};

bool from_meshes(conceg_doc *doc, const conceg_params *params) {
  const std::string of = conceg_params_text(params, "of");
  const bool meshes = has(doc, "/meshes/face"), skeleton = has(doc, "/skeleton/position");
  if (of == "meshes" && !meshes)
    fail(CONCEG_E_MISSING, "/meshes: expected surfaces to draw, got none; run the mesh stage first");
  if (of == "skeleton" && !skeleton)
    fail(CONCEG_E_MISSING, "/skeleton: expected skeletons to draw, got none; run the grow stage first");
  if (!meshes && !skeleton)
    fail(CONCEG_E_MISSING,
         "/meshes, /skeleton: expected one of them to draw, got none; run the grow or the mesh stage first");
  return of != "skeleton" && meshes;
}

void add_surfaces(const conceg_substrate *substrate, std::vector<Cell> &cells) {
  const std::uint64_t count = conceg_substrate_cells(substrate);
  std::vector<Cell *> drawn(count, nullptr);
  for (Cell &cell : cells)
    drawn[cell.row] = &cell;
  for (std::uint64_t mesh = 0; mesh < conceg_substrate_meshes(substrate); mesh++) {
    conceg_mesh_view found = {};
    found.size = sizeof found;
    must(conceg_substrate_mesh(substrate, mesh, &found));
    if (found.cell >= count || !drawn[found.cell]) continue;
    Surface &surface = drawn[found.cell]->surface;
    const auto base = static_cast<std::uint32_t>(surface.vertex.size());
    for (std::uint64_t i = 0; i < found.vertex_count; i++)
      surface.vertex.emplace_back(found.vertex[3 * i], found.vertex[3 * i + 1], found.vertex[3 * i + 2]);
    for (std::uint64_t i = 0; i < found.face_count; i++)
      surface.face.emplace_back(found.face[3 * i] + base, found.face[3 * i + 1] + base,
                                found.face[3 * i + 2] + base);
  }
}

void add_cones(const conceg_substrate *substrate, const CellInfo &info, Cell &cell) {
  conceg_skeleton_view found = {};
  found.size = sizeof found;
  must(conceg_substrate_skeleton(substrate, info.row, &found));
  const auto point = [&](std::uint64_t i) {
    return glm::dvec3(found.position[3 * i], found.position[3 * i + 1], found.position[3 * i + 2]);
  };
  if (info.soma_radius > 0.0)
    cell.cones.push_back({info.soma, info.soma, info.soma_radius, info.soma_radius});
  for (std::uint64_t i = 0; i < found.count; i++) {
    const double radius = found.radius[i];
    if (found.parent[i] >= 0) {
      const auto parent = static_cast<std::uint64_t>(found.parent[i]);
      cell.cones.push_back({point(parent), point(i), found.radius[parent], radius});
    } else if (info.soma_radius > 0.0 && glm::length(point(i) - info.soma) > 0.0) {
      // A tree is joined to its soma from one radius deeper within it.
      cell.cones.push_back(
          {point(i) - radius * glm::normalize(point(i) - info.soma), point(i), radius, radius});
    }
  }
}

void zoom_in(Scene &scene, double size, const char *at) {
  glm::dvec3 centre = 0.5 * (scene.lo + scene.hi);
  int end = 0;
  if (*at && (std::sscanf(at, "%lf,%lf,%lf%n", &centre.x, &centre.y, &centre.z, &end) != 3 || at[end] ||
              !std::isfinite(centre.x + centre.y + centre.z)))
    fail(CONCEG_E_PARAM, "zoom_at: expected three numbers such as 10,20.5,3, got \"%s\"", at);
  zoom(scene, centre, size);
}

std::vector<CellInfo> cells_of(const conceg_substrate *substrate, const std::string &list) {
  std::vector<CellInfo> chosen;
  for (std::size_t begin = 0, end; begin <= list.size(); begin = end + 1) {
    end = std::min(list.find(',', begin), list.size());
    for (CellInfo &cell : select_cells(substrate, list.substr(begin, end - begin)))
      chosen.push_back(std::move(cell));
  }
  return chosen;
}

Scene make_scene(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params, Workers &workers,
                 std::vector<CellInfo> &chosen) {
  conceg_substrate *opened = nullptr;
  must(conceg_substrate_open(doc, &opened));
  const std::shared_ptr<conceg_substrate> substrate(opened, conceg_substrate_free);
  const std::string wanted = conceg_params_text(params, "cells");
  chosen = cells_of(opened, wanted);
  Scene scene;
  scene.box = read_box(doc);
  const View<double> pia = view<double>(doc, "/domain@pia", 3);
  scene.pia = {pia[0], pia[1], pia[2]};
  const double size = conceg_params_f64(params, "zoom_um");
  scene.clipped = size > 0 || (wanted == "all" && !conceg_params_bool(params, "whole"));
  scene.types = texts(doc, "/types/name");
  scene.type_colour = type_colours(texts(doc, "/types/class"));
  std::vector<Cell> cells(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); i++) {
    if (chosen[i].type >= scene.types.size())
      fail(CONCEG_E_FORMAT, "/cells/type[%llu]: expected a type below %zu, got %u",
           static_cast<unsigned long long>(chosen[i].row), scene.types.size(), chosen[i].type);
    cells[i].row = chosen[i].row, cells[i].id = chosen[i].id, cells[i].type = chosen[i].type;
  }
  if (from_meshes(doc, params))
    add_surfaces(opened, cells);
  else
    for (std::size_t i = 0; i < cells.size(); i++)
      add_cones(opened, chosen[i], cells[i]);
  scene.wire = conceg_params_bool(params, "wire") != 0;
  add_bodies(scene, cells, workers, progress_of(ctx));
  if (size > 0) zoom_in(scene, size, conceg_params_text(params, "zoom_at"));
  return scene;
}

void save(conceg_ctx *ctx, const std::string &path, const Image &image) {
  write_png(path, image);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "render: wrote %s, %d x %d pixels", path.c_str(), image.width,
                 image.height);
}

conceg_status check(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "render", [&] { (void)from_meshes(doc, params); });
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "render", [&] {
    Workers workers(conceg_ctx_threads(ctx));
    std::vector<CellInfo> chosen;
    const Scene scene = make_scene(ctx, doc, params, workers, chosen);
    std::string dir = conceg_params_text(params, "dir"), name = "cells.png", cut_name = "cut.png";
    if (dir.empty()) fail(CONCEG_E_PARAM, "dir: expected the name of a folder, got an empty text");
    const bool single = chosen.size() == 1 && std::string(conceg_params_text(params, "cells")) != "all";
    if (single) {
      char number[40];
      std::snprintf(number, sizeof number, "cell_%04llu",
                    static_cast<unsigned long long>(chosen.front().row));
      name = std::string(number) + ".png", cut_name = std::string(number) + "_cut.png";
    }
    make_folder(dir);
    PictureOptions options;
    options.size_px = static_cast<int>(conceg_params_i64(params, "size_px")),
    options.samples = static_cast<int>(conceg_params_i64(params, "samples"));
    options.azimuth_deg = conceg_params_f64(params, "azimuth_deg"),
    options.elevation_deg = conceg_params_f64(params, "elevation_deg");
    options.cut_axis = conceg_params_text(params, "cut_axis")[0] - 'x',
    options.cut_position = conceg_params_f64(params, "cut_position");
    const std::string what = conceg_params_text(params, "what");
    const Progress progress = progress_of(ctx);
    if (what != "cut") save(ctx, dir + "/" + name, picture_of_cells(scene, options, workers, progress));
    if (what == "cut" || (what == "both" && !single))
      save(ctx, dir + "/" + cut_name, picture_of_cut(scene, options, workers, progress));
    workers.count(ctx, "render.items");
  });
}

const char *const reads[] = {"/domain", "/types", "/cells", nullptr};
const char *const nothing[] = {nullptr};

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_render;
extern "C" const conceg_stage conceg_stage_render = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "render",
    "raycast",
    "1.0.0",
    "draws the cells in the box and a cut through it as PNG, without a display",
    "conceg render --dir pictures < cube.cgx",
    parameters,
    reads,
    nothing,
    nothing,
    CONCEG_STAGE_SINK | CONCEG_STAGE_THREADED,
    check,
    run};
