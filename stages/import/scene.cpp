// SPDX-License-Identifier: BSD-3-Clause
#include "scene.hpp"

#include "surface_figures.hpp"
#include "view.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace conceg::importing {
namespace {

struct Bounds {
  glm::dvec3 low = glm::dvec3(INFINITY), high = glm::dvec3(-INFINITY);
  void include(const glm::dvec3 &point, double r) {
    low = glm::min(low, point - r), high = glm::max(high, point + r);
  }
};

// A box around all that there is, on whole micrometres.
void put_box_around(const Scene &scene, double margin, glm::dvec3 &lo, glm::dvec3 &hi) {
  Bounds bounds;
  for (const SceneCell &cell : scene.cells) {
    for (std::size_t i = 0; i < cell.position.size(); i++)
      bounds.include(cell.position[i], cell.radius[i]);
    bounds.include(cell.soma, cell.soma_radius);
  }
  for (const SceneSurface &surface : scene.surfaces)
    for (const glm::dvec3 &vertex : surface.surface.vertex)
      bounds.include(vertex, 0.0);
  for (int axis = 0; axis < 3; axis++) {
    lo[axis] = std::floor(bounds.low[axis] - margin), hi[axis] = std::ceil(bounds.high[axis] + margin);
    if (!(hi[axis] > lo[axis])) hi[axis] = lo[axis] + 1.0;
  }
}

void write_cells(conceg_doc *doc, const Scene &scene) {
  std::vector<std::string> type, cell_class;
  std::vector<std::uint64_t> placed, id;
  std::vector<std::uint32_t> cell_type;
  std::vector<glm::dvec3> soma;
  std::vector<float> soma_radius;
  for (const SceneCell &cell : scene.cells) {
    const auto row = static_cast<std::size_t>(std::find(type.begin(), type.end(), cell.type) - type.begin());
    if (row == type.size())
      type.push_back(cell.type), cell_class.push_back(cell.cell_class), placed.push_back(0);
    placed[row]++;
    id.push_back(id.size()), cell_type.push_back(static_cast<std::uint32_t>(row));
    soma.push_back(cell.soma), soma_radius.push_back(static_cast<float>(cell.soma_radius));
  }
  put_texts(doc, "/types/name", type), put_texts(doc, "/types/class", cell_class);
  put(doc, "/types/placed", placed);
  put(doc, "/cells/id", id), put(doc, "/cells/type", cell_type);
  put3(doc, "/cells/soma", soma), put(doc, "/cells/radius", soma_radius);
}

// Numbers of branches (runs between forks) and trees, as they come.
void number_branches(const SceneCell &cell, std::vector<std::uint32_t> &branch,
                     std::vector<std::uint32_t> &tree) {
  const std::size_t count = cell.parent.size(), first = branch.size();
  std::vector<std::uint32_t> children(count, 0);
  for (const std::int64_t parent : cell.parent)
    if (parent >= 0) children[static_cast<std::size_t>(parent)]++;
  std::uint32_t branches = 0, trees = 0;
  for (std::size_t i = 0; i < count; i++) {
    const auto up = static_cast<std::size_t>(cell.parent[i]);
    const bool root = cell.parent[i] < 0;
    branch.push_back(root || children[up] > 1 ? branches++ : branch[first + up]);
    tree.push_back(root ? trees++ : tree[first + up]);
  }
}

void write_skeletons(conceg_doc *doc, const Scene &scene) {
  std::vector<std::uint64_t> offset = {0};
  std::vector<glm::dvec3> position;
  std::vector<float> radius, inner;
  std::vector<std::int64_t> parent;
  std::vector<std::uint8_t> kind;
  std::vector<std::uint32_t> branch, tree;
  bool myelin = false;
  for (const SceneCell &cell : scene.cells) {
    position.insert(position.end(), cell.position.begin(), cell.position.end());
    radius.insert(radius.end(), cell.radius.begin(), cell.radius.end());
    const std::vector<double> &below = cell.inner_radius.empty() ? cell.radius : cell.inner_radius;
    myelin = myelin || below != cell.radius;
    inner.insert(inner.end(), below.begin(), below.end());
    parent.insert(parent.end(), cell.parent.begin(), cell.parent.end());
    kind.insert(kind.end(), cell.kind.begin(), cell.kind.end());
    number_branches(cell, branch, tree);
    offset.push_back(position.size());
  }
  put(doc, "/skeleton/cell_offset", offset), put3(doc, "/skeleton/position", position);
  put(doc, "/skeleton/radius", radius), put(doc, "/skeleton/target_radius", radius);
  put(doc, "/skeleton/parent", parent), put(doc, "/skeleton/kind", kind);
  put(doc, "/skeleton/branch", branch), put(doc, "/skeleton/tree", tree);
  if (!myelin) return;
  conceg_array array = {};
  array.size = sizeof array, array.dtype = CONCEG_F32, array.rank = 1, array.shape[0] = inner.size();
  array.data = inner.data(), array.unit = "um";
  must(conceg_doc_write(doc, "/x_interop/inner_radius", &array));
}

void write_meshes(conceg_ctx *ctx, conceg_doc *doc, const Scene &scene) {
  std::vector<std::uint32_t> cell, face, component;
  std::vector<std::uint8_t> lod, closed, compartment;
  std::vector<std::string> form;
  std::vector<glm::dvec3> origin, vertex;
  std::vector<std::uint64_t> vertex_offset = {0}, face_offset = {0};
  std::vector<double> volume, area;
  std::vector<std::int64_t> genus;
  std::size_t open = 0, torn = 0;
  for (const SceneSurface &s : scene.surfaces) {
    Bounds bounds;
    for (const glm::dvec3 &p : s.surface.vertex)
      bounds.include(p, 0.0);
    const glm::dvec3 middle = snap(0.5 * (bounds.low + bounds.high));
    Surface rounded = s.surface;
    // Multiples of 2^-24 um in single precision, so that the sum with the origin is exact. The values pass
    // through memory: gcc 12 leaves the conversion there and back out of a loop that it vectorises.
    std::vector<glm::vec3> local;
    for (const glm::dvec3 &p : rounded.vertex)
      local.emplace_back(glm::floor((p - middle) * 0x1p24 + 0.5) * 0x1p-24);
    for (std::size_t i = 0; i < local.size(); i++)
      rounded.vertex[i] = middle + glm::dvec3(local[i]);
    const SurfaceFigures figures = measure_surface(rounded);
    const bool flip = figures.volume < 0.0; // a file that winds its triangles inward
    cell.push_back(s.cell), lod.push_back(0), closed.push_back(figures.closed);
    form.push_back(figures.closed ? "closed" : "open"), origin.push_back(middle);
    volume.push_back(std::fabs(figures.volume)), area.push_back(figures.area), genus.push_back(figures.genus);
    open += !figures.closed, torn += figures.components > 1;
    vertex.insert(vertex.end(), rounded.vertex.begin(), rounded.vertex.end());
    for (const glm::uvec3 &f : rounded.face)
      face.insert(face.end(), {f.x, flip ? f.z : f.y, flip ? f.y : f.z});
    compartment.insert(compartment.end(), rounded.face.size(), s.compartment);
    component.insert(component.end(), figures.component.begin(), figures.component.end());
    vertex_offset.push_back(vertex.size()), face_offset.push_back(face.size() / 3);
  }
  if (open)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "import: %zu of %zu surfaces are not closed: no simulator can take them", open,
                   cell.size());
  if (torn)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "import: %zu of %zu surfaces are in several pieces (/meshes/component)", torn,
                   cell.size());
  put(doc, "/meshes/cell", cell), put(doc, "/meshes/lod", lod), put_texts(doc, "/meshes/form", form);
  put3(doc, "/meshes/origin", origin), put(doc, "/meshes/vertex_offset", vertex_offset);
  put(doc, "/meshes/face_offset", face_offset), put3(doc, "/meshes/vertex", vertex),
      put(doc, "/meshes/face", face, 3);
  put(doc, "/meshes/compartment", compartment), put(doc, "/meshes/component", component);
  put(doc, "/meshes/volume", volume), put(doc, "/meshes/area", area), put(doc, "/meshes/genus", genus);
  put(doc, "/meshes/closed", closed);
}

bool ends_with(std::string name, const std::string &ending) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name.size() >= ending.size() &&
         name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
}

} // namespace

void SceneCell::follow(const glm::dvec3 &at, double r, std::uint8_t code) {
  parent.push_back(static_cast<std::int64_t>(position.size()) - 1);
  position.push_back(at), radius.push_back(r), kind.push_back(code);
}

std::vector<std::string> find_files(const std::vector<std::string> &names,
                                    const std::vector<std::string> &endings) {
  std::vector<std::string> files;
  for (const std::string &name : names) {
    std::error_code error;
    if (!std::filesystem::is_directory(name, error)) {
      files.push_back(name);
      continue;
    }
    std::vector<std::string> found;
    std::filesystem::recursive_directory_iterator entry(name, error), end;
    for (; !error && entry != end; entry.increment(error)) {
      const std::string file = entry->path().filename().string();
      if (entry->is_regular_file() && file[0] != '.' &&
          std::any_of(endings.begin(), endings.end(),
                      [&](const std::string &e) { return ends_with(file, e); }))
        found.push_back(entry->path().string());
    }
    if (error) fail(CONCEG_E_IO, "%s: cannot be listed: %s", name.c_str(), error.message().c_str());
    if (found.empty())
      fail(CONCEG_E_MISSING, "%s: expected files that end in %s, got none", name.c_str(), endings[0].c_str());
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

std::string base_name(const std::string &path) {
  return std::filesystem::path(path).filename().string();
}

const std::string &only_file(const Request &request, const char *what) {
  if (request.names.size() != 1)
    fail(CONCEG_E_USAGE, "expected one file, %s, got %zu", what, request.names.size());
  return request.names[0];
}

void check_frame(const Scene &scene, const std::string &path, const char *remedy) {
  if (!scene.has_box) return;
  const glm::dvec3 sides = scene.hi - scene.lo;
  std::size_t points = 0, far = 0;
  const auto look = [&](const glm::dvec3 &p) {
    const glm::dvec3 below = scene.lo - sides - p, above = p - scene.hi - sides;
    points++, far += std::max({below.x, below.y, below.z, above.x, above.y, above.z}) > 0.0;
  };
  double widest = 0.0;
  for (const SceneCell &cell : scene.cells) {
    for (const glm::dvec3 &p : cell.position)
      look(p);
    for (const double r : cell.radius)
      widest = std::max(widest, r);
    if (cell.soma_radius > 0.0) look(cell.soma), widest = std::max(widest, cell.soma_radius);
  }
  for (const SceneSurface &surface : scene.surfaces)
    for (const glm::dvec3 &p : surface.surface.vertex)
      look(p);
  if (points && far == points)
    fail(CONCEG_E_FORMAT,
         "%s: all %zu points lie more than a side outside of the box of %g x %g x %g um: another unit or "
         "frame; %s",
         path.c_str(), points, sides.x, sides.y, sides.z, remedy);
  if (widest > std::max({sides.x, sides.y, sides.z}))
    fail(CONCEG_E_FORMAT, "%s: a radius of %g um in a box of %g x %g x %g um: another unit; %s", path.c_str(),
         widest, sides.x, sides.y, sides.z, remedy);
}

void write_domain(conceg_doc *doc, const Scene &scene, double margin_um, const std::uint8_t periodic[3]) {
  static const double pia[3] = {0, 0, 1};
  glm::dvec3 lo = scene.lo, hi = scene.hi;
  if (!scene.has_box) put_box_around(scene, margin_um, lo, hi);
  put(doc, "/domain@lo", &lo.x, 3), put(doc, "/domain@hi", &hi.x, 3);
  put(doc, "/domain@periodic", periodic, 3), put(doc, "/domain@pia", pia, 3);
  put_scalar(doc, "/domain@lattice_step", CONCEG_LATTICE_STEP_UM);
}

void write_document(conceg_ctx *ctx, conceg_doc *doc, const Scene &scene, double margin_um) {
  static const std::uint8_t open[3] = {0, 0, 0};
  write_domain(doc, scene, margin_um, open);
  write_cells(doc, scene);
  std::size_t points = 0;
  for (const SceneCell &cell : scene.cells)
    points += cell.position.size();
  if (scene.surfaces.empty() || points) write_skeletons(doc, scene);
  if (!scene.surfaces.empty()) write_meshes(ctx, doc, scene);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "import: %zu cells, %zu points, %zu surfaces", scene.cells.size(),
                 points, scene.surfaces.size());
}

} // namespace conceg::importing
