/* SPDX-License-Identifier: BSD-3-Clause
 * What conceg swc check and conceg swc repair share. */
#ifndef CONCEG_APPS_SWC_H
#define CONCEG_APPS_SWC_H

#include "cli.h"

/* One SWC file; `inside` is its path below the folder it was found in, or its own name. */
struct swc_file {
  const char *path, *inside;
};
struct swc_files {
  struct swc_file *file;
  uint32_t count, capacity;
};

/* Files as named, and every *.swc below folders, in the order of their names. Returns 0 or the exit code. */
int swc_list(struct cli *cli, const struct words *names, struct swc_files *out);
void swc_list_free(struct swc_files *files);

/* --floating and --somata as reading flags. Returns 0 or the exit code. */
int swc_choices(struct cli *cli, const char *floating, const char *somata, uint32_t *flags);

int swc_check(int argc, char **argv);
int swc_repair(int argc, char **argv);

#endif
