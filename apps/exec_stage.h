/* SPDX-License-Identifier: BSD-3-Clause
 * impl: exec:PROG: a program that obeys spec/stream.md stands in for a stage. */
#ifndef CONCEG_APPS_EXEC_STAGE_H
#define CONCEG_APPS_EXEC_STAGE_H

#include "cli.h"

/* The program's command behind "exec:", or NULL when `impl` is of another form. */
const char *exec_command(const char *impl);

/* Hands the document, with the recipe and the --set values in /recipe, to the program and takes back what it
 * writes; *doc is closed and replaced. `own` is the recipe of -p, or NULL. Returns 0 or an exit code after an
 * error line. */
int exec_stage(struct cli *cli, const char *kind, const char *command, const conceg_recipe *own,
               const char *const *sets, conceg_doc **doc);

#endif
