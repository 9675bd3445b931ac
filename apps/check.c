/* SPDX-License-Identifier: BSD-3-Clause
 * conceg check: every integrity gate, one line each. The stage of the same name looks; this prints. */
#include "array_text.h"
#include "contain.h"
#include "json.h"
#include "tools.h"

#include <string.h>

enum column { GROUP, GATE, VERDICT, VALUE, UNIT, RULE, LOOKED_AT, COLUMNS };

struct gates {
  conceg_array column[COLUMNS];
  uint64_t rows, passed, failed, no_verdict;
};

static const char *text_at(const struct gates *gates, enum column column, uint64_t row) {
  return value_string(&gates->column[column], row);
}

static int read_gates(struct cli *cli, conceg_doc *doc, struct gates *out) {
  static const char *const names[COLUMNS] = {"group",      "gate", "verdict",  "value",
                                             "value_unit", "rule", "looked_at"};
  uint64_t row;
  int i;
  memset(out, 0, sizeof *out);
  for (i = 0; i < COLUMNS; i++) {
    const char *path = cli_keep(cli, "/statistics/gates/%s", names[i]);
    const int code = read_array(cli, doc, path, &out->column[i]);
    if (code != EXIT_OK) return code;
    if (out->column[i].rank != 1 || (out->column[i].dtype == CONCEG_TEXT) == (i == VALUE) ||
        (i && out->column[i].shape[0] != out->rows))
      return cli_fail(cli, EXIT_STAGE, "%s: the stage wrote another table than that of the gates", path);
    out->rows = out->column[0].shape[0];
  }
  for (row = 0; row < out->rows; row++) {
    const char *verdict = text_at(out, VERDICT, row);
    uint64_t *count = !strcmp(verdict, "passed")   ? &out->passed
                      : !strcmp(verdict, "failed") ? &out->failed
                                                   : &out->no_verdict;
    ++*count;
  }
  return EXIT_OK;
}

static int is_void(const struct gates *gates, uint64_t row) {
  return !strcmp(text_at(gates, VERDICT, row), "void");
}

/* "0.0003 (at most 0.005)" */
static const char *measure_text(struct cli *cli, const struct gates *gates, uint64_t row) {
  const char *unit = text_at(gates, UNIT, row);
  const int named = *unit && strcmp(unit, "1") != 0;
  if (is_void(gates, row)) return "-";
  return cli_keep(cli, "%.6g%s%s (%s)", value_number(&gates->column[VALUE], row), named ? " " : "",
                  named ? unit : "", text_at(gates, RULE, row));
}

static void print_lines(struct cli *cli, const struct gates *gates) {
  uint64_t row;
  for (row = 0; row < gates->rows; row++) {
    if (cli->quiet && strcmp(text_at(gates, VERDICT, row), "failed") != 0) continue;
    printf("%-6s  %-10s %-33s %-30s %s\n", text_at(gates, VERDICT, row), text_at(gates, GROUP, row),
           text_at(gates, GATE, row), measure_text(cli, gates, row), text_at(gates, LOOKED_AT, row));
  }
}

static void print_json(const struct gates *gates, const char *name) {
  struct json json = {0};
  uint64_t row;
  json_open(&json, NULL, '{');
  json_text(&json, "file", name);
  json_open(&json, "gates", '[');
  for (row = 0; row < gates->rows; row++) {
    json_open(&json, NULL, '{');
    json_text(&json, "group", text_at(gates, GROUP, row));
    json_text(&json, "gate", text_at(gates, GATE, row));
    json_text(&json, "verdict", text_at(gates, VERDICT, row));
    if (!is_void(gates, row)) {
      json_number(&json, "value", value_number(&gates->column[VALUE], row));
      json_text(&json, "unit", text_at(gates, UNIT, row));
      json_text(&json, "rule", text_at(gates, RULE, row));
    }
    json_text(&json, "looked_at", text_at(gates, LOOKED_AT, row));
    json_close(&json, '}');
  }
  json_close(&json, ']');
  json_whole(&json, "passed", gates->passed);
  json_whole(&json, "failed", gates->failed);
  json_whole(&json, "void", gates->no_verdict);
  json_flag(&json, "sound", gates->failed == 0);
  json_close(&json, '}');
}

static void print_gates(struct cli *cli, const struct gates *gates, const char *name) {
  if (cli->json) {
    print_json(gates, name);
    return;
  }
  print_lines(cli, gates);
  if (!cli->quiet || gates->failed)
    printf("%s: %s: %llu gates passed, %llu failed, %llu void\n", name, gates->failed ? "NOT SOUND" : "sound",
           (unsigned long long)gates->passed, (unsigned long long)gates->failed,
           (unsigned long long)gates->no_verdict);
}

struct check {
  struct cli cli;
  conceg_registry *registry;
  conceg_recipe *recipe;
};

static int look(struct check *check, conceg_doc *doc) {
  struct cli *cli = &check->cli;
  const conceg_stage *stage;
  conceg_params *params = NULL;
  conceg_status status =
      conceg_registry_find(check->registry, "check", cli_impl(cli, "check", check->recipe, doc), &stage);
  if (status != CONCEG_OK) return cli_fail_stage_missing(cli, status);
  status = conceg_params_new(cli->ctx, stage, doc, check->recipe, cli->sets.word, NULL, &params);
  if (status == CONCEG_OK) status = contain_stage(cli, stage, doc, params);
  conceg_params_free(params);
  return status == CONCEG_OK ? EXIT_OK : cli_fail_status(cli, status);
}

static int check_file(struct check *check, const char *path) {
  struct cli *cli = &check->cli;
  struct gates gates;
  conceg_doc *doc = NULL;
  int code = cli_open(cli, path, &doc);
  if (code == EXIT_OK) code = look(check, doc);
  if (code == EXIT_OK) code = read_gates(cli, doc, &gates);
  if (code == EXIT_OK) {
    print_gates(cli, &gates, path && strcmp(path, "-") ? path : "standard input");
    if (cli->output) code = cli_save(cli, doc, cli->output);
    if (code == EXIT_OK && gates.failed) code = EXIT_STAGE;
  }
  if (conceg_doc_close(doc) != CONCEG_OK && code == EXIT_OK) code = cli_fail_status(cli, CONCEG_E_IO);
  return code;
}

/* All files, whatever the first ones are; the exit code of the first that failed. */
static int check_files(struct check *check) {
  struct cli *cli = &check->cli;
  conceg_status status = conceg_registry_new(cli->ctx, conceg_builtins, &check->registry);
  uint32_t i;
  int code = EXIT_OK;
  if (status == CONCEG_OK && cli->recipe) status = conceg_recipe_load(cli->ctx, cli->recipe, &check->recipe);
  if (status != CONCEG_OK) return cli_fail_status(cli, status);
  if (cli->output && cli->words.count > 1)
    return cli_fail(cli, EXIT_USAGE, "-o takes one document with its gates; give one FILE.cgx");
  if (cli->output && !strcmp(cli->output, "-"))
    return cli_fail(cli, EXIT_USAGE, "-o -: the gates are printed there; give a file");
  if (cli->output) code = cli_check_output(cli, cli->output);
  if (code != EXIT_OK) return code;
  if (!cli->words.count) return check_file(check, NULL);
  for (i = 0; i < cli->words.count; i++) {
    const int one = check_file(check, cli->words.word[i]);
    if (code == EXIT_OK) code = one;
  }
  return code;
}

static const conceg_stage *own_stage(void) {
  uint32_t i;
  for (i = 0; conceg_builtins[i]; i++)
    if (!strcmp(conceg_builtins[i]->kind, "check")) return conceg_builtins[i];
  return NULL;
}

int tool_check(int argc, char **argv) {
  const conceg_stage *stage = own_stage();
  const struct cli_program program = {.name = "conceg check",
                                      .usage = "[FILE.cgx ...] [options]",
                                      .summary =
                                          "whether a document can be believed: every integrity gate, one "
                                          "line each; exit code 1 when one failed",
                                      .example = "conceg check cube.cgx && echo sound",
                                      .kind = "check",
                                      .params = stage ? stage->params : NULL,
                                      .most_words = UINT32_MAX};
  struct check check;
  int code;
  memset(&check, 0, sizeof check);
  code = cli_begin(&check.cli, &program, argc, argv);
  if (code < 0) code = cli_close_stdout(&check.cli, check_files(&check));
  conceg_recipe_free(check.recipe);
  conceg_registry_free(check.registry);
  return cli_end(&check.cli, code);
}
