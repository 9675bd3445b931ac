/* SPDX-License-Identifier: BSD-3-Clause
 * conceg validate: every broken rule of the format, one line each. */
#include "array_text.h"
#include "json.h"
#include "tools.h"

#include <string.h>

struct report {
  int as_json, quiet;
  struct json json;
  uint64_t errors, warnings;
};

static void print_problem(void *user, const conceg_problem *problem) {
  struct report *report = user;
  const int is_error = problem->severity == 0;
  if (report->quiet && !is_error) return;
  if (is_error)
    report->errors++;
  else
    report->warnings++;
  if (!report->as_json) {
    printf("%s %s %s: expected %s, got %s\n", is_error ? "error" : "warning", problem->rule, problem->path,
           problem->expected, problem->got);
    return;
  }
  json_open(&report->json, NULL, '{');
  json_text(&report->json, "severity", is_error ? "error" : "warning");
  json_text(&report->json, "rule", problem->rule);
  json_text(&report->json, "path", problem->path);
  json_text(&report->json, "expected", problem->expected);
  json_text(&report->json, "got", problem->got);
  json_close(&report->json, '}');
}

static int validate_file(struct cli *cli, const char *name, const char *group) {
  struct report report = {.as_json = cli->json, .quiet = cli->quiet};
  struct words arrays = {0};
  conceg_doc *doc = NULL;
  conceg_status status;
  int code = cli_open(cli, name, &doc);
  if (code != EXIT_OK) return code;
  list_arrays(cli, doc, group ? group : "/", &arrays);
  if (report.as_json) json_open(&report.json, NULL, '{'), json_open(&report.json, "problems", '[');
  status = conceg_doc_validate(doc, group, print_problem, &report);
  if (status != CONCEG_OK && status != CONCEG_E_FORMAT)
    code = cli_fail_status(cli, status);
  else if (status != CONCEG_OK)
    code = EXIT_INPUT;
  if (report.as_json) {
    json_close(&report.json, ']');
    json_text(&report.json, "file", name ? name : "-");
    json_whole(&report.json, "arrays_checked", arrays.count);
    json_whole(&report.json, "errors", report.errors);
    json_whole(&report.json, "warnings", report.warnings);
    json_flag(&report.json, "valid", code == EXIT_OK);
    json_close(&report.json, '}');
  } else if (!report.quiet || code != EXIT_OK) {
    printf("%s: %s: %u arrays and attributes checked against CGX %u.%u, %llu errors, %llu warnings\n",
           name ? name : "standard input", code == EXIT_OK ? "valid" : "NOT VALID", arrays.count,
           CONCEG_CGX_MAJOR, CONCEG_CGX_MINOR, (unsigned long long)report.errors,
           (unsigned long long)report.warnings);
  }
  words_free(&arrays);
  if (conceg_doc_close(doc) != CONCEG_OK && code == EXIT_OK) code = cli_fail_status(cli, CONCEG_E_IO);
  return code;
}

int tool_validate(int argc, char **argv) {
  const char *group = NULL;
  const struct cli_option options[] = {
      {"group", 0, "GROUP", "check only this group, such as /cells", NULL, &group, NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  const struct cli_program program = {.name = "conceg validate",
                                      .usage = "[FILE.cgx] [options]",
                                      .summary =
                                          "check a document against every rule of the format (spec/cgx.md)",
                                      .example = "conceg validate cube.cgx && echo good",
                                      .options = options,
                                      .most_words = 1};
  struct cli cli;
  int code = cli_begin(&cli, &program, argc, argv);
  if (code < 0)
    code = cli_close_stdout(&cli, validate_file(&cli, cli.words.count ? cli.words.word[0] : NULL, group));
  return cli_end(&cli, code);
}
