/* SPDX-License-Identifier: BSD-3-Clause
 * Arrays of a document: typed, of rank 0 to 4, row-major, little-endian. A path names a dataset
 * ("/cells/soma") or an attribute ("/domain@lo"). Names, types, shapes and units are those of
 * spec/schema.yaml. */
#ifndef CONCEG_ARRAY_H
#define CONCEG_ARRAY_H

#include "conceg/ctx.h"

CONCEG_BEGIN_C

typedef enum conceg_dtype {
  CONCEG_U8 = 1,
  CONCEG_I8 = 2,
  CONCEG_U32 = 3,
  CONCEG_I32 = 4,
  CONCEG_U64 = 5,
  CONCEG_I64 = 6,
  CONCEG_F32 = 7,
  CONCEG_F64 = 8,
  CONCEG_TEXT = 9, /* data is const char *const *: shape[0] NUL-terminated UTF-8 strings (rank 0: one) */
  CONCEG_DTYPE_MAXIMUM = 0x7fffffff
} conceg_dtype;

typedef struct conceg_array {
  uint32_t size; /* sizeof(conceg_array), set by the caller */
  conceg_dtype dtype;
  uint32_t rank;
  uint32_t reserved;
  uint64_t shape[4];
  const void *data; /* borrowed; NULL only when an extent is 0 */
  const char *unit; /* borrowed; NULL on writing = the schema's unit */
} conceg_array;

typedef struct conceg_doc conceg_doc;

/* Bytes of one element; 0 for CONCEG_TEXT or an unknown type. "f64" and so on for the name. Any thread. */
CONCEG_API size_t conceg_dtype_bytes(conceg_dtype dtype);
CONCEG_API const char *conceg_dtype_name(conceg_dtype dtype);
/* Product of the extents (1 for rank 0). Any thread. */
CONCEG_API uint64_t conceg_array_count(const conceg_array *array);

/* 1 if the group, dataset or attribute is there, else 0. */
CONCEG_API int conceg_doc_has(const conceg_doc *doc, const char *path);

/* Reads an array as a view. Borrowed: valid until the same path is written or dropped, or the document is
 * closed. `out->size` must be set. Errors: E_MISSING, E_FORMAT (type that this library cannot hold), E_IO,
 * E_NOMEM. */
CONCEG_API conceg_status conceg_doc_read(conceg_doc *doc, const char *path,
                                         conceg_array *out) CONCEG_NODISCARD;

/* Type, shape and unit of an array as conceg_doc_read gives them, without reading its values: out->data is
 * NULL. For programs that list what is there. Errors: E_MISSING, E_FORMAT. */
CONCEG_API conceg_status conceg_doc_describe(conceg_doc *doc, const char *path,
                                             conceg_array *out) CONCEG_NODISCARD;

/* Copies an array into the document, replacing what was there; groups are made as needed. A failed call
 * changes nothing. Errors: E_PARAM (bad path), E_NOMEM, E_IO (no space in the temporary folder). */
CONCEG_API conceg_status conceg_doc_write(conceg_doc *doc, const char *path,
                                          const conceg_array *array) CONCEG_NODISCARD;

/* Gives the document a new zeroed array and returns its storage to be filled in place, so that large results
 * are not copied. Borrowed like a view; fill it before the document is digested, validated or saved. Not for
 * CONCEG_TEXT. Errors as conceg_doc_write. */
CONCEG_API conceg_status conceg_doc_new_array(conceg_doc *doc, const char *path, conceg_dtype dtype,
                                              uint32_t rank, const uint64_t *shape,
                                              void **storage) CONCEG_NODISCARD;

/* One string (rank 0 text). */
CONCEG_API conceg_status conceg_doc_read_text(conceg_doc *doc, const char *path,
                                              const char **out) CONCEG_NODISCARD;
CONCEG_API conceg_status conceg_doc_write_text(conceg_doc *doc, const char *path,
                                               const char *text) CONCEG_NODISCARD;

/* Removes a dataset, an attribute or a whole group; OK when it was not there. */
CONCEG_API conceg_status conceg_doc_drop(conceg_doc *doc, const char *path) CONCEG_NODISCARD;

/* Children of a group in canonical order: the count, and the i-th child's full path (borrowed until the next
 * write or drop). Sub-groups end in "/". Attributes of the group come last, as "/group@name". NULL past the
 * end. */
CONCEG_API uint64_t conceg_doc_children(const conceg_doc *doc, const char *group);
CONCEG_API const char *conceg_doc_child(const conceg_doc *doc, const char *group, uint64_t index);

CONCEG_END_C
#endif
