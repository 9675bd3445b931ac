/* SPDX-License-Identifier: BSD-3-Clause
 * Digests: SHA-256 against known answers, both ways to compute it, and what a content digest does and does
 * not see. */
#define _XOPEN_SOURCE 700
#include "damage.h"
#include "sample.h"

#include "sha256.h"

static void hash(const char *bytes, size_t count, size_t step, char hex[65]) {
  struct sha256 sha;
  uint8_t digest[32];
  sha256_start(&sha);
  for (size_t i = 0; i < count; i += step)
    sha256_add(&sha, bytes + i, count - i < step ? count - i : step);
  sha256_end(&sha, digest);
  sha256_hex(digest, hex);
}

static void test_sha256(void) {
  static const struct {
    const char *text, *hex;
  } known[] = {{"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
               {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
               {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
                "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"}};
  char hex[65], other[65];
  for (int portable = 0; portable < 2; portable++) {
    sha256_force_portable(portable);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
      hash(known[i].text, strlen(known[i].text), 64, hex);
      CHECK_TEXT(hex, known[i].hex);
    }
    char *million = malloc(1000000);
    memset(million, 'a', 1000000);
    hash(million, 1000000, 977, hex);
    CHECK_TEXT(hex, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    free(million);
  }
  char bytes[300];
  for (size_t i = 0; i < sizeof bytes; i++)
    bytes[i] = (char)(i * 31 + 7);
  for (size_t count = 0; count < sizeof bytes; count++) { /* every length of padding, any split */
    sha256_force_portable(0);
    hash(bytes, count, 1000, hex);
    sha256_force_portable(1);
    hash(bytes, count, count % 63 + 1, other);
    CHECK_TEXT(other, hex);
  }
  sha256_force_portable(0);
}

static void digest(conceg_doc *doc, const char *group, char hex[65]) {
  hex[0] = '\0';
  CHECK_EQUAL(conceg_doc_digest(doc, group, hex), CONCEG_OK);
}

static void test_layout(conceg_ctx *ctx) {
  char path[256], hex[65], other[65];
  conceg_doc *doc = sample_doc(ctx), *back = NULL;
  digest(doc, "/", hex);
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(path, "a.cgx")), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_open(ctx, path, &back), CONCEG_OK);
  digest(back, "/", other);
  CHECK_TEXT(other, hex);
  conceg_doc_close(back);
  /* The same values stored otherwise: compressed, and text padded with more room. */
  const hid_t file = damage_open(path);
  const hsize_t shape[2] = {3, 3};
  const double soma[9] = {1, 2, 3, 10, 20, 30, 39.5, 0, 5};
  const hid_t packed = H5Pcreate(H5P_DATASET_CREATE), wide = H5Tcopy(H5T_C_S1);
  H5Pset_chunk(packed, 2, shape);
  H5Pset_deflate(packed, 9);
  CHECK(H5Ldelete(file, "/cells/soma", H5P_DEFAULT) >= 0);
  damage_dataset(file, "/cells/soma", H5T_IEEE_F64BE, 2, shape, packed, NULL);
  hid_t dataset = H5Dopen2(file, "/cells/soma", H5P_DEFAULT);
  CHECK(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, soma) >= 0);
  H5Dclose(dataset);
  damage_text_attribute(file, "/cells/soma", "unit", "um");
  char recipe[100] = "conceg: 1\nseed: 1\n";
  H5Tset_size(wide, sizeof recipe);
  CHECK(H5Ldelete(file, "/recipe", H5P_DEFAULT) >= 0);
  damage_dataset(file, "/recipe", wide, 0, NULL, H5P_DEFAULT, recipe);
  damage_text_attribute(file, "/recipe", "unit", "");
  H5Tclose(wide);
  H5Pclose(packed);
  damage_close(file);
  CHECK_EQUAL(conceg_doc_open(ctx, path, &back), CONCEG_OK);
  digest(back, "/", other);
  CHECK_TEXT(other, hex);
  conceg_doc_close(back);
  conceg_doc_close(doc);
}

/* Every change of content changes the digest; the words about its origin do not. */
static void test_changes(conceg_ctx *ctx) {
  char before[65], after[65], cells[65];
  conceg_doc *doc = sample_doc(ctx);
  digest(doc, "/", before);
  digest(doc, "/cells", cells);
  CHECK_EQUAL(conceg_doc_write_text(doc, "/cells@made_from", "types=0"), CONCEG_OK);
  PUT("/provenance/stage", CONCEG_TEXT, char *, 0, (char *)"place");
  digest(doc, "/", after);
  CHECK_TEXT(after, before);
  PUT("/bars/angle", CONCEG_F64, double, 0, 0, 1.5, 0);
  digest(doc, "/", after);
  CHECK(strcmp(after, before) != 0);
  digest(doc, "/cells", after);
  CHECK_TEXT(after, cells);
  PUT("/cells/radius", CONCEG_F32, float, 0, 5, 4, 1);
  digest(doc, "/cells", after);
  CHECK(strcmp(after, cells) != 0);
  PUT("/cells/radius", CONCEG_F32, float, 0, 5, 4, 0);
  digest(doc, "/cells", after);
  CHECK_TEXT(after, cells);
  CHECK_EQUAL(conceg_doc_write_text(doc, "/cells/radius@unit", "mm"), CONCEG_OK);
  digest(doc, "/cells", after);
  CHECK(strcmp(after, cells) != 0);
  CHECK_EQUAL(conceg_doc_digest(doc, "/nothing", after), CONCEG_E_MISSING);
  conceg_doc_close(doc);
}

/* The rule of spec/cgx.md by hand: one line "path type [shape] sha256-of-values" per array. */
static void test_definition(conceg_ctx *ctx) {
  char hex[65], expected[65], values[65], unit[65], lines[512];
  const float radius[2] = {1.5f, 2};
  conceg_doc *doc = NULL;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  sample_put(doc, ctx, "/x_a/radius", CONCEG_F32, 2, 0, radius);
  digest(doc, "/x_a", hex);
  hash((const char *)radius, sizeof radius, 64, values);
  hash("1", 2, 64, unit); /* text: the bytes and their NUL */
  snprintf(lines, sizeof lines, "/x_a/radius f32 [2] %s\n/x_a/radius@unit text [] %s\n", values, unit);
  hash(lines, strlen(lines), 64, expected);
  CHECK_TEXT(hex, expected);
  conceg_doc_close(doc);
}

int main(void) {
  conceg_ctx *ctx = sample_ctx();
  sample_folder();
  test_sha256();
  test_layout(ctx);
  test_changes(ctx);
  test_definition(ctx);
  conceg_ctx_free(ctx);
  sample_clean();
  return check_done();
}
