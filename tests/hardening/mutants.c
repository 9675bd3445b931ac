/* SPDX-License-Identifier: BSD-3-Clause
 * Damaged documents by the thousand: a few bytes of a good file are changed at random places, and each result
 * is opened, read, digested, validated and saved in a process of its own. Same seed, same mutants. Counts
 * what came of them; a crash or a hang is kept as a file and fails the test.  mutants [COUNT] [FOLDER FOR
 * CRASHES] */
#define _XOPEN_SOURCE 700
#include "../unit/damage.h"
#include "../unit/hdf5_leaks.h"
#include "../unit/sample.h"

#include "conceg/model.h"

#include <signal.h>
#include <string.h>
#include <sys/wait.h>

/* A process that is watched starts slowly. */
#ifdef __SANITIZE_ADDRESS__
enum { USUAL_COUNT = 150 };
#else
enum { USUAL_COUNT = 1000 };
#endif

enum { OPENED = 0, REFUSED = 1, OUT_OF_MEMORY = 2, CHANGED = 3, SECONDS = 20 };

static uint64_t state = 88172645463325252u;
static uint64_t next(uint64_t below) {
  state ^= state << 13, state ^= state >> 7, state ^= state << 17;
  return state % below;
}

static void read_all(conceg_doc *doc, const char *group) {
  for (uint64_t i = 0; i < conceg_doc_children(doc, group); i++) {
    const char *path = conceg_doc_child(doc, group, i);
    conceg_array array = {.size = sizeof array};
    if (path[strlen(path) - 1] == '/')
      read_all(doc, path);
    else if (conceg_doc_read(doc, path, &array) == CONCEG_OK && array.dtype == CONCEG_TEXT)
      for (uint64_t row = 0; row < conceg_array_count(&array); row++)
        CHECK(strlen(((const char *const *)array.data)[row]) < SIZE_MAX);
  }
}

/* What a program may do with a document; the exit code says what came of it. */
static int use(conceg_ctx *ctx, const void *image, size_t count) {
  conceg_doc *doc = NULL, *again = NULL;
  conceg_substrate *substrate = NULL;
  void *saved = NULL;
  size_t length = 0;
  char before[65], after[65];
  const conceg_status status = conceg_doc_from_memory(ctx, image, count, &doc);
  if (status != CONCEG_OK) return status == CONCEG_E_NOMEM ? OUT_OF_MEMORY : REFUSED;
  int result = OPENED;
  read_all(doc, "/");
  if (conceg_doc_validate(doc, NULL, NULL, NULL) == CONCEG_E_NOMEM) result = OUT_OF_MEMORY;
  if (conceg_substrate_open(doc, &substrate) == CONCEG_OK) conceg_substrate_free(substrate);
  /* What can be digested and saved comes back the same. */
  if (conceg_doc_digest(doc, "/", before) == CONCEG_OK &&
      conceg_doc_to_memory(doc, &saved, &length) == CONCEG_OK) {
    if (conceg_doc_from_memory(ctx, saved, length, &again) != CONCEG_OK ||
        conceg_doc_digest(again, "/", after) != CONCEG_OK || strcmp(before, after) != 0)
      result = CHANGED;
    if (result == CHANGED) fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    (void)conceg_doc_close(again);
    conceg_free(saved);
  }
  (void)conceg_doc_close(doc);
  return result;
}

static void mutate(unsigned char *bytes, size_t count) {
  static const unsigned char telling[] = {0, 1, 0x7f, 0x80, 0xff, 8};
  for (uint64_t changes = 1 + next(4); changes; changes--) {
    const size_t at = 96 + next(count - 96); /* the superblock is another test's */
    if (next(3))
      bytes[at] = next(2) ? telling[next(sizeof telling)] : (unsigned char)next(256);
    else
      bytes[at] ^= (unsigned char)(1u << next(8));
  }
}

static void keep(const char *folder, const char *name, long number, const void *bytes, size_t count) {
  char path[600];
  if (!folder) return;
  snprintf(path, sizeof path, "%s/%s-%ld.cgx", folder, name, number);
  FILE *file = fopen(path, "wb");
  if (file && fwrite(bytes, 1, count, file) == count) fprintf(stderr, "kept as %s\n", path);
  if (file) fclose(file);
}

/* One mutant after the other; `counts` by exit code, the last one for crashes. Those of `known` are HDF5
 * 1.10's own (strings of variable length; H5Ocopy and H5Aiterate of a damaged old header): counted, and
 * contained by programs. */
static void run(const char *name, const unsigned char *good, size_t count, long mutants, const char *folder,
                int known) {
  long counts[5] = {0}, hung = 0; /* a hang is nobody's to be excused */
  unsigned char *bytes = malloc(count);
  for (long i = 0; i < mutants; i++) {
    int status = 0;
    memcpy(bytes, good, count);
    mutate(bytes, count);
    const pid_t pid = fork();
    if (pid == 0) {
      alarm(SECONDS);
      conceg_ctx *ctx = conceg_ctx_new();
      _exit(use(ctx, bytes, count));
    }
    waitpid(pid, &status, 0);
    const int code = WIFEXITED(status) && WEXITSTATUS(status) <= CHANGED ? WEXITSTATUS(status) : 4;
    counts[code]++;
    hung += WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
    if (code < OUT_OF_MEMORY || (known && code == 4 && !folder)) continue;
    fprintf(stderr, "%s, mutant %ld: %s %d\n", name, i, WIFEXITED(status) ? "exit code" : "signal",
            WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status));
    keep(folder, name, i, bytes, count);
  }
  printf("%-14s %ld mutants of %zu bytes: %ld opened, %ld refused, %ld out of memory, %ld changed by saving, "
         "%ld crashed, %ld of them hung\n",
         name, mutants, count, counts[0], counts[1], counts[2], counts[3], counts[4], hung);
  CHECK(counts[OPENED] && counts[REFUSED]);
  CHECK_EQUAL(counts[OUT_OF_MEMORY] + counts[CHANGED] + (known ? hung : counts[4]), 0);
  free(bytes);
}

/* The same content as other programs write it: old superblock and groups, chunks, strings of variable length.
 */
static unsigned char *old_form(const char *path, int with_strings, size_t *count) {
  const hid_t from = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), create = H5Pcreate(H5P_FILE_CREATE);
  char old[256];
  sample_path(old, "old.cgx");
  const hid_t to = H5Fcreate(old, H5F_ACC_TRUNC, create, H5P_DEFAULT);
  static const char *const groups[] = {"domain", "types", "cells", "skeleton", "meshes"};
  for (size_t i = 0; i < sizeof groups / sizeof *groups; i++)
    if (H5Lexists(from, groups[i], H5P_DEFAULT) > 0)
      CHECK(H5Ocopy(from, groups[i], to, groups[i], H5P_DEFAULT, H5P_DEFAULT) >= 0);
  const uint32_t version[2] = {1, 0};
  const uint8_t one = 1;
  damage_text_attribute(to, "/", "format", "conceg-interchange");
  damage_text_attribute(to, "/", "length_unit", "um");
  damage_text_attribute(to, "/", "time_unit", "ms");
  damage_attribute(to, "/", "version", H5T_NATIVE_UINT32, 2, version);
  damage_attribute(to, "/", "complete", H5T_NATIVE_UINT8, 0, &one);
  const hsize_t rows = 300, chunk = 64;
  const char *strings[300];
  static double numbers[300];
  for (int i = 0; i < 300; i++)
    strings[i] = i % 3 ? "a text" : "", numbers[i] = i;
  hid_t list = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(list, 1, &chunk);
  H5Pset_shuffle(list);
  H5Pset_deflate(list, 6);
  damage_dataset(to, "/x_packed", H5T_IEEE_F64BE, 1, &rows, list, NULL);
  const hid_t dataset = H5Dopen2(to, "/x_packed", H5P_DEFAULT);
  CHECK(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0);
  H5Dclose(dataset);
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  if (with_strings) {
    damage_dataset(to, "/x_strings", type, 1, &rows, H5P_DEFAULT, strings);
    damage_attribute(to, "/x_strings", "words", type, 5, strings);
  }
  H5Tclose(type);
  H5Pclose(list);
  H5Pclose(create);
  H5Fclose(from);
  damage_close(to);
  FILE *file = fopen(old, "rb");
  unsigned char *bytes = malloc(1 << 22);
  *count = fread(bytes, 1, 1 << 22, file);
  fclose(file);
  return bytes;
}

/* One file, in this process: to look at a mutant that was kept. */
static int use_file(const char *path) {
  static unsigned char bytes[1 << 22];
  FILE *file = fopen(path, "rb");
  const size_t count = file ? fread(bytes, 1, sizeof bytes, file) : 0;
  conceg_ctx *ctx = conceg_ctx_new();
  const int result = use(ctx, bytes, count);
  if (file) fclose(file);
  printf("%s: %d %s\n", path, result, conceg_ctx_error(ctx));
  conceg_ctx_free(ctx);
  return result;
}

int main(int argc, char **argv) {
  if (argc == 2 && strchr(argv[1], '.')) return use_file(argv[1]);
  const long mutants = argc > 1 ? strtol(argv[1], NULL, 10) : USUAL_COUNT;
  const char *folder = argc > 2 ? argv[2] : NULL;
  conceg_ctx *ctx = sample_ctx();
  conceg_doc *doc = sample_doc(ctx);
  char path[256];
  void *image = NULL;
  size_t count = 0, old_count = 0;
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(path, "good.cgx")), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_to_memory(doc, &image, &count), CONCEG_OK);
  conceg_doc_close(doc);
  run("canonical", image, count, mutants, folder, 0);
  conceg_free(image);
  for (int with_strings = 0; with_strings < 2; with_strings++) {
    unsigned char *old = old_form(path, with_strings, &old_count);
    run(with_strings ? "old-strings" : "old-form", old, old_count, mutants, folder, 1);
    free(old);
  }
  conceg_ctx_free(ctx);
  sample_clean();
  return check_done();
}
