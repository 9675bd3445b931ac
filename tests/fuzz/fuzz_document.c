/* SPDX-License-Identifier: BSD-3-Clause
 * Bytes as a document: opened, read, validated, digested, written again. What is written must open and hold
 * the same. */
#include "fuzz.h"

static void read_all(conceg_doc *doc, const char *group, int depth) {
  const uint64_t count = conceg_doc_children(doc, group);
  for (uint64_t i = 0; i < count && depth < 20; i++) {
    const char *child = conceg_doc_child(doc, group, i);
    conceg_array array = {.size = sizeof array};
    char path[2048];
    DEMAND(child != NULL);
    snprintf(path, sizeof path, "%s", child);
    if (path[strlen(path) - 1] == '/')
      read_all(doc, path, depth + 1);
    else if (conceg_doc_read(doc, path, &array) == CONCEG_OK && array.dtype == CONCEG_TEXT)
      for (uint64_t k = 0; k < conceg_array_count(&array) && k < 1000; k++)
        DEMAND(strlen(((const char *const *)array.data)[k]) < (size_t)1 << 30);
  }
}

static void count_problem(void *user, const conceg_problem *problem) {
  DEMAND(problem->rule && problem->path && problem->expected && problem->got);
  ++*(int *)user;
}

static void write_again(conceg_ctx *ctx, conceg_doc *doc) {
  char before[65], after[65];
  void *bytes = NULL;
  size_t count = 0;
  conceg_doc *again = NULL;
  if (conceg_doc_digest(doc, "/", before) != CONCEG_OK ||
      conceg_doc_to_memory(doc, &bytes, &count) != CONCEG_OK)
    return;
  DEMAND(conceg_doc_from_memory(ctx, bytes, count, &again) == CONCEG_OK);
  DEMAND(conceg_doc_digest(again, "/", after) == CONCEG_OK);
  DEMAND(!strcmp(before, after));
  DEMAND(conceg_doc_close(again) == CONCEG_OK);
  conceg_free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  conceg_ctx *ctx = fuzz_ctx();
  conceg_doc *doc = NULL;
  conceg_substrate *substrate = NULL;
  int problems = 0;
  if (size > (size_t)1 << 20) return 0;
  planted_bug(data, size);
  if (conceg_doc_from_memory(ctx, data, size, &doc) != CONCEG_OK) {
    DEMAND(doc == NULL && *conceg_ctx_error(ctx));
    return 0;
  }
  read_all(doc, "/", 0);
  const conceg_status status = conceg_doc_validate(doc, NULL, count_problem, &problems);
  DEMAND(status != CONCEG_E_FORMAT || problems > 0 || *conceg_ctx_error(ctx));
  if (conceg_substrate_open(doc, &substrate) == CONCEG_OK)
    for (uint64_t i = 0; i < conceg_substrate_cells(substrate) && i < 100; i++) {
      conceg_skeleton_view view = {.size = sizeof view};
      if (conceg_substrate_skeleton(substrate, i, &view) == CONCEG_OK && view.count)
        DEMAND(view.position != NULL);
    }
  conceg_substrate_free(substrate);
  write_again(ctx, doc);
  if (conceg_doc_close(doc) != CONCEG_OK) conceg_ctx_clear_error(ctx);
  return 0;
}
