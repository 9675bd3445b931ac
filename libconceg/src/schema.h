/* SPDX-License-Identifier: BSD-3-Clause
 * The compiled spec/schema.yaml: which groups, datasets and attributes CGX knows, in canonical order, and
 * their rules. */
#ifndef CONCEG_SCHEMA_H
#define CONCEG_SCHEMA_H

#include "conceg/array.h"

enum schema_rule {
  RULE_FINITE = 1,
  RULE_POSITIVE = 2,
  RULE_NONNEGATIVE = 4,
  RULE_UNIT_VECTOR = 8,
  RULE_UNIQUE = 16,
  RULE_INDEX_OF = 32,
  RULE_INDEX_OR_NONE = 64,
  RULE_CSR_OF = 128
};

/* One extent: a fixed number (name NULL), a named one, or a named one plus 1 (offsets). */
struct schema_extent {
  char *name;
  uint64_t fixed;
  int plus_one;
};

struct schema_item {
  char *name;
  int attribute, required;
  conceg_dtype dtype;
  uint32_t rank;
  struct schema_extent extent[4];
  char *unit; /* "" = none */
  uint32_t rules;
  char *rule_extent; /* the extent that index_of, index_or_none or csr_of name */
  uint32_t choices;
  char **choice;
};

struct schema_group {
  char *name;
  int dataset; /* a dataset of the root, described by item[0], instead of a group */
  int tables;  /* sub-groups of columns of one length */
  uint32_t items;
  struct schema_item *item;
};

struct schema {
  uint32_t groups; /* the first is the root ("") with the root attributes */
  struct schema_group *group;
  uint32_t globals;
  char **global; /* names of extents that all groups share */
};

conceg_status schema_new(conceg_ctx *ctx, struct schema **out);
void schema_free(struct schema *schema);

/* Group by name ("cells", "" = root), item by name and kind; NULL when the schema does not know it. */
const struct schema_group *schema_group(const struct schema *schema, const char *name, size_t length);
const struct schema_item *schema_item(const struct schema_group *group, const char *name, int attribute);
/* Item of a full path ("/cells/soma", "/domain@lo", "/recipe"); NULL when unknown. */
const struct schema_item *schema_find(const struct schema *schema, const char *path);
/* Place of a path among its siblings; UINT32_MAX = unknown (such ones follow, by name). */
uint32_t schema_order(const struct schema *schema, const char *path);
int schema_is_global(const struct schema *schema, const char *extent);

#endif
