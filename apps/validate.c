/* SPDX-License-Identifier: BSD-3-Clause
 * conceg validate: every broken rule of the format, one line each. */
#include "array_text.h"
#include "expect.h"
#include "json.h"
#include "refusal.h"
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
  json_open(&report->json, "index", '[');
  for (uint32_t axis = 0; axis < problem->rank; axis++)
    json_whole(&report->json, NULL, problem->index[axis]);
  json_close(&report->json, ']');
  json_text(&report->json, "expected", problem->expected);
  json_text(&report->json, "got", problem->got);
  json_close(&report->json, '}');
}

static void print_summary(struct report *report, const char *name, uint32_t arrays, int code) {
  if (report->as_json) {
    json_close(&report->json, ']');
    json_text(&report->json, "file", name ? name : "-");
    json_whole(&report->json, "arrays_checked", arrays);
    json_whole(&report->json, "errors", report->errors);
    json_whole(&report->json, "warnings", report->warnings);
    json_flag(&report->json, "valid", code == EXIT_OK);
    json_close(&report->json, '}');
  } else if (!report->quiet || code != EXIT_OK) {
    printf("%s: %s: %u arrays and attributes checked against CGX %u.%u, %llu errors, %llu warnings\n",
           name ? name : "standard input", code == EXIT_OK ? "valid" : "NOT VALID", arrays, CONCEG_CGX_MAJOR,
           CONCEG_CGX_MINOR, (unsigned long long)report->errors, (unsigned long long)report->warnings);
  }
}

/* The error line stands on standard error already; here it is one more broken rule. */
static void print_refusal(struct cli *cli, struct report *report, const char *name) {
  struct refusal refusal;
  const conceg_problem problem = refusal_problem(
      conceg_ctx_error(cli->ctx), name && strcmp(name, "-") ? name : "standard input", &refusal);
  print_problem(report, &problem);
}

static int validate_file(struct cli *cli, const char *name, const char *group) {
  struct report report = {.as_json = cli->json, .quiet = cli->quiet};
  struct words arrays = {0};
  conceg_doc *doc = NULL;
  int code = cli_open(cli, name, &doc);
  if (code != EXIT_OK && code != EXIT_INPUT) return code;
  if (report.as_json) json_open(&report.json, NULL, '{'), json_open(&report.json, "problems", '[');
  if (code == EXIT_INPUT) {
    print_refusal(cli, &report, name);
  } else {
    list_arrays(cli, doc, group ? group : "/", &arrays);
    const conceg_status status = conceg_doc_validate(doc, group, print_problem, &report);
    if (status != CONCEG_OK) code = status == CONCEG_E_FORMAT ? EXIT_INPUT : cli_fail_status(cli, status);
  }
  print_summary(&report, name, arrays.count, code);
  words_free(&arrays);
  if (conceg_doc_close(doc) != CONCEG_OK && code == EXIT_OK) code = cli_fail_status(cli, CONCEG_E_IO);
  return code;
}

/* All files, whatever the first ones are; the exit code of the first that failed. */
static int validate_files(struct cli *cli, const char *group) {
  if (!cli->words.count) return validate_file(cli, NULL, group);
  int code = EXIT_OK;
  for (uint32_t i = 0; i < cli->words.count; i++) {
    const int one = validate_file(cli, cli->words.word[i], group);
    if (code == EXIT_OK) code = one;
  }
  return code;
}

int tool_validate(int argc, char **argv) {
  const char *group = NULL, *manifest = NULL;
  const struct cli_option options[] = {
      {"group", 0, "GROUP", "check only this group, such as /cells", NULL, &group, NULL},
      {"expect", 0, "MANIFEST", "the files of a manifest, each with its verdict (spec/conformance)", NULL,
       &manifest, NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  const struct cli_program program = {.name = "conceg validate",
                                      .usage = "[FILE.cgx ...] [options]",
                                      .summary =
                                          "check a document against every rule of the format (spec/cgx.md)",
                                      .example = "conceg validate cube.cgx && echo good",
                                      .options = options,
                                      .most_words = UINT32_MAX};
  struct cli cli;
  int code = cli_begin(&cli, &program, argc, argv);
  if (code < 0 && manifest && (group || cli.words.count))
    code = cli_fail(&cli, EXIT_USAGE, "--expect names the files itself: leave out files and --group");
  if (code < 0)
    code = cli_close_stdout(&cli, manifest ? expect_manifest(&cli, manifest) : validate_files(&cli, group));
  return cli_end(&cli, code);
}
