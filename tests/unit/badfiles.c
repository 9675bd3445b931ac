/* SPDX-License-Identifier: BSD-3-Clause
 * Bad input: every file that is no document ends in one clear line and the right status; foreign forms of a
 * good one are read. */
#define _XOPEN_SOURCE 700
#include "damage.h"
#include "hdf5_leaks.h"
#include "sample.h"

#include <fcntl.h>

static char good[256], bad[256];

/* Opens a file that must be refused with this status and these words. */
static void refuse(conceg_ctx *ctx, const char *path, conceg_status status, const char *words) {
  conceg_doc *doc = NULL;
  conceg_ctx_clear_error(ctx);
  CHECK_EQUAL(conceg_doc_open(ctx, path, &doc), status);
  CHECK(doc == NULL);
  if (!strstr(conceg_ctx_error(ctx), words)) {
    fprintf(stderr, "expected \"%s\" in \"%s\"\n", words, conceg_ctx_error(ctx));
    CHECK(!"the message names the reason");
  }
  conceg_doc_close(doc);
}

static void write_bytes(const char *path, const void *bytes, size_t count) {
  FILE *file = fopen(path, "wb");
  CHECK(file && fwrite(bytes, 1, count, file) == count);
  if (file) fclose(file);
}

static void copy_good(void) {
  char command[600];
  snprintf(command, sizeof command, "cp '%s' '%s'", good, bad);
  CHECK_EQUAL(system(command), 0);
}

static void test_bytes(conceg_ctx *ctx) {
  static const char text[] =
      "# a recipe is not a document, whatever its name is: domain, types, dictionary, density\n";
  void *image = NULL;
  size_t count = 0;
  conceg_doc *doc = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_to_memory(doc, &image, &count), CONCEG_OK);
  refuse(ctx, "no-such-file.cgx", CONCEG_E_IO, "No such file");
  refuse(ctx, sample_folder(), CONCEG_E_IO, "folder");
  write_bytes(bad, "", 0);
  refuse(ctx, bad, CONCEG_E_FORMAT, "is empty");
  write_bytes(bad, text, sizeof text);
  refuse(ctx, bad, CONCEG_E_FORMAT, "not a CGX file");
  for (size_t cut = 1; cut < count; cut = cut * 3 / 2 + 1) {
    write_bytes(bad, image, cut);
    refuse(ctx, bad, CONCEG_E_FORMAT, cut < 8 ? "not a CGX file" : "truncated");
    conceg_doc *none = NULL;
    CHECK_EQUAL(conceg_doc_from_memory(ctx, image, cut, &none), CONCEG_E_FORMAT);
  }
  char *longer = calloc(count + 100, 1);
  memcpy(longer, image, count);
  write_bytes(bad, longer, count + 100);
  refuse(ctx, bad, CONCEG_E_FORMAT, "after the end");
  free(longer);
  /* Any byte may be wrong: refused or read, never a crash. */
  for (size_t i = 0; i < count; i += 97) {
    char *other = malloc(count);
    memcpy(other, image, count);
    other[i] ^= 0x5a;
    conceg_doc *read = NULL;
    if (conceg_doc_from_memory(ctx, other, count, &read) == CONCEG_OK)
      CHECK(conceg_doc_validate(read, NULL, NULL, NULL) <= CONCEG_OK);
    conceg_doc_close(read);
    free(other);
  }
  conceg_free(image);
  conceg_doc_close(doc);
}

static void test_root(conceg_ctx *ctx) {
  const uint32_t newer[2] = {2, 0}, minor[2] = {1, 7};
  const uint8_t no = 0;
  copy_good();
  hid_t file = damage_open(bad);
  damage_attribute(file, "/", "version", H5T_NATIVE_UINT32, 2, newer);
  damage_close(file);
  refuse(ctx, bad, CONCEG_E_VERSION, "got 2.0");
  copy_good();
  file = damage_open(bad);
  damage_text_attribute(file, "/", "format", "something else");
  damage_close(file);
  refuse(ctx, bad, CONCEG_E_FORMAT, "got something else");
  copy_good();
  file = damage_open(bad);
  H5Adelete(file, "format");
  damage_close(file);
  refuse(ctx, bad, CONCEG_E_FORMAT, "@format");
  copy_good();
  file = damage_open(bad);
  damage_attribute(file, "/", "complete", H5T_NATIVE_UINT8, 0, &no);
  damage_close(file);
  refuse(ctx, bad, CONCEG_E_FORMAT, "did not finish");
  /* A newer minor version is read, and stays what it is. */
  copy_good();
  file = damage_open(bad);
  const hsize_t shape = 3;
  const float value[3] = {1, 2, 3};
  damage_attribute(file, "/", "version", H5T_NATIVE_UINT32, 2, minor);
  damage_dataset(file, "/future/thing", H5T_IEEE_F32LE, 1, &shape, H5P_DEFAULT, value);
  damage_close(file);
  conceg_doc *doc = NULL;
  CHECK_EQUAL(conceg_doc_open(ctx, bad, &doc), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_save(doc, bad), CONCEG_OK);
  conceg_doc_close(doc);
  CHECK_EQUAL(conceg_doc_open(ctx, bad, &doc), CONCEG_OK);
  conceg_array array = {.size = sizeof array};
  CHECK_EQUAL(conceg_doc_read(doc, "/future/thing", &array), CONCEG_OK);
  CHECK(((const float *)array.data)[2] == 3);
  CHECK_EQUAL(conceg_doc_read(doc, "/@version", &array), CONCEG_OK);
  CHECK_EQUAL(((const uint32_t *)array.data)[1], 7);
  conceg_doc_close(doc);
}

static void test_claims(conceg_ctx *ctx) {
  const hsize_t huge[2] = {(hsize_t)1 << 40, 3}, chunk[2] = {1000, 3};
  copy_good();
  hid_t file = damage_open(bad);
  const hid_t late = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_alloc_time(late, H5D_ALLOC_TIME_LATE);
  damage_dataset(file, "/network/position", H5T_IEEE_F64LE, 2, huge, late, NULL);
  damage_close(file);
  refuse(ctx, bad, CONCEG_E_FORMAT, "/network/position");
  copy_good();
  file = damage_open(bad);
  H5Pset_chunk(late, 2, chunk);
  damage_dataset(file, "/network/position", H5T_IEEE_F64LE, 2, huge, late, NULL);
  damage_close(file);
  refuse(ctx, bad, CONCEG_E_FORMAT, "more than a file of");
  H5Pclose(late);
  copy_good();
  file = damage_open(bad);
  CHECK(H5Lcreate_external("other.cgx", "/x", file, "/outside", H5P_DEFAULT, H5P_DEFAULT) >= 0);
  damage_close(file);
  refuse(ctx, bad, CONCEG_E_FORMAT, "link");
  copy_good();
  file = damage_open(bad);
  CHECK(H5Lcreate_hard(file, "/cells", file, "/cells/loop", H5P_DEFAULT, H5P_DEFAULT) >= 0);
  damage_close(file);
  refuse(ctx, bad, CONCEG_E_FORMAT, "loop");
}

/* What other writers do: big-endian, compressed, strings of variable length, blank padding. */
static void test_foreign(conceg_ctx *ctx) {
  const hsize_t shape[2] = {3, 3}, three = 3;
  const int32_t numbers[9] = {1, -2, 3, 4, 5, 6, 7, 8, -9};
  const char *const words[3] = {"one", "", "caf\xc3\xa9"};
  copy_good();
  hid_t file = damage_open(bad);
  const hid_t packed = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(packed, 2, shape);
  H5Pset_shuffle(packed);
  H5Pset_deflate(packed, 6);
  const hid_t space = H5Screate_simple(2, shape, NULL);
  hid_t dataset = H5Dcreate2(file, "/x_packed", H5T_STD_I32BE, space, H5P_DEFAULT, packed, H5P_DEFAULT);
  CHECK(H5Dwrite(dataset, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0);
  H5Dclose(dataset);
  H5Sclose(space);
  H5Pclose(packed);
  hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  damage_dataset(file, "/x_variable", type, 1, &three, H5P_DEFAULT, words);
  H5Tclose(type);
  type = H5Tcopy(H5T_FORTRAN_S1);
  H5Tset_size(type, 4);
  damage_dataset(file, "/x_blank", type, 1, &three, H5P_DEFAULT, "a   bcd     ");
  H5Tclose(type);
  type = H5Tcreate(H5T_COMPOUND, 8);
  H5Tinsert(type, "a", 0, H5T_NATIVE_INT32);
  H5Tinsert(type, "b", 4, H5T_NATIVE_INT32);
  damage_dataset(file, "/x_compound", type, 1, &three, H5P_DEFAULT, numbers);
  damage_attribute(file, "/x_variable", "pair", type, 0, numbers);
  H5Tclose(type);
  damage_close(file);

  conceg_doc *doc = NULL;
  conceg_array array = {.size = sizeof array};
  CHECK_EQUAL(conceg_doc_open(ctx, bad, &doc), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_save(doc, bad), CONCEG_OK); /* all is carried through */
  conceg_doc_close(doc);
  CHECK_EQUAL(conceg_doc_open(ctx, bad, &doc), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_read(doc, "/x_packed", &array), CONCEG_OK);
  CHECK(array.dtype == CONCEG_I32 && memcmp(array.data, numbers, sizeof numbers) == 0);
  CHECK_EQUAL(conceg_doc_read(doc, "/x_variable", &array), CONCEG_OK);
  for (int i = 0; i < 3; i++)
    CHECK_TEXT(((const char *const *)array.data)[i], words[i]);
  CHECK_EQUAL(conceg_doc_read(doc, "/x_blank", &array), CONCEG_OK);
  CHECK_TEXT(((const char *const *)array.data)[1], "bcd");
  CHECK_EQUAL(conceg_doc_read(doc, "/x_compound", &array), CONCEG_E_FORMAT);
  CHECK(strstr(conceg_ctx_error(ctx), "a compound") != NULL);
  CHECK(conceg_doc_has(doc, "/x_variable@pair"));
  conceg_doc_close(doc);
}

int main(void) {
  conceg_ctx *ctx = sample_ctx();
  sample_path(good, "good.cgx");
  sample_path(bad, "bad.cgx");
  conceg_doc *doc = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_save(doc, good), CONCEG_OK);
  conceg_doc_close(doc);
  test_bytes(ctx);
  test_root(ctx);
  test_claims(ctx);
  test_foreign(ctx);
  conceg_ctx_free(ctx);
  sample_clean();
  return check_done();
}
