/* SPDX-License-Identifier: BSD-3-Clause
 * conceg stages: which stages there are, and which file answers. */
#include "array_text.h"
#include "json.h"
#include "tools.h"

#include <string.h>

struct row {
  const char *kind, *name, *file;
  const conceg_stage *stage; /* NULL when it could not be opened */
  const char *problem;
};

static void add_row(struct table *table, const struct row *row) {
  words_add(&table->cells, row->kind);
  words_add(&table->cells, row->name);
  words_add(&table->cells, row->stage && row->stage->version ? row->stage->version : "-");
  words_add(&table->cells, row->file);
  words_add(&table->cells, row->stage ? (row->stage->summary ? row->stage->summary : "") : row->problem);
}

static void print_row_json(struct json *json, const struct row *row) {
  json_open(json, NULL, '{');
  json_text(json, "kind", row->kind);
  json_text(json, "name", row->name);
  json_text(json, "file", row->file);
  if (row->stage) {
    json_text(json, "version", row->stage->version ? row->stage->version : "");
    json_text(json, "summary", row->stage->summary ? row->stage->summary : "");
  } else {
    json_text(json, "problem", row->problem);
  }
  json_close(json, '}');
}

static int list_stages(struct cli *cli) {
  struct table table = {.columns = 5};
  struct json json = {0};
  static const char *const headings[] = {"stage", "impl", "version", "answered by", "what"};
  conceg_registry *registry;
  struct row row;
  uint32_t i;
  const conceg_status status = conceg_registry_new(cli->ctx, conceg_builtins, &registry);
  if (status != CONCEG_OK) return cli_fail_status(cli, status);
  for (i = 0; i < 5; i++)
    words_add(&table.cells, headings[i]);
  if (cli->json) json_open(&json, NULL, '[');
  for (i = 0; conceg_registry_at(registry, i, &row.kind, &row.name, &row.file); i++) {
    const char *impl = strcmp(row.file, "built in") ? cli_keep(cli, "plugin:%s", row.name) : row.name;
    row.stage = NULL, row.problem = "";
    if (conceg_registry_find(registry, row.kind, impl, &row.stage) != CONCEG_OK)
      row.problem = cli_keep(cli, "cannot be used: %s", conceg_ctx_error(cli->ctx));
    if (cli->json)
      print_row_json(&json, &row);
    else
      add_row(&table, &row);
  }
  if (cli->json)
    json_close(&json, ']');
  else
    table_print(&table, 0);
  table_free(&table);
  conceg_registry_free(registry);
  return EXIT_OK;
}

int tool_stages(int argc, char **argv) {
  const struct cli_program program = {.name = "conceg stages",
                                      .usage = "[--json]",
                                      .summary = "which stages there are and which file answers for each",
                                      .example = "CONCEG_STAGE_PATH=./plugins conceg stages"};
  struct cli cli;
  int code = cli_begin(&cli, &program, argc, argv);
  if (code < 0) code = cli_close_stdout(&cli, list_stages(&cli));
  return cli_end(&cli, code);
}
