/* SPDX-License-Identifier: BSD-3-Clause
 * Free room on disk, before a run that needs it begins. */
#ifndef CONCEG_APPS_ROOM_H
#define CONCEG_APPS_ROOM_H

#include "cli.h"

struct room_need {
  const char *folder; /* any path on the file system */
  const char *what;   /* "checkpoints" */
  double bytes;
};

/* EXIT_OK, or EXIT_IO after a line that names the folder, what is needed there by whom, and the remedies.
 * Needs on one file system add up. A folder that cannot be asked is passed over: writing there will tell. */
int room_check(struct cli *cli, const struct room_need *needs, uint32_t count, const char *remedy);

#endif
