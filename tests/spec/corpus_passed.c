/* SPDX-License-Identifier: BSD-3-Clause
 * spec/conformance/passed and roundtrip: documents that keep every rule, one step of understanding each. */
#define _XOPEN_SOURCE 700
#include "corpus.h"

static void save(struct maker *maker, const char *name, unsigned parts, const char *note) {
  const char *path = corpus_file(maker, name, "valid", "-", 0, note);
  corpus_save(maker, corpus_doc(maker->ctx, parts), path);
}

static void make_origin(struct maker *maker, const char *path, unsigned parts) {
  conceg_doc *doc = corpus_doc(maker->ctx, parts);
  char hex[65], line[80];
  CHECK_EQUAL(conceg_doc_digest(doc, "/skeleton", hex), CONCEG_OK);
  snprintf(line, sizeof line, "skeleton=%s", hex);
  conceg_ctx *ctx = maker->ctx;
  PUT("/meshes@made_from", CONCEG_TEXT, char *, 0, line);
  corpus_save(maker, doc, path);
}

/* The root attributes and one dataset each in a form that ConCeG reads and does not write. */
static hid_t new_file(const char *path, H5F_libver_t low, H5F_libver_t high) {
  static const uint32_t version[2] = {1, 0};
  static const uint8_t complete = 1;
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS), create = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_libver_bounds(access, low, high);
  H5Pset_obj_track_times(create, 0);
  const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, create, access);
  CHECK(file >= 0);
  damage_text_attribute(file, "/", "format", "conceg-interchange");
  damage_attribute(file, "/", "version", H5T_STD_U32LE, 2, version);
  damage_text_attribute(file, "/", "length_unit", "um");
  damage_text_attribute(file, "/", "time_unit", "ms");
  damage_attribute(file, "/", "complete", H5T_STD_U8LE, 0, &complete);
  H5Pclose(create);
  H5Pclose(access);
  return file;
}

static void put_types(hid_t file) {
  const hsize_t two = 2;
  const hid_t list = corpus_list(), type = H5Tcopy(H5T_C_S1), groups = H5Pcreate(H5P_GROUP_CREATE);
  H5Pset_obj_track_times(groups, 0);
  H5Gclose(H5Gcreate2(file, "/types", H5P_DEFAULT, groups, H5P_DEFAULT));
  H5Tset_size(type, 9);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  corpus_dataset(file, "/types/name", type, 1, &two, list, "round\0\0\0\0thin\0\0\0\0", "");
  corpus_dataset(file, "/types/class", type, 1, &two, list, "pyramidalastrocyte", "");
  H5Tclose(type);
  H5Pclose(groups);
  H5Pclose(list);
}

static void make_forms(struct maker *maker) {
  const double fraction[2] = {0.25, 0.75};
  const hsize_t two = 2;
  hid_t file =
      new_file(corpus_file(maker, "passed/0018-superblock-0.cgx", "valid", "-", 0, "the oldest superblock"),
               H5F_LIBVER_EARLIEST, H5F_LIBVER_LATEST);
  put_types(file);
  damage_close(file);
  file = new_file(corpus_file(maker, "passed/0019-superblock-3.cgx", "valid", "-", 0,
                              "the newest superblock and object headers"),
                  H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
  put_types(file);
  damage_close(file);
  file = new_file(corpus_file(maker, "passed/0020-big-endian.cgx", "valid", "-", 0, "numbers big end first"),
                  H5F_LIBVER_V18, H5F_LIBVER_V18);
  put_types(file);
  hid_t list = corpus_list();
  const hid_t space = H5Screate_simple(1, &two, NULL);
  hid_t dataset = H5Dcreate2(file, "/types/fraction", H5T_IEEE_F64BE, space, H5P_DEFAULT, list, H5P_DEFAULT);
  CHECK(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, fraction) >= 0);
  H5Dclose(dataset);
  damage_text_attribute(file, "/types/fraction", "unit", "1");
  damage_close(file);
  file = new_file(
      corpus_file(maker, "passed/0021-compressed.cgx", "valid", "-", 0, "a chunked and compressed array"),
      H5F_LIBVER_V18, H5F_LIBVER_V18);
  put_types(file);
  H5Pset_chunk(list, 1, &two);
  H5Pset_shuffle(list);
  H5Pset_deflate(list, 6);
  corpus_dataset(file, "/types/fraction", H5T_IEEE_F64LE, 1, &two, list, fraction, "1");
  damage_close(file);
  H5Pclose(list);
  H5Sclose(space);
  file = new_file(corpus_file(maker, "passed/0022-variable-text.cgx", "valid", "-", 0,
                              "texts of variable length, and padded by blanks"),
                  H5F_LIBVER_V18, H5F_LIBVER_V18);
  put_types(file);
  const char *const layers[2] = {"L4", ""};
  const hid_t variable = H5Tcopy(H5T_C_S1), blank = H5Tcopy(H5T_FORTRAN_S1);
  H5Tset_size(variable, H5T_VARIABLE);
  H5Tset_size(blank, 4);
  list = corpus_list();
  corpus_dataset(file, "/types/layer", variable, 1, &two, list, layers, "");
  corpus_dataset(file, "/types/entry", blank, 1, &two, list, "a   bcd ", "");
  H5Pclose(list);
  H5Tclose(variable);
  H5Tclose(blank);
  damage_close(file);
}

void make_passed(struct maker *maker) {
  conceg_ctx *ctx = maker->ctx;
  save(maker, "passed/0001-empty.cgx", 0, "the root attributes alone");
  save(maker, "passed/0002-recipe.cgx", RECIPE, "the recipe is one text");
  save(maker, "passed/0003-box.cgx", BOX, "a periodic box of 40 um");
  conceg_doc *doc = corpus_doc(ctx, BOX);
  PUT("/domain@periodic", CONCEG_U8, uint8_t, 0, 1, 1, 0);
  PUT("/domain/layer_name", CONCEG_TEXT, char *, 0, (char *)"L2", (char *)"L4");
  PUT("/domain/layer_lo", CONCEG_F64, double, 0, 20, 0);
  PUT("/domain/layer_hi", CONCEG_F64, double, 0, 40, 20);
  corpus_save(maker, doc,
              corpus_file(maker, "passed/0004-layers.cgx", "valid", "-", 0, "two layers, open along z"));
  save(maker, "passed/0005-dictionary.cgx", DICTIONARY, "an entry of one donor, one tree, two bars");
  save(maker, "passed/0006-cells.cgx", BOX | TYPES, "three cells of two types, one without a soma");
  doc = corpus_doc(ctx, BOX | TYPES | DICTIONARY);
  PUT("/cells/donor", CONCEG_U32, uint32_t, 0, 0, 0, UINT32_MAX);
  corpus_save(
      maker, doc,
      corpus_file(maker, "passed/0007-donors.cgx", "valid", "-", 0, "cells name their donors, one has none"));
  save(maker, "passed/0008-bars.cgx", BOX | TYPES | BARS, "bars of a cell: offsets, parents");
  save(maker, "passed/0009-network.cgx", BOX | NETWORK, "a network with an edge through the box");
  save(maker, "passed/0010-skeleton.cgx", BOX | TYPES | SKELETON,
       "points of a cell: offsets, parents, radii");
  save(maker, "passed/0011-skeleton-of-bars.cgx", BOX | TYPES | BARS | SKELETON, "points name their bars");
  save(maker, "passed/0012-spheres.cgx", BOX | TYPES | SKELETON | SPHERES, "spheres along the segments");
  save(maker, "passed/0013-meshes.cgx", BOX | TYPES | MESHES, "two surfaces of four faces");
  save(maker, "passed/0014-volumes.cgx", BOX | TYPES | VOLUMES, "one leaf of 8 x 8 x 8 labels");
  save(maker, "passed/0015-statistics.cgx", TABLES, "a table of two columns");
  save(maker, "passed/0016-provenance.cgx", PROVENANCE, "two stages have run");
  make_origin(maker,
              corpus_file(maker, "passed/0017-made-from.cgx", "valid", "-", 0,
                          "meshes say of which skeletons they were made"),
              BOX | TYPES | SKELETON | MESHES);
  make_forms(maker);
  doc = corpus_doc(ctx, 0);
  PUT("/x_lab/deep/notes", CONCEG_TEXT, char *, 0, (char *)"caf\xc3\xa9", (char *)"", (char *)"longer");
  corpus_save(maker, doc,
              corpus_file(maker, "passed/0023-own-group.cgx", "valid", "-", 0, "a group of one's own"));
  save(maker, "passed/0024-whole.cgx",
       RECIPE | BOX | TYPES | DICTIONARY | BARS | NETWORK | SKELETON | SPHERES | MESHES | TABLES | PROVENANCE,
       "a whole tiny tissue");
}

void make_roundtrip(struct maker *maker) {
  conceg_ctx *ctx = maker->ctx;
  const uint32_t minor[2] = {1, 7};
  const hsize_t three = 3;
  const int32_t pairs[6] = {1, 2, 3, 4, 5, 6};
  conceg_doc *doc = corpus_doc(ctx, BOX | TYPES);
  PUT("/x_lab/deep/values", CONCEG_I32, int32_t, 0, 1, -2, 3);
  PUT("/cells/x_lab_colour", CONCEG_U8, uint8_t, 0, 7, 8, 9);
  corpus_save(maker, doc,
              corpus_file(maker, "roundtrip/0001-x-groups.cgx", "carried", "-", 0,
                          "arrays of one's own at the top and inside a known group"));
  doc = corpus_doc(ctx, BOX);
  PUT("/future/thing", CONCEG_F32, float, 0, 1, 2, 3);
  corpus_save(maker, doc,
              corpus_file(maker, "roundtrip/0002-unknown-group.cgx", "carried", "CGX-012", 0,
                          "a group that is not known"));
  const char *path = corpus_file(maker, "roundtrip/0003-newer-minor.cgx", "carried", "-", 0,
                                 "minor version 7 with a group of its own");
  doc = corpus_doc(ctx, BOX);
  PUT("/future/thing", CONCEG_F32, float, 0, 1, 2, 3);
  corpus_save(maker, doc, path);
  hid_t file = damage_open(path);
  damage_attribute(file, "/", "version", H5T_STD_U32LE, 2, minor);
  damage_close(file);
  path = corpus_file(maker, "roundtrip/0004-compound.cgx", "carried", "-", 0,
                     "compounds in a group of one's own");
  doc = corpus_doc(ctx, BOX);
  PUT("/x_lab/values", CONCEG_I32, int32_t, 0, 1, -2, 3);
  corpus_save(maker, doc, path);
  file = damage_open(path);
  const hid_t type = H5Tcreate(H5T_COMPOUND, 8), list = corpus_list();
  H5Tinsert(type, "a", 0, H5T_STD_I32LE);
  H5Tinsert(type, "b", 4, H5T_STD_I32LE);
  corpus_dataset(file, "/x_lab/pairs", type, 1, &three, list, pairs, NULL);
  damage_attribute(file, "/x_lab/values", "pair", type, 0, pairs);
  H5Tclose(type);
  H5Pclose(list);
  damage_close(file);
}
