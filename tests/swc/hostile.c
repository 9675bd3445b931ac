/* SPDX-License-Identifier: BSD-3-Clause
 * SWC files that are large or deep on purpose: read or refused, without recursion, in the memory that
 * conceg/swc.h promises. */
#define _GNU_SOURCE
#include "check.h"
#include "conceg/swc.h"

#include <stdarg.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#define BYTES_PER_BYTE 64
#define MILLION 1000000

static conceg_ctx *ctx;
static char *text;
static size_t length, room;

static void add(const char *format, ...) CONCEG_PRINTF(1, 2);
static void add(const char *format, ...) {
  va_list arguments;
  if (room - length < 256) {
    room = room ? 2 * room : 1 << 20;
    text = realloc(text, room);
    if (!text) abort();
  }
  va_start(arguments, format);
  length += (size_t)vsnprintf(text + length, room - length, format, arguments);
  va_end(arguments);
}

static uint64_t peak_bytes(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (uint64_t)usage.ru_maxrss * 1024;
}

typedef struct wanted {
  conceg_status status;
  const char *code; /* of one of the problems; NULL = any */
  uint64_t samples;
  uint64_t columns; /* beyond the seven */
} wanted;

static int has_code(const conceg_swc *swc, const char *code) {
  const char *found;
  uint32_t i;
  for (i = 0; conceg_swc_problem(swc, i, NULL, NULL, &found, NULL); i++)
    if (!strcmp(found, code)) return 1;
  return 0;
}

/* In a process of its own, so that the peak is that of this text alone. */
static void check_text(const char *name, void (*write)(void), uint32_t flags, wanted want) {
  int state = 0;
  const pid_t child = fork();
  if (child == 0) {
    conceg_swc *swc = NULL;
    uint64_t before, used, most;
    check_failed_ = 0;
    write();
    before = peak_bytes();
    CHECK_EQUAL(conceg_swc_parse(ctx, text, length, name, flags, &swc), want.status);
    used = peak_bytes() - before;
    most = BYTES_PER_BYTE * (uint64_t)length + (1 << 20) + 8 * want.columns * (want.samples + 64) * 4;
#ifndef __SANITIZE_ADDRESS__ /* whose own memory would be counted */
    CHECK(used <= most);
#else
    (void)most;
#endif
    CHECK_EQUAL(conceg_swc_count(swc), want.samples);
    if (want.code) CHECK(has_code(swc, want.code));
    if (want.status != CONCEG_OK) CHECK(strstr(conceg_ctx_error(ctx), name) == conceg_ctx_error(ctx));
    if (length > MILLION)
      printf("%s: %zu bytes of text, %.1f bytes of memory per byte\n", name, length,
             (double)used / (double)length);
    conceg_swc_free(swc);
    fflush(stdout);
    _exit(check_failed_ != 0);
  }
  CHECK(child > 0 && waitpid(child, &state, 0) == child);
  if (!WIFEXITED(state) || WEXITSTATUS(state)) fprintf(stderr, "  in %s\n", name);
  CHECK(WIFEXITED(state) && WEXITSTATUS(state) == 0);
}

static void usual(void) {
  int i;
  add("1 1 0 0 0 5 -1\n");
  for (i = 2; i < MILLION / 4; i++)
    add("%d 3 %.4f %.4f %.4f 0.5000 %d\n", i, 6 + i * 0.1234, i * 0.2, i * -0.7, i - 1);
}
static void deep(void) {
  int i;
  for (i = 0; i < MILLION; i++)
    add("%d 3 %d 0 0 1 %d\n", i, i, i - 1);
}
static void deep_backwards(void) {
  int i;
  for (i = MILLION / 4; i-- > 0;)
    add("%d 3 %d 0 0 1 %d\n", i, i, i - 1);
}
static void deep_soma(void) {
  int i;
  for (i = 0; i < MILLION; i++)
    add("%d 1 %d 0 0 1 %d\n", i, i % 3, i - 1);
}
static void one_fork(void) {
  int i;
  add("0 3 0 0 0 1 -1\n");
  for (i = 1; i < MILLION / 4; i++)
    add("%d 3 %d 0 0 1 0\n", i, i);
}
static void one_cycle(void) {
  int i;
  for (i = 0; i < MILLION / 4; i++)
    add("%d 3 0 0 0 1 %d\n", i, (i + 1) % (MILLION / 4));
}
/* The shortest rows, each with two problems. */
static void orphans(void) {
  int i;
  add("0 1 0 0 0 5 -1\n");
  for (i = 1; i < MILLION / 8; i++)
    add("%d 3 0 0 0 1 %d\n", i, MILLION + i);
}
static void copies(void) {
  int i;
  for (i = 0; i < MILLION / 8; i++)
    add("1 3 0 0 0 1 -1\n");
}
static void many_somata(void) {
  int i;
  for (i = 0; i < MILLION / 8; i++)
    add("%d 1 %d 0 0 1 -1\n", i, i);
}
static void many_columns(void) {
  int i;
  add("1 3 0 0 0 1 -1");
  for (i = 0; i < MILLION; i++)
    add(" 1");
  add("\n");
}
static void wide_rows(void) {
  int i;
  add("0 3 0 0 0 1 -1 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25\n");
  for (i = 1; i < MILLION / 4; i++)
    add("%d 3 %d 0 0 1 %d\n", i, i, i - 1);
}
static void fill(char c, size_t count) {
  text = malloc(count);
  if (!text) abort();
  memset(text, c, count);
  length = room = count;
}
static void one_line(void) {
  fill('7', 100 * MILLION);
}
static void one_comment(void) {
  fill('#', 10 * MILLION);
}
static void one_blank_line(void) {
  fill(' ', 10 * MILLION);
}
static void zeros(void) {
  fill('\0', 10 * MILLION);
}
static void line_ends(void) {
  fill('\n', 10 * MILLION);
}
static void headers(void) {
  while (length < 2 * MILLION)
    add("#a\n");
}
static void prose_lines(void) {
  while (length < 2 * MILLION)
    add("a\n");
}
static void minus_signs(void) {
  size_t i;
  fill('-', 10 * MILLION);
  for (i = 1; i < length; i += 2)
    text[i] = '\n';
}
static void a_zero_byte(void) {
  add("1 3 0 0 0 1 -1\n2 3 1 0 0 1 1\n3 3 2 0 0 1 2\n");
  text[20] = '\0';
}
static void number_of_zeros(void) {
  add("1 3 0.");
  while (length < MILLION)
    add("0000000000000000000000000000000000000000");
  add("1 0 0 1 -1\n");
}
static void largest_ids(void) {
  add("9223372036854775806 3 0 0 0 1 -1\n9223372036854775807 3 1 0 0 1 9223372036854775806\n0 3 2 0 0 1 "
      "9223372036854775807\n");
}

/* 4 GiB and more are refused before a byte is read. */
static void check_sizes(void) {
  char path[] = "conceg_hostile_XXXXXX";
  conceg_swc *swc = NULL;
  const int handle = mkstemp(path);
  CHECK_EQUAL(conceg_swc_parse(ctx, "", UINT32_MAX, "size", 0, &swc), CONCEG_E_RANGE);
  CHECK(swc == NULL);
  CHECK_EQUAL(conceg_swc_parse(ctx, "", SIZE_MAX, "size", 0, &swc), CONCEG_E_RANGE);
  CHECK(handle >= 0 && ftruncate(handle, (off_t)5 << 30) == 0);
  CHECK_EQUAL(conceg_swc_read(ctx, path, 0, &swc), CONCEG_E_RANGE);
  CHECK(swc == NULL && strstr(conceg_ctx_error(ctx), "4 GiB"));
  CHECK(peak_bytes() < 100 * MILLION);
  close(handle), unlink(path);
}

static void check_flags(void) {
  conceg_swc *swc = NULL;
  CHECK_EQUAL(conceg_swc_parse(ctx, "1 1 0 0 0 5 -1\n", 15, "flags", 1u << 31, &swc), CONCEG_E_PARAM);
  CHECK(swc == NULL);
  CHECK_EQUAL(conceg_swc_parse(ctx, "1 1 0 0 0 5 -1\n", 15, "flags",
                               CONCEG_SWC_DROP_FLOATING | CONCEG_SWC_ATTACH_FLOATING, &swc),
              CONCEG_E_PARAM);
  CHECK(swc == NULL);
}

int main(void) {
  const conceg_status bad = CONCEG_E_FORMAT;
  ctx = conceg_ctx_new();
  check_sizes();
  check_flags();
  check_text("usual", usual, 0, (wanted){CONCEG_OK, NULL, MILLION / 4 - 2, 0});
  check_text("deep", deep, 0, (wanted){CONCEG_OK, "W_NO_SOMA", MILLION, 0});
  check_text("deep_backwards", deep_backwards, 0, (wanted){CONCEG_OK, "W_NO_SOMA", MILLION / 4, 0});
  check_text("deep_soma", deep_soma, 0, (wanted){CONCEG_OK, NULL, 0, 0});
  check_text("one_fork", one_fork, 0, (wanted){CONCEG_OK, NULL, MILLION / 4, 0});
  check_text("one_cycle", one_cycle, 0, (wanted){bad, "E_CYCLE", 0, 0});
  check_text("orphans", orphans, 0, (wanted){CONCEG_OK, "W_ORPHAN", MILLION / 8 - 1, 0});
  check_text("orphans_dropped", orphans, CONCEG_SWC_DROP_FLOATING, (wanted){CONCEG_OK, "W_POINT", 0, 0});
  check_text("orphans_attached", orphans, CONCEG_SWC_ATTACH_FLOATING, (wanted){bad, "E_FLOATING", 0, 0});
  check_text("orphans_strict", orphans, CONCEG_SWC_STRICT, (wanted){bad, "W_ORPHAN", 0, 0});
  check_text("copies", copies, 0, (wanted){CONCEG_OK, "W_DUP", 1, 0});
  check_text("many_somata", many_somata, 0, (wanted){bad, "E_SOMATA", 0, 0});
  check_text("many_somata_split", many_somata, CONCEG_SWC_SPLIT, (wanted){CONCEG_OK, "W_SOMATA", 0, 0});
  check_text("many_columns", many_columns, 0, (wanted){CONCEG_OK, "W_COLUMNS", 1, 25});
  check_text("wide_rows", wide_rows, 0, (wanted){CONCEG_OK, "W_COLUMNS", MILLION / 4, 25});
  check_text("one_line", one_line, 0, (wanted){bad, "E_COLUMNS", 0, 0});
  check_text("one_comment", one_comment, 0, (wanted){bad, "E_EMPTY", 0, 0});
  check_text("one_blank_line", one_blank_line, 0, (wanted){bad, "E_EMPTY", 0, 0});
  check_text("zeros", zeros, 0, (wanted){bad, "E_EMPTY", 0, 0});
  check_text("line_ends", line_ends, 0, (wanted){bad, "E_EMPTY", 0, 0});
  check_text("headers", headers, 0, (wanted){bad, "E_EMPTY", 0, 0});
  check_text("prose_lines", prose_lines, 0, (wanted){bad, "W_PROSE", 0, 0});
  check_text("minus_signs", minus_signs, 0, (wanted){bad, "E_STOP", 0, 0});
  check_text("a_zero_byte", a_zero_byte, 0, (wanted){bad, NULL, 0, 0});
  check_text("number_of_zeros", number_of_zeros, 0, (wanted){bad, "E_NUMBER", 0, 0});
  check_text("largest_ids", largest_ids, 0, (wanted){CONCEG_OK, "W_NO_SOMA", 3, 0});
  conceg_ctx_free(ctx);
  return check_done();
}
