/* SPDX-License-Identifier: BSD-3-Clause
 * conceg params: the parameter table of a stage, for reading, for a recipe (--yaml) or for programs (--json).
 */
#include "cli.h"
#include "json.h"
#include "tools.h"

#include <string.h>

static const char *type_name(int32_t type) {
  static const char *const names[] = {"", "f64", "i64", "bool", "text", "choice", "file"};
  return type > 0 && type < (int32_t)(sizeof names / sizeof *names) ? names[type] : "";
}

static void print_yaml(const conceg_stage *stage) {
  const conceg_param *row;
  printf("%s:\n", stage->kind);
  for (row = stage->params; row && row->name; row++) {
    if (row->type == CONCEG_PARAM_FILE) continue;
    printf("  %s: %s", row->name, *row->fallback ? row->fallback : "\"\"");
    printf("  # %s%s%s%s\n", row->help ? row->help : "", row->unit && *row->unit ? " [" : "",
           row->unit ? row->unit : "", row->unit && *row->unit ? "]" : "");
  }
}

static void print_json(const conceg_stage *stage) {
  struct json json = {0};
  const conceg_param *row;
  json_open(&json, NULL, '[');
  for (row = stage->params; row && row->name; row++) {
    json_open(&json, NULL, '{');
    json_text(&json, "name", row->name);
    json_text(&json, "type", type_name(row->type));
    json_text(&json, "unit", row->unit ? row->unit : "");
    json_text(&json, "help", row->help ? row->help : "");
    json_text(&json, "default", row->fallback);
    if (row->choices) json_text(&json, "choices", row->choices);
    if (row->type == CONCEG_PARAM_F64 || row->type == CONCEG_PARAM_I64)
      json_number(&json, "lo", row->lo), json_number(&json, "hi", row->hi);
    json_close(&json, '}');
  }
  json_close(&json, ']');
}

static int print_table(struct cli *cli, int yaml) {
  conceg_registry *registry;
  const conceg_stage *stage;
  conceg_status status;
  int code = EXIT_OK;
  if (!cli->words.count)
    return cli_fail(cli, EXIT_USAGE, "which stage? usage: %s %s", cli->program->name, cli->program->usage);
  status = conceg_registry_new(cli->ctx, conceg_builtins, &registry);
  if (status != CONCEG_OK) return cli_fail_status(cli, status);
  status = conceg_registry_find(registry, cli->words.word[0], cli->impl, &stage);
  if (status != CONCEG_OK) {
    code = cli_fail_stage_missing(cli, status);
  } else if (cli->json) {
    print_json(stage);
  } else if (yaml) {
    print_yaml(stage);
  } else {
    printf("%s (%s): %s\n", stage->kind, stage->name, stage->summary ? stage->summary : "");
    cli_print_params(stdout, stage->params);
  }
  conceg_registry_free(registry);
  return code;
}

int tool_params(int argc, char **argv) {
  int yaml = 0;
  const struct cli_option options[] = {
      {"yaml", 0, NULL, "as the section of a recipe, with the defaults", &yaml, NULL, NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  const struct cli_program program = {.name = "conceg params",
                                      .usage = "STAGE [--impl NAME] [--yaml|--json]",
                                      .summary = "the parameters of a stage",
                                      .example = "conceg params grow --yaml >> recipe.yaml",
                                      .options = options,
                                      .most_words = 1};
  struct cli cli;
  int code = cli_begin(&cli, &program, argc, argv);
  if (code < 0) code = cli_close_stdout(&cli, print_table(&cli, yaml));
  return cli_end(&cli, code);
}
