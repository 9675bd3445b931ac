/* SPDX-License-Identifier: BSD-3-Clause
 * The document: making, opening and closing. */
#define _POSIX_C_SOURCE 200809L
#include "ctx_internal.h"
#include "doc_internal.h"
#include "stream.h"
#include "texts.h"

#include <stdlib.h>
#include <string.h>

static const char format_name[] = "conceg-interchange";

static conceg_status out_of_memory(conceg_ctx *ctx) {
  return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "document: out of memory");
}

static conceg_status make_empty(conceg_ctx *ctx, conceg_doc **out) {
  conceg_doc *doc = calloc(1, sizeof *doc);
  if (!doc) return out_of_memory(ctx);
  doc->budget.ctx = ctx;
  doc->schema = ctx_schema(ctx);
  if (!doc->schema) {
    free(doc);
    return out_of_memory(ctx);
  }
  doc->root = entry_new(ENTRY_GROUP, NULL, "", 0, doc->schema);
  if (!doc->root) {
    free(doc);
    return out_of_memory(ctx);
  }
  *out = doc;
  return CONCEG_OK;
}

/* Root attributes: the library writes them itself. */
static conceg_status add_root(conceg_doc *doc, const char *name, conceg_dtype dtype, uint32_t rank,
                              uint64_t count, const void *data, uint64_t bytes) {
  struct entry *entry = entry_new(ENTRY_ARRAY, doc->root, name, 1, doc->schema);
  if (!entry) return out_of_memory(doc->budget.ctx);
  entry->dtype = dtype;
  entry->rank = rank;
  entry->shape[0] = rank ? count : 0;
  const char *text = data;
  conceg_status status = dtype == CONCEG_TEXT ? texts_copy(&doc->budget, entry->path, &text, 1, &entry->store)
                                              : store_new(&doc->budget, entry->path, bytes, &entry->store);
  if (status == CONCEG_OK && dtype != CONCEG_TEXT) memcpy(entry->store.data, data, bytes);
  if (status == CONCEG_OK && !entry_attach(&doc->budget, entry)) status = out_of_memory(doc->budget.ctx);
  if (status != CONCEG_OK) entry_free(&doc->budget, entry);
  return status;
}

conceg_status conceg_doc_new(conceg_ctx *ctx, conceg_doc **out) {
  static const uint32_t version[2] = {CONCEG_CGX_MAJOR, CONCEG_CGX_MINOR};
  static const uint8_t complete = 1;
  conceg_doc *doc = NULL;
  *out = NULL;
  conceg_status status = make_empty(ctx, &doc);
  if (status != CONCEG_OK) return status;
  status = add_root(doc, "format", CONCEG_TEXT, 0, 1, format_name, 0);
  if (status == CONCEG_OK) status = add_root(doc, "version", CONCEG_U32, 1, 2, version, sizeof version);
  if (status == CONCEG_OK) status = add_root(doc, "length_unit", CONCEG_TEXT, 0, 1, "um", 0);
  if (status == CONCEG_OK) status = add_root(doc, "time_unit", CONCEG_TEXT, 0, 1, "ms", 0);
  if (status == CONCEG_OK) status = add_root(doc, "complete", CONCEG_U8, 0, 1, &complete, sizeof complete);
  if (status == CONCEG_OK)
    *out = doc;
  else
    (void)conceg_doc_close(doc);
  return status;
}

static const struct entry *root_attribute(const conceg_doc *doc, const char *name) {
  return entry_child(doc->root, name, strlen(name), 1);
}

/* Is it a CGX file, of a version that can be read, and did its writer finish? */
static conceg_status check_root(const conceg_doc *doc) {
  conceg_ctx *ctx = doc->budget.ctx;
  const char *name = h5_name(doc->file);
  const struct entry *format = root_attribute(doc, "format"), *version = root_attribute(doc, "version");
  const char *text = entry_text(format);
  if (!text || strcmp(text, format_name) != 0)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT,
                           "%s: /@format: not a CGX file: expected \"%s\", got %s (CGX-002)", name,
                           format_name, text ? text : "nothing");
  if (!version || version->kind != ENTRY_ARRAY || conceg_dtype_bytes(version->dtype) != 4 ||
      version->dtype == CONCEG_F32 || version->rank != 1 || version->shape[0] != 2)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT,
                           "%s: /@version: expected two u32 numbers, got something else (CGX-003)", name);
  const uint32_t *number = version->store.data;
  if (number[0] != CONCEG_CGX_MAJOR)
    return conceg_ctx_fail(
        ctx, CONCEG_E_VERSION,
        "%s: /@version: expected major version %u, got %u.%u; use a ConCeG of that version (CGX-003)", name,
        CONCEG_CGX_MAJOR, number[0], number[1]);
  const struct entry *complete = root_attribute(doc, "complete");
  if (complete && complete->kind == ENTRY_ARRAY && complete->dtype == CONCEG_U8 && !complete->rank &&
      *(const uint8_t *)complete->store.data == 0)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT,
                           "%s: /@complete: expected 1, got 0: its writer did not finish (CGX-004)", name);
  return CONCEG_OK;
}

static conceg_status open_input(conceg_ctx *ctx, struct input *input, conceg_doc **out) {
  conceg_doc *doc = NULL;
  conceg_status status = make_empty(ctx, &doc);
  if (status == CONCEG_OK) {
    status = h5_open(ctx, input->path, input->name, input->length, &doc->file);
    if (status == CONCEG_OK) status = h5_scan(doc->file, &doc->budget, doc->schema, doc->root);
    if (status == CONCEG_OK) status = check_root(doc);
    if (status == CONCEG_OK)
      *out = doc;
    else
      (void)conceg_doc_close(doc);
  }
  input_release(input);
  return status;
}

conceg_status conceg_doc_open(conceg_ctx *ctx, const char *path, conceg_doc **out) {
  struct input input;
  *out = NULL;
  const conceg_status status = input_open(ctx, path, &input);
  return status == CONCEG_OK ? open_input(ctx, &input, out) : status;
}

conceg_status conceg_doc_from_memory(conceg_ctx *ctx, const void *bytes, size_t count, conceg_doc **out) {
  struct input input;
  *out = NULL;
  const conceg_status status = input_from_memory(ctx, bytes, count, &input);
  return status == CONCEG_OK ? open_input(ctx, &input, out) : status;
}

conceg_status conceg_doc_close(conceg_doc *doc) {
  if (!doc) return CONCEG_OK;
  /* A failure that led here keeps its own message unless closing fails too. */
  const conceg_status status = h5_close(doc->budget.ctx, doc->file);
  entry_free(&doc->budget, doc->root);
  free(doc);
  return status;
}

void conceg_free(void *memory) {
  free(memory);
}
