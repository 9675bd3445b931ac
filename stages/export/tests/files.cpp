// SPDX-License-Identifier: BSD-3-Clause
// The file writers on plain data: splitting at the box, PLY, VTK read back by VTK, and files that appear
// whole or not at all.
#include "folder.hpp"
#include "ply.hpp"
#include "spheres.hpp"
#include "tests/tissue.hpp"
#include "tree.hpp"
#include "vtk.hpp"

#include "check.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLMultiBlockDataReader.h>
#include <vtkXMLPolyDataReader.h>

#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

using namespace conceg;
using namespace conceg::exporting;

static std::string folder;

static std::string contents(const std::string &path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

static conceg_box cube() {
  conceg_box box = {};
  for (int axis = 0; axis < 3; axis++)
    box.hi[axis] = testing::box_side, box.periodic[axis] = 1;
  return box;
}

// A straight run of 50 um through the box, with a fork at its end.
static Tree long_tree() {
  Tree tree;
  tree.position = {{5, 5, 5}, {55, 5, 5}, {55, 12, 5}, {55, 5, 1}};
  tree.radius = {1.0, 2.0, 2.0, 2.0};
  tree.target_radius = {2.0, 4.0, 4.0, 4.0};
  tree.parent = {-1, 0, 1, 1};
  tree.kind = {3, 3, 3, 4};
  tree.branch = {0, 0, 1, 2};
  tree.on_soma = {1, 1, 1, 1};
  return tree;
}

static void splitting() {
  const conceg_box box = cube();
  const Tree tree = split_at_box(long_tree(), box);
  // 5 -> 20 | 0 -> 20 | 0 -> 15, then the two branches.
  CHECK_EQUAL(tree.size(), 8);
  double length = 0.0;
  int roots = 0;
  for (std::size_t i = 0; i < tree.size(); i++) {
    for (int axis = 0; axis < 3; axis++)
      CHECK(tree.position[i][axis] >= 0.0 && tree.position[i][axis] <= 20.0);
    roots += tree.parent[i] < 0;
    if (tree.parent[i] < 0) continue;
    CHECK(tree.parent[i] < static_cast<std::int64_t>(i));
    length += glm::length(tree.position[i] - tree.position[static_cast<std::size_t>(tree.parent[i])]);
  }
  CHECK_EQUAL(roots, 3);
  CHECK_NEAR(length, 61.0, 1e-9);
  CHECK_NEAR(tree.position[1].x, 20.0, 1e-9);
  CHECK_NEAR(tree.position[2].x, 0.0, 1e-9);
  CHECK_NEAR(tree.radius[1], 1.3, 1e-12);
  CHECK_NEAR(tree.target_radius[1], 2.6, 1e-12);
  CHECK_EQUAL(tree.on_soma[0], 1);
  CHECK_EQUAL(tree.on_soma[2], 0);
  CHECK_EQUAL(tree.kind[7], 4);
  CHECK_EQUAL(runs(tree).size(), 5);
  conceg_box open = box;
  open.periodic[0] = 0;
  CHECK_EQUAL(split_at_box(long_tree(), open).size(), 4);
}

static void runs_of_a_fork() {
  const std::vector<std::vector<std::uint32_t>> lists = runs(long_tree());
  CHECK_EQUAL(lists.size(), 3);
  CHECK_EQUAL(lists[0].size(), 2);
  CHECK_EQUAL(lists[1][0], 1); // a branch starts with the point of its fork
  CHECK_EQUAL(lists[2][1], 3);
}

static double widest_gap(const SphereTree &tree) {
  double widest = 0.0; // in radii of the thicker neighbour
  for (const Sphere &sphere : tree.spheres) {
    if (sphere.parent < 0) continue;
    const Sphere &before = tree.spheres[static_cast<std::size_t>(sphere.parent)];
    widest = std::max(widest, glm::length(sphere.at - before.at) / std::max(sphere.outer, before.outer));
  }
  return widest;
}

static void spheres_of_a_cell() {
  Cell cell;
  cell.soma = {10.0, 10.0, 10.0}, cell.soma_radius = 4.0;
  Tree tree;
  // A stem that thins out and forks, one branch of constant radius, and one that widens more steeply than 4.
  tree.position = {{10.0, 10.0, 15.0}, {10.0, 10.0, 45.0}, {12.0, 10.0, 47.0}, {10.0, 10.1, 45.0}};
  tree.radius = {2.0, 0.1, 0.1, 1.0};
  tree.parent = {-1, 0, 1, 1};
  const std::vector<SphereTree> pieces = sphere_trees(cell, tree, {});
  CHECK_EQUAL(pieces.size(), 1);
  CHECK(pieces[0].soma);
  CHECK(widest_gap(pieces[0]) < 0.25 * (1.0 + 1e-9) && widest_gap(pieces[0]) > 0.24);
  // Within the soma the spheres touch it from inside, until one radius of the stem below its surface.
  double depth = 0.0;
  for (const Sphere &sphere : pieces[0].spheres)
    if (sphere.at.z < 12.0 + 1e-9) {
      depth = sphere.at.z - 10.0;
      CHECK_NEAR(depth + sphere.outer, 4.0, 1e-9);
    }
  CHECK_NEAR(depth, 2.0, 1e-9);
  cell.soma_radius = 0.0, tree.parent[2] = -1;
  CHECK_EQUAL(sphere_trees(cell, tree, {}).size(), 2);

  // In a box of 20 um the stem passes z = 20 and z = 40: three images, of which the first has the soma.
  const std::vector<SphereTree> images = images_in_box(pieces[0], cube());
  CHECK_EQUAL(images.size(), 3);
  std::size_t somas = 0;
  for (const SphereTree &image : images) {
    somas += image.soma;
    CHECK(widest_gap(image) < 0.25 * (1.0 + 1e-9));
    for (const Sphere &sphere : image.spheres)
      CHECK(sphere.at.z > -sphere.outer && sphere.at.z < 20.0 + sphere.outer);
  }
  CHECK_EQUAL(somas, 1);
  conceg_box open = cube();
  open.periodic[2] = 0;
  CHECK_EQUAL(images_in_box(pieces[0], open).size(), 1);
  CHECK_EQUAL(images_in_box(pieces[0], open)[0].spheres.size(), pieces[0].spheres.size());
}

static void shares_of_balls() {
  const double ball = 4.0 / 3.0 * 3.14159265358979323846 * 27.0 / 8000.0;
  // One within, one cut in half by a side and of an axon, and one of an axon within the first.
  const BallShares shares = ball_shares({{{5.0, 6.0, 7.0}, 3.0, false},
                                         {{20.0, 12.0, 13.0}, 3.0, true},
                                         {{5.0, 6.0, 7.0}, 1.5, true},
                                         {{90.0, 0.0, 0.0}, 3.0, true}},
                                        glm::dvec3(20.0));
  CHECK_NEAR(shares.all, 1.5 * ball, 1e-3 * ball);
  CHECK_NEAR(shares.axons, (0.5 + 0.125) * ball, 1e-3 * ball);
}

// Every point of the ball's images in the box is covered: the images of its triangles in the box have the
// area of the ball.
static void tiling() {
  const Surface ball = testing::moved(testing::icosphere(3), testing::centres[1], 3.0);
  const TiledSurface tiled = tile(cube(), ball);
  CHECK(tiled.face.size() > ball.face.size());
  CHECK(tiled.face.size() < 2 * ball.face.size());
  CHECK_EQUAL(tiled.source_face.size(), tiled.face.size());
  std::vector<int> seen(ball.face.size(), 0);
  for (std::size_t i = 0; i < tiled.face.size(); i++) {
    seen[tiled.source_face[i]]++;
    const glm::dvec3 step =
        (tiled.vertex[tiled.face[i].x] - ball.vertex[ball.face[tiled.source_face[i]].x]) / testing::box_side;
    CHECK(step == glm::round(step));
  }
  for (const int count : seen)
    CHECK(count >= 1);
  Surface far;
  far.vertex = {{1e30, 0, 0}, {0, 1, 0}, {0, 0, 1}}, far.face = {{0, 1, 2}};
  bool refused = false;
  try {
    (void)tile(cube(), far);
  } catch (const Error &error) {
    refused = error.status() == CONCEG_E_RANGE;
  }
  CHECK(refused);
}

static void ply() {
  const Surface ball = testing::moved(testing::icosphere(2), {1.0 / 3.0, 2, 3}, 2.0),
                other = testing::moved(testing::icosphere(1), {9, 9, 9}, 1.0);
  const std::string text_path = folder + "/ball.ply", binary_path = folder + "/two.ply";
  {
    OutputFile file(text_path);
    write_ply(file, {&ball}, true, {"a face and a vertex with nx before end_header"});
    CHECK(!std::filesystem::exists(text_path));
    file.commit();
  }
  // A reader as simple as MC/DC's: words up to end_header, then numbers.
  std::istringstream in(contents(text_path));
  std::string word;
  std::size_t vertices = 0, faces = 0;
  int keywords = 0;
  while (in >> word && word != "end_header") {
    if (word == "vertex") in >> vertices, keywords++;
    if (word == "face") in >> faces, keywords++;
    CHECK(word != "nx");
  }
  CHECK_EQUAL(keywords, 2);
  CHECK_EQUAL(vertices, ball.vertex.size());
  CHECK_EQUAL(faces, ball.face.size());
  int wrong = 0;
  for (std::size_t i = 0; i < vertices; i++) {
    glm::dvec3 p;
    in >> p.x >> p.y >> p.z;
    wrong += p != ball.vertex[i];
  }
  for (std::size_t i = 0; i < faces; i++) {
    int sides = 0;
    glm::uvec3 f;
    in >> sides >> f.x >> f.y >> f.z;
    wrong += sides != 3 || f != ball.face[i];
  }
  CHECK(!in.fail());
  CHECK_EQUAL(wrong, 0);

  {
    OutputFile file(binary_path);
    write_ply(file, {&ball, &other}, false, {});
    file.commit();
  }
  const std::string bytes = contents(binary_path);
  const std::size_t body = bytes.find("end_header\n") + 11, all = ball.vertex.size() + other.vertex.size();
  CHECK_EQUAL(bytes.size() - body, 24 * all + 13 * (ball.face.size() + other.face.size()));
  double x = 0.0;
  std::memcpy(&x, bytes.data() + body + 24 * ball.vertex.size(), sizeof x);
  CHECK(x == other.vertex[0].x);
  std::uint32_t last = 0;
  std::memcpy(&last, bytes.data() + bytes.size() - 4, sizeof last);
  CHECK_EQUAL(last, other.face.back().z + ball.vertex.size());
}

static void vtk_skeletons() {
  const Tree tree = long_tree();
  const std::string path = folder + "/skeletons.vtp";
  write_skeletons_vtp(path, {{&tree, {1, 2, 3}, 4.0, 7, 2}, {&tree, {0, 0, 0}, 0.0, 8, 1}});
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkPolyData *data = reader->GetOutput();
  CHECK_EQUAL(data->GetNumberOfPoints(), 9);
  CHECK_EQUAL(data->GetNumberOfLines(), 6);
  CHECK_EQUAL(data->GetNumberOfVerts(), 1);
  CHECK(data->GetPointData()->GetArray("radius") && data->GetCellData()->GetArray("type"));
  if (!data->GetPointData()->GetArray("radius")) return;
  CHECK_NEAR(data->GetPointData()->GetArray("radius")->GetComponent(0, 0), 4.0, 0.0);
  CHECK_NEAR(data->GetPointData()->GetArray("target_radius")->GetComponent(2, 0), 4.0, 0.0);
  CHECK_EQUAL(data->GetPointData()->GetArray("kind")->GetComponent(0, 0), 1);
  CHECK_EQUAL(data->GetCellData()->GetArray("cell")->GetComponent(0, 0), 7);
  CHECK_EQUAL(data->GetCellData()->GetArray("cell")->GetComponent(6, 0), 8);
  CHECK_NEAR(data->GetPoint(2)[0], 55.0, 0.0);
}

static void vtk_surfaces() {
  const Surface ball = testing::moved(testing::icosphere(2), {1.0 / 3.0, 2, 3}, 2.0);
  std::vector<std::uint32_t> section(ball.face.size());
  for (std::size_t i = 0; i < section.size(); i++)
    section[i] = static_cast<std::uint32_t>(i);
  make_folder(folder + "/surfaces");
  write_surface_vtp(folder + "/surfaces/a.vtp",
                    {&ball, std::vector<std::uint8_t>(ball.face.size(), 3), {}, section, 4, 1});
  write_surface_vtp(folder + "/surfaces/b.vtp", {&ball, {}, {}, {}, 5, 1});
  write_blocks_vtm(folder + "/surfaces.vtm", {{"surfaces/a.vtp", "first"}, {"surfaces/b.vtp", "a < b & c"}});
  vtkNew<vtkXMLMultiBlockDataReader> reader;
  reader->SetFileName((folder + "/surfaces.vtm").c_str());
  reader->Update();
  auto *blocks = vtkMultiBlockDataSet::SafeDownCast(reader->GetOutput());
  CHECK(blocks && blocks->GetNumberOfBlocks() == 2);
  if (!blocks || blocks->GetNumberOfBlocks() != 2) return;
  auto *first = vtkPolyData::SafeDownCast(blocks->GetBlock(0));
  CHECK(first && first->GetNumberOfPolys() == static_cast<vtkIdType>(ball.face.size()));
  if (!first) return;
  CHECK_EQUAL(first->GetNumberOfPoints(), ball.vertex.size());
  CHECK(first->GetPoint(5)[0] == ball.vertex[5].x);
  CHECK_EQUAL(first->GetCellData()->GetArray("section")->GetComponent(17, 0), 17);
  CHECK_EQUAL(first->GetCellData()->GetArray("compartment")->GetComponent(17, 0), 3);
  CHECK_EQUAL(first->GetCellData()->GetArray("cell")->GetComponent(0, 0), 4);
  CHECK(!first->GetCellData()->GetArray("component"));
  CHECK_TEXT(blocks->GetMetaData(1u)->Get(vtkCompositeDataSet::NAME()), "a < b & c");
}

static void vtk_volume() {
  Volume volume;
  volume.origin = {0.5, 0, 0}, volume.spacing = {1, 2, 3}, volume.shape = {4, 3, 2};
  for (std::uint32_t i = 0; i < 24; i++)
    volume.label.push_back(i), volume.distance.push_back(0.5f * static_cast<float>(i));
  write_volume_vti(folder + "/volume.vti", volume);
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName((folder + "/volume.vti").c_str());
  reader->Update();
  vtkImageData *image = reader->GetOutput();
  CHECK_EQUAL(image->GetNumberOfPoints(), 24);
  CHECK_NEAR(image->GetSpacing()[2], 3.0, 0.0);
  CHECK(image->GetPointData()->GetArray("label") != nullptr);
  if (!image->GetPointData()->GetArray("label")) return;
  CHECK_EQUAL(image->GetPointData()->GetArray("label")->GetComponent(5, 0), 5); // x fastest: (1, 1, 0)
  CHECK_NEAR(image->GetPointData()->GetArray("distance")->GetComponent(23, 0), 11.5, 0.0);
}

static conceg_status status_of(const std::function<void()> &body) {
  try {
    body();
  } catch (const Error &error) {
    CHECK(*error.what());
    return error.status();
  }
  return CONCEG_OK;
}

static void names_and_failures() {
  CHECK(cell_file_name(7, "L2/3 pyramidal") == "cell_0007_L23_pyramidal");
  CHECK(cell_file_name(12345, "../x, y") == "cell_12345_x_y");
  CHECK(quoted_csv("a,\"b\"") == "\"a,\"\"b\"\"\"");
  CHECK(quoted_json("a\"\n") == "\"a\\\"\\u000a\"");
  CHECK(quoted_json("\xC2\xB5\xF0\x9F\x98\x80") == "\"\\u00b5\\ud83d\\ude00\"");
  const std::string plain = folder + "/plain";
  std::ofstream(plain) << "x";
  CHECK_EQUAL(status_of([&] { OutputFolder out(plain + "/below"); }), CONCEG_E_IO);
  CHECK_EQUAL(status_of([&] { OutputFolder out(plain); }), CONCEG_E_IO);
  CHECK_EQUAL(status_of([&] { OutputFolder out(""); }), CONCEG_E_PARAM);
  CHECK_EQUAL(status_of([&] { OutputFile out(folder + "/absent/file"); }), CONCEG_E_IO);
  // A file that may not grow any more, as on a full disk: the final name never appears.
  {
    const std::string path = folder + "/never";
    rlimit before;
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit small = {1000, before.rlim_max};
    std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &small);
    CHECK_EQUAL(status_of([&] {
                  OutputFile out(path);
                  out.write(std::string(1 << 20, 'x'));
                  out.commit();
                }),
                CONCEG_E_IO);
    setrlimit(RLIMIT_FSIZE, &before);
    CHECK(!std::filesystem::exists(path));
  }
  // What a killed run has left goes when the folder is used again; what somebody else holds stays.
  {
    const std::string left = folder + "/.conceg-1-7.tmp", held = folder + "/.conceg-1-8.tmp",
                      other = folder + "/.conceg-x.tmp";
    std::ofstream(left) << "left";
    std::ofstream(held) << "held";
    std::ofstream(other) << "not of this form";
    const int descriptor = open(held.c_str(), O_RDONLY);
    CHECK_EQUAL(flock(descriptor, LOCK_EX), 0);
    make_folder(folder);
    CHECK(!std::filesystem::exists(left));
    CHECK(std::filesystem::exists(held));
    CHECK(std::filesystem::exists(other));
    close(descriptor);
    make_folder(folder);
    CHECK(!std::filesystem::exists(held));
    std::filesystem::remove(other);
  }
  // A writer that gives up half way leaves nothing.
  {
    OutputFile out(folder + "/given_up");
    out.write("half");
  }
  CHECK(!std::filesystem::exists(folder + "/given_up"));
  for (const auto &entry : std::filesystem::directory_iterator(folder))
    CHECK(entry.path().string().find(".conceg") == std::string::npos);
}

int main() {
  folder =
      (std::filesystem::temp_directory_path() / ("conceg_export_files_" + std::to_string(getpid()))).string();
  make_folder(folder);
  splitting();
  runs_of_a_fork();
  spheres_of_a_cell();
  shares_of_balls();
  tiling();
  ply();
  vtk_skeletons();
  vtk_surfaces();
  vtk_volume();
  names_and_failures();
  std::filesystem::remove_all(folder);
  return check_done();
}
