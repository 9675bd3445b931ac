/* SPDX-License-Identifier: BSD-3-Clause
 * Saving whole or not at all, standard input and output, and arrays that outgrow the memory budget. */
#define _XOPEN_SOURCE 700
#include "sample.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

static void refuse(conceg_ctx *ctx, conceg_doc *doc, const char *path, conceg_status status,
                   const char *words) {
  const int before = sample_files();
  CHECK_EQUAL(conceg_doc_save(doc, path), status);
  if (!strstr(conceg_ctx_error(ctx), words)) {
    fprintf(stderr, "expected \"%s\" in \"%s\"\n", words, conceg_ctx_error(ctx));
    CHECK(!"the message names the reason");
  }
  CHECK_EQUAL(sample_files(), before);
}

static void test_refusals(conceg_ctx *ctx) {
  char path[256];
  conceg_doc *doc = sample_doc(ctx);
  refuse(ctx, doc, sample_folder(), CONCEG_E_IO, "folder");
  refuse(ctx, doc, "no/such/folder/a.cgx", CONCEG_E_IO, "No such file");
  refuse(ctx, doc, "", CONCEG_E_PARAM, "file name");
  refuse(ctx, doc, "/dev/full", CONCEG_E_IO, "No space left on device");
  refuse(ctx, doc, "/proc/a.cgx", CONCEG_E_IO, "/proc/a.cgx");
  if (geteuid() != 0) { /* root may write anywhere */
    CHECK_EQUAL(mkdir(sample_path(path, "locked"), 0500), 0);
    refuse(ctx, doc, sample_path(path, "locked/a.cgx"), CONCEG_E_IO, "Permission denied");
  }
  CHECK_EQUAL(conceg_doc_save(doc, "/dev/null"), CONCEG_OK);
  CHECK_EQUAL(conceg_ctx_set_tmpdir(ctx, "no/such/folder"), CONCEG_E_IO);
  conceg_doc_close(doc);
}

static void test_link(conceg_ctx *ctx) {
  char file[256], link[256];
  struct stat info;
  conceg_doc *doc = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(file, "target.cgx")), CONCEG_OK);
  CHECK_EQUAL(symlink("target.cgx", sample_path(link, "link.cgx")), 0);
  CHECK_EQUAL(conceg_doc_drop(doc, "/meshes"), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_save(doc, link), CONCEG_OK);
  CHECK(lstat(link, &info) == 0 && S_ISLNK(info.st_mode));
  CHECK(sample_same(file, link));
  conceg_doc_close(doc);
}

/* Runs `child` with the given file as descriptor `fd`; its exit status. */
static int in_child(int fd, int file, int (*child)(const char *), const char *argument) {
  const pid_t pid = fork();
  if (pid == 0) {
    signal(SIGPIPE, SIG_IGN);
    if (file >= 0)
      dup2(file, fd);
    else
      close(fd);
    _exit(child(argument));
  }
  int status = -1;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* Reads standard input and saves it to `path`; on a failure the message must hold that text instead. */
static int read_stdin(const char *path) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = NULL;
  const conceg_status status = conceg_doc_open(ctx, "-", &doc);
  if (status != CONCEG_OK) return strstr(conceg_ctx_error(ctx), path) ? -status : 99;
  if (conceg_doc_save(doc, path) != CONCEG_OK) return 98;
  return conceg_doc_close(doc) == CONCEG_OK ? 0 : 97;
}

static int write_stdout(const char *words) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = sample_doc(ctx);
  const conceg_status status = conceg_doc_save(doc, "-");
  if (status != CONCEG_OK && !strstr(conceg_ctx_error(ctx), words)) return 99;
  return -status;
}

/* A pipe that holds the first `count` bytes of a file; a helper process fills it. */
static int pipe_of(const char *path, size_t count) {
  int ends[2];
  CHECK_EQUAL(pipe(ends), 0);
  if (fork() == 0) {
    char *bytes = malloc(count + 1);
    FILE *file = fopen(path, "rb");
    count = fread(bytes, 1, count, file);
    close(ends[0]);
    size_t done = 0;
    while (done < count) {
      const ssize_t put = write(ends[1], bytes + done, count - done);
      if (put <= 0) break;
      done += (size_t)put;
    }
    _exit(0);
  }
  close(ends[1]);
  return ends[0];
}

static void test_streams(conceg_ctx *ctx) {
  char good[256], copy[256];
  conceg_doc *doc = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(good, "good.cgx")), CONCEG_OK);
  conceg_doc_close(doc);
  sample_path(copy, "copy.cgx");
  int fd = pipe_of(good, 1 << 24);
  CHECK_EQUAL(in_child(0, fd, read_stdin, copy), 0);
  close(fd);
  CHECK(sample_same(good, copy));
  fd = open(good, O_RDONLY);
  unlink(copy);
  CHECK_EQUAL(in_child(0, fd, read_stdin, copy), 0); /* < good.cgx */
  close(fd);
  CHECK(sample_same(good, copy));
  fd = pipe_of(good, 0);
  CHECK_EQUAL(in_child(0, fd, read_stdin, "wrote nothing"), -CONCEG_E_FORMAT);
  close(fd);
  fd = pipe_of(good, 3000);
  CHECK_EQUAL(in_child(0, fd, read_stdin, "truncated"), -CONCEG_E_FORMAT);
  close(fd);
  fd = open("/dev/null", O_RDONLY);
  CHECK_EQUAL(in_child(0, fd, read_stdin, "wrote nothing"), -CONCEG_E_FORMAT);
  close(fd);
  CHECK_EQUAL(in_child(0, -1, read_stdin, "standard input"), -CONCEG_E_IO);
  fd = open(copy, O_WRONLY | O_TRUNC);
  CHECK_EQUAL(in_child(1, fd, write_stdout, ""), 0);
  close(fd);
  CHECK(sample_same(good, copy));
  fd = open("/dev/full", O_WRONLY);
  CHECK_EQUAL(in_child(1, fd, write_stdout, "No space left on device"), -CONCEG_E_IO);
  close(fd);
  int ends[2];
  CHECK_EQUAL(pipe(ends), 0);
  close(ends[0]);
  CHECK_EQUAL(in_child(1, ends[1], write_stdout, "Broken pipe"), -CONCEG_E_IO);
  close(ends[1]);
  CHECK_EQUAL(in_child(1, -1, write_stdout, "Bad file descriptor"), -CONCEG_E_IO);
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY); /* a terminal of its own kind */
  if (terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0) {
    fd = open(ptsname(terminal), O_RDWR | O_NOCTTY);
    CHECK_EQUAL(in_child(0, fd, read_stdin, "terminal"), -CONCEG_E_USAGE);
    CHECK_EQUAL(in_child(1, fd, write_stdout, "-o FILE"), -CONCEG_E_USAGE);
    close(fd);
  }
  close(terminal);
  while (wait(NULL) > 0) {
  }
}

static conceg_doc *large_doc(conceg_ctx *ctx) {
  conceg_doc *doc = sample_doc(ctx);
  const uint64_t shape[2] = {700001, 3};
  for (int part = 0; part < 4; part++) {
    char path[64];
    void *storage = NULL;
    snprintf(path, sizeof path, "/x_lab/part_%d", part);
    CHECK_EQUAL(conceg_doc_new_array(doc, path, CONCEG_F64, 2, shape, &storage), CONCEG_OK);
    for (uint64_t i = 0; storage && i < shape[0] * 3; i++)
      ((double *)storage)[i] = (double)(i * 7 + (uint64_t)part);
  }
  return doc;
}

/* A small budget moves arrays to the temporary folder; the bytes stay the same, and nothing is left behind.
 */
static void test_spilling(conceg_ctx *ctx) {
  char a[256], b[256];
  conceg_doc *doc = large_doc(ctx);
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(a, "large.cgx")), CONCEG_OK);
  conceg_doc_close(doc);
  conceg_ctx *tight = sample_ctx();
  CHECK_EQUAL(conceg_ctx_set_tmpdir(tight, sample_folder()), CONCEG_OK);
  conceg_ctx_set_memory(tight, 8 << 20);
  const int before = sample_files();
  doc = large_doc(tight);
  CHECK_EQUAL(sample_files(), before);
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(b, "spilled.cgx")), CONCEG_OK);
  conceg_doc_close(doc);
  CHECK(sample_same(a, b));
  CHECK_EQUAL(conceg_doc_open(tight, a, &doc), CONCEG_OK);
  conceg_array array = {.size = sizeof array};
  CHECK_EQUAL(conceg_doc_read(doc, "/x_lab/part_2", &array), CONCEG_OK);
  CHECK(((const double *)array.data)[2100002] == 2100002 * 7 + 2);
  CHECK_EQUAL(conceg_doc_save(doc, b), CONCEG_OK);
  CHECK(sample_same(a, b));
  conceg_doc_close(doc);
  CHECK_EQUAL(sample_files(), before + 1);
  conceg_ctx_free(tight);
}

int main(void) {
  conceg_ctx *ctx = sample_ctx();
  sample_folder();
  test_refusals(ctx);
  test_link(ctx);
  test_streams(ctx);
  test_spilling(ctx);
  conceg_ctx_free(ctx);
  sample_clean();
  return check_done();
}
