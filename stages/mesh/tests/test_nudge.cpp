// SPDX-License-Identifier: BSD-3-Clause
// Faces that are too near are moved apart, and nothing else is; a check of moved faces finds what a check of
// everything finds; surfaces that a later run takes over stay as they were.
#include "check.h"
#include "nudge.hpp"
#include "scenes.hpp"

#include <cstring>

using namespace scenes;

namespace {

constexpr double kLeast = 0.1;

// Balls and tubes, each with its own surface on its own: they know nothing of one another.
std::vector<Surface> alone(const std::vector<Tissue> &tissues) {
  SceneOptions options;
  options.h = 0.25;
  std::vector<Surface> surfaces;
  for (const Tissue &tissue : tissues)
    surfaces.push_back(mesh_of(tissue, options, 1, true, true).surfaces[0]);
  for (std::uint32_t i = 0; i < surfaces.size(); i++)
    surfaces[i].cell = i;
  return surfaces;
}

Tissue ball(const glm::dvec3 &centre, double radius) {
  Tissue tissue = empty_box(12);
  add_cell(tissue, centre, radius);
  return tissue;
}

CheckOptions options_of() {
  CheckOptions options;
  options.least_gap = kLeast, options.reach = 1.5 * kLeast;
  return options;
}

CheckResult check(const std::vector<Surface> &surfaces) {
  conceg::Workers workers(2);
  return check_surfaces(views_of(surfaces), empty_box(12).box, options_of(), workers, {});
}

void put_in_place(const Nudged &nudged, std::vector<Surface> &surfaces) {
  for (std::size_t s = 0; s < surfaces.size(); s++)
    for (const MovedVertex &v : nudged.vertex[s])
      surfaces[s].vertex[v.vertex] = v.place;
}

void same_defects(const CheckResult &one, const CheckResult &other) {
  CHECK_EQUAL(one.defects.size(), other.defects.size());
  for (std::size_t i = 0; i < std::min(one.defects.size(), other.defects.size()); i++) {
    const Defect &a = one.defects[i], &b = other.defects[i];
    CHECK(a.flaw == b.flaw && a.surface == b.surface && a.face == b.face &&
          a.other_surface == b.other_surface && a.other_face == b.other_face && a.lift == b.lift);
  }
}

// Moves apart until nothing is found, with the check of moved faces beside that of everything.
void settle(std::vector<Surface> surfaces, const std::vector<std::uint8_t> &fixed, Flaw first) {
  const std::vector<Surface> before = surfaces;
  CheckResult result = check(surfaces);
  CHECK(std::any_of(result.defects.begin(), result.defects.end(),
                    [&](const Defect &d) { return d.flaw == first; }));
  conceg::Workers one(1), three(3);
  int turns = 0;
  for (; turns < 8 && !result.defects.empty(); turns++) {
    const Nudged nudged =
        nudge(views_of(surfaces), result.defects, fixed, empty_box(12).box, {kLeast, kLeast}, one);
    const Nudged again =
        nudge(views_of(surfaces), result.defects, fixed, empty_box(12).box, {kLeast, kLeast}, three);
    CHECK(nudged.count > 0);
    CHECK_EQUAL(nudged.count, again.count);
    for (std::size_t s = 0; s < surfaces.size(); s++) {
      CHECK_EQUAL(nudged.vertex[s].size(), again.vertex[s].size());
      for (std::size_t i = 0; i < std::min(nudged.vertex[s].size(), again.vertex[s].size()); i++)
        CHECK(nudged.vertex[s][i].vertex == again.vertex[s][i].vertex &&
              nudged.vertex[s][i].place == again.vertex[s][i].place);
    }
    put_in_place(nudged, surfaces);
    check_again(views_of(surfaces), nudged.changed, empty_box(12).box, options_of(), three, {}, result);
    same_defects(result, check(surfaces));
  }
  std::size_t moved = 0;
  double farthest = 0;
  for (std::size_t s = 0; s < surfaces.size(); s++)
    for (std::size_t v = 0; v < surfaces[s].vertex.size(); v++) {
      const double way = glm::length(glm::dvec3(surfaces[s].vertex[v]) - glm::dvec3(before[s].vertex[v]));
      moved += way > 0, farthest = std::max(farthest, way);
      if (fixed[s]) CHECK(way == 0);
    }
  std::printf("%s: %d turns, %zu vertices moved by at most %.3f um\n", flaw_name(first), turns, moved,
              farthest);
  CHECK(result.defects.empty());
  CHECK(moved > 0 && moved < surfaces[0].vertex.size() / 4);
  for (const Surface &surface : surfaces)
    CHECK_NEAR(volume_of(surface) / volume_of(before[surface.cell]), 1, 0.02);
}

void pairs_move_apart() {
  settle(alone({ball({4, 6, 6}, 2), ball({8.03, 6, 6}, 2)}), {0, 0}, Flaw::near);
  settle(alone({ball({4, 6, 6}, 2), ball({8.03, 6, 6}, 2)}), {1, 0}, Flaw::near);
  settle(alone({ball({4, 6, 6}, 2), ball({7.98, 6, 6}, 2)}), {0, 0}, Flaw::crossing_cells);
  settle(alone({ball({2, 6, 6}, 2), ball({10.03, 6, 6}, 1.97)}), {0, 0}, Flaw::near); // through the box
  std::vector<Surface> image = alone({ball({6, 6, 6}, 2)});
  float longest = 0;
  for (const glm::vec3 &v : image[0].vertex)
    longest = std::max(longest, v.x);
  for (glm::vec3 &v : image[0].vertex)
    v.x *= 5.98f / longest; // a body that is nearly as long as the box
  settle(image, {0}, Flaw::near);
}

// A vertex that was pulled over its neighbours goes back among them.
void folds_open() {
  std::vector<Surface> folded = alone({ball({6, 6, 6}, 2)});
  glm::vec3 *top = &folded[0].vertex[0];
  for (glm::vec3 &v : folded[0].vertex)
    if (v.z > top->z) top = &v;
  top->x += 0.4f;
  settle(folded, {0}, Flaw::fold);
}

void nothing_to_move() {
  conceg::Workers workers(2);
  const std::vector<Surface> surfaces = alone({ball({4, 6, 6}, 2), ball({8.03, 6, 6}, 2)});
  const CheckResult result = check(surfaces);
  CHECK(!result.defects.empty());
  CHECK_EQUAL(
      nudge(views_of(surfaces), result.defects, {1, 1}, empty_box(12).box, {kLeast, kLeast}, workers).count,
      0);
  CHECK_EQUAL(nudge(views_of(surfaces), {}, {0, 0}, empty_box(12).box, {kLeast, kLeast}, workers).count, 0);
}

// No face turns over, however far vertices are asked to go.
void faces_stay_up() {
  conceg::Workers workers(2);
  std::vector<Surface> surfaces = alone({ball({4, 6, 6}, 2), ball({7.9, 6, 6}, 2)});
  const std::vector<Surface> before = surfaces;
  CheckResult result = check(surfaces);
  put_in_place(nudge(views_of(surfaces), result.defects, {0, 0}, empty_box(12).box, {1.0, 5.0}, workers),
               surfaces);
  for (std::size_t s = 0; s < surfaces.size(); s++)
    for (const glm::uvec3 &f : surfaces[s].face) {
      const auto normal = [&](const Surface &t) {
        return cross_product(t.at(f.y) - t.at(f.x), t.at(f.z) - t.at(f.x));
      };
      CHECK(glm::dot(normal(before[s]), normal(surfaces[s])) > 0);
    }
}

void kept_surfaces_move_in_a_copy() {
  const char *path = "test_mesh_nudge.side";
  const std::string key(64, 'k');
  const Surface surface = alone({ball({4, 6, 6}, 2)})[0];
  const glm::vec3 place(7, 8, 9);
  for (const bool named : {false, true}) {
    std::remove(path);
    {
      auto file = named ? std::make_unique<SurfaceFile>(path, key, 1) : std::make_unique<SurfaceFile>(".", 1);
      const CellNotes notes;
      file->add(surface, &notes);
      for (const std::uint32_t v : {3u, 5u}) { // the second time the copy itself
        file->move(0, {{v, place}});
        const Views views = file->views();
        CHECK_EQUAL(views.size(), 1);
        for (std::uint32_t u = 0; u < surface.vertex.size(); u++)
          CHECK(views[0].relative[u] == (u == 3 || u == v ? place : surface.vertex[u]));
        CHECK(std::memcmp(views[0].face, surface.face.data(), surface.face.size() * sizeof surface.face[0]) ==
              0);
      }
    }
    if (!named) continue;
    SurfaceFile again(path, key, 1);
    CHECK_EQUAL(again.taken_over().size(), 1);
    CHECK(again.views()[0].relative[3] == surface.vertex[3]);
  }
  std::remove(path);
}

} // namespace

int main() {
  pairs_move_apart();
  folds_open();
  nothing_to_move();
  faces_stay_up();
  kept_surfaces_move_in_a_copy();
  return check_done();
}
