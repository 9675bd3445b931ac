// SPDX-License-Identifier: BSD-3-Clause
// Surfaces on disk: a run that was killed goes on with the same bytes, a crossing that is really there is
// repaired, little memory gives the same document, and files of others are refused.
#include "check.h"
#include "document.hpp"

#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace scenes;

namespace {

const char *const side_file = "test_mesh_stream.side";
const std::string key(64, 'k');

FinishOptions stream_options() {
  FinishOptions options;
  options.side_file = side_file, options.key = key;
  return options;
}

SceneOptions coarse() {
  SceneOptions options;
  options.h = 0.3;
  return options;
}

void same_bytes(const Done &one, const Done &other) {
  CHECK_EQUAL(one.surfaces.size(), other.surfaces.size());
  CHECK_EQUAL(one.base_faces, other.base_faces);
  for (std::size_t i = 0; i < one.surfaces.size(); i++) {
    const Surface &a = one.surfaces[i], &b = other.surfaces[i];
    CHECK(a.vertex.size() == b.vertex.size() && a.face.size() == b.face.size() &&
          std::memcmp(a.vertex.data(), b.vertex.data(), a.vertex.size() * sizeof a.vertex[0]) == 0 &&
          std::memcmp(a.face.data(), b.face.data(), a.face.size() * sizeof a.face[0]) == 0);
    CHECK_NEAR(one.pieces[a.cell].detached_volume, other.pieces[a.cell].detached_volume, 0);
  }
}

std::size_t size_of(const char *path) {
  struct stat info;
  return stat(path, &info) ? 0 : static_cast<std::size_t>(info.st_size);
}

// Tubes in a row, each its own cell: surfaces become finished all the while.
Tissue fence() {
  Tissue tissue = empty_box(24);
  for (int i = 0; i < 60; i++)
    add_tube(tissue, {2.0 + 2.2 * (i % 10), 3, 1.5 + 3.6 * (i / 10)},
             {2.4 + 2.2 * (i % 10), 20, 2.5 + 3.6 * (i / 10)}, 0.9);
  return tissue;
}

void killed_run_goes_on() {
  const Tissue tissue = fence();
  const Done whole = finish_tissue(tissue, coarse(), {}, 2);
  CHECK_EQUAL(whole.check.errors, 0);
  std::remove(side_file);
  const pid_t child = fork();
  if (child == 0) { // half way it is killed
    finish_tissue(tissue, coarse(), stream_options(), 2,
                  [](const char *, std::uint64_t done, std::uint64_t all) {
                    return 2 * done < all || raise(SIGKILL) != 0;
                  });
    _exit(0);
  }
  int status = 0;
  CHECK(waitpid(child, &status, 0) == child && WIFSIGNALED(status));
  const int torn = open(side_file, O_WRONLY | O_APPEND);
  CHECK(torn >= 0 && write(torn, "half a record", 13) == 13 && close(torn) == 0);
  const Done rest = finish_tissue(tissue, coarse(), stream_options(), 3);
  std::printf("%zu of %zu cells taken over\n", rest.taken_over, tissue.cells());
  CHECK(rest.taken_over > 0 && rest.taken_over < tissue.cells());
  same_bytes(whole, rest);
  const Done again = finish_tissue(tissue, coarse(), stream_options(), 1);
  CHECK_EQUAL(again.taken_over, tissue.cells());
  same_bytes(whole, again);
  // What is foreseen of the disk: faces by the area, bytes by the face.
  const double foreseen = 3 * primitive_area(make_scene(tissue, coarse()));
  CHECK(double(whole.base_faces) < foreseen && double(whole.base_faces) > 0.6 * foreseen);
  std::size_t faces = 0;
  for (const Surface &surface : whole.surfaces)
    faces += surface.face.size();
  const double bytes = double(size_of(side_file)) / double(faces);
  std::printf("%zu of %.0f faces foreseen, %.2f bytes a face\n", std::size_t(whole.base_faces), foreseen,
              bytes);
  CHECK(bytes > 17.9 && bytes < 19);
  std::remove(side_file);
}

// A surface that crosses another is put where the mesher takes its own from.
void real_crossing_is_repaired() {
  const Tissue tissue = fence();
  const Done sound = finish_tissue(tissue, coarse(), {}, 2);
  Surface spoiled = sound.surfaces[4];
  glm::vec3 *moved = &spoiled.vertex[0]; // the one nearest to the middle
  for (glm::vec3 &v : spoiled.vertex)
    if (glm::length(v) < glm::length(*moved)) moved = &v;
  *moved += glm::vec3(4, 0, 0);
  std::remove(side_file);
  {
    SurfaceFile file(side_file, key, tissue.cells());
    CellNotes notes;
    notes.base_faces = 1;
    file.add(spoiled, &notes);
  }
  std::vector<Surface> crossing = sound.surfaces;
  crossing[4] = spoiled;
  conceg::Workers workers(2);
  CHECK(check_surfaces(views_of(crossing), tissue.box, {}, workers, {}).crossings > 0);
  const Done repaired = finish_tissue(tissue, coarse(), stream_options(), 2);
  CHECK_EQUAL(repaired.taken_over, 1);
  CHECK(repaired.rounds > 0 && repaired.repaired_pairs > 0);
  CHECK_EQUAL(repaired.check.errors, 0);
  CHECK_NEAR(volume_of(repaired.surfaces[4]) / volume_of(sound.surfaces[4]), 1, 0.01);
  // Far from the place nothing has changed.
  CHECK(repaired.surfaces[40].vertex == sound.surfaces[40].vertex);
  std::remove(side_file);
}

template <class Body> conceg_status status_of(const Body &body) {
  try {
    body();
    return CONCEG_OK;
  } catch (const conceg::Error &error) {
    CHECK(*error.what());
    return error.status();
  }
}

void files_of_others_are_refused() {
  std::remove(side_file);
  { SurfaceFile(side_file, key, 3); }
  CHECK_EQUAL(status_of([] { SurfaceFile(side_file, std::string(64, 'x'), 3); }), CONCEG_E_FORMAT);
  SurfaceFile held(side_file, key, 3);
  CHECK_EQUAL(status_of([] { SurfaceFile(side_file, key, 3); }), CONCEG_E_IO);
  std::FILE *other = std::fopen("test_mesh_stream.other", "w");
  for (int i = 0; i < 20; i++)
    std::fputs("not a side file", other);
  std::fclose(other);
  CHECK_EQUAL(status_of([] { SurfaceFile("test_mesh_stream.other", key, 3); }), CONCEG_E_FORMAT);
  CHECK_EQUAL(size_of("test_mesh_stream.other"), 300); // left as it was
  std::remove("test_mesh_stream.other"), std::remove(side_file);
  CHECK_EQUAL(status_of([] { SurfaceFile("no/such/folder/x", key, 3); }), CONCEG_E_IO);
  CHECK_EQUAL(status_of([] { SideFile("no/such/folder"); }), CONCEG_E_IO);
  CHECK_EQUAL(status_of([] { need_free_space(".", 1e24, "test"); }), CONCEG_E_IO);
  CHECK_EQUAL(status_of([] { need_free_space(".", 1, "test"); }), CONCEG_OK);
}

// Arrays on disk, hash in small slabs, surfaces kept in a named file that goes when it is no longer needed.
void little_memory_is_enough() {
  const Tissue tissue = forest(20, 2, 500, 3);
  std::string digests[2];
  for (int i = 0; i < 2; i++) {
    conceg_ctx *ctx = conceg_ctx_new();
    if (i) conceg_ctx_set_memory(ctx, 1u << 20);
    conceg_doc *doc = document_of(ctx, tissue);
    std::vector<const char *> sets = {"mesh.h_um=0.3", "mesh.volumes=false"};
    if (i) sets.push_back("mesh.checkpoint=test_mesh_stream.side");
    CHECK_EQUAL(run_stage(ctx, doc, sets), CONCEG_OK);
    CHECK_TEXT(conceg_ctx_error(ctx), "");
    char hex[65] = "";
    conceg::must(conceg_doc_digest(doc, "/meshes", hex));
    digests[i] = hex;
    conceg::must(conceg_doc_close(doc));
    conceg_ctx_free(ctx);
  }
  CHECK(digests[0] == digests[1]);
  CHECK_EQUAL(size_of(side_file), 0);
}

} // namespace

int main() {
  killed_run_goes_on();
  real_crossing_is_repaired();
  files_of_others_are_refused();
  little_memory_is_enough();
  return check_done();
}
