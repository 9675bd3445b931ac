/* SPDX-License-Identifier: BSD-3-Clause
 * The tables of /statistics: /statistics/<table>/<column>, all columns of one length. */
#include "info.h"

#include <string.h>

#define COLUMN_LIMIT 32

struct columns {
  conceg_array array[COLUMN_LIMIT];
  const char *name[COLUMN_LIMIT];
  uint32_t count;
  uint64_t rows;
};

static int read_columns(struct cli *cli, conceg_doc *doc, const char *group, struct columns *out) {
  const uint64_t children = conceg_doc_children(doc, group);
  struct words paths = {0};
  uint64_t i;
  int code = EXIT_OK, texts;
  memset(out, 0, sizeof *out);
  for (i = 0; i < children; i++) {
    const char *child = conceg_doc_child(doc, group, i);
    if (!strchr(child, '@') && child[strlen(child) - 1] != '/') words_add(&paths, cli_keep(cli, "%s", child));
  }
  /* Names first, numbers after them: that is how a table is read. */
  for (texts = 1; texts >= 0; texts--)
    for (i = 0; code == EXIT_OK && i < paths.count && out->count < COLUMN_LIMIT; i++) {
      conceg_array *array = &out->array[out->count];
      code = read_array(cli, doc, paths.word[i], array);
      if (code != EXIT_OK || (array->dtype == CONCEG_TEXT) != texts || array->rank != 1 ||
          (out->count && array->shape[0] != out->rows))
        continue;
      out->rows = array->shape[0];
      out->name[out->count++] = strrchr(paths.word[i], '/') + 1;
    }
  words_free(&paths);
  return code;
}

static const char *cell_text(struct cli *cli, const conceg_array *array, uint64_t row) {
  char text[VALUE_TEXT];
  if (array->dtype == CONCEG_TEXT) return value_string(array, row);
  if (array->dtype == CONCEG_F32 || array->dtype == CONCEG_F64)
    return cli_keep(cli, "%.5g", value_number(array, row));
  value_text(array, row, text);
  return cli_keep(cli, "%s", text);
}

static void print_text(struct cli *cli, const char *name, const struct columns *columns) {
  struct table table = {.columns = columns->count};
  uint64_t row;
  uint32_t i;
  printf("  %s\n", name);
  for (i = 0; i < columns->count; i++) {
    const char *unit = columns->array[i].unit;
    if (unit && *unit && strcmp(unit, "1") != 0)
      words_add(&table.cells, cli_keep(cli, "%s [%s]", columns->name[i], unit));
    else
      words_add(&table.cells, columns->name[i]);
  }
  for (row = 0; row < columns->rows; row++)
    for (i = 0; i < columns->count; i++)
      words_add(&table.cells, cell_text(cli, &columns->array[i], row));
  table_print(&table, 4);
  table_free(&table);
}

static void print_json(struct json *json, const char *name, const struct columns *columns) {
  uint64_t row;
  uint32_t i;
  json_open(json, name, '{');
  for (i = 0; i < columns->count; i++) {
    const conceg_array *array = &columns->array[i];
    json_open(json, columns->name[i], '{');
    json_text(json, "unit", array->unit ? array->unit : "");
    json_open(json, "values", '[');
    for (row = 0; row < columns->rows; row++) {
      if (array->dtype == CONCEG_TEXT)
        json_text(json, NULL, value_string(array, row));
      else
        json_number(json, NULL, value_number(array, row));
    }
    json_close(json, ']');
    json_close(json, '}');
  }
  json_close(json, '}');
}

int print_statistics(struct cli *cli, conceg_doc *doc, struct json *json) {
  const uint64_t children = conceg_doc_children(doc, "/statistics");
  struct words groups = {0};
  uint32_t i;
  uint64_t child;
  int code = EXIT_OK;
  for (child = 0; child < children; child++) {
    const char *path = conceg_doc_child(doc, "/statistics", child);
    if (path[strlen(path) - 1] == '/') words_add(&groups, cli_keep(cli, "%.*s", (int)strlen(path) - 1, path));
  }
  if (json)
    json_open(json, "statistics", '{');
  else if (groups.count)
    puts("statistics:");
  for (i = 0; code == EXIT_OK && i < groups.count; i++) {
    struct columns columns;
    const char *name = strrchr(groups.word[i], '/') + 1;
    code = read_columns(cli, doc, groups.word[i], &columns);
    if (code != EXIT_OK || !columns.count) continue;
    if (json)
      print_json(json, name, &columns);
    else
      print_text(cli, name, &columns);
  }
  if (json) json_close(json, '}');
  words_free(&groups);
  return code;
}
