// SPDX-License-Identifier: BSD-3-Clause
// Pictures of known shapes: the silhouette and the cut of a ball, tiling at the box, colours, text, PNG,
// thread counts.
#include "output.hpp"
#include "picture.hpp"
#include "png.hpp"
#include "tests/tissue.hpp"

#include "check.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <filesystem>
#include <unistd.h>

using namespace conceg;
using namespace conceg::rendering;

static const double pi = 3.14159265358979323846;

static Scene empty_scene(bool clipped) {
  Scene scene;
  for (int axis = 0; axis < 3; axis++)
    scene.box.hi[axis] = testing::box_side, scene.box.periodic[axis] = 1;
  scene.clipped = clipped;
  scene.types = {"ball"};
  scene.type_colour = type_colours({"pyramidal"});
  return scene;
}

static Scene ball_scene(bool clipped, const glm::dvec3 &centre, double radius, bool cones) {
  Scene scene = empty_scene(clipped);
  std::vector<Cell> cells(1);
  if (cones)
    cells[0].cones = {{centre, centre, radius, radius}};
  else
    cells[0].surface = testing::moved(testing::icosphere(5), centre, radius);
  Workers workers(2);
  add_bodies(scene, cells, workers, nullptr);
  return scene;
}

static bool is_cell(const Colour &pixel) {
  return pixel.b > pixel.r + 0.08f;
} // pyramidal blue

// Area that the cell takes in the plot of a picture, in um2.
static double cell_area(const Image &image, double um_per_pixel, int right) {
  double count = 0.0;
  for (int y = 0; y < image.height; y++)
    for (int x = 0; x < right; x++)
      count += is_cell(image.at(x, y));
  return count * um_per_pixel * um_per_pixel;
}

static void silhouettes() {
  for (const bool cones : {false, true}) {
    const Scene scene = ball_scene(true, {10, 10, 10}, 6.0, cones);
    const Camera camera(scene, 35, 22);
    Frame frame = {0, 0, 400, 400, 0.1, 2};
    Image image(400, 400, Colour(1.0f));
    Workers workers(2);
    const auto rays = make_ray_scene(scene, 2);
    draw_scene(image, frame, scene, *rays, camera, workers, nullptr);
    CHECK_NEAR(cell_area(image, 0.1, 400), pi * 36.0, 0.02 * pi * 36.0);
  }
}

static void balls_across_the_corner() {
  // Looking along z at a ball around the corner: four quarters, together one ball; the cut faces belong to
  // it.
  for (const bool cones : {false, true}) {
    const Scene scene = ball_scene(true, {0, 20, 20}, 6.0, cones);
    const Camera camera(scene, 0, 90);
    CHECK_NEAR(camera.extent().x, 20.0, 1e-9);
    Frame frame = {0, 0, 200, 200, 0.1, 2};
    Image image(200, 200, Colour(1.0f));
    Workers workers(2);
    draw_scene(image, frame, scene, *make_ray_scene(scene, 2), camera, workers, nullptr);
    CHECK_NEAR(cell_area(image, 0.1, 200), pi * 36.0, 0.03 * pi * 36.0);
    CHECK(is_cell(image.at(5, 5)) && is_cell(image.at(194, 5)) && is_cell(image.at(5, 194)) &&
          is_cell(image.at(194, 194)));
    CHECK(!is_cell(image.at(100, 100)));
  }
  const Scene whole = ball_scene(false, {0, 20, 20}, 6.0, false);
  CHECK_NEAR(whole.lo.x, -6.0, 0.02);
  CHECK_NEAR(whole.hi.z, 26.0, 0.02);
}

static void cuts() {
  Workers workers(2);
  for (const bool cones : {false, true})
    for (int axis = 0; axis < 3; axis++)
      for (const double offset : {0.0, 3.0}) {
        // The second ball lies around a corner of the box, so that its disc comes in pieces.
        for (const glm::dvec3 &centre : {glm::dvec3(10, 10, 10), glm::dvec3(0.5, 19.5, 0.25)}) {
          const Scene scene = ball_scene(true, centre, 6.0, cones);
          const double position = std::fmod(centre[axis] + offset, testing::box_side);
          const CutMap map = cut(scene, cut_plane(axis, position), 500, 500, 0.1, workers, nullptr);
          CHECK_NEAR(map.covered * 400.0, pi * (36.0 - offset * offset), 0.01 * pi * 36.0);
          double line = 0.0;
          for (const auto mark : map.membrane)
            line += mark;
          const double drawn = 0.1 * 2.0 * pi * std::sqrt(36.0 - offset * offset);
          CHECK_NEAR(line * 400.0 / (500.0 * 500.0), drawn, 0.05 * drawn);
        }
      }
  // No membrane in the plane at all: nothing is covered.
  const Scene scene = ball_scene(true, {10, 10, 10}, 6.0, false);
  CHECK_NEAR(cut(scene, cut_plane(2, 1.0), 50, 50, 0.1, workers, nullptr).covered, 0.0, 0.0);
}

// A surface turned inside out is seen as such: the cut fills the outside instead.
static void inverted_surface_is_noticed() {
  Scene scene = empty_scene(true);
  std::vector<Cell> cells(1);
  cells[0].surface = testing::moved(testing::icosphere(3), {10, 10, 10}, 6.0);
  for (glm::uvec3 &f : cells[0].surface.face)
    std::swap(f.y, f.z);
  Workers workers(1);
  add_bodies(scene, cells, workers, nullptr);
  const CutMap map = cut(scene, cut_plane(2, 10.0), 200, 200, 0.1, workers, nullptr);
  CHECK_NEAR(map.covered, 1.0 - pi * 36.0 / 400.0, 0.01);
}

static void thread_counts() {
  const Scene scene = ball_scene(true, {0.5, 19.5, 0.25}, 6.0, false);
  PictureOptions options;
  options.size_px = 200;
  Workers one(1), three(3);
  CHECK(picture_of_cut(scene, options, one, nullptr).pixel ==
        picture_of_cut(scene, options, three, nullptr).pixel);
  // Three first: a device for one thread limits TBB in the whole process.
  const Image by_three = picture_of_cells(scene, options, three, nullptr);
  CHECK(picture_of_cells(scene, options, one, nullptr).pixel == by_three.pixel);
}

static void sizes() {
  Workers workers(2);
  PictureOptions options;
  for (const int size : {64, 300}) {
    options.size_px = size;
    for (const Image &image :
         {picture_of_cells(ball_scene(true, {10, 10, 10}, 4.0, false), options, workers, nullptr),
          picture_of_cut(ball_scene(true, {10, 10, 10}, 4.0, false), options, workers, nullptr)}) {
      CHECK_EQUAL(std::max(image.width, image.height), size);
      CHECK_EQUAL(image.pixel.size(), image.width * image.height);
    }
  }
  CHECK_NEAR(scale_bar_um(9.99), 5.0, 1e-12);
  CHECK_NEAR(scale_bar_um(10.0), 10.0, 1e-9);
  CHECK_NEAR(scale_bar_um(0.0299), 0.02, 1e-12);
}

static float distance(const Colour &a, const Colour &b) {
  return glm::length(a - b);
}

static void colours() {
  const std::vector<std::string> classes = {"pyramidal", "pyramidal", "interneuron", "interneuron",
                                            "astrocyte", "microglia", "axon",        "other"};
  const std::vector<Colour> palette = type_colours(classes);
  for (std::size_t i = 0; i < palette.size(); i++)
    for (std::size_t j = 0; j < i; j++)
      CHECK(distance(palette[i], palette[j]) > 0.2f);
  // Classes stay apart for an eye without the red-green channel: compare yellow-blue and lightness only.
  const auto seen = [](const Colour &c) {
    return glm::vec2(0.5f * (c.r + c.g) - c.b, 0.3f * c.r + 0.6f * c.g + 0.1f * c.b);
  };
  for (const int i : {0, 2, 4, 5})
    for (const int j : {0, 2, 4, 5})
      if (i < j)
        CHECK(glm::length(seen(palette[static_cast<std::size_t>(i)]) -
                          seen(palette[static_cast<std::size_t>(j)])) > 0.08f);
  for (std::uint64_t id = 0; id < 50; id++)
    CHECK(distance(cell_colour(palette[0], id), palette[0]) < 0.2f);
  CHECK(cell_colour(palette[0], 1) != cell_colour(palette[0], 2));
  const std::vector<Colour> many = type_colours(std::vector<std::string>(30, "astrocyte"));
  CHECK_EQUAL(many.size(), 30);
  for (int k = 0; k < 3; k++)
    CHECK_NEAR(to_srgb(to_linear(palette[1]))[k], palette[1][k], 1e-5);
}

static void text() {
  Image image(200, 40, Colour(1.0f));
  draw_text(image, "L2/3 \xC2\xB5m", 5, 30, 20, Colour(0.0f));
  double dark = 0.0;
  for (const Colour &pixel : image.pixel)
    dark += 1.0 - pixel.r;
  CHECK(dark > 100.0 && dark < 2000.0);
  CHECK(text_width("mm", 10) > text_width("il", 10));
  CHECK_NEAR(text_width("", 10), 0.0, 0.0);
  draw_text(image, "\xFF\xE2\x82", -50, 500, 20, Colour(0.0f)); // broken UTF-8, outside of the picture
}

static void png() {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("conceg_render_" + std::to_string(getpid()) + ".png"))
          .string();
  Image image(30, 20, Colour(1.0f));
  image.at(3, 2) = Colour(1.0f, 0.0f, 0.5f);
  write_png(path, image);
  vtkNew<vtkPNGReader> reader;
  CHECK(reader->CanReadFile(path.c_str()));
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData *data = reader->GetOutput();
  CHECK_EQUAL(data->GetDimensions()[0], 30);
  CHECK_EQUAL(data->GetDimensions()[1], 20);
  CHECK_EQUAL(data->GetScalarComponentAsDouble(3, 17, 0, 1), 0);
  CHECK_EQUAL(data->GetScalarComponentAsDouble(3, 17, 0, 2), 128);
  CHECK_EQUAL(data->GetScalarComponentAsDouble(4, 17, 0, 1), 255);
  std::filesystem::remove(path);
  conceg_status status = CONCEG_OK;
  try {
    write_png(path + "/below/x.png", image);
  } catch (const Error &error) {
    status = error.status();
  }
  CHECK_EQUAL(status, CONCEG_E_IO);
}

int main() {
  silhouettes();
  balls_across_the_corner();
  cuts();
  inverted_surface_is_noticed();
  sizes();
  colours();
  text();
  png();
  thread_counts();
  return check_done();
}
