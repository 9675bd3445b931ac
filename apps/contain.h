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

#endif
