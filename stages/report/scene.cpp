// SPDX-License-Identifier: BSD-3-Clause
#include "scene.hpp"

#include "formatted.hpp"
#include "view.hpp"

#include <cmath>
#include <cstdarg>

namespace conceg::reporting {
namespace {

// Far enough for any tissue, and near enough that voxels have numbers.
constexpr double farthest = 1e7;                 // um
constexpr std::uint64_t most_faces = 20'000'000; // more are not even read: they would not fit by far

bool near_enough(const double *p) {
  return std::abs(p[0]) < farthest && std::abs(p[1]) < farthest && std::abs(p[2]) < farthest;
}

void check_length(const char *path, std::size_t got, std::size_t expected) {
  if (got != expected) fail(CONCEG_E_FORMAT, "%s: expected %zu rows, got %zu", path, expected, got);
}

// Offsets over `groups` rows into `rows`.
View<std::uint64_t> offsets(conceg_doc *doc, const char *path, std::size_t groups, std::size_t rows) {
  const auto view_of = view<std::uint64_t>(doc, path);
  check_length(path, view_of.rows(), groups + 1);
  if (view_of[0] != 0 || view_of[groups] != rows)
    fail(CONCEG_E_FORMAT, "%s: expected 0 first and %zu last", path, rows);
  for (std::size_t i = 0; i < groups; i++)
    if (view_of[i] > view_of[i + 1])
      fail(CONCEG_E_FORMAT, "%s[%zu]: expected offsets that do not fall", path, i);
  return view_of;
}

void read_cells(conceg_doc *doc, Scene &scene) {
  if (!has(doc, "/cells/id")) return;
  const auto id = view<std::uint64_t>(doc, "/cells/id");
  const auto type = view<std::uint32_t>(doc, "/cells/type");
  const auto soma = view<double>(doc, "/cells/soma", 3);
  const auto radius = view<float>(doc, "/cells/radius");
  const std::size_t types = has(doc, "/types/name") ? texts(doc, "/types/name").size() : 0;
  scene.cells = id.rows();
  check_length("/cells/type", type.rows(), scene.cells),
      check_length("/cells/soma", soma.rows(), scene.cells);
  check_length("/cells/radius", radius.rows(), scene.cells);
  scene.id.assign(id.begin(), id.end()), scene.type.assign(type.begin(), type.end());
  scene.soma_radius.assign(radius.begin(), radius.end());
  for (std::size_t i = 0; i < scene.cells; i++) {
    if (type[i] >= types)
      fail(CONCEG_E_RANGE, "/cells/type[%zu]: expected a type below %zu, got %u", i, types, type[i]);
    if (!near_enough(soma.row(i)))
      fail(CONCEG_E_RANGE, "/cells/soma[%zu]: expected finite coordinates below 1e7 um", i);
    if (!(radius[i] >= 0) || !std::isfinite(radius[i]))
      fail(CONCEG_E_RANGE, "/cells/radius[%zu]: expected a radius of 0 um or more", i);
    scene.soma.emplace_back(soma.row(i)[0], soma.row(i)[1], soma.row(i)[2]);
  }
}

void read_skeletons(conceg_doc *doc, Scene &scene, std::size_t most) {
  if (!has(doc, "/skeleton/position")) return;
  const auto position = view<double>(doc, "/skeleton/position", 3);
  const auto radius = view<float>(doc, "/skeleton/radius");
  const auto parent = view<std::int64_t>(doc, "/skeleton/parent");
  const auto kind = view<std::uint8_t>(doc, "/skeleton/kind");
  const auto offset = offsets(doc, "/skeleton/cell_offset", scene.cells, position.rows());
  scene.points = position.rows();
  check_length("/skeleton/radius", radius.rows(), scene.points);
  check_length("/skeleton/parent", parent.rows(), scene.points);
  check_length("/skeleton/kind", kind.rows(), scene.points);
  for (std::size_t cell = 0; cell < scene.cells; cell++)
    for (std::size_t i = offset[cell]; i < offset[cell + 1]; i++) {
      if (parent[i] < -1 || parent[i] >= static_cast<std::int64_t>(i - offset[cell]))
        fail(CONCEG_E_RANGE, "/skeleton/parent[%zu]: expected -1 or an earlier row of the cell, got %lld", i,
             static_cast<long long>(parent[i]));
      if (!near_enough(position.row(i)))
        fail(CONCEG_E_RANGE, "/skeleton/position[%zu]: expected finite coordinates below 1e7 um", i);
      if (!(radius[i] > 0) || !std::isfinite(radius[i]))
        fail(CONCEG_E_RANGE, "/skeleton/radius[%zu]: expected a radius above 0 um", i);
    }
  scene.skeleton = thin(
      {offset.data(), position.data(), radius.data(), parent.data(), kind.data(), scene.cells, scene.points},
      most / 8);
  const Thinned &thinned = scene.skeleton;
  if (thinned.stride == 0)
    scene.left_out.push_back(
        formatted("All skeletons: %zu points are too many for this page.", scene.points));
  else if (thinned.spacing_um > 0)
    scene.left_out.push_back(
        formatted("Of %zu skeleton points %zu are drawn: one per %g um of path, every fork and tip.",
                  scene.points, thinned.runs.position.size(), thinned.spacing_um));
  if (thinned.stride > 1)
    scene.left_out.push_back(
        formatted("Only the processes of every %zuth cell are drawn; somata are all there.", thinned.stride));
}

// Rows of /meshes at the coarsest level that there is.
std::vector<std::size_t> rows_of_level(conceg_doc *doc, std::size_t surfaces, int &level) {
  std::vector<std::size_t> rows;
  level = 0;
  if (!has(doc, "/meshes/lod")) {
    for (std::size_t k = 0; k < surfaces; k++)
      rows.push_back(k);
    return rows;
  }
  const auto lod = view<std::uint8_t>(doc, "/meshes/lod");
  check_length("/meshes/lod", lod.rows(), surfaces);
  for (const std::uint8_t value : lod)
    level = std::max<int>(level, value);
  for (std::size_t k = 0; k < surfaces; k++)
    if (lod[k] == level) rows.push_back(k);
  return rows;
}

std::uint64_t rows_at(conceg_doc *doc, const char *path) {
  conceg_array array = {};
  array.size = sizeof array;
  must(conceg_doc_describe(doc, path, &array));
  return array.rank ? array.shape[0] : 0;
}

void read_surfaces(conceg_doc *doc, Scene &scene, std::size_t most) {
  if (!has(doc, "/meshes/face")) return;
  scene.faces = rows_at(doc, "/meshes/face");
  if (scene.faces > most_faces) {
    scene.left_out.push_back(
        formatted("All surfaces: %llu triangles are too many for a page; skeletons stand for them.",
                  static_cast<unsigned long long>(scene.faces)));
    return;
  }
  const auto cell = view<std::uint32_t>(doc, "/meshes/cell");
  const auto vertex = view<double>(doc, "/meshes/vertex", 3);
  const auto face = view<std::uint32_t>(doc, "/meshes/face", 3);
  const auto first_vertex = offsets(doc, "/meshes/vertex_offset", cell.rows(), vertex.rows());
  const auto first_face = offsets(doc, "/meshes/face_offset", cell.rows(), face.rows());
  std::vector<Surface> surfaces;
  scene.faces = 0;
  for (const std::size_t k : rows_of_level(doc, cell.rows(), scene.level)) {
    Surface surface;
    surface.cell = cell[k];
    if (cell[k] >= scene.cells)
      fail(CONCEG_E_RANGE, "/meshes/cell[%zu]: expected a cell below %zu, got %u", k, scene.cells, cell[k]);
    for (std::size_t v = first_vertex[k]; v < first_vertex[k + 1]; v++) {
      if (!near_enough(vertex.row(v)))
        fail(CONCEG_E_RANGE, "/meshes/vertex[%zu]: expected finite coordinates below 1e7 um", v);
      surface.vertex.emplace_back(vertex.row(v)[0], vertex.row(v)[1], vertex.row(v)[2]);
    }
    for (std::size_t f = first_face[k]; f < first_face[k + 1]; f++) {
      for (int corner = 0; corner < 3; corner++)
        if (face.row(f)[corner] >= surface.vertex.size())
          fail(CONCEG_E_RANGE, "/meshes/face[%zu]: expected vertices below %zu, got %u", f,
               surface.vertex.size(), face.row(f)[corner]);
      surface.face.emplace_back(face.row(f)[0], face.row(f)[1], face.row(f)[2]);
    }
    scene.faces += surface.face.size();
    surfaces.push_back(std::move(surface));
  }
  scene.surfaces = surfaces.size();
  scene.mesh = coarsen(std::move(surfaces), most);
  if (scene.level > 0)
    scene.left_out.push_back(
        formatted("Surfaces are those of level %d, which may cross one another.", scene.level));
  if (scene.surfaces && scene.mesh.surfaces.empty())
    scene.left_out.push_back(
        formatted("All surfaces: %llu triangles do not fit, even simplified; give a larger --size-mb.",
                  static_cast<unsigned long long>(scene.faces)));
  else if (scene.mesh.step_um > 0)
    scene.left_out.push_back(formatted(
        "Surfaces are simplified (vertices within voxels of %g um are merged), for the picture alone.",
        scene.mesh.step_um));
}

} // namespace

Scene read_scene(conceg_doc *doc, std::size_t most) {
  Scene scene;
  read_cells(doc, scene);
  if (!scene.cells) return scene;
  // 20 bytes a cell for its soma.
  const std::size_t room = most > 20 * scene.cells ? most - 20 * scene.cells : 0;
  read_skeletons(doc, scene, room / 2);
  const std::size_t taken = 8 * scene.skeleton.runs.position.size() + 9 * scene.skeleton.runs.cell.size();
  read_surfaces(doc, scene, room > taken ? room - taken : 0);
  return scene;
}

} // namespace conceg::reporting
