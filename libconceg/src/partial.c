/* SPDX-License-Identifier: BSD-3-Clause
 * Unfinished files: making, naming, and removing those of killed runs. */
#define _GNU_SOURCE
#include "partial.h"

#include "conceg/doc.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { ATTEMPTS = 1000 };

static int next_name(const char *folder, char path[PATH_MAX]) {
  static atomic_uint counter;
  const unsigned number = atomic_fetch_add(&counter, 1);
  if (snprintf(path, PATH_MAX, "%s/.conceg-%ld-%u.tmp", folder, (long)getpid(), number) < PATH_MAX) return 1;
  errno = ENAMETOOLONG;
  return 0;
}

static int is_partial_name(const char *name) {
  unsigned long pid;
  unsigned number;
  int length = 0;
  return sscanf(name, ".conceg-%lu-%u.tmp%n", &pid, &number, &length) == 2 && length && !name[length];
}

/* A sweep may have come between making the file and locking it. */
static int is_still_there(int fd, const char *path) {
  struct stat open_file, named;
  return fstat(fd, &open_file) == 0 && lstat(path, &named) == 0 && open_file.st_dev == named.st_dev &&
         open_file.st_ino == named.st_ino;
}

int partial_new(const char *folder, char path[PATH_MAX]) {
  for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
    if (!next_name(folder, path)) return -1;
    const int fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno == EEXIST) continue;
    if (fd < 0) return -1;
    /* A file system without locks loses only the sweep's certainty. */
    if (flock(fd, LOCK_EX | LOCK_NB) == 0 ? is_still_there(fd, path) : errno != EWOULDBLOCK) return fd;
    close(fd);
  }
  errno = EEXIST;
  return -1;
}

int partial_anonymous(const char *folder, char path[PATH_MAX]) {
  *path = '\0';
#ifdef O_TMPFILE
  /* Without /proc it could not be given a name later. */
  const int fd = access("/proc/self/fd", X_OK) == 0 ? open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600) : -1;
  if (fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
  if (fd >= 0) close(fd);
#endif
  return partial_new(folder, path);
}

int partial_name(int fd, const char *folder, char path[PATH_MAX]) {
  char self[64];
  snprintf(self, sizeof self, "/proc/self/fd/%d", fd);
  for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
    if (!next_name(folder, path)) return 0;
    if (linkat(AT_FDCWD, self, AT_FDCWD, path, AT_SYMLINK_FOLLOW) == 0) return 1;
    if (errno != EEXIST) return 0;
  }
  return 0;
}

void partial_folder_of(const char *path, char folder[PATH_MAX]) {
  const char *slash = strrchr(path, '/');
  if (!slash)
    strcpy(folder, ".");
  else
    snprintf(folder, PATH_MAX, "%.*s", slash == path ? 1 : (int)(slash - path), path);
}

/* Calls `fn` for each file that was left behind, which is then removed unless `keep`. */
static int sweep(const char *folder, int keep, conceg_clean_fn fn, void *user) {
  DIR *listing = opendir(folder);
  if (!listing) return 0;
  for (struct dirent *item; (item = readdir(listing)) != NULL;) {
    char path[PATH_MAX];
    struct stat info;
    if (!is_partial_name(item->d_name)) continue;
    if (snprintf(path, sizeof path, "%s/%s", folder, item->d_name) >= PATH_MAX) continue;
    const int fd = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) continue;
    /* The lock stays until the name is gone, so that nobody else takes the file for a living one. */
    if (fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && flock(fd, LOCK_EX | LOCK_NB) == 0 &&
        is_still_there(fd, path) && (keep || unlink(path) == 0) && fn)
      fn(user, path, (uint64_t)info.st_size);
    close(fd);
  }
  closedir(listing);
  return 1;
}

void partial_sweep(const char *folder) {
  sweep(folder, 0, NULL, NULL);
}

conceg_status conceg_clean(conceg_ctx *ctx, const char *folder, int keep, conceg_clean_fn fn, void *user) {
  if (sweep(folder, keep, fn, user)) return CONCEG_OK;
  return ctx ? conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be listed: %s", folder, strerror(errno))
             : CONCEG_E_IO;
}
