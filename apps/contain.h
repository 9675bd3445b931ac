/* SPDX-License-Identifier: BSD-3-Clause
 * A stage may be somebody else's code: what it does to the process while it runs must not look like success.
 */
#ifndef CONCEG_APPS_CONTAIN_H
#define CONCEG_APPS_CONTAIN_H

#include "cli.h"

/* conceg_stage_run in a frame: what the stage prints to standard output goes to standard error, since that
 * stream carries documents alone; a crash, an exception that nobody catches and a call of exit() become an
 * error line and EXIT_STAGE, with nothing written. With CONCEG_CORE set in the environment a crash keeps its
 * signal. */
conceg_status contain_stage(struct cli *cli, const conceg_stage *stage, conceg_doc *doc,
                            const conceg_params *params);

/* From here on a crash outside of stages is blamed on the document `name`: an error line and EXIT_INPUT. HDF5
 * does not survive every damaged file. */
void contain_input(const struct cli *cli, const char *name);

#endif
