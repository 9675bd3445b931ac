/* SPDX-License-Identifier: BSD-3-Clause
 * From argv to a struct cli. */
#ifndef CONCEG_APPS_CLI_PARSE_H
#define CONCEG_APPS_CLI_PARSE_H

#include "cli.h"

/* EXIT_OK, or EXIT_USAGE after an error line. */
int cli_parse(struct cli *cli, int argc, char **argv);
/* The options that every program has. `cli` may be a scratch one when only names and help are wanted. */
#define COMMON_COUNT 16
void cli_common_options(struct cli *cli, struct cli_option out[COMMON_COUNT]);

#endif
