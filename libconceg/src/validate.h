/* SPDX-License-Identifier: BSD-3-Clause
 * Shared by the validate*.c files: who reports, and what is known so far. Rule ids are those of spec/cgx.md.
 */
#ifndef CONCEG_VALIDATE_H
#define CONCEG_VALIDATE_H

#include "doc_internal.h"
#include "schema.h"

/* A named extent and the array that fixed its value. */
struct extent {
  const char *group; /* NULL = shared by all groups */
  const char *name;
  const char *path;
  uint64_t value;
};

struct validator {
  conceg_doc *doc;
  conceg_ctx *ctx;
  const char *only; /* "/cells"; NULL = the whole document */
  conceg_problem_fn fn;
  void *user;
  char first[2048]; /* the first broken MUST, as one line */
  uint64_t errors;
  struct extent *extent;
  size_t extents, extent_room;
};

enum severity { MUST = 0, SHOULD = 1 };

/* Calls the user's function; `path` outside `only` is passed over. The texts are used at once. */
void report(struct validator *validator, const char *rule, enum severity severity, const char *path,
            const char *expected, const char *got);
/* The same for the `index`-th value of an array; `more` others break the rule as well. */
void report_value(struct validator *validator, const char *rule, enum severity severity,
                  const struct entry *entry, uint64_t index, uint64_t more, const char *expected,
                  const char *got);
int is_wanted(const struct validator *validator, const char *path);

/* Type, rank and fixed extents; fixes or compares every named extent. */
conceg_status check_form(struct validator *validator, const struct schema_group *group,
                         const struct schema_item *item, const struct entry *entry);
/* The value of a named extent. 0 when nothing has fixed it. */
int find_extent(const struct validator *validator, const struct schema_group *group, const char *name,
                uint64_t *value);

/* Every rule about the values of one array of the right form. */
conceg_status check_values(struct validator *validator, const struct schema_group *group,
                           const struct schema_item *item, struct entry *entry);
/* Rules that tie arrays together: parents, faces, vertices, places in the box. */
conceg_status check_links(struct validator *validator);
/* Rules about what numbers mean together: loops, processes folded into the box, labels, provenance. */
conceg_status check_tissue(struct validator *validator);

/* One value as text. */
void format_number(conceg_dtype dtype, const void *values, uint64_t index, char text[64]);

#endif
