/* SPDX-License-Identifier: BSD-3-Clause
 * Inside of a recipe, for recipe.c, grammar.c and params.c. */
#ifndef CONCEG_SRC_RECIPE_H
#define CONCEG_SRC_RECIPE_H

#include "yaml.h"

struct conceg_recipe {
  conceg_node *root; /* a map in canonical order */
  struct text text;  /* canonical text, made when asked for */
};

/* The grammar of spec/cli.md: known keys, forms, ranges; puts the keys into canonical order. E_PARAM with
 * file and line. */
conceg_status recipe_check(conceg_ctx *ctx, conceg_node *root) CONCEG_NODISCARD;

/* Error line "file:line: text", or "file: text" for a value that was set from the command line. */
conceg_status fail_node(conceg_ctx *ctx, conceg_status status, const conceg_node *node, const char *format,
                        ...) CONCEG_PRINTF(4, 5);

/* An empty recipe with only its version. NULL when out of memory. */
conceg_recipe *recipe_new(void);
conceg_recipe *recipe_clone(const conceg_recipe *recipe);
/* The section of a stage, made when it is not there; NULL when out of memory. */
conceg_node *recipe_section(conceg_recipe *recipe, const char *kind);
/* Forgets the text after the tree was changed. */
void recipe_changed(conceg_recipe *recipe);

#endif
