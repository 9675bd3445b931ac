/* SPDX-License-Identifier: BSD-3-Clause
 * Every case of reader_table.tsv: problems, soma and samples, tolerant and strict, must be those of the
 * table. test_swc_reader_table TABLE FIXTURES           checks test_swc_reader_table TABLE FIXTURES DIR
 * writes each case as DIR/ROW-NAME.swc test_swc_reader_table TABLE FIXTURES DIR N     writes N files made by
 * damage to the cases */
#define _GNU_SOURCE
#include "check.h"
#include "conceg/swc.h"

#include <stdarg.h>

#define CELLS 7
#define MOST_TEXT 8192
#define MOST_CASES 256

typedef struct text {
  char byte[MOST_TEXT];
  size_t length;
} text;

static char *line_of[MOST_CASES][CELLS];
static int case_count;
static conceg_ctx *ctx;

static int hex(char c) {
  return c <= '9' ? c - '0' : c - 'a' + 10;
}

static void read_fixture(const char *folder, const char *name, text *out) {
  char path[4096];
  FILE *file;
  snprintf(path, sizeof path, "%s/%s", folder, name);
  file = fopen(path, "rb");
  CHECK(file != NULL);
  out->length = file ? fread(out->byte, 1, sizeof out->byte, file) : 0;
  CHECK(out->length > 0 && out->length < sizeof out->byte);
  if (file) fclose(file);
}

static void unescape(const char *p, const char *folder, text *out) {
  out->length = 0;
  if (*p == '@') {
    read_fixture(folder, p + 1, out);
    return;
  }
  while (*p) {
    char c = *p++;
    if (c == '\\') {
      c = *p++;
      if (c == 'x')
        c = (char)(hex(p[0]) * 16 + hex(p[1])), p += 2;
      else
        c = c == 'n' ? '\n' : c == 'r' ? '\r' : '\t';
    }
    out->byte[out->length++] = c;
  }
}

static uint32_t flags_of(const char *options) {
  return (strstr(options, "split") ? CONCEG_SWC_SPLIT : 0) |
         (strstr(options, "drop") ? CONCEG_SWC_DROP_FLOATING : 0) |
         (strstr(options, "attach") ? CONCEG_SWC_ATTACH_FLOATING : 0);
}

static void add(text *out, const char *format, ...) CONCEG_PRINTF(2, 3);
static void add(text *out, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  out->length +=
      (size_t)vsnprintf(out->byte + out->length, sizeof out->byte - out->length, format, arguments);
  va_end(arguments);
}

/* Only errors, or all problems, as the table writes them. */
static void problems_text(const conceg_swc *swc, int only_errors, text *out) {
  uint32_t i, severity, line;
  const char *code;
  out->length = 0, out->byte[0] = 0;
  for (i = 0; conceg_swc_problem(swc, i, &severity, &line, &code, NULL); i++)
    if (!only_errors || !severity) add(out, "%s%s@%u", out->length ? " " : "", code, line);
  if (!out->length) add(out, "-");
}

static void somas_text(const conceg_swc *swc, text *out) {
  static const char *const form[] = {"none", "point", "three", "chain", "outline", "tree"};
  uint32_t cell;
  out->length = 0, out->byte[0] = 0;
  for (cell = 0; cell < conceg_swc_cell_count(swc); cell++) {
    double c[3], radius;
    const conceg_soma_form soma = conceg_swc_cell_soma(swc, cell, c, &radius);
    int axis;
    for (axis = 0; axis < 3; axis++)
      if (fabs(c[axis]) < 1e-9) c[axis] = 0.0;
    add(out, "%s%s", cell ? "; " : "", form[soma]);
    if (soma != CONCEG_SOMA_NONE) add(out, " %.6g,%.6g,%.6g %.6g", c[0], c[1], c[2], radius);
  }
}

static void samples_text(const conceg_swc *swc, text *out) {
  const double *p = conceg_swc_position(swc);
  uint64_t i;
  uint32_t cell = 0;
  out->length = 0, out->byte[0] = 0;
  for (i = 0; i < conceg_swc_count(swc); i++, p += 3) {
    const int64_t up = conceg_swc_parent(swc)[i];
    for (; i >= conceg_swc_cell_first(swc, cell + 1); cell++)
      add(out, " |");
    add(out, "%s%d/%g,%g,%g/%g/", out->length ? " " : "", (int)conceg_swc_kind(swc)[i], p[0], p[1], p[2],
        conceg_swc_radius(swc)[i]);
    if (up >= 0)
      add(out, "%d", (int)up);
    else
      add(out, conceg_swc_on_soma(swc)[i] ? "s" : "-");
  }
  if (!out->length) add(out, "-");
}

/* The problems of the table: all of them, or those that are errors in strict mode. */
static void expected_problems(const char *table, int strict_errors, text *out) {
  char copy[MOST_TEXT], *word, *rest = copy;
  out->length = 0, out->byte[0] = 0;
  snprintf(copy, sizeof copy, "%s", table);
  while ((word = strtok(rest, " ")) != NULL) {
    char *const mark = strchr(word, '!');
    const int error = mark || *word == 'E';
    rest = NULL;
    if (mark) *mark = '\0';
    if (!strict_errors || error) add(out, "%s%s", out->length ? " " : "", word);
  }
  if (!out->length) add(out, "-");
}

/* Rows are all accounted for. */
static void check_rows(const conceg_swc *swc) {
  CHECK_EQUAL(conceg_swc_rows(swc, CONCEG_SWC_USE_ALL),
              conceg_swc_rows(swc, CONCEG_SWC_USE_SAMPLES) + conceg_swc_rows(swc, CONCEG_SWC_USE_SOMA) +
                  conceg_swc_rows(swc, CONCEG_SWC_USE_COPIES) + conceg_swc_rows(swc, CONCEG_SWC_USE_DROPPED));
  CHECK_EQUAL(conceg_swc_rows(swc, CONCEG_SWC_USE_SAMPLES), conceg_swc_count(swc));
}

static void check_case(char *const cell[CELLS], const char *folder) {
  static text file, expected, got;
  uint32_t strict;
  unescape(cell[3], folder, &file);
  for (strict = 0; strict < 2; strict++) {
    conceg_swc *swc = NULL;
    const conceg_status status =
        conceg_swc_parse(ctx, file.byte, file.length, cell[1], flags_of(cell[2]) | strict, &swc);
    const int before = check_failed_, refused = !strcmp(cell[5], "refused");
    expected_problems(cell[4], 1, &expected);
    CHECK_EQUAL(status, refused || (strict && strcmp(expected.byte, "-") != 0) ? CONCEG_E_FORMAT : CONCEG_OK);
    problems_text(swc, 1, &got);
    if (strict) CHECK_TEXT(got.byte, expected.byte);
    /* Strictness changes the verdict, never what is found. */
    expected_problems(cell[4], 0, &expected);
    problems_text(swc, 0, &got);
    CHECK_TEXT(got.byte, expected.byte);
    if (status == CONCEG_OK) {
      somas_text(swc, &got);
      CHECK_TEXT(got.byte, cell[5]);
      samples_text(swc, &got);
      CHECK_TEXT(got.byte, cell[6]);
      check_rows(swc);
    } else {
      CHECK_EQUAL(conceg_swc_count(swc), 0);
      CHECK_EQUAL(conceg_swc_cell_count(swc), 0);
      CHECK(strstr(conceg_ctx_error(ctx), cell[1]) == conceg_ctx_error(ctx));
    }
    if (check_failed_ != before)
      fprintf(stderr, "  in row %s, %s, %s\n", cell[0], cell[1], strict ? "strict" : "tolerant");
    conceg_swc_free(swc);
  }
}

static void read_table(const char *path) {
  static char line[MOST_TEXT];
  FILE *file = fopen(path, "r");
  CHECK(file != NULL);
  while (file && fgets(line, sizeof line, file)) {
    char *p = line;
    int i;
    if (*line == '#') continue;
    line[strcspn(line, "\n")] = '\0';
    for (i = 0; i < CELLS && case_count < MOST_CASES; i++) {
      char *const tab = strchr(p, '\t');
      if (tab) *tab = '\0';
      CHECK((tab != NULL) == (i < CELLS - 1));
      line_of[case_count][i] = strdup(p);
      if (tab) p = tab + 1;
    }
    case_count++;
  }
  if (file) fclose(file);
}

/* Each row of the reader's table has a case. */
static void check_coverage(void) {
  int row, i;
  for (row = 1; row <= 41; row++) {
    int found = 0;
    for (i = 0; i < case_count; i++)
      found |= atoi(line_of[i][0]) == row;
    if (!found) fprintf(stderr, "  no case of row %d\n", row);
    CHECK(found);
  }
}

static void save(const char *folder, const char *row, const char *name, const text *file) {
  char path[4096];
  FILE *out;
  snprintf(path, sizeof path, "%s/%s-%s.swc", folder, row, name);
  out = fopen(path, "wb");
  CHECK(out && fwrite(file->byte, 1, file->length, out) == file->length && fclose(out) == 0);
}

static uint64_t draw(uint64_t *state, uint64_t below) {
  *state = *state * 6364136223846793005ull + 1442695040888963407ull;
  return (*state >> 33) % below;
}

/* A case with one to four digits changed into others, and at times any byte into any other, the end cut off,
 * or another case behind it. */
static void damage(text *file, const char *folder, uint64_t *state) {
  static const char spice[] = "0123456789-+.e# \n\r\t,";
  static text other;
  uint64_t changes = 1 + draw(state, 4), how = draw(state, 16);
  while (changes-- && file->length) {
    char *const byte = &file->byte[draw(state, file->length)];
    if (*byte >= '0' && *byte <= '9') *byte = (char)('0' + draw(state, 10));
  }
  if (how < 3 && file->length) file->byte[draw(state, file->length)] = spice[draw(state, sizeof spice - 1)];
  if (how == 4) file->length = file->length * 3 / 4;
  if (how != 5) return;
  unescape(line_of[draw(state, (uint64_t)case_count)][3], folder, &other);
  if (file->length + other.length >= sizeof file->byte) return;
  memcpy(file->byte + file->length, other.byte, other.length);
  file->length += other.length;
}

int main(int argc, char **argv) {
  static text file;
  const int count = argc > 4 ? atoi(argv[4]) : 0;
  uint64_t state = 2024;
  int i;
  if (argc < 3) return 2;
  ctx = conceg_ctx_new();
  read_table(argv[1]);
  CHECK(ctx && case_count > 41);
  for (i = 0; argc == 3 && i < case_count; i++)
    check_case(line_of[i], argv[2]);
  check_coverage();
  for (i = 0; argc == 4 && i < case_count; i++)
    unescape(line_of[i][3], argv[2], &file), save(argv[3], line_of[i][0], line_of[i][1], &file);
  for (i = 0; i < count; i++) {
    char name[32];
    unescape(line_of[i % case_count][3], argv[2], &file);
    damage(&file, argv[2], &state);
    snprintf(name, sizeof name, "%06d", i);
    save(argv[3], "damaged", name, &file);
  }
  if (argc == 3) printf("%d cases\n", case_count);
  for (i = 0; i < case_count * CELLS; i++)
    free(line_of[i / CELLS][i % CELLS]);
  conceg_ctx_free(ctx);
  return check_done();
}
