/* SPDX-License-Identifier: BSD-3-Clause
 * conceg info: groups and sizes, recipe, domain, cell types, provenance and statistics of a document. */
#include "info.h"

#include "tools.h"

#include <string.h>

struct info {
  struct cli *cli;
  conceg_doc *doc;
  const char *name;
  struct json *json; /* NULL = text */
};

/* An array that may be absent: 1 when it was read and has this type. */
static int optional_array(struct info *info, const char *path, conceg_dtype dtype, conceg_array *out) {
  if (!conceg_doc_has(info->doc, path)) return 0;
  memset(out, 0, sizeof *out);
  out->size = sizeof *out;
  return conceg_doc_read(info->doc, path, out) == CONCEG_OK && out->dtype == dtype;
}

static void print_header(struct info *info) {
  conceg_array version, complete;
  unsigned major = 0, minor = 0;
  int whole = 0;
  if (optional_array(info, "/@version", CONCEG_U32, &version) && conceg_array_count(&version) == 2)
    major = ((const uint32_t *)version.data)[0], minor = ((const uint32_t *)version.data)[1];
  if (optional_array(info, "/@complete", CONCEG_U8, &complete) && conceg_array_count(&complete) == 1)
    whole = *(const uint8_t *)complete.data;
  if (info->json) {
    json_text(info->json, "file", info->name);
    json_open(info->json, "version", '[');
    json_whole(info->json, NULL, major), json_whole(info->json, NULL, minor);
    json_close(info->json, ']');
    json_flag(info->json, "complete", whole);
  } else {
    printf("%s: CGX %u.%u%s\n", info->name, major, minor, whole ? "" : ", NOT COMPLETE");
  }
}

static void print_recipe(struct info *info) {
  conceg_recipe *recipe = NULL;
  const conceg_node *root;
  const char *title, *seed;
  if (!conceg_doc_has(info->doc, "/recipe")) return;
  if (conceg_recipe_from_doc(info->cli->ctx, info->doc, &recipe) != CONCEG_OK) {
    conceg_ctx_log(info->cli->ctx, CONCEG_LOG_WARNING, "%s", conceg_ctx_error(info->cli->ctx));
    return;
  }
  root = conceg_recipe_root(recipe);
  title = conceg_node_text(conceg_node_get(root, "title")),
  seed = conceg_node_text(conceg_node_get(root, "seed"));
  if (info->json) {
    json_text(info->json, "title", title ? title : "");
    json_text(info->json, "recipe", conceg_recipe_text(recipe));
  } else {
    printf("recipe: %s, seed %s\n", title ? title : "(no title)", seed ? seed : "1");
  }
  conceg_recipe_free(recipe);
}

static void print_domain(struct info *info) {
  conceg_array lo, hi, periodic;
  const double *a, *b;
  const uint8_t *p;
  int axis;
  if (!optional_array(info, "/domain@lo", CONCEG_F64, &lo) ||
      !optional_array(info, "/domain@hi", CONCEG_F64, &hi) ||
      !optional_array(info, "/domain@periodic", CONCEG_U8, &periodic))
    return;
  if (conceg_array_count(&lo) != 3 || conceg_array_count(&hi) != 3 || conceg_array_count(&periodic) != 3)
    return;
  a = lo.data, b = hi.data, p = periodic.data;
  if (!info->json) {
    printf("domain: %g x %g x %g um, from [%g %g %g], periodic in", b[0] - a[0], b[1] - a[1], b[2] - a[2],
           a[0], a[1], a[2]);
    for (axis = 0; axis < 3; axis++)
      if (p[axis]) printf(" %c", "xyz"[axis]);
    puts(p[0] || p[1] || p[2] ? "" : " no direction");
    return;
  }
  json_open(info->json, "domain", '{');
  json_open(info->json, "lo", '[');
  for (axis = 0; axis < 3; axis++)
    json_number(info->json, NULL, a[axis]);
  json_close(info->json, ']');
  json_open(info->json, "hi", '[');
  for (axis = 0; axis < 3; axis++)
    json_number(info->json, NULL, b[axis]);
  json_close(info->json, ']');
  json_open(info->json, "periodic", '[');
  for (axis = 0; axis < 3; axis++)
    json_flag(info->json, NULL, p[axis]);
  json_close(info->json, ']');
  json_close(info->json, '}');
}

/* Rows of the widest dataset of a group say how long it is: its first extent that is not an offset. */
static int measure_group(struct info *info, const char *group, uint32_t *arrays, uint64_t *rows,
                         uint64_t *bytes) {
  struct words paths = {0};
  uint32_t i;
  int code = EXIT_OK;
  *rows = *bytes = 0;
  list_arrays(info->cli, info->doc, group, &paths);
  for (i = 0; code == EXIT_OK && i < paths.count; i++) {
    conceg_array array;
    code = describe_array(info->cli, info->doc, paths.word[i], &array);
    if (code != EXIT_OK) break;
    *bytes += array_bytes(&array);
    if (array.rank && !strchr(paths.word[i], '@') && !strstr(paths.word[i], "_offset") &&
        array.shape[0] > *rows)
      *rows = array.shape[0];
  }
  *arrays = paths.count;
  words_free(&paths);
  return code;
}

static int print_groups(struct info *info) {
  struct table table = {.columns = 4};
  struct words groups = {0};
  const uint64_t children = conceg_doc_children(info->doc, "/");
  uint64_t i, rows, bytes;
  uint32_t arrays;
  int code = EXIT_OK;
  for (i = 0; i < children; i++) {
    const char *child = conceg_doc_child(info->doc, "/", i);
    if (!strchr(child, '@')) words_add(&groups, cli_keep(info->cli, "%s", child));
  }
  if (info->json) json_open(info->json, "groups", '[');
  words_add(&table.cells, "group"), words_add(&table.cells, "arrays"), words_add(&table.cells, "rows"),
      words_add(&table.cells, "size");
  for (i = 0; code == EXIT_OK && i < groups.count; i++) {
    char size[32];
    code = measure_group(info, groups.word[i], &arrays, &rows, &bytes);
    if (info->json) {
      json_open(info->json, NULL, '{');
      json_text(info->json, "group", groups.word[i]);
      json_whole(info->json, "arrays", arrays), json_whole(info->json, "rows", rows),
          json_whole(info->json, "bytes", bytes);
      json_close(info->json, '}');
      continue;
    }
    bytes_text(bytes, size, sizeof size);
    words_add(&table.cells, groups.word[i]);
    words_add(&table.cells, cli_keep(info->cli, "%u", arrays));
    words_add(&table.cells, cli_keep(info->cli, "%llu", (unsigned long long)rows));
    words_add(&table.cells, cli_keep(info->cli, "%s", size));
  }
  if (info->json)
    json_close(info->json, ']');
  else
    table_print(&table, 2);
  table_free(&table);
  words_free(&groups);
  return code;
}

static uint64_t count_cells(const conceg_array *type, uint64_t wanted) {
  uint64_t i, count = 0;
  const uint64_t cells = conceg_array_count(type);
  for (i = 0; i < cells; i++)
    count += ((const uint32_t *)type->data)[i] == wanted;
  return count;
}

static int print_types(struct info *info) {
  struct table table = {.columns = 5};
  static const char *const headings[] = {"type", "class", "fraction", "cells", "entry"};
  conceg_array name, class_name, fraction, type, entry;
  int has_fraction, has_cells, has_entry;
  uint64_t i;
  if (!optional_array(info, "/types/name", CONCEG_TEXT, &name) ||
      !optional_array(info, "/types/class", CONCEG_TEXT, &class_name))
    return EXIT_OK;
  has_fraction = optional_array(info, "/types/fraction", CONCEG_F64, &fraction) &&
                 conceg_array_count(&fraction) == conceg_array_count(&name);
  has_cells = optional_array(info, "/cells/type", CONCEG_U32, &type);
  has_entry = optional_array(info, "/types/entry", CONCEG_TEXT, &entry);
  if (info->json) json_open(info->json, "types", '[');
  for (i = 0; i < 5; i++)
    words_add(&table.cells, headings[i]);
  for (i = 0; i < conceg_array_count(&name); i++) {
    const uint64_t cells = has_cells ? count_cells(&type, i) : 0;
    const double part = has_fraction ? value_number(&fraction, i) : 0;
    if (info->json) {
      json_open(info->json, NULL, '{');
      json_text(info->json, "name", value_string(&name, i)),
          json_text(info->json, "class", value_string(&class_name, i));
      json_number(info->json, "fraction", part), json_whole(info->json, "cells", cells);
      json_text(info->json, "entry", has_entry ? value_string(&entry, i) : "");
      json_close(info->json, '}');
      continue;
    }
    words_add(&table.cells, value_string(&name, i)), words_add(&table.cells, value_string(&class_name, i));
    words_add(&table.cells, cli_keep(info->cli, "%.4g", part));
    words_add(&table.cells, cli_keep(info->cli, "%llu", (unsigned long long)cells));
    words_add(&table.cells, has_entry ? value_string(&entry, i) : "");
  }
  if (info->json)
    json_close(info->json, ']');
  else
    puts("cell types:"), table_print(&table, 2);
  table_free(&table);
  return EXIT_OK;
}

static int print_provenance(struct info *info) {
  static const char *const columns[] = {"/provenance/stage", "/provenance/implementation",
                                        "/provenance/implementation_version", "/provenance/library_version",
                                        "/provenance/parameters"};
  conceg_array array[5], seed;
  int has_seed;
  uint64_t row;
  uint32_t i;
  for (i = 0; i < 5; i++)
    if (!optional_array(info, columns[i], CONCEG_TEXT, &array[i])) return EXIT_OK;
  has_seed = optional_array(info, "/provenance/seed", CONCEG_U64, &seed) &&
             conceg_array_count(&seed) == conceg_array_count(&array[0]);
  if (info->json)
    json_open(info->json, "provenance", '[');
  else
    puts("made by:");
  for (row = 0; row < conceg_array_count(&array[0]); row++) {
    const uint64_t number = has_seed ? ((const uint64_t *)seed.data)[row] : 0;
    if (!info->json) {
      printf("  %s (%s %s, ConCeG %s), seed %llu\n", value_string(&array[0], row),
             value_string(&array[1], row), value_string(&array[2], row), value_string(&array[3], row),
             (unsigned long long)number);
      if (info->cli->verbose) printf("    %s\n", value_string(&array[4], row));
      continue;
    }
    json_open(info->json, NULL, '{');
    for (i = 0; i < 5; i++)
      json_text(info->json, strrchr(columns[i], '/') + 1, value_string(&array[i], row));
    json_whole(info->json, "seed", number);
    json_close(info->json, '}');
  }
  if (info->json) json_close(info->json, ']');
  return EXIT_OK;
}

static int print_all(struct info *info) {
  int code;
  if (info->json) json_open(info->json, NULL, '{');
  print_header(info);
  print_recipe(info);
  print_domain(info);
  code = print_groups(info);
  if (code == EXIT_OK) code = print_types(info);
  if (code == EXIT_OK) code = print_provenance(info);
  if (code == EXIT_OK && conceg_doc_has(info->doc, "/statistics"))
    code = print_statistics(info->cli, info->doc, info->json);
  if (info->json) json_close(info->json, '}');
  return code;
}

int tool_info(int argc, char **argv) {
  const struct cli_program program = {.name = "conceg info",
                                      .usage = "[FILE.cgx] [--json]",
                                      .summary =
                                          "what a document holds: groups, cell types, provenance, statistics",
                                      .example = "conceg info cube.cgx",
                                      .most_words = 1};
  struct cli cli;
  struct json json = {0};
  struct info info = {.cli = &cli};
  int code = cli_begin(&cli, &program, argc, argv);
  if (code < 0) {
    const char *path = cli.words.count ? cli.words.word[0] : NULL;
    info.name = path ? path : "standard input";
    info.json = cli.json ? &json : NULL;
    code = cli_open(&cli, path, &info.doc);
    if (code == EXIT_OK) code = cli_close_stdout(&cli, print_all(&info));
    if (info.doc && conceg_doc_close(info.doc) != CONCEG_OK && code == EXIT_OK)
      code = cli_fail_status(&cli, CONCEG_E_IO);
  }
  return cli_end(&cli, code);
}
