/* SPDX-License-Identifier: BSD-3-Clause
 * Values of one stage run, for params.c and run.c. */
#ifndef CONCEG_SRC_PARAMS_INTERNAL_H
#define CONCEG_SRC_PARAMS_INTERNAL_H

#include "recipe.h"

#include "conceg/stage.h"

struct param_value {
  char *text; /* as written; numbers keep their text */
  double number;
  int64_t whole;
  int boolean, quoted, given;
};

/* What the stage told during its run, from whatever thread it was: that it asked for a name that is not in
 * its table, and that it restored a document. */
struct param_told {
  int misuse, restored; /* __atomic */
  char name[64];
};

struct conceg_params {
  const conceg_stage *stage;
  uint32_t count;
  struct param_value *value; /* in the order of the table */
  uint32_t arguments;
  char **argument;
  struct text canonical;
  struct param_told *told;
  conceg_recipe *recipe; /* the document's recipe with everything applied; NULL when there is none */
  int recipe_is_new;     /* 1 = to be written into /recipe before the run */
  int has_seed;
  uint64_t seed;
};

/* Every row of a stage's table is sound: name, type, range, default, no name twice, at most 256 rows. E_ABI
 * naming `from` and the row. */
conceg_status params_check_table(conceg_ctx *ctx, const conceg_stage *stage, const char *from);

#endif
