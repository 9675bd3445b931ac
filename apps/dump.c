/* SPDX-License-Identifier: BSD-3-Clause
 * conceg dump: a document as text in canonical order, for reading, grep and diff. */
#include "array_text.h"
#include "tools.h"

#include <string.h>

static void print_string(const char *text) {
  putchar('"');
  for (; *text; text++) {
    if (*text == '"' || *text == '\\')
      printf("\\%c", *text);
    else if (*text == '\n')
      fputs("\\n", stdout);
    else
      putchar(*text);
  }
  putchar('"');
}

static void print_value(const conceg_array *array, uint64_t index) {
  char text[VALUE_TEXT];
  if (array->dtype == CONCEG_TEXT) {
    print_string(value_string(array, index));
    return;
  }
  value_text(array, index, text);
  fputs(text, stdout);
}

/* One line for scalars and attributes, else one line a row. `limit` 0 = all rows. */
static void print_array(const char *path, const conceg_array *array, uint64_t limit) {
  const uint64_t count = conceg_array_count(array), rows = array->rank ? array->shape[0] : 1;
  const uint64_t width = rows ? count / rows : 0, shown = limit && limit < rows ? limit : rows;
  uint64_t i, j;
  char shape[128];
  shape_text(array, shape, sizeof shape);
  printf("%s %s%s%s:", path, shape, array->unit && *array->unit ? " " : "", array->unit ? array->unit : "");
  if (array->rank == 0 || (array->rank == 1 && strchr(path, '@'))) {
    for (i = 0; i < count; i++)
      putchar(' '), print_value(array, i);
    putchar('\n');
    return;
  }
  putchar('\n');
  for (i = 0; i < shown; i++) {
    putchar(' ');
    for (j = 0; j < width; j++)
      putchar(' '), print_value(array, i * width + j);
    putchar('\n');
  }
  if (shown < rows) printf("  (%llu more rows)\n", (unsigned long long)(rows - shown));
}

static int dump_file(struct cli *cli, const char *path, const char *group, uint64_t limit) {
  struct words arrays = {0};
  conceg_doc *doc = NULL;
  uint32_t i;
  int code = cli_open(cli, path, &doc);
  if (code != EXIT_OK) return code;
  if (!conceg_doc_has(doc, group))
    code = cli_fail(cli, EXIT_INPUT, "%s: the document does not have it", group);
  else
    list_arrays(cli, doc, group, &arrays);
  for (i = 0; code == EXIT_OK && i < arrays.count && !ferror(stdout); i++) {
    conceg_array array;
    code = read_array(cli, doc, arrays.word[i], &array);
    if (code == EXIT_OK) print_array(arrays.word[i], &array, limit);
  }
  words_free(&arrays);
  if (conceg_doc_close(doc) != CONCEG_OK && code == EXIT_OK) code = cli_fail_status(cli, CONCEG_E_IO);
  return code;
}

int tool_dump(int argc, char **argv) {
  const char *group = "/", *rows = NULL;
  const struct cli_option options[] = {
      {"group", 'g', "PATH", "only this group or dataset", NULL, &group, NULL},
      {"rows", 0, "N", "at most N rows of each dataset", NULL, &rows, NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  const struct cli_program program = {.name = "conceg dump",
                                      .usage = "[GROUP] [FILE.cgx] [options]",
                                      .summary = "a document as text, in canonical order",
                                      .example = "conceg dump /cells cube.cgx --rows 5",
                                      .options = options,
                                      .most_words = 2};
  struct cli cli;
  unsigned long long limit = 0;
  int code = cli_begin(&cli, &program, argc, argv);
  if (code < 0 && rows && (rows[strspn(rows, "0123456789")] || sscanf(rows, "%llu", &limit) != 1))
    code = cli_fail(&cli, EXIT_USAGE, "--rows %s: expected a whole number", rows);
  if (code < 0 && cli.words.count == 2) group = cli.words.word[0];
  if (code < 0)
    code = cli_close_stdout(
        &cli, dump_file(&cli, cli.words.count ? cli.words.word[cli.words.count - 1] : NULL, group, limit));
  return cli_end(&cli, code);
}
