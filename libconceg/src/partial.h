/* SPDX-License-Identifier: BSD-3-Clause
 * Files that are not finished yet. Each has a hidden name of one form, .conceg-PID-N.tmp, and is locked by
 * its maker for as long as it has that name: one that nobody has locked was left by a run that was killed. */
#ifndef CONCEG_PARTIAL_H
#define CONCEG_PARTIAL_H

#include "conceg/ctx.h"

#include <limits.h>

/* Makes a new, empty, locked file in `folder`; its name in `path`. Returns its descriptor, -1 with errno. */
int partial_new(const char *folder, char path[PATH_MAX]);
/* The same without a name where the file system can (then *path is empty), for the temporary folder. */
int partial_anonymous(const char *folder, char path[PATH_MAX]);
/* Gives a file without a name one of the above form, for the moment in which a library opens it. 0 with
 * errno. */
int partial_name(int fd, const char *folder, char path[PATH_MAX]);
/* Removes what killed runs have left in the folder. Never fails: what cannot be removed stays. */
void partial_sweep(const char *folder);
/* Folder of a path, "." when it names none. */
void partial_folder_of(const char *path, char folder[PATH_MAX]);

#endif
