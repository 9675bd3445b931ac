/* SPDX-License-Identifier: BSD-3-Clause
 * The pages of a program, all from its struct cli_program: plain text, a man page, lines for shell
 * completion. */
#ifndef CONCEG_APPS_HELP_H
#define CONCEG_APPS_HELP_H

#include "cli.h"

/* Variables of the environment that the programs look at: name, meaning. */
#define CONCEG_ENVIRONMENT(X)                                                                                \
  X("CONCEG_STAGE_PATH", "folders of plugins, separated by colons; an empty element is the install folder")  \
  X("TMPDIR", "folder for what does not fit in memory and for streams (default /tmp)")                       \
  X("PATH", "where programs conceg-WORD and those of impl: exec:PROG are looked for")                        \
  X("CONCEG_CORE", "when set, a crash keeps its signal, so that a core file can be had")

/* Prints the page on standard output. `format` is NULL or "plain", "man" or "list"; 0 = there is no such
 * format. */
int help_print(const struct cli_program *program, const char *format);
void help_print_man(const struct cli_program *program, const struct cli_option *common);
/* "[0.5 um, 0 to 10]": default, unit and range of a parameter without the brackets. */
void help_bounds(const conceg_param *row, char *out, size_t size);

#endif
