/* SPDX-License-Identifier: BSD-3-Clause
 * Provenance: which stage made what out of what. No program path, host, time or thread count is ever noted.
 */
#include "provenance.h"

#define GROUP_PATH 256

const char *group_name(const char *group) {
  if (group_optional(group)) group++;
  return *group == '/' ? group + 1 : group;
}

int group_optional(const char *group) {
  return *group == '?';
}

int group_in(const char *const *groups, const char *group) {
  for (; groups && *groups; groups++)
    if (!strcmp(group_name(*groups), group_name(group))) return 1;
  return 0;
}

static conceg_status no_memory(conceg_ctx *ctx) {
  return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "provenance: out of memory");
}

/* ---- Rows ---- */

/* The old column of `rows` rows as a view; E_FORMAT when it is of another form. */
static conceg_status read_column(conceg_ctx *ctx, conceg_doc *doc, const char *path, conceg_dtype dtype,
                                 uint64_t rows, conceg_array *out) {
  conceg_status status;
  memset(out, 0, sizeof *out);
  out->size = sizeof *out;
  status = conceg_doc_read(doc, path, out);
  if (status != CONCEG_OK) return status;
  if (out->dtype != dtype || out->rank != 1 || out->shape[0] != rows)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: expected %llu rows of %s like /provenance/stage", path,
                           (unsigned long long)rows, conceg_dtype_name(dtype));
  return CONCEG_OK;
}

static conceg_status append_text(conceg_ctx *ctx, conceg_doc *doc, const char *path, uint64_t rows,
                                 const char *value) {
  conceg_array array = {sizeof array, CONCEG_TEXT, 1, 0, {0, 0, 0, 0}, NULL, NULL};
  const char **row = calloc(rows + 1, sizeof *row);
  char **owned = calloc(rows + 1, sizeof *owned);
  conceg_status status = row && owned ? CONCEG_OK : no_memory(ctx);
  uint64_t i;
  /* An old document may lack an optional column: its rows are then empty. */
  if (status == CONCEG_OK && rows && conceg_doc_has(doc, path))
    status = read_column(ctx, doc, path, CONCEG_TEXT, rows, &array);
  for (i = 0; status == CONCEG_OK && i < rows; i++) {
    const char *old = array.data ? ((const char *const *)array.data)[i] : "";
    row[i] = owned[i] = text_copy(old, strlen(old)); /* the view ends when the path is written */
    if (!owned[i]) status = no_memory(ctx);
  }
  if (status == CONCEG_OK) {
    row[rows] = value;
    array.dtype = CONCEG_TEXT, array.rank = 1, array.shape[0] = rows + 1, array.data = row, array.unit = NULL;
    status = conceg_doc_write(doc, path, &array);
  }
  for (i = 0; owned && i < rows; i++)
    free(owned[i]);
  free(owned);
  free(row);
  return status;
}

static conceg_status append_number(conceg_ctx *ctx, conceg_doc *doc, const char *path, conceg_dtype dtype,
                                   uint64_t rows, const void *value) {
  conceg_array array = {sizeof array, dtype, 1, 0, {0, 0, 0, 0}, NULL, NULL};
  const size_t bytes = conceg_dtype_bytes(dtype);
  char *column = calloc(rows + 1, bytes);
  conceg_status status = column ? CONCEG_OK : no_memory(ctx);
  if (status == CONCEG_OK && rows && conceg_doc_has(doc, path))
    status = read_column(ctx, doc, path, dtype, rows, &array);
  if (status == CONCEG_OK) {
    if (rows && array.data) memcpy(column, array.data, rows * bytes);
    memcpy(column + rows * bytes, value, bytes);
    array.dtype = dtype, array.rank = 1, array.shape[0] = rows + 1, array.data = column, array.unit = NULL;
    status = conceg_doc_write(doc, path, &array);
  }
  free(column);
  return status;
}

conceg_status provenance_add(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params,
                             const char *input) {
  const conceg_stage *stage = params->stage;
  const uint64_t seed = conceg_ctx_seed(ctx);
  const uint32_t abi = stage->abi;
  conceg_array first = {sizeof first, CONCEG_TEXT, 1, 0, {0, 0, 0, 0}, NULL, NULL};
  conceg_status status = CONCEG_OK;
  uint64_t rows = 0;
  if (conceg_doc_has(doc, "/provenance/stage")) {
    status = conceg_doc_read(doc, "/provenance/stage", &first);
    rows = first.rank == 1 ? first.shape[0] : 0;
  }
  if (status == CONCEG_OK) status = append_text(ctx, doc, "/provenance/stage", rows, stage->kind);
  if (status == CONCEG_OK) status = append_text(ctx, doc, "/provenance/implementation", rows, stage->name);
  if (status == CONCEG_OK)
    status = append_text(ctx, doc, "/provenance/implementation_version", rows,
                         stage->version ? stage->version : "");
  if (status == CONCEG_OK)
    status = append_text(ctx, doc, "/provenance/library_version", rows, conceg_version());
  if (status == CONCEG_OK)
    status = append_text(ctx, doc, "/provenance/parameters", rows, conceg_params_canonical(params));
  if (status == CONCEG_OK) status = append_number(ctx, doc, "/provenance/seed", CONCEG_U64, rows, &seed);
  if (status == CONCEG_OK) status = append_number(ctx, doc, "/provenance/abi", CONCEG_U32, rows, &abi);
  if (status == CONCEG_OK) status = append_text(ctx, doc, "/provenance/input", rows, input);
  return status;
}

/* ---- Origins ---- */

void origins_free(struct origins *origins) {
  uint32_t i;
  for (i = 0; i < origins->count; i++)
    free(origins->line[i]);
  free(origins->line);
  memset(origins, 0, sizeof *origins);
}

conceg_status origins_take(conceg_ctx *ctx, conceg_doc *doc, const conceg_stage *stage, struct origins *out) {
  uint32_t count = 0, i;
  memset(out, 0, sizeof *out);
  while (stage->reads && stage->reads[count])
    count++;
  out->line = calloc(count + 1, sizeof *out->line);
  if (!out->line) return no_memory(ctx);
  for (i = 0; i < count; i++) {
    struct text line = {0};
    char path[GROUP_PATH], digest[65];
    conceg_status status;
    /* A group that the stage rewrites is gone afterwards: its old digest would match nothing. */
    if (group_in(stage->writes, stage->reads[i])) continue;
    snprintf(path, sizeof path, "/%s", group_name(stage->reads[i]));
    if (group_optional(stage->reads[i]) && !conceg_doc_has(doc, path)) continue;
    status = conceg_doc_digest(doc, path, digest);
    if (status != CONCEG_OK) return status;
    text_format(&line, "%s=%s", group_name(stage->reads[i]), digest);
    if (line.failed) return no_memory(ctx);
    out->line[out->count++] = line.data;
  }
  return CONCEG_OK;
}

conceg_status origins_write(conceg_doc *doc, const char *group, const struct origins *origins) {
  conceg_array array = {sizeof array, CONCEG_TEXT, 1, 0, {origins->count, 0, 0, 0}, origins->line, NULL};
  char path[GROUP_PATH];
  snprintf(path, sizeof path, "/%s@made_from", group_name(group));
  if (!origins->count) return conceg_doc_drop(doc, path);
  return conceg_doc_write(doc, path, &array);
}

conceg_status origins_warn(conceg_ctx *ctx, conceg_doc *doc, const char *group) {
  conceg_array array = {sizeof array, CONCEG_TEXT, 1, 0, {0, 0, 0, 0}, NULL, NULL};
  char path[GROUP_PATH];
  conceg_status status;
  uint64_t i;
  snprintf(path, sizeof path, "/%s@made_from", group_name(group));
  if (!conceg_doc_has(doc, path)) return CONCEG_OK;
  status = conceg_doc_read(doc, path, &array);
  if (status != CONCEG_OK) return status;
  if (array.dtype != CONCEG_TEXT || array.rank > 1) return CONCEG_OK; /* the validator's business */
  for (i = 0; i < conceg_array_count(&array); i++) {
    const char *line = ((const char *const *)array.data)[i], *equals = strchr(line, '=');
    char origin[GROUP_PATH], digest[65];
    if (!equals || equals - line >= GROUP_PATH - 2) continue;
    snprintf(origin, sizeof origin, "/%.*s", (int)(equals - line), line);
    if (!conceg_doc_has(doc, origin)) continue;
    status = conceg_doc_digest(doc, origin, digest);
    if (status != CONCEG_OK) return status;
    if (strcmp(digest, equals + 1) != 0)
      conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "/%s was made from another %s than the one in this document",
                     group_name(group), origin);
  }
  return CONCEG_OK;
}
