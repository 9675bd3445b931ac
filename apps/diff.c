/* SPDX-License-Identifier: BSD-3-Clause
 * conceg diff: do two documents hold the same? Exactly, or within tolerances for builds by other compilers
 * and libraries. */
#include "array_text.h"
#include "json.h"
#include "tools.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct diff {
  struct cli cli;
  int exact;
  double absolute, relative;
  const char *ignore;
  conceg_doc *doc[2];
  struct words arrays[2];
  struct json json;
  uint64_t compared, different;
};

static void report(struct diff *diff, const char *path, const char *what) {
  diff->different++;
  if (!diff->cli.json) {
    printf("%s: %s\n", path, what);
    return;
  }
  json_open(&diff->json, NULL, '{');
  json_text(&diff->json, "path", path);
  json_text(&diff->json, "difference", what);
  json_close(&diff->json, '}');
}

/* Provenance and digests follow from the bits of everything else: only --exact looks at them. */
static int is_ignored(const struct diff *diff, const char *path) {
  const char *list = diff->ignore, *made_from = strstr(path, "@made_from");
  if (!diff->exact && (!strncmp(path, "/provenance", 11) || (made_from && !made_from[10]))) return 1;
  while (list && *list) {
    const size_t length = strcspn(list, ",");
    const char *name = *list == '/' ? list + 1 : list;
    const size_t name_length = length - (size_t)(name - list);
    if (name_length && !strncmp(path + 1, name, name_length) &&
        (!path[1 + name_length] || strchr("/@", path[1 + name_length])))
      return 1;
    list += length + (list[length] == ',');
  }
  return 0;
}

static int same_value(const struct diff *diff, const conceg_array *a, const conceg_array *b, uint64_t i,
                      double *gap) {
  *gap = 0;
  if (a->dtype == CONCEG_TEXT) return strcmp(value_string(a, i), value_string(b, i)) == 0;
  if (a->dtype == CONCEG_U64) return ((const uint64_t *)a->data)[i] == ((const uint64_t *)b->data)[i];
  if (a->dtype == CONCEG_I64) return ((const int64_t *)a->data)[i] == ((const int64_t *)b->data)[i];
  const double x = value_number(a, i), y = value_number(b, i);
  *gap = fabs(x - y);
  if (x == y || (isnan(x) && isnan(y))) return 1;
  if (diff->exact || (a->dtype != CONCEG_F32 && a->dtype != CONCEG_F64)) return 0;
  return *gap <= diff->absolute + diff->relative * fmax(fabs(x), fabs(y));
}

static void first_difference(const conceg_array *a, const conceg_array *b, uint64_t index, char *out,
                             size_t size) {
  char x[VALUE_TEXT], y[VALUE_TEXT];
  if (a->dtype == CONCEG_TEXT) {
    snprintf(out, size, "first at [%llu]: \"%.60s\" and \"%.60s\"", (unsigned long long)index,
             value_string(a, index), value_string(b, index));
    return;
  }
  value_text(a, index, x);
  value_text(b, index, y);
  snprintf(out, size, "first at [%llu]: %s and %s", (unsigned long long)index, x, y);
}

static void compare_values(struct diff *diff, const char *path, const conceg_array *a,
                           const conceg_array *b) {
  const uint64_t count = conceg_array_count(a);
  uint64_t i, wrong = 0, first = 0;
  double largest = 0, gap;
  char where[400], line[600];
  for (i = 0; i < count; i++) {
    if (same_value(diff, a, b, i, &gap)) continue;
    if (!wrong++) first = i;
    if (gap > largest) largest = gap;
  }
  if (!wrong) return;
  first_difference(a, b, first, where, sizeof where);
  snprintf(line, sizeof line, "%llu of %llu values differ, by at most %g; %s", (unsigned long long)wrong,
           (unsigned long long)count, largest, where);
  report(diff, path, line);
}

static int compare_path(struct diff *diff, const char *path) {
  conceg_array a, b;
  char shape_a[128], shape_b[128], line[300];
  int code = read_array(&diff->cli, diff->doc[0], path, &a);
  if (code == EXIT_OK) code = read_array(&diff->cli, diff->doc[1], path, &b);
  if (code != EXIT_OK) return code;
  diff->compared++;
  shape_text(&a, shape_a, sizeof shape_a);
  shape_text(&b, shape_b, sizeof shape_b);
  if (strcmp(shape_a, shape_b) != 0) {
    snprintf(line, sizeof line, "%s and %s", shape_a, shape_b);
    report(diff, path, line);
  } else {
    if (strcmp(a.unit ? a.unit : "", b.unit ? b.unit : "") != 0) {
      snprintf(line, sizeof line, "units \"%s\" and \"%s\"", a.unit ? a.unit : "", b.unit ? b.unit : "");
      report(diff, path, line);
    }
    compare_values(diff, path, &a, &b);
  }
  return EXIT_OK;
}

static int compare_all(struct diff *diff) {
  uint32_t side, i;
  int code = EXIT_OK;
  for (side = 0; side < 2; side++)
    list_arrays(&diff->cli, diff->doc[side], "/", &diff->arrays[side]);
  for (i = 0; code == EXIT_OK && i < diff->arrays[0].count; i++) {
    const char *path = diff->arrays[0].word[i];
    if (is_ignored(diff, path)) continue;
    if (!conceg_doc_has(diff->doc[1], path))
      report(diff, path, "only in the first document");
    else
      code = compare_path(diff, path);
  }
  for (i = 0; i < diff->arrays[1].count; i++) {
    const char *path = diff->arrays[1].word[i];
    if (!is_ignored(diff, path) && !conceg_doc_has(diff->doc[0], path))
      report(diff, path, "only in the second document");
  }
  return code;
}

static int diff_files(struct diff *diff) {
  struct cli *cli = &diff->cli;
  uint32_t side;
  int code = EXIT_OK;
  if (cli->words.count != 2)
    return cli_fail(cli, EXIT_USAGE, "expected two documents (usage: %s %s)", cli->program->name,
                    cli->program->usage);
  for (side = 0; side < 2 && code == EXIT_OK; side++)
    code = cli_open(cli, cli->words.word[side], &diff->doc[side]);
  if (code != EXIT_OK) return code;
  if (cli->json) json_open(&diff->json, NULL, '{'), json_open(&diff->json, "differences", '[');
  code = compare_all(diff);
  if (cli->json) {
    json_close(&diff->json, ']');
    json_whole(&diff->json, "compared", diff->compared);
    json_flag(&diff->json, "same", diff->different == 0);
    json_close(&diff->json, '}');
  } else if (code == EXIT_OK) {
    printf("%s: %llu arrays and attributes compared%s, %llu differ\n", diff->different ? "DIFFERENT" : "same",
           (unsigned long long)diff->compared, diff->exact ? " exactly" : "",
           (unsigned long long)diff->different);
  }
  return code == EXIT_OK && diff->different ? EXIT_STAGE : code;
}

static int parse_tolerance(struct cli *cli, const char *option, const char *text, double *out) {
  char *end;
  if (!text) return EXIT_OK;
  *out = strtod(text, &end);
  if (end != text && !*end && *out >= 0) return EXIT_OK;
  return cli_fail(cli, EXIT_USAGE, "%s %s: expected a number, 0 or more", option, text);
}

int tool_diff(int argc, char **argv) {
  struct diff diff;
  const char *absolute = NULL, *relative = NULL;
  const struct cli_option options[] = {
      {"exact", 0, NULL,
       "every bit, provenance too (default: floating-point values within the tolerances, no provenance)",
       &diff.exact, NULL, NULL},
      {"absolute", 0, "X", "allowed difference (default 1e-9)", NULL, &absolute, NULL},
      {"relative", 0, "X", "allowed difference relative to the value (default 1e-6)", NULL, &relative, NULL},
      {"ignore", 0, "PATH[,PATH...]", "groups or datasets to leave out", NULL, &diff.ignore, NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  const struct cli_program program = {
      .name = "conceg diff",
      .usage = "A.cgx B.cgx [options]",
      .summary = "compare two documents; exit 0 when they are the same, 1 when they differ",
      .example = "conceg diff gcc.cgx clang.cgx --relative 1e-5",
      .options = options,
      .most_words = 2};
  uint32_t side;
  int code;
  memset(&diff, 0, sizeof diff);
  diff.absolute = 1e-9, diff.relative = 1e-6;
  code = cli_begin(&diff.cli, &program, argc, argv);
  if (code < 0) {
    code = parse_tolerance(&diff.cli, "--absolute", absolute, &diff.absolute);
    if (code == EXIT_OK) code = parse_tolerance(&diff.cli, "--relative", relative, &diff.relative);
    if (code == EXIT_OK) code = cli_close_stdout(&diff.cli, diff_files(&diff));
  }
  for (side = 0; side < 2; side++) {
    if (diff.doc[side] && conceg_doc_close(diff.doc[side]) != CONCEG_OK && code == EXIT_OK)
      code = cli_fail_status(&diff.cli, CONCEG_E_IO);
    words_free(&diff.arrays[side]);
  }
  return cli_end(&diff.cli, code);
}
