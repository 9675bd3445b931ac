/* SPDX-License-Identifier: BSD-3-Clause
 * Which stages a run takes, in which order, and the same as a shell pipe. */
#ifndef CONCEG_APPS_PIPELINE_H
#define CONCEG_APPS_PIPELINE_H

#include "cli.h"

/* The recipe's `stages`, else the default order, with `block` before mesh where it is asked for, cut to
 * --from and --until (NULL = no cut). 0 or an exit code. */
int pipeline_choose(struct cli *cli, const conceg_recipe *recipe, const char *from, const char *until,
                    int with_block, struct words *kinds);

/* "conceg place -p recipe.yaml | conceg triangulate > OUT" on standard output. */
void pipeline_print(const struct cli *cli, const char *recipe, const char *input, const struct words *kinds);

#endif
