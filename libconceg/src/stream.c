/* SPDX-License-Identifier: BSD-3-Clause
 * Bytes in and out of the process (spec/stream.md). */
#define _XOPEN_SOURCE 700
#include "stream.h"
#include "partial.h"
#include "store.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <unistd.h>

enum { HEAD_BYTES = 64, BLOCK_BYTES = 1 << 20, REPORT_BLOCKS = 16 };
static const unsigned char signature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};

static uint64_t little_endian(const unsigned char *bytes) {
  uint64_t value = 0;
  for (int i = 7; i >= 0; i--)
    value = value << 8 | bytes[i];
  return value;
}

/* Reads until `count` bytes or the end: how many, -1 on an error. */
static ssize_t read_fully(int fd, void *buffer, size_t count) {
  size_t done = 0;
  while (done < count) {
    const ssize_t got = read(fd, (char *)buffer + done, count - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (!got) break;
    done += (size_t)got;
  }
  return (ssize_t)done;
}

static int write_fully(int fd, const void *buffer, size_t count) {
  size_t done = 0;
  while (done < count) {
    const ssize_t put = write(fd, (const char *)buffer + done, count - done);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return 0;
    done += (size_t)put;
  }
  return 1;
}

/* The size of the whole file, as its first bytes say it. */
static conceg_status expected_length(conceg_ctx *ctx, const char *name, const unsigned char *head,
                                     size_t count, uint64_t *length) {
  if (count < sizeof signature || memcmp(head, signature, sizeof signature) != 0) {
    char shown[3 * 8 + 1] = "";
    for (size_t i = 0; i < count && i < 8; i++)
      snprintf(shown + 3 * i, 4, "%02x ", head[i]);
    return conceg_ctx_fail(
        ctx, CONCEG_E_FORMAT,
        "%s: not a CGX file: expected the HDF5 signature 89 48 44 46 0d 0a 1a 0a, got %s(CGX-001)", name,
        shown);
  }
  if (count < HEAD_BYTES)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT,
                           "%s: truncated: expected at least %d bytes, got %zu (CGX-001)", name, HEAD_BYTES,
                           count);
  const unsigned version = head[8], offset_size = version < 2 ? head[13] : head[9];
  if (version > 3 || offset_size != 8)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT,
                           "%s: expected an HDF5 superblock of version 0 to 3 with 8-byte offsets, got "
                           "version %u with %u (CGX-001)",
                           name, version, offset_size);
  *length = little_endian(head + (version == 0 ? 40 : version == 1 ? 44 : 28));
  return CONCEG_OK;
}

static conceg_status check_length(conceg_ctx *ctx, const char *name, uint64_t expected, uint64_t got) {
  if (got == expected) return CONCEG_OK;
  return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: %s: expected %llu bytes, got %llu (CGX-001)", name,
                         got < expected ? "truncated" : "bytes after the end of the file",
                         (unsigned long long)expected, (unsigned long long)got);
}

static conceg_status fail_system(conceg_ctx *ctx, const char *name, const char *what) {
  return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: %s: %s", name, what, strerror(errno));
}

static conceg_status set_names(conceg_ctx *ctx, struct input *input, const char *path, const char *name) {
  input->path = strdup(path);
  input->name = strdup(name);
  if (input->path && input->name) return CONCEG_OK;
  return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", name);
}

void input_release(struct input *input) {
  if (input->temporary) unlink(input->path);
  if (input->temporary) close(input->held);
  free(input->path);
  free(input->name);
  *input = (struct input){0};
}

/* A file for what comes in, without a name where the file system can. */
static int new_spool(conceg_ctx *ctx, const char *name, char path[PATH_MAX]) {
  const int fd = partial_anonymous(conceg_ctx_tmpdir(ctx), path);
  if (fd < 0)
    conceg_ctx_fail(ctx, CONCEG_E_IO,
                    "%s: cannot be stored in the temporary folder %s: %s; set TMPDIR to another folder", name,
                    conceg_ctx_tmpdir(ctx), strerror(errno));
  return fd;
}

static conceg_status fail_spool(conceg_ctx *ctx, const char *name) {
  return conceg_ctx_fail(ctx, CONCEG_E_IO,
                         "%s: cannot be stored in the temporary folder %s: %s; set TMPDIR to another folder",
                         name, conceg_ctx_tmpdir(ctx), strerror(errno));
}

/* Copies what `fd` gives into the spool and counts it. Stops once it is longer than it may be. */
static conceg_status spool_bytes(conceg_ctx *ctx, int fd, int spool, const char *name, uint64_t expected,
                                 uint64_t *length) {
  char *buffer = malloc(BLOCK_BYTES);
  if (!buffer) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", name);
  conceg_status status = CONCEG_OK;
  for (uint64_t block = 1; status == CONCEG_OK; block++) {
    const ssize_t got = read_fully(fd, buffer, BLOCK_BYTES);
    if (got < 0)
      status = fail_system(ctx, name, "cannot be read");
    else if (!write_fully(spool, buffer, (size_t)got))
      status = fail_spool(ctx, name);
    if (status != CONCEG_OK || got == 0) break;
    *length += (uint64_t)got;
    if (*length > expected) break;
    if (block % REPORT_BLOCKS == 0) status = conceg_ctx_progress(ctx, "read", *length, expected);
  }
  free(buffer);
  return status;
}

/* HDF5 opens files by name: the whole spool gets one for that moment, and the document takes it away again.
 */
static conceg_status finish_spool(conceg_ctx *ctx, int spool, char path[PATH_MAX], const char *name,
                                  conceg_status status, struct input *out) {
  if (status == CONCEG_OK && !*path && !partial_name(spool, conceg_ctx_tmpdir(ctx), path))
    status = fail_spool(ctx, name);
  if (status == CONCEG_OK) status = set_names(ctx, out, path, name);
  if (status == CONCEG_OK) {
    out->temporary = 1;
    out->held = spool;
    return CONCEG_OK;
  }
  if (*path) unlink(path);
  close(spool);
  input_release(out);
  return status;
}

static conceg_status spool_pipe(conceg_ctx *ctx, int fd, const char *name, struct input *out) {
  unsigned char head[HEAD_BYTES];
  const ssize_t got = read_fully(fd, head, sizeof head);
  if (got < 0) return fail_system(ctx, name, "cannot be read");
  if (got == 0)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s is empty: the program before this one wrote nothing",
                           name);
  uint64_t expected = 0;
  conceg_status status = expected_length(ctx, name, head, (size_t)got, &expected);
  if (status == CONCEG_OK) status = check_free_space(ctx, conceg_ctx_tmpdir(ctx), expected);
  if (status != CONCEG_OK) return status;
  char path[PATH_MAX];
  const int spool = new_spool(ctx, name, path);
  if (spool < 0) return CONCEG_E_IO;
  out->length = (uint64_t)got;
  if (!write_fully(spool, head, (size_t)got)) status = fail_spool(ctx, name);
  if (status == CONCEG_OK) status = spool_bytes(ctx, fd, spool, name, expected, &out->length);
  if (status == CONCEG_OK) status = check_length(ctx, name, expected, out->length);
  return finish_spool(ctx, spool, path, name, status, out);
}

/* A regular file is opened in place by `path`. */
static conceg_status use_file(conceg_ctx *ctx, int fd, uint64_t length, const char *path, const char *name,
                              struct input *out) {
  unsigned char head[HEAD_BYTES];
  ssize_t got = pread(fd, head, sizeof head, 0);
  if (got < 0) return fail_system(ctx, name, "cannot be read");
  if (got == 0)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s is empty: expected a CGX file, got 0 bytes (CGX-001)",
                           name);
  uint64_t expected = 0;
  conceg_status status = expected_length(ctx, name, head, (size_t)got, &expected);
  if (status == CONCEG_OK) status = check_length(ctx, name, expected, length);
  if (status == CONCEG_OK) status = set_names(ctx, out, path, name);
  out->length = length;
  if (status != CONCEG_OK) input_release(out);
  return status;
}

static conceg_status open_stdin(conceg_ctx *ctx, struct input *out) {
  static const char name[] = "standard input";
  struct stat info;
  if (fstat(STDIN_FILENO, &info) != 0) return fail_system(ctx, name, "cannot be read");
  if (isatty(STDIN_FILENO))
    return conceg_ctx_fail(
        ctx, CONCEG_E_USAGE,
        "%s is a terminal: expected a document from a pipe or a file, or a file name as argument", name);
  /* A file without a name cannot be opened a second time by HDF5. */
  if (S_ISREG(info.st_mode) && info.st_nlink > 0) {
    if (info.st_size == 0)
      return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s is empty: the program before this one wrote nothing",
                             name);
    return use_file(ctx, STDIN_FILENO, (uint64_t)info.st_size, "/dev/stdin", name, out);
  }
  return spool_pipe(ctx, STDIN_FILENO, name, out);
}

conceg_status input_open(conceg_ctx *ctx, const char *path, struct input *out) {
  *out = (struct input){0};
  if (strcmp(path, "-") == 0) return open_stdin(ctx, out);
  const int fd = open(path, O_RDONLY | O_CLOEXEC);
  struct stat info;
  if (fd < 0) return fail_system(ctx, path, "cannot be opened");
  conceg_status status;
  if (fstat(fd, &info) != 0)
    status = fail_system(ctx, path, "cannot be read");
  else if (S_ISDIR(info.st_mode))
    status = conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: expected a CGX file, got a folder", path);
  else if (S_ISREG(info.st_mode) && info.st_nlink > 0)
    status = use_file(ctx, fd, (uint64_t)info.st_size, path, path, out);
  else
    status = spool_pipe(ctx, fd, path, out);
  close(fd);
  return status;
}

conceg_status input_from_memory(conceg_ctx *ctx, const void *bytes, size_t count, struct input *out) {
  static const char name[] = "memory image";
  *out = (struct input){0};
  if (!count)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s is empty: expected a CGX file, got 0 bytes (CGX-001)",
                           name);
  uint64_t expected = 0;
  conceg_status status = expected_length(ctx, name, bytes, count, &expected);
  if (status == CONCEG_OK) status = check_length(ctx, name, expected, count);
  if (status == CONCEG_OK) status = check_free_space(ctx, conceg_ctx_tmpdir(ctx), count);
  if (status != CONCEG_OK) return status;
  char path[PATH_MAX];
  const int spool = new_spool(ctx, name, path);
  if (spool < 0) return CONCEG_E_IO;
  out->length = count;
  if (!write_fully(spool, bytes, count)) status = fail_spool(ctx, name);
  return finish_spool(ctx, spool, path, name, status, out);
}

/* One block from `fd` to `to`, inside the kernel where it can: bytes moved, 0 at the end, -1 on an error. */
static ssize_t move_block(int fd, int to, char *buffer, int *in_kernel) {
  if (*in_kernel) {
    const ssize_t moved = sendfile(to, fd, NULL, BLOCK_BYTES);
    if (moved >= 0 || (errno != EINVAL && errno != ENOSYS)) return moved;
    *in_kernel = 0;
  }
  const ssize_t got = read_fully(fd, buffer, BLOCK_BYTES);
  if (got > 0 && !write_fully(to, buffer, (size_t)got)) return -1;
  return got;
}

conceg_status copy_out(conceg_ctx *ctx, int fd, int to, const char *name) {
  struct stat info;
  char *buffer = malloc(BLOCK_BYTES);
  if (!buffer) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", name);
  conceg_status status = CONCEG_OK;
  if (fstat(fd, &info) != 0 || lseek(fd, 0, SEEK_SET) < 0)
    status = fail_system(ctx, name, "cannot be written");
  uint64_t done = 0;
  int in_kernel = 1;
  for (uint64_t block = 1; status == CONCEG_OK; block++) {
    const ssize_t moved = move_block(fd, to, buffer, &in_kernel);
    if (moved < 0 && errno == EINTR) continue;
    if (moved < 0) status = fail_system(ctx, name, "cannot be written");
    if (moved <= 0) break;
    done += (uint64_t)moved;
    if (block % REPORT_BLOCKS == 0) status = conceg_ctx_progress(ctx, "write", done, (uint64_t)info.st_size);
  }
  free(buffer);
  return status;
}

conceg_status read_whole(conceg_ctx *ctx, int fd, void **bytes, size_t *count) {
  struct stat info;
  if (fstat(fd, &info) != 0 || lseek(fd, 0, SEEK_SET) < 0)
    return fail_system(ctx, "memory image", "cannot be read back");
  const size_t length = (size_t)info.st_size;
  void *buffer = malloc(length ? length : 1);
  if (!buffer)
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "memory image: out of memory for %zu bytes", length);
  if (read_fully(fd, buffer, length) != (ssize_t)length) {
    free(buffer);
    return fail_system(ctx, "memory image", "cannot be read back");
  }
  *bytes = buffer;
  *count = length;
  return CONCEG_OK;
}
