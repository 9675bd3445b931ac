/* SPDX-License-Identifier: BSD-3-Clause
 * conceg validate --expect: runs a manifest of documents and says which got another verdict than expected. */
#define _POSIX_C_SOURCE 200809L
#include "expect.h"
#include "json.h"
#include "refusal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 5, LINE_BYTES = 4096 };
enum column { FILE_NAME, EXPECT, RULE, CODE, NOTE };

/* What a document turned out to be. */
struct verdict {
  const char *expect; /* valid, warned, invalid, not-a-document, carried, lost */
  char rule[8];       /* of the first problem that counts; "-" = none */
  int mixed;          /* other rules are broken as well */
  int code;
  char first[1024]; /* the first problem as one line */
};

struct runner {
  struct cli *cli;
  struct json json;
  uint64_t files, agreed, tests;
  uint32_t line;
};

static void note_problem(void *user, const conceg_problem *problem) {
  struct verdict *verdict = user;
  const int is_error = problem->severity == 0, had_error = strcmp(verdict->expect, "invalid") == 0;
  if (strcmp(verdict->rule, "-") != 0 && is_error == had_error) {
    verdict->mixed |= strcmp(verdict->rule, problem->rule) != 0;
    return;
  }
  if (had_error) return; /* a warning beside an error */
  verdict->expect = is_error ? "invalid" : "warned";
  verdict->mixed = 0;
  snprintf(verdict->rule, sizeof verdict->rule, "%s", problem->rule);
  snprintf(verdict->first, sizeof verdict->first, "%s %s: expected %s, got %s", problem->rule, problem->path,
           problem->expected, problem->got);
}

/* A document that is written and read again is the same one, and its canonical file stays as it is. */
static conceg_status carry(struct cli *cli, conceg_doc *doc, int *same) {
  char before[65], after[65];
  void *image[2] = {NULL, NULL};
  size_t count[2] = {0, 0};
  conceg_doc *again = NULL;
  conceg_status status = conceg_doc_digest(doc, "/", before);
  if (status == CONCEG_OK) status = conceg_doc_to_memory(doc, &image[0], &count[0]);
  if (status == CONCEG_OK) status = conceg_doc_from_memory(cli->ctx, image[0], count[0], &again);
  if (status == CONCEG_OK) status = conceg_doc_digest(again, "/", after);
  if (status == CONCEG_OK) status = conceg_doc_to_memory(again, &image[1], &count[1]);
  *same = status == CONCEG_OK && strcmp(before, after) == 0 && count[0] == count[1] &&
          memcmp(image[0], image[1], count[0]) == 0;
  for (int i = 0; i < 2; i++)
    conceg_free(image[i]);
  const conceg_status closed = conceg_doc_close(again);
  return status == CONCEG_OK ? closed : status;
}

/* Fills the verdict; anything but CONCEG_OK is a failure of the run itself. */
static conceg_status judge(struct cli *cli, const char *path, int carried, struct verdict *out) {
  *out = (struct verdict){.expect = "valid", .rule = "-", .code = EXIT_OK};
  conceg_doc *doc = NULL;
  conceg_status status = conceg_doc_open(cli->ctx, path, &doc);
  if (status == CONCEG_E_FORMAT || status == CONCEG_E_VERSION) {
    struct refusal refusal;
    const conceg_problem problem = refusal_problem(conceg_ctx_error(cli->ctx), path, &refusal);
    note_problem(out, &problem);
    out->expect = "not-a-document";
    out->code = exit_code(status);
    return CONCEG_OK;
  }
  if (status != CONCEG_OK) return status;
  status = conceg_doc_validate(doc, NULL, note_problem, out);
  if (status == CONCEG_E_FORMAT && strcmp(out->rule, "-") != 0) {
    out->code = EXIT_INPUT;
    status = CONCEG_OK;
  }
  if (status == CONCEG_OK && carried && out->code == EXIT_OK) {
    int same = 0;
    status = carry(cli, doc, &same);
    out->expect = same ? "carried" : "lost";
  }
  const conceg_status closed = conceg_doc_close(doc);
  return status == CONCEG_OK ? closed : status;
}

static void tell(struct runner *runner, char *const column[COLUMNS], const struct verdict *got, int agreed) {
  if (runner->cli->json) {
    json_open(&runner->json, NULL, '{');
    json_text(&runner->json, "file", column[FILE_NAME]);
    json_text(&runner->json, "expected", column[EXPECT]);
    json_text(&runner->json, "expected_rule", column[RULE]);
    json_text(&runner->json, "got", got->expect);
    json_text(&runner->json, "got_rule", got->rule);
    json_whole(&runner->json, "exit", (uint64_t)got->code);
    json_flag(&runner->json, "agrees", agreed);
    json_close(&runner->json, '}');
  } else if (!agreed) {
    printf("%s: expected %s %s, exit %s; got %s %s%s, exit %d%s%s\n", column[FILE_NAME], column[EXPECT],
           column[RULE], column[CODE], got->expect, got->rule, got->mixed ? " and other rules" : "",
           got->code, *got->first ? ": " : "", got->first);
  }
}

static int run_row(struct runner *runner, const char *folder, char *const column[COLUMNS]) {
  char path[2 * LINE_BYTES];
  struct verdict got;
  if (strcmp(column[EXPECT], "test") == 0) { /* a rule for programs: the note names its test */
    runner->tests++;
    return EXIT_OK;
  }
  snprintf(path, sizeof path, "%s%s", folder, column[FILE_NAME]);
  const conceg_status status = judge(runner->cli, path, strcmp(column[EXPECT], "carried") == 0, &got);
  if (status != CONCEG_OK) return cli_fail_status(runner->cli, status);
  const int agreed = strcmp(got.expect, column[EXPECT]) == 0 && strcmp(got.rule, column[RULE]) == 0 &&
                     !got.mixed && got.code == atoi(column[CODE]);
  runner->files++;
  runner->agreed += (uint64_t)agreed;
  tell(runner, column, &got, agreed);
  return EXIT_OK;
}

/* Cuts a line at its tabs. 0 when it has another number of columns. */
static int split(char *line, char *column[COLUMNS]) {
  int count = 0;
  line[strcspn(line, "\r\n")] = '\0';
  for (char *at = line; at && count <= COLUMNS; count++) {
    char *tab = strchr(at, '\t');
    if (tab) *tab++ = '\0';
    if (count < COLUMNS) column[count] = at;
    at = tab;
  }
  return count == COLUMNS;
}

static int run_rows(struct runner *runner, FILE *file, const char *path) {
  char folder[LINE_BYTES] = "", line[LINE_BYTES], *column[COLUMNS];
  const char *slash = strrchr(path, '/');
  int code = EXIT_OK;
  if (slash) snprintf(folder, sizeof folder, "%.*s/", (int)(slash - path), path);
  while (code == EXIT_OK && fgets(line, sizeof line, file)) {
    runner->line++;
    if (*line == '#' || line[strspn(line, "\r\n")] == '\0') continue;
    if (!split(line, column))
      return cli_fail(runner->cli, EXIT_INPUT,
                      "%s:%u: expected five columns between tabs: file, verdict, rule, exit code, note", path,
                      runner->line);
    code = run_row(runner, folder, column);
  }
  return code;
}

int expect_manifest(struct cli *cli, const char *path) {
  struct runner runner = {.cli = cli};
  FILE *file = fopen(path, "r");
  if (!file) return cli_fail(cli, EXIT_IO, "%s: cannot be opened: %s", path, strerror(errno));
  if (cli->json) json_open(&runner.json, NULL, '{'), json_open(&runner.json, "rows", '[');
  int code = run_rows(&runner, file, path);
  if (ferror(file)) code = cli_fail(cli, EXIT_IO, "%s: cannot be read", path);
  fclose(file);
  const uint64_t deviant = runner.files - runner.agreed;
  if (cli->json) {
    json_close(&runner.json, ']');
    json_whole(&runner.json, "files", runner.files);
    json_whole(&runner.json, "as_expected", runner.agreed);
    json_whole(&runner.json, "not", deviant);
    json_close(&runner.json, '}');
  }
  if (code != EXIT_OK) return code;
  if (!runner.files) return cli_fail(cli, EXIT_INPUT, "%s: expected at least one file, got none", path);
  if (!cli->json && (!cli->quiet || deviant))
    printf("%llu files: %llu as expected, %llu not; %llu rules are left to tests of programs\n",
           (unsigned long long)runner.files, (unsigned long long)runner.agreed, (unsigned long long)deviant,
           (unsigned long long)runner.tests);
  return deviant ? EXIT_STAGE : EXIT_OK;
}
