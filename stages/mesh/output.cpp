// SPDX-License-Identifier: BSD-3-Clause
#include "output.hpp"
#include "faces.hpp"

#include "view.hpp"
#include "wrap.hpp"

namespace conceg::mesh {
namespace {

constexpr std::size_t kTask = 1u << 15; // rows

template <class T> T *fill(conceg_doc *doc, const char *path, std::uint64_t rows, std::uint64_t columns = 1) {
  const std::uint64_t shape[2] = {rows, columns};
  void *storage = nullptr;
  must(conceg_doc_new_array(doc, path, dtype_of<T>::value, columns == 1 ? 1 : 2, shape, &storage));
  return static_cast<T *>(storage);
}

// Rows first .. last of one surface, which begin at row `start` of the document's array.
struct Task {
  std::size_t surface, first, last;
  std::uint64_t start;
};

template <class Count>
std::vector<Task> tasks_of(const Views &surfaces, const std::vector<std::uint64_t> &offset,
                           const Count &count) {
  std::vector<Task> tasks;
  for (std::size_t s = 0; s < surfaces.size(); s++)
    for (std::size_t first = 0; first < count(surfaces[s]); first += kTask)
      tasks.push_back({s, first, std::min(first + kTask, count(surfaces[s])), offset[s]});
  return tasks;
}

void write_rows(conceg_doc *doc, const Views &surfaces, const std::vector<std::uint8_t> &lod,
                std::vector<std::uint64_t> &vertex_offset, std::vector<std::uint64_t> &face_offset) {
  vertex_offset = face_offset = {0};
  std::vector<std::uint32_t> cell;
  std::vector<glm::dvec3> origin;
  for (const SurfaceView &surface : surfaces) {
    cell.push_back(surface.cell), origin.push_back(surface.origin);
    vertex_offset.push_back(vertex_offset.back() + surface.vertices);
    face_offset.push_back(face_offset.back() + surface.faces);
  }
  put(doc, "/meshes/cell", cell);
  put(doc, "/meshes/lod", lod);
  put_texts(doc, "/meshes/form", std::vector<std::string>(surfaces.size(), "closed"));
  put3(doc, "/meshes/origin", origin);
  put(doc, "/meshes/lift", std::vector<std::int32_t>(surfaces.size() * 3), 3);
  put(doc, "/meshes/vertex_offset", vertex_offset);
  put(doc, "/meshes/face_offset", face_offset);
}

} // namespace

void write_surfaces(conceg_doc *doc, const Scene &scene, const Index &index, const Finished &done,
                    const std::vector<Level> &levels, Workers &workers) {
  Views surfaces = done.surfaces;
  std::vector<std::uint8_t> lod(surfaces.size());
  for (std::size_t i = 0; i < levels.size(); i++) {
    surfaces.insert(surfaces.end(), levels[i].surfaces.begin(), levels[i].surfaces.end());
    lod.resize(surfaces.size(), static_cast<std::uint8_t>(i + 1));
  }
  std::vector<std::uint64_t> vertex_offset, face_offset;
  write_rows(doc, surfaces, lod, vertex_offset, face_offset);
  double *vertex = fill<double>(doc, "/meshes/vertex", vertex_offset.back(), 3);
  std::uint32_t *face = fill<std::uint32_t>(doc, "/meshes/face", face_offset.back(), 3);
  std::uint8_t *compartment = fill<std::uint8_t>(doc, "/meshes/compartment", face_offset.back());
  std::uint32_t *section = fill<std::uint32_t>(doc, "/meshes/section", face_offset.back());
  fill<std::uint32_t>(doc, "/meshes/component", face_offset.back()); // 0: one piece per cell is kept
  const std::vector<Task> points =
      tasks_of(surfaces, vertex_offset, [](const SurfaceView &s) { return s.vertices; });
  workers.loop(points.size(), 1, [&](std::size_t i, unsigned) {
    const Task &task = points[i];
    double *to = vertex + 3 * (task.start + task.first);
    for (std::size_t v = task.first; v < task.last; v++) {
      const glm::dvec3 p = surfaces[task.surface].at(static_cast<std::uint32_t>(v));
      *to++ = p.x, *to++ = p.y, *to++ = p.z;
    }
  });
  const std::vector<Task> faces =
      tasks_of(surfaces, face_offset, [](const SurfaceView &s) { return s.faces; });
  workers.loop(faces.size(), 1, [&](std::size_t i, unsigned) {
    const Task &task = faces[i];
    for (std::size_t f = task.first; f < task.last; f++) {
      const SurfaceView &surface = surfaces[task.surface];
      const FaceLabel label = label_face(scene, index, surface, f);
      const std::size_t row = task.start + f;
      for (int k = 0; k < 3; k++)
        face[3 * row + static_cast<std::size_t>(k)] = surface.face[f][k];
      compartment[row] = label.compartment, section[row] = label.section;
    }
  });
  done.file->forget();
}

double write_measures(conceg_doc *doc, const conceg_box &box, const Scene &scene, const FinalCheck &check,
                      const std::vector<Pieces> &pieces, const std::vector<Level> &levels, double gap,
                      Workers &workers) {
  Views surfaces = check.surfaces;
  const std::size_t finest = surfaces.size();
  for (const Level &level : levels)
    surfaces.insert(surfaces.end(), level.surfaces.begin(), level.surfaces.end());
  std::vector<double> volumes(surfaces.size()), areas(surfaces.size()), inside(surfaces.size()), detached;
  std::vector<std::int64_t> genus;
  workers.loop(surfaces.size(), 1, [&](std::size_t s, unsigned) {
    volumes[s] = volume_of(surfaces[s]), areas[s] = area_of(surfaces[s]);
    if (s < finest) inside[s] = volume_inside(surfaces[s], box);
  });
  double sum = 0, total = 0;
  for (std::size_t s = 0; s < surfaces.size(); s++) {
    genus.push_back((2 - euler_characteristic(surfaces[s])) / 2);
    detached.push_back(s < finest ? pieces[surfaces[s].cell].detached_volume : 0);
    if (s < finest) sum += inside[s], total += volumes[s];
  }
  std::vector<std::uint8_t> closed = check.result.closed;
  std::vector<double> min_gap = check.result.min_gap;
  closed.resize(surfaces.size(), 1), min_gap.resize(surfaces.size(), 0);
  put(doc, "/meshes/volume", volumes);
  put(doc, "/meshes/area", areas);
  put(doc, "/meshes/genus", genus);
  put(doc, "/meshes/closed", closed);
  put(doc, "/meshes/min_gap", min_gap);
  put(doc, "/meshes/detached_volume", detached);
  put_scalar(doc, "/meshes@icvf", sum / volume(box));
  put_scalar(doc, "/meshes@grid_step", std::max({scene.grid.step.x, scene.grid.step.y, scene.grid.step.z}));
  put_scalar(doc, "/meshes@gap", gap);
  put_scalar(doc, "/meshes@crossings", check.result.crossings);
  put_scalar(doc, "/meshes@pairs_checked", check.result.pairs_checked);
  return total;
}

} // namespace conceg::mesh
