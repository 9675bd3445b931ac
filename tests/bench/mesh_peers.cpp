// SPDX-License-Identifier: BSD-3-Clause
// The surfaces of a document's cells by one way of making them, judged by the check of the mesh stage:
//   bench_mesh_peers DOC ours|openvdb|vtk|FOLDER H_UM THREADS    prints a JSON object
//   bench_mesh_peers DOC balls OUT H_UM                          writes the cells as balls for
//   tests/bench/metaballs.py
// ours: /meshes as it stands. openvdb, vtk: one surface per cell from the stage's own separated field on a
// grid of H_UM, by OpenVDB's volumeToMesh and by vtkFlyingEdges3D. FOLDER: cell_<row>.bin as metaballs.py
// writes them.
#include "check.hpp"
#include "components.hpp"
#include "conceg/conceg.h"
#include "field.hpp"
#include "view.hpp"
#include "wrap.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <vtkAppendPolyData.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStaticCleanPolyData.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <string>
#include <sys/resource.h>
#include <time.h>

namespace {

using namespace conceg;
using namespace conceg::mesh;

constexpr float band = 2.0f; // steps

double seconds(clockid_t clock) {
  timespec t;
  clock_gettime(clock, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

template <class T> std::vector<T> all(conceg_doc *doc, const char *path, std::size_t columns = 1) {
  const View<T> values = view<T>(doc, path, columns);
  return std::vector<T>(values.begin(), values.end());
}

Tissue tissue_of(conceg_doc *doc) {
  Tissue tissue;
  tissue.box = read_box(doc);
  tissue.soma = vec3s<glm::dvec3>(doc, "/cells/soma");
  tissue.soma_radius = all<float>(doc, "/cells/radius");
  tissue.offset = all<std::uint64_t>(doc, "/skeleton/cell_offset");
  tissue.point = vec3s<glm::dvec3>(doc, "/skeleton/position");
  tissue.radius = all<float>(doc, "/skeleton/radius");
  tissue.parent = all<std::int64_t>(doc, "/skeleton/parent");
  tissue.kind = all<std::uint8_t>(doc, "/skeleton/kind");
  if (has(doc, "/skeleton/branch")) tissue.branch = all<std::uint32_t>(doc, "/skeleton/branch");
  return tissue;
}

std::vector<Surface> ours(conceg_doc *doc) {
  std::vector<Surface> surfaces;
  const auto cell = all<std::uint32_t>(doc, "/meshes/cell"),
             face = all<std::uint32_t>(doc, "/meshes/face", 3);
  const auto vertices = all<std::uint64_t>(doc, "/meshes/vertex_offset"),
             faces = all<std::uint64_t>(doc, "/meshes/face_offset");
  const std::vector<glm::dvec3> origin = vec3s<glm::dvec3>(doc, "/meshes/origin"),
                                vertex = vec3s<glm::dvec3>(doc, "/meshes/vertex");
  for (std::size_t i = 0; i < cell.size(); i++) {
    Surface surface;
    surface.cell = cell[i], surface.origin = origin[i];
    for (std::uint64_t v = vertices[i]; v < vertices[i + 1]; v++)
      surface.vertex.push_back(glm::vec3(vertex[v] - origin[i]));
    for (std::uint64_t f = faces[i]; f < faces[i + 1]; f++)
      surface.face.emplace_back(face[3 * f], face[3 * f + 1], face[3 * f + 2]);
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

// body(field, label number, unwrapped place of its node (0, 0, 0)) for every label of every block, cell by
// cell afterwards: `after` is called once all blocks are through.
template <class Body> void for_each_label(const Scene &scene, const Index &index, Body &&body) {
  BlockField field;
  for (std::size_t row = 0; row < index.block.size(); row++) {
    evaluate_block(scene, index, row, field);
    for (std::size_t i = 0; i < field.label.size(); i++)
      body(field, i, field.first - field.label[i].lift * scene.grid.size);
  }
}

bool changes_sign(const float *value) {
  bool negative = false, positive = false;
  for (int i = 0; i < kNodes; i++)
    (value[i] < 0 ? negative : positive) = true;
  return negative && positive;
}

int node(int x, int y, int z) {
  return (z * kRow + y) * kRow + x;
}

Surface placed(std::uint32_t cell, const Tissue &tissue, const Scene &scene, std::vector<glm::dvec3> voxel,
               std::vector<glm::uvec3> face) {
  Surface surface;
  surface.cell = cell, surface.origin = tissue.soma[cell];
  for (const glm::dvec3 &v : voxel)
    surface.vertex.push_back(written(scene.grid.origin + v * scene.grid.step - surface.origin));
  surface.face = std::move(face);
  if (volume_of(surface) < 0)
    for (glm::uvec3 &f : surface.face)
      std::swap(f.y, f.z);
  return surface;
}

std::vector<Surface> by_openvdb(const Tissue &tissue, const Scene &scene, const Index &index) {
  openvdb::initialize();
  std::vector<openvdb::FloatGrid::Ptr> grids;
  for (std::size_t cell = 0; cell < tissue.cells(); cell++)
    grids.push_back(openvdb::FloatGrid::create(band));
  for_each_label(scene, index, [&](const BlockField &field, std::size_t i, const glm::ivec3 &first) {
    auto write = grids[field.label[i].cell]->getAccessor();
    for (int z = kHalo; z < kHalo + field.cubes.z; z++)
      for (int y = kHalo; y < kHalo + field.cubes.y; y++)
        for (int x = kHalo; x < kHalo + field.cubes.x; x++) {
          const float value = field.of(i)[node(x, y, z)];
          if (std::fabs(value) < band) write.setValue({first.x + x, first.y + y, first.z + z}, value);
        }
  });
  std::vector<Surface> surfaces;
  for (std::uint32_t cell = 0; cell < tissue.cells(); cell++) {
    openvdb::tools::signedFloodFill(grids[cell]->tree());
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*grids[cell], points, triangles, quads, 0.0, 0.0);
    grids[cell].reset();
    std::vector<glm::dvec3> voxel;
    std::vector<glm::uvec3> face;
    for (const openvdb::Vec3s &p : points)
      voxel.emplace_back(p.x(), p.y(), p.z());
    for (const openvdb::Vec4I &q : quads)
      face.emplace_back(q[0], q[1], q[2]), face.emplace_back(q[0], q[2], q[3]);
    for (const openvdb::Vec3I &t : triangles)
      face.emplace_back(t[0], t[1], t[2]);
    if (!face.empty()) surfaces.push_back(placed(cell, tissue, scene, std::move(voxel), std::move(face)));
  }
  return surfaces;
}

std::vector<Surface> by_vtk(const Tissue &tissue, const Scene &scene, const Index &index) {
  std::map<std::uint32_t, vtkNew<vtkAppendPolyData>> parts;
  for_each_label(scene, index, [&](const BlockField &field, std::size_t i, const glm::ivec3 &first) {
    if (!changes_sign(field.of(i))) return;
    vtkNew<vtkImageData> image;
    image->SetDimensions(field.cubes.x + 1, field.cubes.y + 1, field.cubes.z + 1);
    image->SetOrigin(first.x + kHalo, first.y + kHalo, first.z + kHalo);
    vtkNew<vtkFloatArray> scalars;
    for (int z = 0; z <= field.cubes.z; z++)
      for (int y = 0; y <= field.cubes.y; y++)
        for (int x = 0; x <= field.cubes.x; x++)
          scalars->InsertNextValue(std::min(field.of(i)[node(x + kHalo, y + kHalo, z + kHalo)], 100.0f));
    image->GetPointData()->SetScalars(scalars);
    vtkNew<vtkFlyingEdges3D> contour;
    contour->SetInputData(image);
    contour->SetValue(0, 0.0);
    contour->ComputeNormalsOff();
    contour->ComputeScalarsOff();
    contour->Update();
    if (contour->GetOutput()->GetNumberOfCells()) {
      vtkNew<vtkPolyData> part;
      part->ShallowCopy(contour->GetOutput());
      parts[field.label[i].cell]->AddInputData(part);
    }
  });
  std::vector<Surface> surfaces;
  for (auto &[cell, append] : parts) {
    vtkNew<vtkStaticCleanPolyData> clean; // points of neighbouring blocks become one
    clean->SetInputConnection(append->GetOutputPort());
    clean->ToleranceIsAbsoluteOn();
    clean->SetAbsoluteTolerance(1e-3);
    clean->Update();
    vtkPolyData *made = clean->GetOutput();
    std::vector<glm::dvec3> voxel(static_cast<std::size_t>(made->GetNumberOfPoints()));
    for (std::size_t v = 0; v < voxel.size(); v++)
      made->GetPoint(static_cast<vtkIdType>(v), &voxel[v].x);
    std::vector<glm::uvec3> face;
    vtkNew<vtkIdList> ids;
    for (vtkIdType f = 0; f < made->GetNumberOfCells(); f++) {
      made->GetCellPoints(f, ids);
      if (ids->GetNumberOfIds() == 3) face.emplace_back(ids->GetId(0), ids->GetId(1), ids->GetId(2));
    }
    surfaces.push_back(placed(cell, tissue, scene, std::move(voxel), std::move(face)));
    append->RemoveAllInputs();
  }
  return surfaces;
}

// Takes out faces without area, which the check cannot place, after points at one place have become one.
// Returns how many; what their absence opens is counted as open edges.
std::size_t take_out_degenerate(Surface &surface) {
  std::map<std::array<float, 3>, std::uint32_t> at;
  std::vector<glm::vec3> kept;
  std::vector<std::uint32_t> number;
  for (const glm::vec3 &p : surface.vertex) {
    const auto [found, fresh] = at.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(kept.size()));
    if (fresh) kept.push_back(p);
    number.push_back(found->second);
  }
  std::vector<glm::uvec3> face;
  for (const glm::uvec3 &old : surface.face) {
    const glm::uvec3 f(number[old.x], number[old.y], number[old.z]);
    const glm::dvec3 a(kept[f.x]), normal = glm::cross(glm::dvec3(kept[f.y]) - a, glm::dvec3(kept[f.z]) - a);
    if (f.x != f.y && f.y != f.z && f.z != f.x && glm::dot(normal, normal) > 0) face.push_back(f);
  }
  const std::size_t gone = surface.face.size() - face.size();
  surface.vertex = std::move(kept), surface.face = std::move(face);
  return gone;
}

// cell_<row>.bin: u64 vertices, u64 faces, f32 x y z in um, u32 corners.
std::vector<Surface> from_folder(const Tissue &tissue, const std::string &folder) {
  std::vector<Surface> surfaces;
  for (std::uint32_t cell = 0; cell < tissue.cells(); cell++) {
    std::ifstream in(folder + "/cell_" + std::to_string(cell) + ".bin", std::ios::binary);
    std::uint64_t count[2];
    if (!in.read(reinterpret_cast<char *>(count), sizeof count) || !count[1]) continue;
    std::vector<glm::vec3> vertex(count[0]);
    Surface surface;
    surface.cell = cell, surface.face.resize(count[1]);
    in.read(reinterpret_cast<char *>(vertex.data()),
            static_cast<std::streamsize>(count[0] * sizeof(glm::vec3)));
    in.read(reinterpret_cast<char *>(surface.face.data()),
            static_cast<std::streamsize>(count[1] * sizeof(glm::uvec3)));
    for (const glm::vec3 &p : vertex)
      surface.vertex.push_back(written(glm::dvec3(p)));
    if (volume_of(surface) < 0)
      for (glm::uvec3 &f : surface.face)
        std::swap(f.y, f.z);
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

// Text for metaballs.py: cell x y z r, balls along every cone at most half a radius apart, and the box.
void write_balls(const Tissue &tissue, const Scene &scene, const char *path) {
  std::FILE *out = std::fopen(path, "w");
  if (!out) std::exit(4);
  for (int axis = 0; axis < 3; axis++)
    std::fprintf(out, "%.9g ", conceg_box_side(&tissue.box, axis));
  std::fprintf(out, "\n");
  const double unit = scene.grid.unit / kFixed;
  for (const Cone &cone : scene.cone) {
    const glm::dvec3 a = scene.grid.origin + glm::dvec3(cone.a) / double(kFixed) * scene.grid.step,
                     b = scene.grid.origin + glm::dvec3(cone.b) / double(kFixed) * scene.grid.step;
    const double ra = cone.ra * unit, rb = cone.rb * unit;
    const int steps = std::max(1, static_cast<int>(std::ceil(glm::length(b - a) / (0.5 * std::min(ra, rb)))));
    for (int k = cone.kind == kSomaKind ? steps : 1; k <= steps; k++) {
      const double t = double(k) / steps;
      const glm::dvec3 p = glm::mix(a, b, t);
      std::fprintf(out, "%u %.6f %.6f %.6f %.6f\n", cone.cell, p.x, p.y, p.z, glm::mix(ra, rb, t));
    }
  }
  std::fclose(out);
}

void judge(const Tissue &tissue, std::vector<Surface> surfaces, unsigned threads, double wall, double cpu) {
  std::size_t degenerate = 0;
  for (Surface &surface : surfaces)
    degenerate += take_out_degenerate(surface);
  CheckOptions options;
  options.reach = 0;
  Workers workers(threads);
  const double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
  const CheckResult result = check_surfaces(views_of(surfaces), tissue.box, options, workers, {});
  const double checked = seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
  std::size_t faces = 0;
  double area = 0, volume = 0;
  for (const Surface &surface : surfaces)
    faces += surface.face.size(), area += area_of(surface), volume += volume_of(surface);
  std::map<Flaw, std::size_t> flaws;
  for (const Defect &defect : result.defects)
    flaws[defect.flaw]++;
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  std::printf(
      "{\"surfaces\": %zu, \"faces\": %zu, \"area_um2\": %.1f, \"volume_um3\": %.1f, \"wall_s\": %.2f, "
      "\"cpu_s\": %.2f, \"check_cpu_s\": %.2f, \"pairs\": %llu, \"crossings_of_cells\": %zu, "
      "\"crossings_of_images\": %zu, \"crossings_of_self\": %zu, \"folds\": %zu, \"open_edges\": %zu, "
      "\"edges_of_many_faces\": %zu, \"split_vertices\": %zu, \"degenerate_faces\": %zu, "
      "\"peak_rss_mib\": %ld}\n",
      surfaces.size(), faces, area, volume, wall, cpu, checked,
      static_cast<unsigned long long>(result.pairs_checked), flaws[Flaw::crossing_cells],
      flaws[Flaw::crossing_image], flaws[Flaw::crossing_self], flaws[Flaw::fold], flaws[Flaw::open_edge],
      flaws[Flaw::turned_face], flaws[Flaw::split_vertex], degenerate, usage.ru_maxrss / 1024);
}

int bench(conceg_ctx *ctx, char **argv) {
  conceg_doc *doc = nullptr;
  must(conceg_doc_open(ctx, argv[1], &doc));
  const Tissue tissue = tissue_of(doc);
  const std::string way = argv[2];
  const bool balls = way == "balls";
  const auto threads = static_cast<unsigned>(balls ? 1 : std::atoi(argv[4]));
  SceneOptions options;
  options.h = std::atof(balls ? argv[4] : argv[3]);
  options.gap = 0.04;
  options.cluster = false;
  if (balls) options.centred = true; // the radii as they are
  const double wall = seconds(CLOCK_MONOTONIC), cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
  Workers one(1);
  std::vector<Surface> surfaces;
  if (way == "ours") {
    surfaces = ours(doc);
  } else if (balls) {
    write_balls(tissue, make_scene(tissue, options), argv[3]);
    return 0;
  } else if (way == "openvdb" || way == "vtk") {
    const Scene scene = make_scene(tissue, options);
    const Index index = make_index(scene, one, {});
    surfaces = way == "vtk" ? by_vtk(tissue, scene, index) : by_openvdb(tissue, scene, index);
    for (Surface &surface : surfaces)
      keep_soma_piece(surface, glm::dvec3(0), tissue.soma_radius[surface.cell] > 0);
  } else {
    surfaces = from_folder(tissue, way);
  }
  judge(tissue, surfaces, threads, seconds(CLOCK_MONOTONIC) - wall, seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu);
  return conceg_doc_close(doc) == CONCEG_OK ? 0 : 4;
}

} // namespace

int main(int argc, char **argv) {
  if (argc != 5) {
    std::fprintf(stderr,
                 "usage: bench_mesh_peers DOC ours|openvdb|vtk|FOLDER H_UM THREADS | DOC balls OUT H_UM\n");
    return 2;
  }
  conceg_ctx *ctx = conceg_ctx_new();
  try {
    const int status = bench(ctx, argv);
    conceg_ctx_free(ctx);
    return status;
  } catch (const std::exception &error) {
    std::fprintf(stderr, "%s %s\n", error.what(), conceg_ctx_error(ctx));
    return 1;
  }
}
