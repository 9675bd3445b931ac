/* SPDX-License-Identifier: BSD-3-Clause
 * The document: one CGX file, stream or memory image (spec/cgx.md, spec/stream.md). Opening never changes the
 * input; saving writes a new canonical file, whole or not at all. One document belongs to one thread at a
 * time. A program that also uses HDF5 itself must close its own files: HDF5's clean-up at exit is switched
 * off. */
#ifndef CONCEG_DOC_H
#define CONCEG_DOC_H

#include "conceg/array.h"

CONCEG_BEGIN_C

/* An empty document. Owned: close it. */
CONCEG_API conceg_status conceg_doc_new(conceg_ctx *ctx, conceg_doc **out) CONCEG_NODISCARD;

/* Opens a file, or standard input for "-" (a pipe is spooled to memory or to the temporary folder). Arrays
 * are read when asked for. Errors: E_IO, E_FORMAT (not a CGX file, truncated, empty), E_VERSION, E_NOMEM. */
CONCEG_API conceg_status conceg_doc_open(conceg_ctx *ctx, const char *path,
                                         conceg_doc **out) CONCEG_NODISCARD;

/* Opens a memory image; the bytes are copied. */
CONCEG_API conceg_status conceg_doc_from_memory(conceg_ctx *ctx, const void *bytes, size_t count,
                                                conceg_doc **out) CONCEG_NODISCARD;

/* Writes the canonical file: same content, same bytes. A path is replaced by rename after the last close
 * succeeded; "-" is standard output, which must not be a terminal. Errors: E_IO (with the path and the
 * system's reason), E_NOMEM. */
CONCEG_API conceg_status conceg_doc_save(conceg_doc *doc, const char *path) CONCEG_NODISCARD;

/* The canonical file as a memory image, owned by the caller: release with conceg_free. */
CONCEG_API conceg_status conceg_doc_to_memory(conceg_doc *doc, void **bytes, size_t *count) CONCEG_NODISCARD;
CONCEG_API void conceg_free(void *memory);

/* Closes without saving; doc may be NULL. Returns E_IO when the input could not be closed. */
CONCEG_API conceg_status conceg_doc_close(conceg_doc *doc);

/* A run that is killed while it writes leaves at most one hidden file, .conceg-PID-N.tmp, beside its target
 * (and none in the temporary folder where the file system can make files without a name). conceg_clean finds
 * such files in one folder: those that no process has locked. `fn` (may be NULL) is called for each with its
 * path and size; they are removed unless `keep` is not 0. Files of runs that are still going on are never
 * touched. `ctx` may be NULL: there is no error line then. E_IO when the folder cannot be listed. */
typedef void (*conceg_clean_fn)(void *user, const char *path, uint64_t bytes);
CONCEG_API conceg_status conceg_clean(conceg_ctx *ctx, const char *folder, int keep, conceg_clean_fn fn,
                                      void *user) CONCEG_NODISCARD;

/* SHA-256 over (path, type, shape, bytes) of a group and all below it, in hex with a final NUL: a content
 * digest that does not depend on the file's layout. "/" digests the whole document except /provenance. */
CONCEG_API conceg_status conceg_doc_digest(conceg_doc *doc, const char *group, char hex[65]) CONCEG_NODISCARD;

/* One broken rule: its id ("CGX-012"), where ("/cells/soma[3]"), what was expected and what was found. */
typedef struct conceg_problem {
  uint32_t size;
  uint32_t severity; /* 0 error (a MUST), 1 warning (a SHOULD) */
  const char *rule, *path, *expected, *got;
  uint32_t rank,
      reserved; /* numbers in `index` that say which value it is; 0 = the array or group as a whole */
  uint64_t index[4];
} conceg_problem;
typedef void (*conceg_problem_fn)(void *user, const conceg_problem *problem);

/* Checks the document, or only one group when `group` is not NULL, against every rule of spec/cgx.md; calls
 * `fn` (may be NULL) for each problem. Returns CONCEG_OK, or E_FORMAT when a MUST rule is broken (the first
 * one is the context's error). */
CONCEG_API conceg_status conceg_doc_validate(conceg_doc *doc, const char *group, conceg_problem_fn fn,
                                             void *user) CONCEG_NODISCARD;

CONCEG_END_C
#endif
