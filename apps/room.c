/* SPDX-License-Identifier: BSD-3-Clause
 * Free room on disk. */
#define _GNU_SOURCE
#include "room.h"

#include "outlook.h"

#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

static int fail_room(struct cli *cli, const struct room_need *needs, uint32_t count, uint32_t first,
                     dev_t device, double bytes, double left, const char *remedy) {
  char parts[512] = "", need[32], free_text[32];
  size_t used = 0;
  uint32_t i;
  for (i = 0; i < count; i++) {
    struct stat info;
    char size[32];
    if (!(needs[i].bytes > 0) || stat(needs[i].folder, &info) || info.st_dev != device) continue;
    outlook_size_text(size, sizeof size, needs[i].bytes);
    used += (size_t)snprintf(parts + used, sizeof parts - used, "%s%s of %s in %.100s", used ? ", " : "",
                             size, needs[i].what, needs[i].folder);
    if (used >= sizeof parts) break;
  }
  outlook_size_text(need, sizeof need, bytes);
  outlook_size_text(free_text, sizeof free_text, left);
  return cli_fail(cli, EXIT_IO, "%s: this run needs about %s of disk there (%s), %s are free; %s",
                  needs[first].folder, need, parts, free_text, remedy);
}

int room_check(struct cli *cli, const struct room_need *needs, uint32_t count, const char *remedy) {
  uint32_t i, j;
  for (i = 0; i < count; i++) {
    struct stat here, there;
    struct statvfs disk;
    double bytes = 0, left;
    if (stat(needs[i].folder, &here) || statvfs(needs[i].folder, &disk)) continue;
    for (j = 0; j < count; j++)
      if (!stat(needs[j].folder, &there) && there.st_dev == here.st_dev) bytes += needs[j].bytes;
    left = (double)disk.f_bavail * (double)disk.f_frsize;
    if (bytes > left) return fail_room(cli, needs, count, i, here.st_dev, bytes, left, remedy);
  }
  return EXIT_OK;
}
