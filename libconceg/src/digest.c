/* SPDX-License-Identifier: BSD-3-Clause
 * Content digests (spec/cgx.md): a group's digest is over one line per array below it, "path type shape
 * sha256-of-values". Digests of values are kept with the array, so that unchanged arrays are read once. */
#define _POSIX_C_SOURCE 200809L
#include "doc_internal.h"
#include "sha256.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static conceg_status add_block(void *user, uint64_t first, uint64_t count, const void *values) {
  (void)first;
  const struct entry *entry = ((void **)user)[1];
  sha256_add(((void **)user)[0], values, count * conceg_dtype_bytes(entry->dtype));
  return CONCEG_OK;
}

/* Strings count as their bytes, each with its final NUL, so that the padding in a file does not matter. */
static conceg_status add_texts(conceg_doc *doc, const struct entry *entry, struct sha256 *hash) {
  struct store loaded = {0};
  struct budget apart = {.ctx = doc->budget.ctx};
  if (!entry->store.data) {
    const conceg_status status = h5_read_texts(&apart, doc->file, entry, &loaded);
    if (status != CONCEG_OK) return status;
  }
  const char *const *strings = entry->store.data ? entry->store.data : loaded.data;
  for (uint64_t i = 0; i < entry_count(entry); i++)
    sha256_add(hash, strings[i], strlen(strings[i]) + 1);
  store_free(&apart, &loaded);
  return CONCEG_OK;
}

static conceg_status digest_values(conceg_doc *doc, struct entry *entry) {
  if (entry->digested) return CONCEG_OK;
  struct sha256 hash;
  sha256_start(&hash);
  void *user[2] = {&hash, entry};
  const conceg_status status = entry->dtype == CONCEG_TEXT ? add_texts(doc, entry, &hash)
                                                           : doc_each_block(doc, entry, add_block, user);
  if (status != CONCEG_OK) return status;
  sha256_end(&hash, entry->digest);
  entry->digested = 1;
  return CONCEG_OK;
}

static conceg_status add_array(conceg_doc *doc, struct entry *entry, struct sha256 *hash) {
  const conceg_status status = digest_values(doc, entry);
  if (status != CONCEG_OK) return status;
  char hex[65], line[256];
  int length = snprintf(line, sizeof line, " %s [", conceg_dtype_name(entry->dtype));
  for (uint32_t axis = 0; axis < entry->rank; axis++)
    length += snprintf(line + length, sizeof line - (size_t)length, "%s%llu", axis ? "," : "",
                       (unsigned long long)entry->shape[axis]);
  sha256_hex(entry->digest, hex);
  length += snprintf(line + length, sizeof line - (size_t)length, "] %s\n", hex);
  sha256_add(hash, entry->path, strlen(entry->path));
  sha256_add(hash, line, (size_t)length);
  return CONCEG_OK;
}

/* What says where content came from is no content. */
static int is_left_out(const struct entry *entry, const struct entry *top) {
  if (entry->kind == ENTRY_OPAQUE) return 1;
  if (entry->attribute) return strcmp(entry->name, "made_from") == 0 || !entry->parent->parent;
  return !top->parent && entry->parent == top && strcmp(entry->name, "provenance") == 0;
}

static int compare_names(const void *a, const void *b) {
  return strcmp((*(struct entry *const *)a)->name, (*(struct entry *const *)b)->name);
}

/* Siblings by name, so that a digest does not change when a later schema learns a name. */
static struct entry **sorted(struct entry *const *list, size_t count) {
  struct entry **copy = malloc((count ? count : 1) * sizeof *copy);
  if (copy && count) {
    memcpy(copy, list, count * sizeof *copy);
    qsort(copy, count, sizeof *copy, compare_names);
  }
  return copy;
}

static conceg_status add_entry(conceg_doc *doc, struct entry *entry, const struct entry *top,
                               struct sha256 *hash) {
  if (is_left_out(entry, top)) return CONCEG_OK;
  conceg_status status = entry->kind == ENTRY_ARRAY ? add_array(doc, entry, hash) : CONCEG_OK;
  struct entry **attr = sorted(entry->attr, entry->attrs), **child = sorted(entry->child, entry->children);
  if (!attr || !child)
    status = conceg_ctx_fail(doc->budget.ctx, CONCEG_E_NOMEM, "%s: out of memory", entry->path);
  for (size_t i = 0; i < entry->attrs && status == CONCEG_OK; i++)
    status = add_entry(doc, attr[i], top, hash);
  for (size_t i = 0; i < entry->children && status == CONCEG_OK; i++)
    status = add_entry(doc, child[i], top, hash);
  free(attr);
  free(child);
  return status;
}

conceg_status conceg_doc_digest(conceg_doc *doc, const char *group, char hex[65]) {
  struct entry *entry = tree_find(doc->root, group);
  if (!entry)
    return conceg_ctx_fail(doc->budget.ctx, CONCEG_E_MISSING,
                           "%s: expected in the document, but it is not there", group);
  struct sha256 hash;
  uint8_t digest[32];
  sha256_start(&hash);
  const conceg_status status = add_entry(doc, entry, entry, &hash);
  if (status != CONCEG_OK) return status;
  sha256_end(&hash, digest);
  sha256_hex(digest, hex);
  return CONCEG_OK;
}
