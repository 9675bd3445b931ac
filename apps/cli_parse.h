/* SPDX-License-Identifier: BSD-3-Clause
 * From argv to a struct cli, and the page that --help prints. */
#ifndef CONCEG_APPS_CLI_PARSE_H
#define CONCEG_APPS_CLI_PARSE_H

#include "cli.h"

/* EXIT_OK, or EXIT_USAGE after an error line. */
int cli_parse(struct cli *cli, int argc, char **argv);
void cli_print_help(const struct cli_program *program);

#endif
