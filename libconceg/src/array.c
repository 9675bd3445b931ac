/* SPDX-License-Identifier: BSD-3-Clause
 * Arrays of a document: reading, writing, dropping, listing. */
#define _POSIX_C_SOURCE 200809L
#include "doc_internal.h"
#include "schema.h"
#include "texts.h"

#include <stdlib.h>
#include <string.h>

static const uint64_t block_bytes = (uint64_t)4 << 20;

size_t conceg_dtype_bytes(conceg_dtype dtype) {
  switch (dtype) {
  case CONCEG_U8:
  case CONCEG_I8:
    return 1;
  case CONCEG_U32:
  case CONCEG_I32:
  case CONCEG_F32:
    return 4;
  case CONCEG_U64:
  case CONCEG_I64:
  case CONCEG_F64:
    return 8;
  default:
    return 0;
  }
}

const char *conceg_dtype_name(conceg_dtype dtype) {
  static const char *const names[] = {"unknown", "u8",  "i8",  "u32", "i32",
                                      "u64",     "i64", "f32", "f64", "text"};
  return dtype >= CONCEG_U8 && dtype <= CONCEG_TEXT ? names[dtype] : names[0];
}

uint64_t conceg_array_count(const conceg_array *array) {
  uint64_t count = 1;
  for (uint32_t axis = 0; axis < array->rank && axis < 4; axis++)
    count *= array->shape[axis];
  return count;
}

int conceg_doc_has(const conceg_doc *doc, const char *path) {
  return tree_find(doc->root, path) != NULL;
}

static conceg_status new_store(conceg_doc *doc, const struct entry *entry, struct store *out) {
  return store_new(&doc->budget, entry->path, entry_bytes(entry), out);
}

conceg_status doc_load(conceg_doc *doc, struct entry *entry) {
  if (entry->store.data) return CONCEG_OK;
  struct store store = {0};
  conceg_status status;
  if (entry->dtype == CONCEG_TEXT)
    status = h5_read_texts(&doc->budget, doc->file, entry, &store);
  else if ((status = new_store(doc, entry, &store)) == CONCEG_OK)
    status =
        h5_read_rows(doc->budget.ctx, doc->file, entry, 0, entry->rank ? entry->shape[0] : 1, store.data);
  if (status == CONCEG_OK)
    entry->store = store;
  else
    store_free(&doc->budget, &store);
  return status;
}

conceg_status doc_each_block(conceg_doc *doc, const struct entry *entry, block_fn fn, void *user) {
  const uint64_t values = entry_count(entry);
  if (!values) return CONCEG_OK;
  const uint64_t rows = entry->rank ? entry->shape[0] : 1, row = values / rows,
                 row_bytes = entry_bytes(entry) / rows;
  uint64_t step = row_bytes < block_bytes ? block_bytes / row_bytes : 1;
  if (step > rows) step = rows;
  void *buffer = NULL;
  if (!entry->store.data && !(buffer = malloc(step * row_bytes)))
    return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "%s: out of memory", entry->path);
  conceg_status status = CONCEG_OK;
  for (uint64_t first = 0; first < rows && status == CONCEG_OK; first += step) {
    const uint64_t count = rows - first < step ? rows - first : step;
    const void *data = buffer ? buffer : (const char *)entry->store.data + first * row_bytes;
    if (buffer) status = h5_read_rows(doc->budget.ctx, doc->file, entry, first, count, buffer);
    if (status == CONCEG_OK) status = fn(user, first * row, count * row, data);
  }
  free(buffer);
  return status;
}

static conceg_status find_array(conceg_doc *doc, const char *path, const conceg_array *out,
                                struct entry **entry) {
  conceg_ctx *ctx = doc->budget.ctx;
  if (out->size < sizeof *out)
    return conceg_ctx_fail(ctx, CONCEG_E_USAGE, "%s: conceg_array.size is not set", path);
  *entry = tree_find(doc->root, path);
  if (!*entry)
    return conceg_ctx_fail(ctx, CONCEG_E_MISSING, "%s: expected in the document, but it is not there", path);
  if ((*entry)->kind == ENTRY_GROUP)
    return conceg_ctx_fail(ctx, CONCEG_E_MISSING, "%s: expected a dataset, got a group", path);
  if ((*entry)->kind == ENTRY_OPAQUE)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: expected numbers or text, got %s", path, (*entry)->why);
  return CONCEG_OK;
}

static void describe(const conceg_doc *doc, const struct entry *entry, const void *data, conceg_array *out) {
  const struct schema_item *item = entry->attribute ? schema_find(doc->schema, entry->path) : NULL;
  out->dtype = entry->dtype;
  out->rank = entry->rank;
  out->reserved = 0;
  memcpy(out->shape, entry->shape, sizeof out->shape);
  out->data = data;
  out->unit = entry->attribute ? (item ? item->unit : NULL) : entry_unit(entry);
}

conceg_status conceg_doc_read(conceg_doc *doc, const char *path, conceg_array *out) {
  struct entry *entry = NULL;
  conceg_status status = find_array(doc, path, out, &entry);
  if (status == CONCEG_OK) status = doc_load(doc, entry);
  if (status == CONCEG_OK) describe(doc, entry, entry_count(entry) ? entry->store.data : NULL, out);
  return status;
}

conceg_status conceg_doc_describe(conceg_doc *doc, const char *path, conceg_array *out) {
  struct entry *entry = NULL;
  const conceg_status status = find_array(doc, path, out, &entry);
  if (status == CONCEG_OK) describe(doc, entry, NULL, out);
  return status;
}

/* The size in bytes of a new array, or E_PARAM. */
static conceg_status check_shape(conceg_ctx *ctx, const char *path, conceg_dtype dtype, uint32_t rank,
                                 const uint64_t *shape, uint64_t *count) {
  const size_t width = dtype == CONCEG_TEXT ? sizeof(char *) : conceg_dtype_bytes(dtype);
  uint64_t bytes = width;
  *count = 1;
  if (!width)
    return conceg_ctx_fail(ctx, CONCEG_E_PARAM, "%s: expected an array type, got %d", path, (int)dtype);
  if (rank > (dtype == CONCEG_TEXT ? 1u : 4u))
    return conceg_ctx_fail(ctx, CONCEG_E_PARAM, "%s: expected rank 0 to %d, got %u", path,
                           dtype == CONCEG_TEXT ? 1 : 4, rank);
  for (uint32_t axis = 0; axis < rank; axis++) {
    if (__builtin_mul_overflow(bytes, shape[axis], &bytes))
      return conceg_ctx_fail(ctx, CONCEG_E_PARAM, "%s: the array would have more than 2^64 bytes", path);
    *count *= shape[axis];
  }
  return CONCEG_OK;
}

static int is_reserved(const char *path) {
  static const char *const reserved[] = {"/@format", "/@version", "/@length_unit", "/@time_unit",
                                         "/@complete"};
  for (size_t i = 0; i < sizeof reserved / sizeof *reserved; i++)
    if (strcmp(path, reserved[i]) == 0) return 1;
  return 0;
}

/* Where a new path hangs: the parent, made as needed. `made` is the topmost group that had to be made. */
struct place {
  struct entry *parent, *made;
  const char *name;
  int attribute;
};

static conceg_status make_group(conceg_doc *doc, const char *name, size_t length, struct place *place) {
  char copy[PATH_BYTES];
  memcpy(copy, name, length);
  copy[length] = '\0';
  struct entry *group = entry_new(ENTRY_GROUP, place->parent, copy, 0, doc->schema);
  if (!group || !entry_attach(&doc->budget, group)) {
    entry_free(&doc->budget, group);
    return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "%s: out of memory", copy);
  }
  if (!place->made) place->made = group;
  place->parent = group;
  return CONCEG_OK;
}

/* Does the schema know the owner of an attribute as a dataset? */
static int owner_is_dataset(const conceg_doc *doc, const char *path) {
  char owner[PATH_BYTES];
  const size_t length = strcspn(path, "@");
  memcpy(owner, path, length);
  owner[length] = '\0';
  return schema_find(doc->schema, owner) != NULL;
}

static conceg_status find_place(conceg_doc *doc, const char *path, struct place *place) {
  conceg_ctx *ctx = doc->budget.ctx;
  if (!path_is_valid(path) || is_reserved(path))
    return conceg_ctx_fail(
        ctx, CONCEG_E_PARAM, "%s: %s", path ? path : "(null)",
        path && path_is_valid(path)
            ? "is written by the library itself"
            : "expected a path like /group/name or /group@name (letters, digits, _ . + -)");
  *place = (struct place){.parent = doc->root};
  const char *at = path + 1;
  for (;;) {
    const size_t length = strcspn(at, "/@");
    if (at[length] == '\0' || at[0] == '@') break;
    struct entry *child = entry_child(place->parent, at, length, 0);
    const int last = at[length] == '@'; /* the owner of an attribute may be a dataset */
    if (child && child->kind != ENTRY_GROUP && !(last && child->kind == ENTRY_ARRAY))
      return conceg_ctx_fail(ctx, CONCEG_E_PARAM, "%s: %s is a dataset, expected a group", path, child->path);
    if (child)
      place->parent = child;
    else {
      if (last && owner_is_dataset(doc, path))
        return conceg_ctx_fail(ctx, CONCEG_E_MISSING,
                               "%s: the dataset that the attribute belongs to is not there", path);
      const conceg_status status = make_group(doc, at, length, place);
      if (status != CONCEG_OK) return status;
    }
    at += length + (last ? 0 : 1);
  }
  place->attribute = at[0] == '@';
  place->name = at + place->attribute;
  struct entry *old = entry_child(place->parent, place->name, strlen(place->name), place->attribute);
  if (old && old->kind == ENTRY_GROUP)
    return conceg_ctx_fail(ctx, CONCEG_E_PARAM, "%s: is a group; drop it before a dataset takes its name",
                           path);
  return CONCEG_OK;
}

static void undo_place(conceg_doc *doc, const struct place *place) {
  if (!place->made) return;
  entry_detach(place->made);
  entry_free(&doc->budget, place->made);
}

/* The entry of a new array with its storage filled from `data` (NULL = zeroes). */
static conceg_status fill_entry(conceg_doc *doc, struct entry *entry, uint64_t count, const void *data) {
  if (entry->dtype == CONCEG_TEXT) return texts_copy(&doc->budget, entry->path, data, count, &entry->store);
  const conceg_status status = new_store(doc, entry, &entry->store);
  if (status == CONCEG_OK && data && count) memcpy(entry->store.data, data, entry->store.bytes);
  return status;
}

static conceg_status add_unit(conceg_doc *doc, struct entry *dataset, const char *unit) {
  const struct schema_item *item = schema_find(doc->schema, dataset->path);
  if (!unit) unit = item ? item->unit : dataset->dtype == CONCEG_TEXT ? "" : "1";
  struct entry *entry = entry_new(ENTRY_ARRAY, dataset, "unit", 1, doc->schema);
  if (!entry) return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "%s: out of memory", dataset->path);
  entry->dtype = CONCEG_TEXT;
  conceg_status status = texts_copy(&doc->budget, entry->path, &unit, 1, &entry->store);
  if (status == CONCEG_OK && !entry_attach(&doc->budget, entry))
    status = conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "%s: out of memory", dataset->path);
  if (status != CONCEG_OK) entry_free(&doc->budget, entry);
  return status;
}

static conceg_status put_array(conceg_doc *doc, const char *path, const conceg_array *array,
                               struct entry **out) {
  uint64_t count = 0;
  conceg_status status =
      check_shape(doc->budget.ctx, path ? path : "(null)", array->dtype, array->rank, array->shape, &count);
  if (status != CONCEG_OK) return status;
  struct place place = {0};
  status = find_place(doc, path, &place);
  struct entry *entry = NULL;
  if (status == CONCEG_OK &&
      !(entry = entry_new(ENTRY_ARRAY, place.parent, place.name, place.attribute, doc->schema)))
    status = conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
  if (status == CONCEG_OK) {
    entry->dtype = array->dtype;
    entry->rank = array->rank;
    memcpy(entry->shape, array->shape, array->rank * sizeof *array->shape);
    status = fill_entry(doc, entry, count, array->data);
  }
  if (status == CONCEG_OK && !place.attribute) status = add_unit(doc, entry, array->unit);
  if (status == CONCEG_OK && !entry_attach(&doc->budget, entry))
    status = conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
  if (status != CONCEG_OK) {
    entry_free(&doc->budget, entry);
    undo_place(doc, &place);
    return status;
  }
  if (place.attribute) place.parent->digested = 0;
  if (out) *out = entry;
  return CONCEG_OK;
}

static conceg_status check_texts(conceg_ctx *ctx, const char *path, const char *const *strings,
                                 uint64_t count) {
  for (uint64_t i = 0; i < count; i++)
    if (!strings[i] || !text_is_utf8(strings[i]))
      return conceg_ctx_fail(ctx, CONCEG_E_PARAM, "%s[%llu]: expected UTF-8 text, got %s", path,
                             (unsigned long long)i, strings[i] ? "other bytes" : "NULL");
  return CONCEG_OK;
}

conceg_status conceg_doc_write(conceg_doc *doc, const char *path, const conceg_array *array) {
  conceg_ctx *ctx = doc->budget.ctx;
  if (array->size < sizeof *array)
    return conceg_ctx_fail(ctx, CONCEG_E_USAGE, "%s: conceg_array.size is not set", path);
  uint64_t count = 0;
  conceg_status status =
      check_shape(ctx, path ? path : "(null)", array->dtype, array->rank, array->shape, &count);
  if (status != CONCEG_OK) return status;
  if (count && !array->data) return conceg_ctx_fail(ctx, CONCEG_E_PARAM, "%s: expected data, got NULL", path);
  if (array->dtype == CONCEG_TEXT && (status = check_texts(ctx, path, array->data, count)) != CONCEG_OK)
    return status;
  if (array->unit && (status = check_texts(ctx, path, &array->unit, 1)) != CONCEG_OK) return status;
  return put_array(doc, path, array, NULL);
}

conceg_status conceg_doc_new_array(conceg_doc *doc, const char *path, conceg_dtype dtype, uint32_t rank,
                                   const uint64_t *shape, void **storage) {
  *storage = NULL;
  if (dtype == CONCEG_TEXT)
    return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_PARAM,
                           "%s: text cannot be filled in place; use conceg_doc_write", path);
  conceg_array array = {.size = sizeof array, .dtype = dtype, .rank = rank};
  for (uint32_t axis = 0; axis < rank && axis < 4; axis++)
    array.shape[axis] = shape[axis];
  struct entry *entry = NULL;
  const conceg_status status = put_array(doc, path, &array, &entry);
  if (status == CONCEG_OK) *storage = entry->store.data;
  return status;
}

conceg_status conceg_doc_read_text(conceg_doc *doc, const char *path, const char **out) {
  conceg_array array = {.size = sizeof array};
  *out = NULL;
  const conceg_status status = conceg_doc_read(doc, path, &array);
  if (status != CONCEG_OK) return status;
  if (array.dtype != CONCEG_TEXT || conceg_array_count(&array) != 1)
    return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_FORMAT,
                           "%s: expected one text, got %llu values of type %s", path,
                           (unsigned long long)conceg_array_count(&array), conceg_dtype_name(array.dtype));
  *out = *(const char *const *)array.data;
  return CONCEG_OK;
}

conceg_status conceg_doc_write_text(conceg_doc *doc, const char *path, const char *text) {
  const conceg_array array = {.size = sizeof array, .dtype = CONCEG_TEXT, .data = &text};
  return conceg_doc_write(doc, path, &array);
}

conceg_status conceg_doc_drop(conceg_doc *doc, const char *path) {
  if (!path || path[0] != '/' || strcmp(path, "/") == 0 || is_reserved(path))
    return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_PARAM,
                           "%s: cannot be dropped: expected a group, dataset or attribute below /",
                           path ? path : "(null)");
  struct entry *entry = tree_find(doc->root, path);
  if (!entry) return CONCEG_OK;
  entry_detach(entry);
  entry_free(&doc->budget, entry);
  return CONCEG_OK;
}

uint64_t conceg_doc_children(const conceg_doc *doc, const char *group) {
  const struct entry *entry = tree_find(doc->root, group);
  return entry ? entry->children + entry->attrs : 0;
}

const char *conceg_doc_child(const conceg_doc *doc, const char *group, uint64_t index) {
  const struct entry *entry = tree_find(doc->root, group);
  if (!entry) return NULL;
  if (index < entry->children) return entry->child[index]->path;
  return index < entry->children + entry->attrs ? entry->attr[index - entry->children]->path : NULL;
}
