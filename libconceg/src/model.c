/* SPDX-License-Identifier: BSD-3-Clause
 * The substrate handle: plain copies of what a simulator needs. Everything is checked while it is copied, so
 * that the read-only functions need no check but that of the index. */
#define _POSIX_C_SOURCE 200809L
#include "doc_internal.h"

#include "conceg/model.h"

#include <stdlib.h>
#include <string.h>

struct conceg_substrate {
  conceg_ctx *ctx; /* used while opening only */
  double lo[3], hi[3];
  uint8_t periodic[3];

  uint64_t types, classes, cells, meshes; /* types = classes once open */
  char **type_name, **class_name;
  uint64_t *id;
  uint32_t *type;
  double *soma;
  float *soma_radius;

  uint64_t *cell_offset; /* NULL without skeletons */
  double *position;
  float *radius;
  int64_t *parent;
  uint8_t *kind;

  uint32_t *mesh_cell;
  uint64_t *vertex_offset, *face_offset;
  double *vertex, *volume, *area;
  uint32_t *face;
  uint8_t *compartment;
};

/* A copy of the array at `path`, which must have this type and `columns` values a row; *rows receives how
 * many. */
static conceg_status copy_array(conceg_doc *doc, const char *path, conceg_dtype dtype, uint64_t columns,
                                uint64_t *rows, void **out) {
  conceg_array array = {.size = sizeof array};
  conceg_status status = conceg_doc_read(doc, path, &array);
  if (status != CONCEG_OK) return status;
  conceg_ctx *ctx = doc->budget.ctx;
  uint64_t width = 1;
  for (uint32_t axis = 1; axis < array.rank; axis++)
    width *= array.shape[axis];
  if (array.dtype != dtype || !array.rank || width != columns)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: expected rows of %llu %s, got rows of %llu %s", path,
                           (unsigned long long)columns, conceg_dtype_name(dtype), (unsigned long long)width,
                           conceg_dtype_name(array.dtype));
  const uint64_t bytes = conceg_array_count(&array) * conceg_dtype_bytes(dtype);
  void *copy = malloc(bytes ? bytes : 1);
  if (!copy)
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory for %llu bytes", path,
                           (unsigned long long)bytes);
  if (bytes) memcpy(copy, array.data, bytes);
  *out = copy;
  *rows = array.shape[0];
  return CONCEG_OK;
}

/* The same where the number of rows is known. */
static conceg_status copy_rows(conceg_doc *doc, const char *path, conceg_dtype dtype, uint64_t columns,
                               uint64_t rows, void **out) {
  uint64_t got = 0;
  const conceg_status status = copy_array(doc, path, dtype, columns, &got, out);
  if (status != CONCEG_OK || got == rows) return status;
  return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_FORMAT, "%s: expected %llu rows, got %llu", path,
                         (unsigned long long)rows, (unsigned long long)got);
}

/* The same for an array that may be absent, which is then zero everywhere. */
static conceg_status copy_optional(conceg_doc *doc, const char *path, conceg_dtype dtype, uint64_t columns,
                                   uint64_t rows, void **out) {
  if (conceg_doc_has(doc, path)) return copy_rows(doc, path, dtype, columns, rows, out);
  *out = calloc(rows ? rows : 1, columns * conceg_dtype_bytes(dtype));
  return *out ? CONCEG_OK : conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
}

/* Offsets of `rows` rows into an array, whose length is *end. */
static conceg_status copy_offsets(conceg_doc *doc, const char *path, uint64_t rows, uint64_t **out,
                                  uint64_t *end) {
  void *copy = NULL;
  const conceg_status status = copy_rows(doc, path, CONCEG_U64, 1, rows + 1, &copy);
  *out = copy;
  if (status != CONCEG_OK) return status;
  const uint64_t *at = *out;
  for (uint64_t i = 0; i <= rows; i++)
    if (at[i] < (i ? at[i - 1] : 0) || (!i && at[0]))
      return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_FORMAT,
                             "%s[%llu]: expected offsets that start at 0 and never fall, got %llu", path,
                             (unsigned long long)i, (unsigned long long)at[i]);
  *end = at[rows];
  return CONCEG_OK;
}

static conceg_status copy_attribute(conceg_doc *doc, const char *path, conceg_dtype dtype, void *out) {
  void *copy = NULL;
  const conceg_status status = copy_rows(doc, path, dtype, 1, 3, &copy);
  if (status == CONCEG_OK) memcpy(out, copy, 3 * conceg_dtype_bytes(dtype));
  free(copy);
  return status;
}

/* `rows` NULL = any number; else as many texts as *rows. */
static conceg_status copy_texts(conceg_doc *doc, const char *path, const uint64_t *rows, uint64_t *count,
                                char ***out) {
  conceg_array array = {.size = sizeof array};
  conceg_status status = conceg_doc_read(doc, path, &array);
  if (status != CONCEG_OK) return status;
  conceg_ctx *ctx = doc->budget.ctx;
  if (array.dtype != CONCEG_TEXT || array.rank != 1)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: expected a list of texts, got %s", path,
                           conceg_dtype_name(array.dtype));
  if (rows && *rows != array.shape[0])
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: expected %llu texts, got %llu", path,
                           (unsigned long long)*rows, (unsigned long long)array.shape[0]);
  *count = array.shape[0];
  *out = calloc(*count + 1, sizeof **out);
  for (uint64_t i = 0; *out && i < *count; i++)
    if (!((*out)[i] = strdup(((const char *const *)array.data)[i]))) status = CONCEG_E_NOMEM;
  if (!*out || status != CONCEG_OK) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
  return CONCEG_OK;
}

static conceg_status check_below(conceg_ctx *ctx, const char *path, const uint32_t *values, uint64_t count,
                                 uint64_t limit) {
  for (uint64_t i = 0; i < count; i++)
    if (values[i] >= limit)
      return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s[%llu]: expected an index below %llu, got %u", path,
                             (unsigned long long)i, (unsigned long long)limit, values[i]);
  return CONCEG_OK;
}

/* The address of a typed pointer as void **, without breaking the aliasing rules. */
#define COPY_INTO(target, call)                                                                              \
  do {                                                                                                       \
    void *copy_ = NULL;                                                                                      \
    if (status == CONCEG_OK) {                                                                               \
      status = call;                                                                                         \
      (target) = copy_;                                                                                      \
    }                                                                                                        \
  } while (0)

static conceg_status copy_domain(conceg_doc *doc, conceg_substrate *s) {
  conceg_status status = copy_attribute(doc, "/domain@lo", CONCEG_F64, s->lo);
  if (status == CONCEG_OK) status = copy_attribute(doc, "/domain@hi", CONCEG_F64, s->hi);
  if (status == CONCEG_OK) status = copy_attribute(doc, "/domain@periodic", CONCEG_U8, s->periodic);
  return status;
}

static conceg_status copy_cells(conceg_doc *doc, conceg_substrate *s) {
  conceg_status status = CONCEG_OK;
  if (conceg_doc_has(doc, "/types")) {
    status = copy_texts(doc, "/types/name", NULL, &s->types, &s->type_name);
    if (status == CONCEG_OK) status = copy_texts(doc, "/types/class", &s->types, &s->classes, &s->class_name);
  }
  if (status != CONCEG_OK || !conceg_doc_has(doc, "/cells")) return status;
  COPY_INTO(s->id, copy_array(doc, "/cells/id", CONCEG_U64, 1, &s->cells, &copy_));
  COPY_INTO(s->type, copy_rows(doc, "/cells/type", CONCEG_U32, 1, s->cells, &copy_));
  COPY_INTO(s->soma, copy_rows(doc, "/cells/soma", CONCEG_F64, 3, s->cells, &copy_));
  COPY_INTO(s->soma_radius, copy_rows(doc, "/cells/radius", CONCEG_F32, 1, s->cells, &copy_));
  if (status == CONCEG_OK) status = check_below(s->ctx, "/cells/type", s->type, s->cells, s->types);
  return status;
}

static conceg_status copy_skeletons(conceg_doc *doc, conceg_substrate *s) {
  uint64_t points = 0;
  if (!conceg_doc_has(doc, "/skeleton")) return CONCEG_OK;
  conceg_status status = copy_offsets(doc, "/skeleton/cell_offset", s->cells, &s->cell_offset, &points);
  COPY_INTO(s->position, copy_rows(doc, "/skeleton/position", CONCEG_F64, 3, points, &copy_));
  COPY_INTO(s->radius, copy_rows(doc, "/skeleton/radius", CONCEG_F32, 1, points, &copy_));
  COPY_INTO(s->parent, copy_rows(doc, "/skeleton/parent", CONCEG_I64, 1, points, &copy_));
  COPY_INTO(s->kind, copy_rows(doc, "/skeleton/kind", CONCEG_U8, 1, points, &copy_));
  for (uint64_t cell = 0; status == CONCEG_OK && cell < s->cells; cell++)
    for (uint64_t i = s->cell_offset[cell]; i < s->cell_offset[cell + 1]; i++)
      if (s->parent[i] < -1 || s->parent[i] >= (int64_t)(i - s->cell_offset[cell]))
        return conceg_ctx_fail(s->ctx, CONCEG_E_FORMAT,
                               "/skeleton/parent[%llu]: expected an earlier row of its cell, or -1, got %lld",
                               (unsigned long long)i, (long long)s->parent[i]);
  return status;
}

static conceg_status check_faces(const conceg_substrate *s) {
  for (uint64_t k = 0; k < s->meshes; k++) {
    const uint64_t limit = s->vertex_offset[k + 1] - s->vertex_offset[k];
    for (uint64_t i = 3 * s->face_offset[k]; i < 3 * s->face_offset[k + 1]; i++)
      if (s->face[i] >= limit)
        return conceg_ctx_fail(
            s->ctx, CONCEG_E_FORMAT, "/meshes/face[%llu,%llu]: expected a vertex below %llu, got %u",
            (unsigned long long)(i / 3), (unsigned long long)(i % 3), (unsigned long long)limit, s->face[i]);
  }
  return CONCEG_OK;
}

static conceg_status copy_meshes(conceg_doc *doc, conceg_substrate *s) {
  uint64_t vertices = 0, faces = 0;
  conceg_status status = CONCEG_OK;
  if (!conceg_doc_has(doc, "/meshes")) return CONCEG_OK;
  COPY_INTO(s->mesh_cell, copy_array(doc, "/meshes/cell", CONCEG_U32, 1, &s->meshes, &copy_));
  if (status == CONCEG_OK) status = check_below(s->ctx, "/meshes/cell", s->mesh_cell, s->meshes, s->cells);
  if (status == CONCEG_OK)
    status = copy_offsets(doc, "/meshes/vertex_offset", s->meshes, &s->vertex_offset, &vertices);
  if (status == CONCEG_OK)
    status = copy_offsets(doc, "/meshes/face_offset", s->meshes, &s->face_offset, &faces);
  COPY_INTO(s->vertex, copy_rows(doc, "/meshes/vertex", CONCEG_F64, 3, vertices, &copy_));
  COPY_INTO(s->face, copy_rows(doc, "/meshes/face", CONCEG_U32, 3, faces, &copy_));
  COPY_INTO(s->compartment, copy_optional(doc, "/meshes/compartment", CONCEG_U8, 1, faces, &copy_));
  COPY_INTO(s->volume, copy_optional(doc, "/meshes/volume", CONCEG_F64, 1, s->meshes, &copy_));
  COPY_INTO(s->area, copy_optional(doc, "/meshes/area", CONCEG_F64, 1, s->meshes, &copy_));
  return status == CONCEG_OK ? check_faces(s) : status;
}

conceg_status conceg_substrate_open(conceg_doc *doc, conceg_substrate **out) {
  *out = NULL;
  conceg_substrate *s = calloc(1, sizeof *s);
  if (!s) return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "substrate: out of memory");
  s->ctx = doc->budget.ctx;
  conceg_status status = copy_domain(doc, s);
  if (status == CONCEG_OK) status = copy_cells(doc, s);
  if (status == CONCEG_OK) status = copy_skeletons(doc, s);
  if (status == CONCEG_OK) status = copy_meshes(doc, s);
  s->ctx = NULL;
  if (status == CONCEG_OK)
    *out = s;
  else
    conceg_substrate_free(s);
  return status;
}

static void free_texts(char **texts, uint64_t count) {
  for (uint64_t i = 0; texts && i < count; i++)
    free(texts[i]);
  free(texts);
}

void conceg_substrate_free(conceg_substrate *s) {
  if (!s) return;
  free_texts(s->type_name, s->types);
  free_texts(s->class_name, s->classes);
  void *const arrays[] = {s->id,     s->type,   s->soma, s->soma_radius, s->cell_offset,   s->position,
                          s->radius, s->parent, s->kind, s->mesh_cell,   s->vertex_offset, s->face_offset,
                          s->vertex, s->volume, s->area, s->face,        s->compartment};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
    free(arrays[i]);
  free(s);
}

void conceg_substrate_box(const conceg_substrate *s, double lo[3], double hi[3], uint8_t periodic[3]) {
  memcpy(lo, s->lo, sizeof s->lo);
  memcpy(hi, s->hi, sizeof s->hi);
  memcpy(periodic, s->periodic, sizeof s->periodic);
}

uint64_t conceg_substrate_cells(const conceg_substrate *s) {
  return s->cells;
}
uint64_t conceg_substrate_meshes(const conceg_substrate *s) {
  return s->meshes;
}

conceg_status conceg_substrate_cell(const conceg_substrate *s, uint64_t cell, conceg_cell_view *out) {
  if (out->size < sizeof *out) return CONCEG_E_USAGE;
  if (cell >= s->cells) return CONCEG_E_RANGE;
  out->type = s->type[cell];
  out->id = s->id[cell];
  out->type_name = s->type_name[out->type];
  out->class_name = s->class_name[out->type];
  memcpy(out->soma, s->soma + 3 * cell, sizeof out->soma);
  out->soma_radius = (double)s->soma_radius[cell];
  return CONCEG_OK;
}

conceg_status conceg_substrate_skeleton(const conceg_substrate *s, uint64_t cell, conceg_skeleton_view *out) {
  if (out->size < sizeof *out) return CONCEG_E_USAGE;
  if (cell >= s->cells) return CONCEG_E_RANGE;
  const uint64_t start = s->cell_offset ? s->cell_offset[cell] : 0;
  out->reserved = 0;
  out->count = s->cell_offset ? s->cell_offset[cell + 1] - start : 0;
  out->position = out->count ? s->position + 3 * start : NULL;
  out->radius = out->count ? s->radius + start : NULL;
  out->parent = out->count ? s->parent + start : NULL;
  out->kind = out->count ? s->kind + start : NULL;
  return CONCEG_OK;
}

conceg_status conceg_substrate_mesh(const conceg_substrate *s, uint64_t mesh, conceg_mesh_view *out) {
  if (out->size < sizeof *out) return CONCEG_E_USAGE;
  if (mesh >= s->meshes) return CONCEG_E_RANGE;
  const uint64_t vertex = s->vertex_offset[mesh], face = s->face_offset[mesh];
  out->cell = s->mesh_cell[mesh];
  out->vertex_count = s->vertex_offset[mesh + 1] - vertex;
  out->face_count = s->face_offset[mesh + 1] - face;
  out->vertex = s->vertex + 3 * vertex;
  out->face = s->face + 3 * face;
  out->compartment = s->compartment + face;
  out->volume = s->volume[mesh];
  out->area = s->area[mesh];
  return CONCEG_OK;
}
