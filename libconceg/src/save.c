/* SPDX-License-Identifier: BSD-3-Clause
 * Saving a document: to a path (whole or not at all), to standard output, to memory. */
#define _XOPEN_SOURCE 700
#include "doc_internal.h"
#include "partial.h"
#include "stream.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The finished bytes as a file without a name in the temporary folder; its descriptor in *fd. */
static conceg_status write_anonymous(conceg_doc *doc, const char *name, int *fd) {
  char path[PATH_MAX];
  const char *folder = conceg_ctx_tmpdir(doc->budget.ctx);
  *fd = partial_anonymous(folder, path);
  if (*fd < 0 || (!*path && !partial_name(*fd, folder, path))) {
    const conceg_status status = conceg_ctx_fail(
        doc->budget.ctx, CONCEG_E_IO, "%s: temporary folder %s: no file can be made there: %s; set TMPDIR",
        name, folder, strerror(errno));
    if (*fd >= 0) close(*fd);
    return status;
  }
  char label[PATH_MAX + 64];
  snprintf(label, sizeof label, "%s, kept in the temporary folder %s (TMPDIR)", name, folder);
  return h5_write(doc->budget.ctx, path, label, doc->root, doc->file, 1, fd);
}

/* Through a temporary file into something that cannot be renamed over: a pipe, a device, a stream. Closes
 * `to`. */
static conceg_status save_through(conceg_doc *doc, int to, const char *name) {
  int fd = -1;
  conceg_status status = write_anonymous(doc, name, &fd);
  if (status == CONCEG_OK) {
    status = copy_out(doc->budget.ctx, fd, to, name);
    close(fd);
  }
  if (close(to) != 0 && status == CONCEG_OK)
    status =
        conceg_ctx_fail(doc->budget.ctx, CONCEG_E_IO, "%s: cannot be written: %s", name, strerror(errno));
  return status;
}

static conceg_status save_to_stdout(conceg_doc *doc) {
  static const char name[] = "standard output";
  conceg_ctx *ctx = doc->budget.ctx;
  if (isatty(STDOUT_FILENO))
    return conceg_ctx_fail(ctx, CONCEG_E_USAGE,
                           "%s is a terminal: a document is not text; name a file with -o FILE", name);
  const int to =
      dup(STDOUT_FILENO); /* a close of the copy tells of late errors and leaves the program its stream */
  if (to < 0) return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be written: %s", name, strerror(errno));
  return save_through(doc, to, name);
}

/* The file takes the mode of the one that it replaces, reaches the disk, and then its name. */
static int put_in_place(int fd, const char *temporary, const char *target) {
  struct stat before;
  if (stat(target, &before) == 0 && fchmod(fd, before.st_mode & 07777) != 0)
    errno = 0; /* not our file: ours will do */
  return fsync(fd) == 0 && rename(temporary, target) == 0;
}

static conceg_status save_to_file(conceg_doc *doc, const char *target, const char *path) {
  conceg_ctx *ctx = doc->budget.ctx;
  char folder[PATH_MAX], temporary[PATH_MAX];
  partial_folder_of(target, folder);
  partial_sweep(folder);
  int fd = partial_new(folder, temporary);
  if (fd < 0)
    return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be written: %s: %s", path, folder, strerror(errno));
  conceg_status status = h5_write(ctx, temporary, path, doc->root, doc->file, 0, &fd);
  if (status != CONCEG_OK) return status;
  /* The name is given while the lock is held, so that no sweep takes the finished file for a left one. */
  const int placed = put_in_place(fd, temporary, target);
  if (!placed) {
    status = conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be written: %s", path, strerror(errno));
    unlink(temporary);
  }
  if (close(fd) != 0 && placed)
    status = conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be written: %s", path, strerror(errno));
  return status;
}

conceg_status conceg_doc_save(conceg_doc *doc, const char *path) {
  conceg_ctx *ctx = doc->budget.ctx;
  struct stat info;
  if (!path || !*path) return conceg_ctx_fail(ctx, CONCEG_E_PARAM, "save: expected a file name, got nothing");
  if (strcmp(path, "-") == 0) return save_to_stdout(doc);
  if (strlen(path) >= PATH_MAX)
    return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be written: %s", path, strerror(ENAMETOOLONG));
  if (stat(path, &info) != 0) return save_to_file(doc, path, path);
  if (S_ISDIR(info.st_mode))
    return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be written: expected a file name, got a folder",
                           path);
  if (!S_ISREG(info.st_mode) || !info.st_nlink) { /* nothing that a name could be put over */
    const int to = open(path, O_WRONLY | O_CLOEXEC);
    if (to < 0) return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be written: %s", path, strerror(errno));
    return save_through(doc, to, path);
  }
  char *target = realpath(path, NULL); /* a link stays a link; what it points to is replaced */
  if (!target) return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be written: %s", path, strerror(errno));
  const conceg_status status = save_to_file(doc, target, path);
  free(target);
  return status;
}

conceg_status conceg_doc_to_memory(conceg_doc *doc, void **bytes, size_t *count) {
  int fd = -1;
  *bytes = NULL;
  *count = 0;
  conceg_status status = write_anonymous(doc, "memory image", &fd);
  if (status != CONCEG_OK) return status;
  status = read_whole(doc->budget.ctx, fd, bytes, count);
  close(fd);
  return status;
}
