/* SPDX-License-Identifier: BSD-3-Clause
 * spec/conformance/failed and stream: one defect per file. */
#define _XOPEN_SOURCE 700
#include "corpus.h"

#include <math.h>

enum { CELLS = BOX | TYPES, LINES = BOX | TYPES | SKELETON };

/* A defect that the library itself can write. */
#define FAIL(number, words, rule, parts, note, ...)                                                          \
  do {                                                                                                       \
    conceg_doc *doc = corpus_doc(ctx, parts);                                                                \
    __VA_ARGS__;                                                                                             \
    corpus_save(maker, doc,                                                                                  \
                corpus_file(maker, "failed/" number "-" words ".cgx", "invalid", "CGX-" rule, 3, note));     \
  } while (0)
/* A defect that takes HDF5's own calls. */
#define FAIL_FILE(number, words, verdict, rule, parts, note, ...)                                            \
  do {                                                                                                       \
    const char *path = corpus_file(maker, "failed/" number "-" words ".cgx", verdict, "CGX-" rule, 3, note); \
    corpus_save(maker, corpus_doc(ctx, parts), path);                                                        \
    hid_t file = damage_open(path), list = corpus_list();                                                    \
    __VA_ARGS__;                                                                                             \
    H5Pclose(list);                                                                                          \
    damage_close(file);                                                                                      \
  } while (0)
#define DROP(path) CHECK_EQUAL(conceg_doc_drop(doc, path), CONCEG_OK)
#define TEXT(path, text) CHECK_EQUAL(conceg_doc_write_text(doc, path, text), CONCEG_OK)

static void make_open(struct maker *maker) {
  conceg_ctx *ctx = maker->ctx;
  const uint32_t newer[2] = {2, 0};
  const uint8_t no = 0;
  const hsize_t huge = (hsize_t)1 << 30, chunk = 1000, three = 3;
  const double values[3] = {1, 2, 3};
  FAIL_FILE("0020", "format", "not-a-document", "002", 0, "another format's name",
            damage_text_attribute(file, "/", "format", "something else"));
  FAIL_FILE("0021", "no-format", "not-a-document", "002", 0, "no format's name", H5Adelete(file, "format"));
  FAIL_FILE("0030", "major-version", "not-a-document", "003", 0, "a major version to come",
            damage_attribute(file, "/", "version", H5T_STD_U32LE, 2, newer));
  FAIL_FILE("0031", "no-version", "not-a-document", "003", 0, "no version", H5Adelete(file, "version"));
  FAIL_FILE("0040", "incomplete", "not-a-document", "004", 0, "its writer did not finish",
            damage_attribute(file, "/", "complete", H5T_STD_U8LE, 0, &no));
  FAIL_FILE("0050", "soft-link", "not-a-document", "005", CELLS, "a soft link",
            H5Lcreate_soft("/cells", file, "x_alias", H5P_DEFAULT, H5P_DEFAULT));
  FAIL_FILE("0051", "external-link", "not-a-document", "005", CELLS, "a link into another file",
            H5Lcreate_external("other.cgx", "/x", file, "x_outside", H5P_DEFAULT, H5P_DEFAULT));
  FAIL_FILE("0052", "loop", "not-a-document", "005", CELLS, "a group inside itself",
            H5Lcreate_hard(file, "/cells", file, "/cells/loop", H5P_DEFAULT, H5P_DEFAULT));
  FAIL_FILE("0053", "external-values", "not-a-document", "005", BOX, "values in another file", {
    H5Pset_external(list, "values.raw", 0, 24);
    damage_dataset(file, "/x_values", H5T_IEEE_F64LE, 1, &three, list, NULL);
  });
  FAIL_FILE("0060", "huge-array", "not-a-document", "006", BOX, "an array larger than its file", {
    H5Pset_alloc_time(list, H5D_ALLOC_TIME_LATE);
    damage_dataset(file, "/x_values", H5T_IEEE_F64LE, 1, &huge, list, NULL);
  });
  FAIL_FILE("0061", "huge-chunked", "not-a-document", "006", BOX, "a compressed array of over 256 times", {
    H5Pset_chunk(list, 1, &chunk);
    damage_dataset(file, "/x_values", H5T_IEEE_F64LE, 1, &huge, list, NULL);
  });
  FAIL_FILE("0160", "filter", "not-a-document", "016", BOX,
            "a filter that is not deflate, shuffle or fletcher32", {
              H5Pset_chunk(list, 1, &three);
              H5Pset_nbit(list);
              damage_dataset(file, "/x_values", H5T_IEEE_F64LE, 1, &three, list, NULL);
            });
  FAIL_FILE("0161", "many-strings", "not-a-document", "016", BOX,
            "an attribute with 65 strings of variable length", {
              static const char *strings[65];
              const hsize_t many = 65;
              const hid_t type = H5Tcopy(H5T_C_S1);
              for (int i = 0; i < 65; i++)
                strings[i] = "word";
              H5Tset_size(type, H5T_VARIABLE);
              corpus_dataset(file, "/x_values", H5T_IEEE_F64LE, 1, &three, list, values, "um");
              const hid_t owner = H5Dopen2(file, "/x_values", H5P_DEFAULT),
                          space = H5Screate_simple(1, &many, NULL);
              const hid_t attribute = H5Acreate2(owner, "words", type, space, H5P_DEFAULT, H5P_DEFAULT);
              H5Awrite(attribute, type, strings);
              H5Aclose(attribute), H5Sclose(space), H5Dclose(owner), H5Tclose(type);
            });
  FAIL_FILE("0070", "name", "invalid", "007", CELLS, "a blank in a name",
            corpus_dataset(file, "/cells/soma volume", H5T_IEEE_F64LE, 1, &three, list, values, "um^3"));
  FAIL_FILE("0080", "compound", "invalid", "008", CELLS, "a compound inside a known group", {
    const hid_t type = H5Tcreate(H5T_COMPOUND, 8);
    H5Tinsert(type, "value", 0, H5T_IEEE_F64LE);
    corpus_dataset(file, "/cells/pair", type, 1, &three, list, values, "");
    H5Tclose(type);
  });
  FAIL_FILE("0081", "boolean", "invalid", "008", TABLES, "an enumeration in a table", {
    const int8_t truth[2] = {0, 1};
    const hsize_t two = 2;
    const hid_t type = H5Tenum_create(H5T_STD_I8LE);
    H5Tenum_insert(type, "FALSE", &truth[0]);
    H5Tenum_insert(type, "TRUE", &truth[1]);
    corpus_dataset(file, "/statistics/cells/closed", type, 1, &two, list, truth, "");
    H5Tclose(type);
  });
  FAIL_FILE("0380", "latin-1", "invalid", "038", CELLS, "text that is not UTF-8", {
    const hsize_t two = 2;
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, 4);
    corpus_dataset(file, "/types/layer", type, 1, &two, list, "caf\xe9L4\0\0", "");
    H5Tclose(type);
  });
}

static void make_forms(struct maker *maker) {
  conceg_ctx *ctx = maker->ctx;
  const float fraction[2] = {0.5f, 0.5f};
  FAIL("0100", "no-unit", "010", CELLS, "positions without a unit", DROP("/cells/soma@unit"));
  FAIL("0110", "unit", "011", CELLS, "positions in mm", TEXT("/cells/soma@unit", "mm"));
  FAIL("0200", "no-array", "020", CELLS, "cells without radii", DROP("/cells/radius"));
  FAIL("0201", "no-attribute", "020", BOX, "a box without a direction of the pia", DROP("/domain@pia"));
  FAIL("0210", "type", "021", CELLS, "fractions in single precision",
       sample_put(doc, ctx, "/types/fraction", CONCEG_F32, 2, 0, fraction));
  FAIL("0220", "rank", "022", CELLS, "fractions as a column",
       PUT("/types/fraction", CONCEG_F64, double, 1, 0.5, 0.5));
  FAIL("0221", "extent", "022", CELLS, "rotations of three numbers",
       PUT("/cells/rotation", CONCEG_F64, double, 3, 1, 0, 0, 0, 1, 0, 0, 0, 1));
  FAIL("0230", "local-extent", "023", CELLS | MESHES, "fewer codes than faces",
       PUT("/meshes/compartment", CONCEG_U8, uint8_t, 0, 1, 1, 1));
  FAIL("0240", "global-extent", "024", LINES, "fewer kinds than points",
       PUT("/skeleton/kind", CONCEG_U8, uint8_t, 0, 3, 3, 3));
  FAIL("0250", "group-for-array", "025", CELLS, "a group where an array belongs", {
    DROP("/cells/soma");
    TEXT("/cells/soma/deep", "x");
  });
  FAIL("0251", "array-for-group", "025", BOX, "an array where a group belongs", TEXT("/cells", "x"));
}

static void make_values(struct maker *maker) {
  conceg_ctx *ctx = maker->ctx;
  FAIL("0300", "nan", "030", CELLS, "a position that is no number",
       PUT("/cells/soma", CONCEG_F64, double, 3, 1, 2, 3, 10, 20, NAN, 39, 0, 5));
  FAIL("0301", "infinite", "030", BOX, "a box without an end",
       PUT("/domain@hi", CONCEG_F64, double, 0, 40, INFINITY, 40));
  FAIL("0310", "zero-radius", "031", LINES, "a point of radius 0",
       PUT("/skeleton/radius", CONCEG_F32, float, 0, 1, 1, 0, 1));
  FAIL("0320", "negative-radius", "032", CELLS, "a soma of radius -1",
       PUT("/cells/radius", CONCEG_F32, float, 0, -1, 4, 0));
  FAIL("0330", "not-unit", "033", CELLS, "a rotation that is no unit quaternion",
       PUT("/cells/rotation", CONCEG_F64, double, 4, 1, 0, 0, 0, 0.6, 0.80001, 0, 0, 0, 0, 0, 1));
  FAIL("0340", "index", "034", CELLS, "a type that is not there",
       PUT("/cells/type", CONCEG_U32, uint32_t, 0, 0, 1, 2));
  FAIL("0342", "edge", "034", BOX | NETWORK, "an edge to a node that is not there",
       PUT("/network/edge", CONCEG_U32, uint32_t, 0, 1, 2, 0, 3));
  FAIL("0350", "donor", "035", CELLS | DICTIONARY, "a donor that is not there",
       PUT("/cells/donor", CONCEG_U32, uint32_t, 0, 0, 1, UINT32_MAX));
  FAIL("0360", "choice", "036", BOX | TYPES | BARS, "a state that is not there",
       PUT("/bars/state", CONCEG_U8, uint8_t, 0, 1, 9, 2));
  FAIL("0361", "class", "036", CELLS, "a class that is not there",
       PUT("/types/class", CONCEG_TEXT, char *, 0, (char *)"pyramidal", (char *)"star"));
  FAIL("0370", "twice", "037", CELLS, "two cells of one number",
       PUT("/cells/id", CONCEG_U64, uint64_t, 0, 11, 12, 11));
}

/* Twelve points in a line along x that were folded back into the box at 40 um. */
static void put_folded(conceg_doc *doc, conceg_ctx *ctx) {
  double position[36];
  float radius[12];
  int64_t parent[12];
  uint8_t kind[12];
  for (int i = 0; i < 12; i++) {
    position[3 * i] = fmod(34.5 + i, 40), position[3 * i + 1] = position[3 * i + 2] = 10;
    radius[i] = 0.5f, parent[i] = i - 1, kind[i] = 3;
  }
  PUT("/skeleton/cell_offset", CONCEG_U64, uint64_t, 0, 0, 12, 12, 12);
  sample_put(doc, ctx, "/skeleton/position", CONCEG_F64, 12, 3, position);
  sample_put(doc, ctx, "/skeleton/radius", CONCEG_F32, 12, 0, radius);
  sample_put(doc, ctx, "/skeleton/target_radius", CONCEG_F32, 12, 0, radius);
  sample_put(doc, ctx, "/skeleton/parent", CONCEG_I64, 12, 0, parent);
  sample_put(doc, ctx, "/skeleton/kind", CONCEG_U8, 12, 0, kind);
}

static void make_links(struct maker *maker) {
  conceg_ctx *ctx = maker->ctx;
  FAIL("0400", "first-offset", "040", LINES, "offsets that begin at 1",
       PUT("/skeleton/cell_offset", CONCEG_U64, uint64_t, 0, 1, 3, 4, 4));
  FAIL("0410", "falling-offsets", "041", LINES, "offsets that fall",
       PUT("/skeleton/cell_offset", CONCEG_U64, uint64_t, 0, 0, 4, 3, 4));
  FAIL("0411", "huge-offset", "041", LINES, "an offset of 2^64 - 1",
       PUT("/skeleton/cell_offset", CONCEG_U64, uint64_t, 0, 0, UINT64_MAX, 4, 4));
  FAIL("0420", "last-offset", "042", LINES, "offsets that end too soon",
       PUT("/skeleton/cell_offset", CONCEG_U64, uint64_t, 0, 0, 3, 3, 3));
  FAIL("0500", "later-parent", "050", LINES, "a parent that comes later",
       PUT("/skeleton/parent", CONCEG_I64, int64_t, 0, -1, 2, 1, -1));
  FAIL("0501", "other-cell", "050", LINES, "a parent in another cell",
       PUT("/skeleton/parent", CONCEG_I64, int64_t, 0, -1, 0, 1, 0));
  FAIL("0502", "bar-parent", "050", BOX | TYPES | BARS, "a bar that is its own parent",
       PUT("/bars/parent", CONCEG_I64, int64_t, 0, -1, 1, -1));
  FAIL("0510", "handed-to", "051", BOX | TYPES | BARS, "a bar handed to a row of another cell",
       PUT("/bars/handed_to", CONCEG_I64, int64_t, 0, -1, 2, -1));
  FAIL("0511", "other-tree", "051", DICTIONARY, "a parent outside the tree",
       PUT("/dictionary/bar_parent", CONCEG_I64, int64_t, 0, -1, 2));
  FAIL("0520", "bar", "052", BOX | TYPES | BARS | SKELETON, "a point of a bar that is not there",
       PUT("/skeleton/bar", CONCEG_U32, uint32_t, 0, 0, 0, 2, 0));
  FAIL("0521", "segment-end", "052", LINES | SPHERES, "a sphere of a segment that is not there",
       PUT("/spheres/segment_end", CONCEG_I64, int64_t, 0, 3));
  FAIL("0530", "folded", "053", LINES, "a process folded back into the box", put_folded(doc, ctx));
  FAIL("0540", "loop", "054", DICTIONARY, "two bars that are each other's parent",
       PUT("/dictionary/bar_parent", CONCEG_I64, int64_t, 0, 1, 0));
  FAIL("0600", "vertex", "060", CELLS | MESHES, "a face of a vertex that is not there",
       PUT("/meshes/face", CONCEG_U32, uint32_t, 3, 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 4, 0, 2, 1, 0, 1, 3, 0,
           3, 2, 1, 2, 3));
  FAIL("0610", "rounding", "061", CELLS | MESHES, "a vertex that is not its origin plus a float32",
       PUT("/meshes/vertex", CONCEG_F64, double, 3, 1, 2, 3, 2.1, 2, 3, 1, 3, 3, 1, 2, 4, 10, 20, 30, 11, 20,
           30, 10, 21, 30, 10, 20, 31));
  FAIL("0620", "flat-box", "062", BOX, "a box without height",
       PUT("/domain@hi", CONCEG_F64, double, 0, 40, 40, 0));
  FAIL("0630", "periodic", "063", BOX, "an axis that is periodic twice",
       PUT("/domain@periodic", CONCEG_U8, uint8_t, 0, 1, 2, 1));
  FAIL("0650", "table", "065", TABLES, "columns of unequal length",
       PUT("/statistics/cells/icvf", CONCEG_F64, double, 0, 0.4));
  FAIL("0660", "label", "066", CELLS | VOLUMES, "the label of a cell that is not there", {
    uint32_t label[512] = {[511] = 4};
    sample_put(doc, ctx, "/volumes/label", CONCEG_U32, 1, 512, label);
  });
  FAIL("0710", "made-from", "071", CELLS, "an origin without a digest",
       PUT("/cells@made_from", CONCEG_TEXT, char *, 0, (char *)"types=now"));
  FAIL("0720", "program-path", "072", PROVENANCE, "a program's path as an implementation",
       PUT("/provenance/implementation", CONCEG_TEXT, char *, 0, (char *)"uniform", (char *)"/opt/grow"));
}

void make_failed(struct maker *maker) {
  make_open(maker);
  make_forms(maker);
  make_values(maker);
  make_links(maker);
}

static void put_bytes(struct maker *maker, const char *name, const char *rule, const void *bytes,
                      size_t count, const char *note) {
  FILE *file = fopen(corpus_file(maker, name, "not-a-document", rule, 3, note), "wb");
  CHECK(file && fwrite(bytes, 1, count, file) == count);
  if (file) CHECK(fclose(file) == 0);
}

/* One byte of a good file is another. */
static void put_patched(struct maker *maker, const char *name, const unsigned char *image, size_t count,
                        size_t at, unsigned char value, const char *note) {
  unsigned char *copy = malloc(count);
  memcpy(copy, image, count);
  copy[at] = value;
  put_bytes(maker, name, "CGX-001", copy, count, note);
  free(copy);
}

void make_stream(struct maker *maker) {
  static const char text[] = "# a recipe is not a document, whatever its name is\nconceg: 1\n";
  void *image = NULL;
  size_t count = 0;
  conceg_doc *doc = corpus_doc(maker->ctx, CELLS);
  CHECK_EQUAL(conceg_doc_to_memory(doc, &image, &count), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  put_bytes(maker, "stream/0001-empty.cgx", "CGX-001", "", 0, "no bytes at all (STR-021)");
  put_bytes(maker, "stream/0002-text.cgx", "CGX-001", text, sizeof text - 1, "a text (STR-022)");
  put_bytes(maker, "stream/0003-cut-in-signature.cgx", "CGX-001", image, 5, "ends in the signature");
  put_bytes(maker, "stream/0004-cut-in-superblock.cgx", "CGX-001", image, 40, "ends in the superblock");
  put_bytes(maker, "stream/0005-cut-in-half.cgx", "CGX-001", image, count / 2, "ends in the middle");
  put_bytes(maker, "stream/0006-cut-at-end.cgx", "CGX-001", image, count - 1, "lacks one byte (STR-022)");
  char *longer = calloc(count + 512, 1);
  memcpy(longer, image, count);
  put_bytes(maker, "stream/0007-byte-after-end.cgx", "CGX-001", longer, count + 1, "one byte more (STR-001)");
  memset(longer, 0, 512);
  memcpy(longer + 512, image, count);
  put_bytes(maker, "stream/0008-user-block.cgx", "CGX-001", longer, count + 512, "512 bytes before it");
  free(longer);
  put_patched(maker, "stream/0009-superblock-4.cgx", image, count, 8, 4, "a superblock of version 4");
  put_patched(maker, "stream/0010-offsets-of-4.cgx", image, count, 9, 4, "offsets of 4 bytes");
  put_patched(maker, "stream/0011-end-address.cgx", image, count, 29, 0x7f, "an end that is elsewhere");
  put_patched(maker, "stream/0012-checksum.cgx", image, count, 44, ((unsigned char *)image)[44] ^ 1,
              "a superblock of another checksum");
  conceg_free(image);
  const hid_t create = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_obj_track_times(create, 0);
  const char *path = corpus_file(maker, "stream/0013-other-hdf5.cgx", "not-a-document", "CGX-002", 3,
                                 "HDF5 of another format");
  const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, create, H5P_DEFAULT);
  CHECK(file >= 0);
  damage_close(file);
  H5Pclose(create);
}
