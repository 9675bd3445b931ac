/* SPDX-License-Identifier: BSD-3-Clause
 * Parameters of a stage (a table that drives argv, YAML, help, docs and range checks) and the recipe that
 * carries them. */
#ifndef CONCEG_PARAMS_H
#define CONCEG_PARAMS_H

#include "conceg/doc.h"

CONCEG_BEGIN_C

typedef enum conceg_param_type {
  CONCEG_PARAM_F64 = 1,
  CONCEG_PARAM_I64 = 2,
  CONCEG_PARAM_BOOL = 3,
  CONCEG_PARAM_TEXT = 4,
  CONCEG_PARAM_CHOICE = 5, /* `choices` is a |-separated list */
  CONCEG_PARAM_FILE =
      6, /* a path; relative paths are taken from the current folder. Not written into /recipe */
  CONCEG_PARAM_MAXIMUM = 0x7fffffff
} conceg_param_type;

/* One row of a stage's table, which ends at name == NULL. Numbers are checked against lo <= value <= hi. */
typedef struct conceg_param {
  const char *name;     /* lower case, words joined by _, unit at the end: "step_um" */
  const char *unit;     /* "um", "1", "" */
  const char *help;     /* one line */
  const char *fallback; /* default as YAML text; never NULL */
  const char *choices;  /* for CHOICE, else NULL */
  int32_t type;         /* conceg_param_type */
  uint32_t flags;       /* 0 */
  double lo, hi;        /* for F64 and I64 */
} conceg_param;

typedef struct conceg_params conceg_params; /* the values of one stage run; read-only for stages */

/* Values by name. The name must be in the stage's table: a wrong one ends in 0, "" or NAN and E_INTERNAL
 * after the run. */
CONCEG_API double conceg_params_f64(const conceg_params *params, const char *name);
CONCEG_API int64_t conceg_params_i64(const conceg_params *params, const char *name);
CONCEG_API int conceg_params_bool(const conceg_params *params, const char *name);
CONCEG_API const char *conceg_params_text(const conceg_params *params,
                                          const char *name); /* also CHOICE and FILE */
/* Positional arguments of the command line (input files of characterise and import): NULL past the end. */
CONCEG_API const char *conceg_params_argument(const conceg_params *params, uint32_t index);
/* 1 if the value was given, by recipe or command line; 0 if it is the default. */
CONCEG_API int conceg_params_given(const conceg_params *params, const char *name);
/* Called by a source with CONCEG_STAGE_RESTORES while it runs: the document is one that was made before, in
 * another form, and the host adds nothing to it. Without effect for other stages. Any thread. */
CONCEG_API void conceg_params_restored(const conceg_params *params);

/* ---- Recipe: a parsed YAML document with line numbers ---- */
typedef struct conceg_recipe conceg_recipe;
typedef struct conceg_node
    conceg_node; /* borrowed from its recipe; NULL is legal everywhere and means "absent" */

/* Parses a recipe file or text and checks its keys (spec/cli.md). Errors: E_IO, E_FORMAT and E_PARAM with
 * file and line. */
CONCEG_API conceg_status conceg_recipe_load(conceg_ctx *ctx, const char *path,
                                            conceg_recipe **out) CONCEG_NODISCARD;
CONCEG_API conceg_status conceg_recipe_parse(conceg_ctx *ctx, const char *text, const char *name,
                                             conceg_recipe **out) CONCEG_NODISCARD;
/* The recipe that travels in the document (/recipe); E_MISSING when there is none. Owned by the caller. */
CONCEG_API conceg_status conceg_recipe_from_doc(conceg_ctx *ctx, conceg_doc *doc,
                                                conceg_recipe **out) CONCEG_NODISCARD;
CONCEG_API void conceg_recipe_free(conceg_recipe *recipe);
/* --set: "stage.key=value" or "domain.size_um=[20,20,20]"; the value is YAML. */
CONCEG_API conceg_status conceg_recipe_set(conceg_ctx *ctx, conceg_recipe *recipe,
                                           const char *assignment) CONCEG_NODISCARD;
/* Canonical YAML of the whole recipe; borrowed until the recipe changes. NULL when out of memory. */
CONCEG_API const char *conceg_recipe_text(conceg_recipe *recipe);

/* The mapping at the top, borrowed from the recipe. */
CONCEG_API const conceg_node *conceg_recipe_root(const conceg_recipe *recipe);
/* Value under a dotted path from a mapping ("domain.size_um"); NULL when absent. */
CONCEG_API const conceg_node *conceg_node_get(const conceg_node *node, const char *path);
/* Sequence or mapping: count, i-th value, i-th key (mapping only). */
CONCEG_API uint32_t conceg_node_count(const conceg_node *node);
CONCEG_API const conceg_node *conceg_node_at(const conceg_node *node, uint32_t index);
CONCEG_API const char *conceg_node_key(const conceg_node *node, uint32_t index);
CONCEG_API int conceg_node_is_map(const conceg_node *node);
CONCEG_API int conceg_node_is_list(const conceg_node *node);
/* Line in the recipe (1-based; 0 = set from the command line). */
CONCEG_API uint32_t conceg_node_line(const conceg_node *node);
/* Scalars; E_MISSING when node is NULL, E_PARAM (with name and line) when the text is not of that type. */
CONCEG_API conceg_status conceg_node_f64(conceg_ctx *ctx, const conceg_node *node,
                                         double *out) CONCEG_NODISCARD;
CONCEG_API conceg_status conceg_node_i64(conceg_ctx *ctx, const conceg_node *node,
                                         int64_t *out) CONCEG_NODISCARD;
CONCEG_API conceg_status conceg_node_bool(conceg_ctx *ctx, const conceg_node *node,
                                          int *out) CONCEG_NODISCARD;
CONCEG_API const char *
conceg_node_text(const conceg_node *node); /* the scalar's text; NULL when not a scalar */

CONCEG_END_C
#endif
