/* SPDX-License-Identifier: BSD-3-Clause
 * What the library's own files know of a document. */
#ifndef CONCEG_DOC_INTERNAL_H
#define CONCEG_DOC_INTERNAL_H

#include "h5.h"
#include "tree.h"

#include "conceg/doc.h"

struct conceg_doc {
  struct budget budget;
  const struct schema *schema;
  struct entry *root;
  struct h5_file *file; /* the input; NULL for a new document */
};

/* Values of a numeric array in the order of storage, `count` of them from index `first` (whole rows). A
 * status that is not OK ends the walk. */
typedef conceg_status (*block_fn)(void *user, uint64_t first, uint64_t count, const void *values);

/* Walks over an array in blocks, from memory or from the file, without keeping it. */
conceg_status doc_each_block(conceg_doc *doc, const struct entry *entry, block_fn fn, void *user);
/* Brings the values of an array into memory, where they stay. */
conceg_status doc_load(conceg_doc *doc, struct entry *entry);

#endif
