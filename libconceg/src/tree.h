/* SPDX-License-Identifier: BSD-3-Clause
 * The document as a tree in memory: groups, arrays and their attributes, siblings in canonical order.
 * No HDF5 here: an array that still lies in the backing file has in_file set and no store. */
#ifndef CONCEG_TREE_H
#define CONCEG_TREE_H

#include "store.h"

#include "conceg/array.h"

struct schema;

enum entry_kind {
  ENTRY_GROUP,
  ENTRY_ARRAY,
  ENTRY_OPAQUE /* something of the backing file that conceg_array cannot hold; carried through, `why` says
                  what it is */
};

struct entry {
  enum entry_kind kind;
  int attribute;    /* 1 = an attribute of `parent` */
  char *path;       /* "/", "/cells/", "/cells/soma", "/cells/soma@unit" */
  const char *name; /* in its own storage, "" for the root */
  uint32_t order;   /* place in the schema; UINT32_MAX = unknown */
  struct entry *parent;
  struct entry **child; /* sub-groups and datasets, then not attributes */
  size_t children, child_room;
  struct entry **attr;
  size_t attrs, attr_room;

  conceg_dtype dtype; /* arrays only from here on */
  uint32_t rank;
  uint64_t shape[4];
  struct store store;
  int in_file;  /* the values are in the backing file; store may hold a loaded copy */
  char *why;    /* opaque: "an enumeration", "a compound", ... */
  int digested; /* `digest` is that of the present values */
  uint8_t digest[32];
};

/* Bounds of a path. */
enum { PATH_BYTES = 1024, PATH_DEPTH = 16 };

struct entry *entry_new(enum entry_kind kind, struct entry *parent, const char *name, int attribute,
                        const struct schema *schema);
/* Frees an entry that has no parent (any more) and all below it. */
void entry_free(struct budget *budget, struct entry *entry);

/* 1 when a new entry may carry this path: absolute, short, made of letters, digits, _ . + - and at most one
 * attribute. */
int path_is_valid(const char *path);

/* The entry at a path, with or without a closing "/" for groups; NULL when there is none. */
struct entry *tree_find(const struct entry *root, const char *path);
/* A child or an attribute by name; `length` bytes of it. */
struct entry *entry_child(const struct entry *entry, const char *name, size_t length, int attribute);
/* Puts an entry among its parent's children, replacing one of the same name. 0 when out of memory (nothing
 * changed). */
int entry_attach(struct budget *budget, struct entry *entry);
void entry_detach(struct entry *entry);
/* For many at once: puts an entry last among its parent's, 0 when out of memory; then sorts the parent's
 * children (or attributes) and keeps the last of each name. */
int entry_append(struct entry *entry);
void entry_sort(struct budget *budget, struct entry *parent, int attributes);

uint64_t entry_count(const struct entry *entry); /* values; text: strings */
uint64_t entry_bytes(const struct entry *entry); /* of the values; 0 for text */
/* Text of a rank-0 text array held in memory; NULL otherwise. */
const char *entry_text(const struct entry *entry);
/* The @unit of a dataset; NULL when it has none. */
const char *entry_unit(const struct entry *entry);

#endif
