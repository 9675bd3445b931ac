/* SPDX-License-Identifier: BSD-3-Clause
 * Opening a substrate: the arrays that simulators need are copied, and checked while they are, so that no
 * index, offset or number of an open substrate leads out of its arrays. */
#define _POSIX_C_SOURCE 200809L
#include "doc_internal.h"
#include "model_internal.h"
#include "provenance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum presence { REQUIRED, OPTIONAL };

/* Where blocks of an array go. */
struct copy {
  char *to;
  size_t width;
};

static conceg_status take_block(void *user, uint64_t first, uint64_t count, const void *values) {
  const struct copy *copy = user;
  memcpy(copy->to + first * copy->width, values, count * copy->width);
  return CONCEG_OK;
}

/* A copy of the array at `path`, which must have this type and `columns` values a row; *rows receives how
 * many. Read block by block, so that the document does not keep it. */
static conceg_status copy_array(conceg_doc *doc, const char *path, conceg_dtype dtype, uint64_t columns,
                                uint64_t *rows, void **out) {
  conceg_array array = {.size = sizeof array};
  conceg_ctx *ctx = doc->budget.ctx;
  conceg_status status = conceg_doc_describe(doc, path, &array);
  if (status != CONCEG_OK) return status;
  uint64_t width = 1;
  for (uint32_t axis = 1; axis < array.rank; axis++)
    width *= array.shape[axis];
  if (array.dtype != dtype || !array.rank || width != columns)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: expected rows of %llu %s, got rows of %llu %s", path,
                           (unsigned long long)columns, conceg_dtype_name(dtype), (unsigned long long)width,
                           conceg_dtype_name(array.dtype));
  struct copy copy = {.width = conceg_dtype_bytes(dtype)};
  const uint64_t bytes = conceg_array_count(&array) * copy.width;
  copy.to = malloc(bytes ? bytes : 1);
  if (!copy.to)
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory for %llu bytes", path,
                           (unsigned long long)bytes);
  status = doc_each_block(doc, tree_find(doc->root, path), take_block, &copy);
  if (status != CONCEG_OK) {
    free(copy.to);
    return status;
  }
  *out = copy.to;
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
static conceg_status copy_or_zero(conceg_doc *doc, const char *path, conceg_dtype dtype, uint64_t columns,
                                  uint64_t rows, void **out) {
  if (conceg_doc_has(doc, path)) return copy_rows(doc, path, dtype, columns, rows, out);
  *out = calloc(rows ? rows : 1, columns * conceg_dtype_bytes(dtype));
  return *out ? CONCEG_OK : conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
}

/* The same for one that is NULL when it is absent. */
static conceg_status copy_or_null(conceg_doc *doc, const char *path, conceg_dtype dtype, uint64_t columns,
                                  uint64_t rows, void **out) {
  return conceg_doc_has(doc, path) ? copy_rows(doc, path, dtype, columns, rows, out) : CONCEG_OK;
}

static conceg_status copy_attribute(conceg_doc *doc, const char *path, enum presence presence,
                                    conceg_dtype dtype, void *out) {
  void *copy = NULL;
  if (presence == OPTIONAL && !conceg_doc_has(doc, path)) return CONCEG_OK;
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

/* Names the first value that is no number; `columns` 1 for a list. */
static conceg_status bad_number(conceg_ctx *ctx, const char *path, uint64_t index, uint64_t columns,
                                double value) {
  if (columns == 1)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s[%llu]: expected a finite number, got %g", path,
                           (unsigned long long)index, value);
  return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s[%llu,%llu]: expected a finite number, got %g", path,
                         (unsigned long long)(index / columns), (unsigned long long)(index % columns), value);
}

static conceg_status check_finite(conceg_ctx *ctx, const char *path, const double *values, uint64_t rows,
                                  uint64_t columns) {
  for (uint64_t i = 0; i < rows * columns; i++)
    if (!isfinite(values[i])) return bad_number(ctx, path, i, columns, values[i]);
  return CONCEG_OK;
}

static conceg_status check_finite_f32(conceg_ctx *ctx, const char *path, const float *values,
                                      uint64_t count) {
  for (uint64_t i = 0; i < count; i++)
    if (!isfinite(values[i])) return bad_number(ctx, path, i, 1, (double)values[i]);
  return CONCEG_OK;
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

/* Copies into a typed pointer unless an earlier step failed; the address is passed as void ** by way of a
 * variable, so that the aliasing rules hold. */
#define COPY_INTO(target, call)                                                                              \
  do {                                                                                                       \
    void *copy_ = NULL;                                                                                      \
    if (status == CONCEG_OK) {                                                                               \
      status = call;                                                                                         \
      (target) = copy_;                                                                                      \
    }                                                                                                        \
  } while (0)

/* Runs a check unless an earlier step failed. */
#define THEN(call)                                                                                           \
  do {                                                                                                       \
    if (status == CONCEG_OK) status = call;                                                                  \
  } while (0)

static conceg_status copy_domain(conceg_doc *doc, conceg_substrate *s) {
  conceg_status status = copy_attribute(doc, "/domain@lo", REQUIRED, CONCEG_F64, s->lo);
  THEN(copy_attribute(doc, "/domain@hi", REQUIRED, CONCEG_F64, s->hi));
  THEN(copy_attribute(doc, "/domain@periodic", REQUIRED, CONCEG_U8, s->periodic));
  THEN(check_finite(s->ctx, "/domain@lo", s->lo, 3, 1));
  THEN(check_finite(s->ctx, "/domain@hi", s->hi, 3, 1));
  for (int axis = 0; status == CONCEG_OK && axis < 3; axis++) {
    if (!(s->hi[axis] > s->lo[axis]) || !isfinite(s->hi[axis] - s->lo[axis]))
      return conceg_ctx_fail(s->ctx, CONCEG_E_FORMAT,
                             "/domain@hi[%d]: expected a value above lo = %g, got %g", axis, s->lo[axis],
                             s->hi[axis]);
    if (s->periodic[axis] > 1)
      return conceg_ctx_fail(s->ctx, CONCEG_E_FORMAT, "/domain@periodic[%d]: expected 0 or 1, got %d", axis,
                             s->periodic[axis]);
  }
  return status;
}

static int compare_ids(const void *a, const void *b) {
  const struct cell_id *first = a, *second = b;
  if (first->id != second->id) return first->id < second->id ? -1 : 1;
  return first->row < second->row ? -1 : first->row > second->row;
}

static conceg_status sort_ids(conceg_substrate *s) {
  s->by_id = malloc((s->cells ? s->cells : 1) * sizeof *s->by_id);
  if (!s->by_id) return conceg_ctx_fail(s->ctx, CONCEG_E_NOMEM, "/cells/id: out of memory");
  for (uint64_t i = 0; i < s->cells; i++)
    s->by_id[i] = (struct cell_id){s->id[i], i};
  qsort(s->by_id, s->cells, sizeof *s->by_id, compare_ids);
  for (uint64_t i = 1; i < s->cells; i++)
    if (s->by_id[i].id == s->by_id[i - 1].id)
      return conceg_ctx_fail(s->ctx, CONCEG_E_FORMAT,
                             "/cells/id[%llu]: expected an id of its own, got %llu again",
                             (unsigned long long)s->by_id[i].row, (unsigned long long)s->by_id[i].id);
  return CONCEG_OK;
}

static conceg_status copy_cells(conceg_doc *doc, conceg_substrate *s) {
  conceg_status status = CONCEG_OK;
  if (conceg_doc_has(doc, "/types")) {
    status = copy_texts(doc, "/types/name", NULL, &s->types, &s->type_name);
    THEN(copy_texts(doc, "/types/class", &s->types, &s->classes, &s->class_name));
  }
  if (status != CONCEG_OK || !conceg_doc_has(doc, "/cells")) return status;
  COPY_INTO(s->id, copy_array(doc, "/cells/id", CONCEG_U64, 1, &s->cells, &copy_));
  COPY_INTO(s->type, copy_rows(doc, "/cells/type", CONCEG_U32, 1, s->cells, &copy_));
  COPY_INTO(s->soma, copy_rows(doc, "/cells/soma", CONCEG_F64, 3, s->cells, &copy_));
  COPY_INTO(s->soma_radius, copy_rows(doc, "/cells/radius", CONCEG_F32, 1, s->cells, &copy_));
  THEN(check_below(s->ctx, "/cells/type", s->type, s->cells, s->types));
  THEN(check_finite(s->ctx, "/cells/soma", s->soma, s->cells, 3));
  THEN(check_finite_f32(s->ctx, "/cells/radius", s->soma_radius, s->cells));
  THEN(sort_ids(s));
  return status;
}

static conceg_status check_parents(const conceg_substrate *s) {
  for (uint64_t cell = 0; cell < s->cells; cell++)
    for (uint64_t i = s->cell_offset[cell]; i < s->cell_offset[cell + 1]; i++)
      if (s->parent[i] < -1 || s->parent[i] >= (int64_t)(i - s->cell_offset[cell]))
        return conceg_ctx_fail(s->ctx, CONCEG_E_FORMAT,
                               "/skeleton/parent[%llu]: expected an earlier row of its cell, or -1, got %lld",
                               (unsigned long long)i, (long long)s->parent[i]);
  return CONCEG_OK;
}

static conceg_status copy_skeletons(conceg_doc *doc, conceg_substrate *s) {
  uint64_t points = 0;
  if (!conceg_doc_has(doc, "/skeleton")) return CONCEG_OK;
  conceg_status status = copy_offsets(doc, "/skeleton/cell_offset", s->cells, &s->cell_offset, &points);
  COPY_INTO(s->position, copy_rows(doc, "/skeleton/position", CONCEG_F64, 3, points, &copy_));
  COPY_INTO(s->radius, copy_rows(doc, "/skeleton/radius", CONCEG_F32, 1, points, &copy_));
  COPY_INTO(s->target_radius, copy_rows(doc, "/skeleton/target_radius", CONCEG_F32, 1, points, &copy_));
  COPY_INTO(s->parent, copy_rows(doc, "/skeleton/parent", CONCEG_I64, 1, points, &copy_));
  COPY_INTO(s->kind, copy_rows(doc, "/skeleton/kind", CONCEG_U8, 1, points, &copy_));
  COPY_INTO(s->branch, copy_or_null(doc, "/skeleton/branch", CONCEG_U32, 1, points, &copy_));
  THEN(check_finite(s->ctx, "/skeleton/position", s->position, points, 3));
  THEN(check_finite_f32(s->ctx, "/skeleton/radius", s->radius, points));
  THEN(check_finite_f32(s->ctx, "/skeleton/target_radius", s->target_radius, points));
  THEN(check_parents(s));
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

/* Coarser levels stand behind the surfaces of level 0 and are not opened. */
static conceg_status keep_finest(conceg_doc *doc, conceg_substrate *s) {
  uint64_t finest = 0, k;
  uint8_t *lod = NULL;
  conceg_status status = CONCEG_OK;
  COPY_INTO(lod, copy_or_null(doc, "/meshes/lod", CONCEG_U8, 1, s->meshes, &copy_));
  for (k = 0; lod && k < s->meshes; k++) {
    if (lod[k]) continue;
    if (finest < k && status == CONCEG_OK)
      status = conceg_ctx_fail(
          s->ctx, CONCEG_E_FORMAT,
          "/meshes/lod[%llu]: expected all surfaces of level 0 first, got one behind level %u",
          (unsigned long long)k, lod[k - 1]);
    finest++;
  }
  if (lod && status == CONCEG_OK) s->meshes = finest;
  free(lod);
  return status;
}

static conceg_status copy_meshes(conceg_doc *doc, conceg_substrate *s) {
  uint64_t vertices = 0, faces = 0;
  conceg_status status = CONCEG_OK;
  if (!conceg_doc_has(doc, "/meshes")) return CONCEG_OK;
  COPY_INTO(s->mesh_cell, copy_array(doc, "/meshes/cell", CONCEG_U32, 1, &s->meshes, &copy_));
  THEN(check_below(s->ctx, "/meshes/cell", s->mesh_cell, s->meshes, s->cells));
  THEN(copy_offsets(doc, "/meshes/vertex_offset", s->meshes, &s->vertex_offset, &vertices));
  THEN(copy_offsets(doc, "/meshes/face_offset", s->meshes, &s->face_offset, &faces));
  COPY_INTO(s->vertex, copy_rows(doc, "/meshes/vertex", CONCEG_F64, 3, vertices, &copy_));
  COPY_INTO(s->face, copy_rows(doc, "/meshes/face", CONCEG_U32, 3, faces, &copy_));
  COPY_INTO(s->compartment, copy_or_zero(doc, "/meshes/compartment", CONCEG_U8, 1, faces, &copy_));
  COPY_INTO(s->component, copy_or_null(doc, "/meshes/component", CONCEG_U32, 1, faces, &copy_));
  COPY_INTO(s->section, copy_or_null(doc, "/meshes/section", CONCEG_U32, 1, faces, &copy_));
  COPY_INTO(s->origin, copy_rows(doc, "/meshes/origin", CONCEG_F64, 3, s->meshes, &copy_));
  COPY_INTO(s->volume, copy_or_zero(doc, "/meshes/volume", CONCEG_F64, 1, s->meshes, &copy_));
  COPY_INTO(s->area, copy_or_zero(doc, "/meshes/area", CONCEG_F64, 1, s->meshes, &copy_));
  COPY_INTO(s->min_gap, copy_or_zero(doc, "/meshes/min_gap", CONCEG_F64, 1, s->meshes, &copy_));
  COPY_INTO(s->genus, copy_or_zero(doc, "/meshes/genus", CONCEG_I64, 1, s->meshes, &copy_));
  COPY_INTO(s->closed, copy_or_zero(doc, "/meshes/closed", CONCEG_U8, 1, s->meshes, &copy_));
  if (conceg_doc_has(doc, "/meshes/form"))
    THEN(copy_texts(doc, "/meshes/form", &s->meshes, &s->forms, &s->form));
  THEN(check_finite(s->ctx, "/meshes/vertex", s->vertex, vertices, 3));
  THEN(check_finite(s->ctx, "/meshes/origin", s->origin, s->meshes, 3));
  THEN(check_finite(s->ctx, "/meshes/volume", s->volume, s->meshes, 1));
  THEN(check_finite(s->ctx, "/meshes/area", s->area, s->meshes, 1));
  THEN(check_finite(s->ctx, "/meshes/min_gap", s->min_gap, s->meshes, 1));
  THEN(check_faces(s));
  THEN(keep_finest(doc, s));
  return status;
}

static conceg_status check_labels(const conceg_substrate *s) {
  for (uint64_t i = 0; s->label && i < 512 * s->leaves; i++)
    if (s->label[i] > s->cells)
      return conceg_ctx_fail(s->ctx, CONCEG_E_FORMAT,
                             "/volumes/label[%llu,%llu]: expected at most the number of cells, %llu, got %u",
                             (unsigned long long)(i / 512), (unsigned long long)(i % 512),
                             (unsigned long long)s->cells, s->label[i]);
  return CONCEG_OK;
}

static conceg_status copy_volumes(conceg_doc *doc, conceg_substrate *s) {
  conceg_status status = CONCEG_OK;
  if (!conceg_doc_has(doc, "/volumes")) return CONCEG_OK;
  s->has_volumes = 1;
  COPY_INTO(s->leaf_origin, copy_array(doc, "/volumes/leaf_origin", CONCEG_I32, 3, &s->leaves, &copy_));
  COPY_INTO(s->label, copy_or_null(doc, "/volumes/label", CONCEG_U32, 512, s->leaves, &copy_));
  COPY_INTO(s->distance, copy_or_null(doc, "/volumes/distance", CONCEG_F32, 512, s->leaves, &copy_));
  THEN(copy_attribute(doc, "/volumes@origin", OPTIONAL, CONCEG_F64, s->volume_origin));
  THEN(copy_attribute(doc, "/volumes@spacing", OPTIONAL, CONCEG_F64, s->volume_spacing));
  THEN(copy_attribute(doc, "/volumes@shape", OPTIONAL, CONCEG_U64, s->volume_shape));
  THEN(check_finite(s->ctx, "/volumes@origin", s->volume_origin, 3, 1));
  THEN(check_finite(s->ctx, "/volumes@spacing", s->volume_spacing, 3, 1));
  if (s->distance) THEN(check_finite_f32(s->ctx, "/volumes/distance", s->distance, 512 * s->leaves));
  THEN(check_labels(s));
  return status;
}

static conceg_status warn_of_origins(conceg_doc *doc, conceg_ctx *ctx) {
  static const char *const derived[] = {"skeleton", "meshes", "volumes"};
  conceg_status status = CONCEG_OK;
  for (size_t i = 0; i < sizeof derived / sizeof *derived; i++)
    THEN(origins_warn(ctx, doc, derived[i]));
  return status;
}

conceg_status conceg_substrate_open(conceg_doc *doc, conceg_substrate **out) {
  if (!out) return CONCEG_E_USAGE;
  *out = NULL;
  if (!doc) return CONCEG_E_USAGE;
  conceg_substrate *s = calloc(1, sizeof *s);
  if (!s) return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "substrate: out of memory");
  s->ctx = doc->budget.ctx;
  conceg_status status = copy_domain(doc, s);
  THEN(copy_cells(doc, s));
  THEN(copy_skeletons(doc, s));
  THEN(copy_meshes(doc, s));
  THEN(copy_volumes(doc, s));
  THEN(warn_of_origins(doc, s->ctx));
  s->ctx = NULL;
  if (status == CONCEG_OK)
    *out = s;
  else
    conceg_substrate_free(s);
  return status;
}

conceg_status conceg_substrate_open_file(conceg_ctx *ctx, const char *path, conceg_substrate **out) {
  conceg_doc *doc = NULL;
  if (!out) return CONCEG_E_USAGE;
  *out = NULL;
  if (!ctx || !path) return CONCEG_E_USAGE;
  conceg_status status = conceg_doc_open(ctx, path, &doc);
  if (status != CONCEG_OK) return status;
  status = conceg_substrate_open(doc, out);
  const conceg_status closed = conceg_doc_close(doc);
  if (status != CONCEG_OK || closed == CONCEG_OK) return status;
  conceg_substrate_free(*out);
  *out = NULL;
  return closed;
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
  free_texts(s->form, s->forms);
  void *const arrays[] = {s->id,          s->by_id,       s->type,      s->soma,          s->soma_radius,
                          s->cell_offset, s->position,    s->radius,    s->target_radius, s->parent,
                          s->kind,        s->branch,      s->mesh_cell, s->vertex_offset, s->face_offset,
                          s->vertex,      s->origin,      s->volume,    s->area,          s->min_gap,
                          s->face,        s->component,   s->section,   s->compartment,   s->closed,
                          s->genus,       s->leaf_origin, s->label,     s->distance};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
    free(arrays[i]);
  free(s);
}
