/* SPDX-License-Identifier: BSD-3-Clause
 * conceg swc repair: a tolerant reading written as plain SWC, with every change named. */
#define _GNU_SOURCE
#include "swc.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* What conceg_swc_write takes (SWC-009, SWC-011). */
#define SMALLEST_RADIUS_UM 1e-6
#define LARGEST_UM 1e12

struct repair {
  struct cli *cli;
  const char *path;
  uint32_t flags;
  int first_only, keep_zero_length;
  double radius_min; /* 0 = none was given */
  int32_t other_type;
  const struct swc_files *inputs;
  uint64_t repaired, refused;
};

/* One cell on its way to a file: the arrays of `out` are owned here. */
struct draft {
  conceg_swc_cell out;
  double *position, *radius;
  uint8_t *kind;
  int64_t *parent;
  double **column;
  const char **column_name, **header;
  uint64_t merged;
};

static void *take(struct cli *cli, uint64_t count, size_t size) {
  void *memory = calloc(count ? (size_t)count : 1, size);
  if (memory) return memory;
  cli_fail(cli, EXIT_STAGE, "out of memory");
  exit(EXIT_STAGE);
}

static void free_draft(struct draft *draft) {
  uint32_t c;
  for (c = 0; c < draft->out.column_count; c++)
    free(draft->column[c]);
  free(draft->position), free(draft->radius), free(draft->kind), free(draft->parent);
  free(draft->column), free(draft->column_name), free(draft->header);
}

/* What the file's owner can do about an error; NULL when the reader's text says it. */
static const char *remedy(const char *code) {
  static const struct {
    const char *code, *text;
  } row[] = {{"E_SOMATA", "--somata=split writes a file per cell, --somata=first the first cell alone"},
             {"E_FLOATING", "--floating=keep or --floating=drop"},
             {"E_COLUMNS", "complete the row, or delete it and give its children another parent"},
             {"E_NUMBER", "correct the number"},
             {"E_NONFINITE", "correct the number, or delete the row and give its children another parent"},
             {"E_DUP", "give one of the rows another id, or delete it"},
             {"E_ID", "correct the number"},
             {"E_EMPTY", "there is nothing to repair"}};
  size_t i;
  for (i = 0; i < sizeof row / sizeof *row; i++)
    if (!strcmp(row[i].code, code)) return row[i].text;
  return NULL;
}

static int refuse(struct repair *repair, uint32_t line, const char *code, const char *text) {
  repair->refused++;
  if (line)
    printf("%s: NOT REPAIRED: line %u: %s: %s\n", repair->path, line, code, text);
  else
    printf("%s: NOT REPAIRED: %s: %s\n", repair->path, code, text);
  return EXIT_INPUT;
}

/* These are told sample by sample, with what was written instead. */
static int is_told_by_sample(const char *code) {
  return !strcmp(code, "W_RADIUS") || !strcmp(code, "W_TYPE") || !strcmp(code, "W_ZEROLEN");
}

/* Prints what the reader found. Returns the exit code; the first error's remedy is printed last. */
static int tell_problems(struct repair *repair, const conceg_swc *swc, conceg_status status) {
  uint32_t i, severity, line, first = 0;
  const char *code, *text, *error = NULL;
  for (i = 0; conceg_swc_problem(swc, i, &severity, &line, &code, &text); i++) {
    if (!severity && !error) error = code, first = line;
    if (status == CONCEG_OK && is_told_by_sample(code)) continue;
    if (line)
      printf("%s:%u: %s: %s\n", repair->path, line, code, text);
    else
      printf("%s: %s: %s\n", repair->path, code, text);
  }
  if (!error) return EXIT_OK;
  text = remedy(error);
  return refuse(repair, first, error, text ? text : "correct the line by hand, as its message says");
}

/* ---- One cell ---- */

static int32_t settle_type(const struct repair *repair, int32_t kind, uint32_t line) {
  if (kind == CONCEG_SWC_UNDEFINED || kind == CONCEG_SWC_AXON || kind == CONCEG_SWC_BASAL ||
      kind == CONCEG_SWC_APICAL || kind == CONCEG_SWC_GLIA)
    return kind;
  printf("%s:%u: W_TYPE: type %d written as %d\n", repair->path, line, (int)kind, (int)repair->other_type);
  return repair->other_type;
}

/* 0 = it is too small and no --radius-min was given. */
static int settle_radius(const struct repair *repair, double radius, uint32_t line, double *out) {
  const double smallest = repair->radius_min > 0.0 ? repair->radius_min : SMALLEST_RADIUS_UM;
  *out = radius;
  if (radius >= smallest) return 1;
  if (!(repair->radius_min > 0.0)) return 0;
  *out = smallest;
  printf("%s:%u: W_RADIUS: radius %g written as %g\n", repair->path, line, radius, smallest);
  return 1;
}

static int is_near(const double position[3], double radius) {
  return fabs(position[0]) < LARGEST_UM && fabs(position[1]) < LARGEST_UM && fabs(position[2]) < LARGEST_UM &&
         radius < LARGEST_UM;
}

/* Samples of one cell without those that lie on their parent, whose children move up to it. `place` has the
 * new number of each old sample. Returns an exit code. */
static int copy_samples(struct repair *repair, const conceg_swc *swc, uint64_t first, uint64_t end,
                        struct draft *draft) {
  const double *const position = conceg_swc_position(swc), *const radius = conceg_swc_radius(swc);
  const int64_t *const parent = conceg_swc_parent(swc);
  const uint32_t *const line = conceg_swc_line(swc);
  uint32_t far_line = 0;
  uint64_t *const place = take(repair->cli, end - first, sizeof *place), i, used = 0;
  uint32_t c, bad_line = 0;
  uint64_t bad = 0;
  for (i = first; i < end; i++) {
    const int64_t up = parent[i];
    const double *const p = position + 3 * i, *const q = up < 0 ? p : position + 3 * up;
    if (up >= 0 && !repair->keep_zero_length && p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) {
      place[i - first] = place[(uint64_t)up - first];
      draft->merged++;
      printf("%s:%u: W_ZEROLEN: lies on its parent in line %u; merged with it\n", repair->path, line[i],
             line[up]);
      continue;
    }
    place[i - first] = used;
    if (!far_line && !is_near(p, radius[i])) far_line = line[i];
    memcpy(draft->position + 3 * used, p, 3 * sizeof *p);
    if (!settle_radius(repair, radius[i], line[i], &draft->radius[used]) && !bad++) bad_line = line[i];
    draft->kind[used] = (uint8_t)settle_type(repair, conceg_swc_kind(swc)[i], line[i]);
    draft->parent[used] = up >= 0                      ? (int64_t)place[(uint64_t)up - first]
                          : conceg_swc_on_soma(swc)[i] ? -1
                                                       : CONCEG_SWC_FLOATING;
    for (c = 0; c < draft->out.column_count; c++)
      draft->column[c][used] = conceg_swc_column(swc, draft->column_name[c])[i];
    used++;
  }
  draft->out.count = used;
  free(place);
  if (far_line)
    return refuse(repair, far_line, "E_NUMBER",
                  "a coordinate or radius is 1e12 um or more; correct its unit");
  if (!bad) return EXIT_OK;
  printf("%s: %llu radii are 0, negative or below %g um\n", repair->path, (unsigned long long)bad,
         SMALLEST_RADIUS_UM);
  return refuse(repair, bad_line, "W_RADIUS", "--radius-min 0.05 writes such radii as 0.05 um");
}

/* Comments that can be kept as they are; the writer makes the others itself. */
static void copy_header(struct repair *repair, const conceg_swc *swc, struct draft *draft) {
  const char *key, *value;
  uint32_t count = 0, i, replaced = 0;
  while (conceg_swc_header_at(swc, count, NULL, NULL))
    count++;
  draft->header = take(repair->cli, (uint64_t)count + 1, sizeof *draft->header);
  for (i = count = 0; conceg_swc_header_at(swc, i, &key, &value); i++) {
    char *const text = (char *)(uintptr_t)cli_keep(repair->cli, "%s%s%s", key, *value ? " " : "", value);
    char *p;
    if (!strncmp(text, "SWC-plus ", 9) || !strcmp(text, "id type x y z radius parent") ||
        !strncmp(text, "@begin", 6) || !strncmp(text, "@end", 4) || !strncmp(text, "@n", 2))
      continue;
    for (p = text; *p; p++) {
      if (*p == '\t') *p = ' ';
      if ((unsigned char)*p >= 32 && (unsigned char)*p <= 126) continue;
      *p = '?';
      replaced++;
    }
    draft->header[count++] = text;
  }
  if (replaced)
    printf("%s: W_ENCODING: %u bytes of comments that are not ASCII written as ?\n", repair->path, replaced);
  draft->out.header = draft->header;
}

static int is_column_name(const char *name) {
  return *name &&
         strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-@") == strlen(name);
}

static void copy_columns(struct repair *repair, const conceg_swc *swc, uint64_t count, struct draft *draft) {
  static const char *const own[] = {"x", "y", "z", "radius"};
  const char *name;
  uint32_t columns = 0, i, c;
  while (conceg_swc_column_at(swc, columns))
    columns++;
  draft->column = take(repair->cli, columns, sizeof *draft->column);
  draft->column_name = take(repair->cli, columns, sizeof *draft->column_name);
  for (i = 0; (name = conceg_swc_column_at(swc, i)) != NULL; i++) {
    int known = 0;
    for (c = 0; c < 4; c++)
      known |= !strcmp(name, own[c]);
    for (c = 0; c < draft->out.column_count; c++)
      known |= !strcmp(name, draft->column_name[c]);
    if (known) continue;
    if (!is_column_name(name)) {
      printf("%s: W_COLUMNS: a column of the footer is left out: its name has other than letters, digits and "
             "_ . - @\n",
             repair->path);
      continue;
    }
    draft->column_name[draft->out.column_count] = name;
    draft->column[draft->out.column_count++] = take(repair->cli, count, sizeof(double));
  }
}

static int copy_soma(struct repair *repair, const conceg_swc *swc, uint32_t cell, struct draft *draft) {
  static const char *const form[] = {"none", "one point", "three points", "a chain", "an outline", "a tree"};
  const conceg_soma_form soma = conceg_swc_cell_soma(swc, cell, draft->out.soma, &draft->out.soma_radius);
  uint64_t i;
  if (soma == CONCEG_SOMA_NONE) {
    for (i = 0; i < draft->out.count; i++)
      if (draft->parent[i] == CONCEG_SWC_FLOATING) draft->parent[i] = -1;
    return EXIT_OK;
  }
  if (!settle_radius(repair, draft->out.soma_radius, 0, &draft->out.soma_radius))
    return refuse(repair, 0, "W_RADIUS",
                  "the soma has no radius; --radius-min 5 gives it 5 um, and all samples at least that; "
                  "or correct the radius of the soma's row");
  if (soma != CONCEG_SOMA_POINT)
    printf("%s: the soma, %s, is written as one sample of radius %.6g um\n", repair->path, form[soma],
           draft->out.soma_radius);
  return EXIT_OK;
}

/* The same samples, to the last bit, in the same order. */
static int is_same(const conceg_swc *swc, const conceg_swc_cell *cell) {
  const uint64_t count = cell->count;
  uint64_t i;
  if (conceg_swc_count(swc) != count ||
      memcmp(conceg_swc_position(swc), cell->position, count * 3 * sizeof(double)) != 0 ||
      memcmp(conceg_swc_radius(swc), cell->radius, count * sizeof(double)) != 0)
    return 0;
  for (i = 0; i < count; i++)
    if (conceg_swc_kind(swc)[i] != cell->kind[i] ||
        conceg_swc_parent(swc)[i] != (cell->parent[i] < 0 ? -1 : cell->parent[i]) ||
        conceg_swc_on_soma(swc)[i] != (cell->parent[i] == -1 && cell->soma_radius > 0.0))
      return 0;
  return 1;
}

/* Reads what was written. The remaining problems are what the cell is, not how it is written. */
static int confirm(struct repair *repair, const char *output, const conceg_swc_cell *cell) {
  conceg_swc *swc = NULL;
  const conceg_status status = conceg_swc_read(repair->cli->ctx, output, CONCEG_SWC_STRICT, &swc);
  int code = EXIT_OK;
  uint32_t i;
  const char *name;
  if (status != CONCEG_OK || !is_same(swc, cell)) {
    code = cli_fail(repair->cli, EXIT_STAGE, "%s: what was written does not read as it should: %s", output,
                    status == CONCEG_OK ? "other samples" : conceg_ctx_error(repair->cli->ctx));
  } else {
    printf("%s: written as %s: %llu samples, %s", repair->path, output, (unsigned long long)cell->count,
           cell->soma_radius > 0.0 ? "1 soma" : "no soma");
    for (i = 0; conceg_swc_problem(swc, i, NULL, NULL, &name, NULL); i++)
      if (i < 8) printf("%s %s", i ? "," : "; stays:", name);
    if (i > 8) printf(" and %u more", i - 8);
    putchar('\n');
  }
  conceg_swc_free(swc);
  return code;
}

static int write_cell(struct repair *repair, const conceg_swc *swc, uint32_t cell, const char *output,
                      uint64_t *merged) {
  const uint64_t first = conceg_swc_cell_first(swc, cell), end = conceg_swc_cell_first(swc, cell + 1);
  struct draft draft = {.out = {.size = sizeof draft.out}};
  conceg_status status;
  int code;
  draft.position = take(repair->cli, end - first, 3 * sizeof(double));
  draft.radius = take(repair->cli, end - first, sizeof(double));
  draft.kind = take(repair->cli, end - first, sizeof(uint8_t));
  draft.parent = take(repair->cli, end - first, sizeof(int64_t));
  copy_columns(repair, swc, end - first, &draft);
  copy_header(repair, swc, &draft);
  draft.out.position = draft.position, draft.out.radius = draft.radius, draft.out.kind = draft.kind;
  draft.out.parent = draft.parent;
  draft.out.column_name = draft.column_name, draft.out.column = (const double *const *)draft.column;
  code = copy_samples(repair, swc, first, end, &draft);
  if (code == EXIT_OK) code = copy_soma(repair, swc, cell, &draft);
  if (code == EXIT_OK) {
    status = conceg_swc_write(repair->cli->ctx, output, &draft.out);
    if (status == CONCEG_E_IO || status == CONCEG_E_NOMEM)
      code = cli_fail_status(repair->cli, status);
    else if (status != CONCEG_OK)
      code = refuse(repair, 0, "not written", conceg_ctx_error(repair->cli->ctx));
    else
      code = confirm(repair, output, &draft.out);
  }
  *merged += draft.merged;
  free_draft(&draft);
  return code;
}

/* ---- One file ---- */

/* "a/cell.swc" and 2: "a/cell-2.swc". */
static const char *numbered(struct cli *cli, const char *output, uint32_t number) {
  const char *const dot = strrchr(output, '.'), *const slash = strrchr(output, '/');
  const int stem =
      dot && (!slash || dot > slash + 1) && dot > output ? (int)(dot - output) : (int)strlen(output);
  return cli_keep(cli, "%.*s-%u%s", stem, output, number, output + stem);
}

/* A file per cell may only hit an input when -o names it. */
static int hits_input(const struct repair *repair, const char *output) {
  struct stat a, b;
  uint32_t i;
  if (stat(output, &a) != 0) return 0;
  for (i = 0; i < repair->inputs->count; i++)
    if (stat(repair->inputs->file[i].path, &b) == 0 && a.st_dev == b.st_dev && a.st_ino == b.st_ino) return 1;
  return 0;
}

static void tell_rows(const struct repair *repair, const conceg_swc *swc, uint64_t merged,
                      uint64_t other_cells) {
  const unsigned long long all = conceg_swc_rows(swc, CONCEG_SWC_USE_ALL),
                           samples = conceg_swc_rows(swc, CONCEG_SWC_USE_SAMPLES),
                           soma = conceg_swc_rows(swc, CONCEG_SWC_USE_SOMA),
                           copies = conceg_swc_rows(swc, CONCEG_SWC_USE_COPIES),
                           dropped = conceg_swc_rows(swc, CONCEG_SWC_USE_DROPPED);
  printf("%s: %llu rows = %llu samples written + %llu of somas + %llu copies + %llu on their parent + %llu "
         "of floating "
         "trees left out + %llu of other cells left out\n",
         repair->path, all, samples - merged - other_cells, soma, copies, (unsigned long long)merged, dropped,
         (unsigned long long)other_cells);
}

static int repair_file(struct repair *repair, const char *path, const char *output) {
  struct cli *const cli = repair->cli;
  conceg_swc *swc = NULL;
  conceg_status status;
  uint64_t merged = 0, other_cells = 0;
  uint32_t cell, cells;
  int code;
  repair->path = path;
  status = conceg_swc_read(cli->ctx, path, repair->flags, &swc);
  if (status != CONCEG_OK && status != CONCEG_E_FORMAT) return cli_fail_status(cli, status);
  progress_clear(&cli->progress);
  code = tell_problems(repair, swc, status);
  cells = conceg_swc_cell_count(swc);
  if (cells > 1 && repair->first_only) {
    other_cells = conceg_swc_count(swc) - conceg_swc_cell_first(swc, 1);
    printf("%s: W_SOMATA: the first of %u cells is written (--somata=first)\n", path, cells);
    cells = 1;
  }
  for (cell = 0; cell < cells && code == EXIT_OK; cell++) {
    const char *const name = cells == 1 ? output : numbered(cli, output, cell + 1);
    if (cells > 1 && hits_input(repair, name))
      code = refuse(repair, 0, "W_SOMATA", cli_keep(cli, "%s is one of the inputs; choose another -o", name));
    else
      code = write_cell(repair, swc, cell, name, &merged);
  }
  if (code == EXIT_OK) tell_rows(repair, swc, merged, other_cells), repair->repaired++;
  conceg_swc_free(swc);
  return code;
}

/* ---- All files ---- */

/* Makes the folders above a file. */
static int make_folders(struct cli *cli, const char *path) {
  char *const copy = (char *)(uintptr_t)cli_keep(cli, "%s", path);
  char *p;
  for (p = strchr(copy + 1, '/'); p; p = strchr(p + 1, '/')) {
    *p = '\0';
    if (mkdir(copy, 0777) != 0 && errno != EEXIST)
      return cli_fail(cli, EXIT_IO, "%s: cannot be made: %s", copy, strerror(errno));
    *p = '/';
  }
  return EXIT_OK;
}

static int repair_all(struct repair *repair, const struct swc_files *files, int is_folder) {
  struct cli *const cli = repair->cli;
  uint32_t i;
  int code = EXIT_OK;
  for (i = 0; i < files->count; i++) {
    const char *output = cli->output;
    if (progress_report(&cli->progress, "files", i, files->count))
      return cli_fail(cli, EXIT_CANCELLED, "cancelled after %u of %u files", i, files->count);
    if (is_folder) {
      output = cli_keep(cli, "%s/%s", cli->output, files->file[i].inside);
      code = make_folders(cli, output);
      if (code != EXIT_OK) return code;
    }
    code = repair_file(repair, files->file[i].path, output);
    if (code != EXIT_OK && code != EXIT_INPUT) return code;
  }
  progress_clear(&cli->progress);
  printf("%u files: %llu repaired, %llu not\n", files->count, (unsigned long long)repair->repaired,
         (unsigned long long)repair->refused);
  return repair->refused ? cli_fail(cli, EXIT_INPUT, "%llu of %u files not repaired; the output says why",
                                    (unsigned long long)repair->refused, files->count)
                         : EXIT_OK;
}

static int repair_words(struct repair *repair) {
  struct cli *const cli = repair->cli;
  struct swc_files files = {0};
  struct stat about;
  int code, is_folder;
  if (cli->words.count != 1 || !cli->output)
    return cli_fail(cli, EXIT_USAGE, "which %s? usage: %s %s",
                    cli->output ? "file or folder" : "-o FILE or FOLDER", cli->program->name,
                    cli->program->usage);
  is_folder = stat(cli->words.word[0], &about) == 0 && S_ISDIR(about.st_mode);
  if (!is_folder && stat(cli->output, &about) == 0 && S_ISDIR(about.st_mode))
    return cli_fail(cli, EXIT_USAGE, "-o %s: it is a folder, expected a file", cli->output);
  code = swc_list(cli, &cli->words, &files);
  repair->inputs = &files;
  if (code == EXIT_OK) code = repair_all(repair, &files, is_folder);
  repair->inputs = NULL;
  swc_list_free(&files);
  return code;
}

/* A positive number, of the whole text. */
static int parse_radius(const char *text, double *out) {
  char *end;
  *out = strtod(text, &end);
  return end != text && !*end && isfinite(*out) && *out >= SMALLEST_RADIUS_UM;
}

int swc_repair(int argc, char **argv) {
  const char *floating = NULL, *somata = NULL, *radius_min = NULL, *other_types = NULL, *zero_length = NULL;
  const struct cli_option options[] = {
      {"floating", 0, "keep|drop|attach",
       "trees beside the soma: kept (default), left out, or joined to what is nearest", NULL, &floating,
       NULL},
      {"somata", 0, "refuse|split|first",
       "several somata: an error (default), a file per cell, or the first cell", NULL, &somata, NULL},
      {"radius-min", 0, "UM",
       "smaller radii are written as this; without it radii of 0 and less are an error", NULL, &radius_min,
       NULL},
      {"other-types", 0, "0|2|3|4|7", "what types other than these are written as (default 0)", NULL,
       &other_types, NULL},
      {"zero-length", 0, "merge|keep", "samples on their parent: merged with it (default), or kept", NULL,
       &zero_length, NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  const struct cli_program program = {.name = "conceg swc repair",
                                      .usage = "FILE|FOLDER -o FILE|FOLDER [options]",
                                      .summary =
                                          "write what can be read as plain SWC, and say what was changed",
                                      .example = "conceg swc repair cell.swc --radius-min 0.05 -o better.swc",
                                      .options = options,
                                      .most_words = 1};
  struct cli cli;
  struct repair repair = {.cli = &cli};
  int code = cli_begin(&cli, &program, argc, argv);
  if (code >= 0) return cli_end(&cli, code);
  code = swc_choices(&cli, floating, somata, &repair.flags);
  repair.first_only = somata && !strcmp(somata, "first");
  repair.keep_zero_length = zero_length && !strcmp(zero_length, "keep");
  if (code == EXIT_OK && zero_length && !repair.keep_zero_length && strcmp(zero_length, "merge") != 0)
    code = cli_fail(&cli, EXIT_USAGE, "--zero-length %s: expected merge or keep", zero_length);
  if (code == EXIT_OK && radius_min && !parse_radius(radius_min, &repair.radius_min))
    code = cli_fail(&cli, EXIT_USAGE, "--radius-min %s: expected a number of %g um or more", radius_min,
                    SMALLEST_RADIUS_UM);
  if (other_types) repair.other_type = *other_types - '0';
  if (code == EXIT_OK && other_types && (strlen(other_types) != 1 || !strchr("02347", *other_types)))
    code = cli_fail(&cli, EXIT_USAGE, "--other-types %s: expected 0, 2, 3, 4 or 7", other_types);
  if (code == EXIT_OK) code = repair_words(&repair);
  return cli_end(&cli, cli_close_stdout(&cli, code));
}
