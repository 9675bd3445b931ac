/* SPDX-License-Identifier: BSD-3-Clause
 * conceg swc check: every problem of SWC files, and whether they are accepted. */
#include "json.h"
#include "swc.h"

#include <string.h>

#define MOST_CODES 64

struct tally {
  const char *code[MOST_CODES];
  uint64_t count[MOST_CODES];
  uint32_t codes;
};

struct report {
  struct cli *cli;
  uint32_t flags;
  struct json json;
  struct tally warnings, errors;
  uint64_t accepted, refused, unread;
};

static void count_code(struct tally *tally, const char *code) {
  uint32_t i = 0;
  while (i < tally->codes && strcmp(tally->code[i], code) != 0)
    i++;
  if (i == MOST_CODES) return; /* the library has fewer */
  if (i == tally->codes) tally->code[tally->codes++] = code, tally->count[i] = 0;
  tally->count[i]++;
}

static void print_tally(const char *name, const struct tally *tally) {
  uint32_t i;
  if (!tally->codes) return;
  printf("; %s:", name);
  for (i = 0; i < tally->codes; i++)
    printf("%s %s %llu", i ? "," : "", tally->code[i], (unsigned long long)tally->count[i]);
}

static void json_tally(struct json *json, const char *name, const struct tally *tally) {
  uint32_t i;
  json_open(json, name, '{');
  for (i = 0; i < tally->codes; i++)
    json_whole(json, tally->code[i], tally->count[i]);
  json_close(json, '}');
}

static void print_problem(struct report *report, const char *path, uint32_t severity, uint32_t line,
                          const char *code, const char *text) {
  if (report->cli->json) {
    json_open(&report->json, NULL, '{');
    json_text(&report->json, "severity", severity ? "warning" : "error");
    json_whole(&report->json, "line", line);
    json_text(&report->json, "code", code);
    json_text(&report->json, "text", text);
    json_close(&report->json, '}');
  } else if (line)
    printf("%s:%u: %s: %s\n", path, line, code, text);
  else
    printf("%s: %s: %s\n", path, code, text);
}

static void print_verdict(struct report *report, const char *path, const conceg_swc *swc, int accepted,
                          uint64_t errors, uint64_t warnings) {
  static const char *const form[] = {"none", "point", "three points", "chain", "outline", "tree"};
  struct json *const json = &report->json;
  double radius = 0.0;
  const conceg_soma_form soma = conceg_swc_soma(swc, NULL, &radius);
  if (report->cli->json) {
    json_flag(json, "accepted", accepted);
    json_whole(json, "errors", errors), json_whole(json, "warnings", warnings);
    json_whole(json, "samples", conceg_swc_count(swc)), json_whole(json, "cells", conceg_swc_cell_count(swc));
    json_text(json, "soma", form[soma]), json_number(json, "soma_radius_um", radius);
  } else if (!accepted)
    printf("%s: REFUSED, %llu errors, %llu warnings\n", path, (unsigned long long)errors,
           (unsigned long long)warnings);
  else if (!report->cli->quiet)
    printf("%s: accepted, %llu warnings, %llu samples, soma: %s\n", path, (unsigned long long)warnings,
           (unsigned long long)conceg_swc_count(swc), form[soma]);
}

static void check_file(struct report *report, const char *path) {
  struct cli *const cli = report->cli;
  conceg_swc *swc = NULL;
  const conceg_status status = conceg_swc_read(cli->ctx, path, report->flags, &swc);
  uint64_t errors = 0, warnings = 0;
  uint32_t i, severity, line;
  const char *code, *text;
  progress_clear(&cli->progress);
  if (cli->json) json_open(&report->json, NULL, '{'), json_text(&report->json, "file", path);
  if (status != CONCEG_OK && status != CONCEG_E_FORMAT) {
    report->unread++;
    if (cli->json)
      json_flag(&report->json, "accepted", 0),
          json_text(&report->json, "not_read", conceg_ctx_error(cli->ctx));
    else
      printf("NOT READ: %s\n", conceg_ctx_error(cli->ctx));
  } else {
    if (cli->json) json_open(&report->json, "problems", '[');
    for (i = 0; conceg_swc_problem(swc, i, &severity, &line, &code, &text); i++) {
      count_code(severity ? &report->warnings : &report->errors, code);
      if (severity)
        warnings++;
      else
        errors++;
      if (!severity || !cli->quiet) print_problem(report, path, severity, line, code, text);
    }
    if (cli->json) json_close(&report->json, ']');
    print_verdict(report, path, swc, status == CONCEG_OK, errors, warnings);
    if (status == CONCEG_OK)
      report->accepted++;
    else
      report->refused++;
  }
  if (cli->json) json_close(&report->json, '}');
  conceg_swc_free(swc);
}

static void print_summary(struct report *report, uint32_t files) {
  struct json *const json = &report->json;
  if (report->cli->json) {
    json_close(json, ']');
    json_whole(json, "files_named", files);
    json_whole(json, "read", report->accepted + report->refused);
    json_whole(json, "accepted", report->accepted), json_whole(json, "refused", report->refused);
    json_whole(json, "not_read", report->unread);
    json_tally(json, "errors", &report->errors), json_tally(json, "warnings", &report->warnings);
    json_close(json, '}');
    return;
  }
  if (report->cli->quiet && !report->refused && !report->unread) return;
  printf("%llu files read%s: %llu accepted, %llu refused",
         (unsigned long long)(report->accepted + report->refused),
         report->flags & CONCEG_SWC_STRICT ? " strictly" : "", (unsigned long long)report->accepted,
         (unsigned long long)report->refused);
  print_tally("errors", &report->errors);
  print_tally("warnings", &report->warnings);
  putchar('\n');
}

static int check_files(struct cli *cli, uint32_t flags) {
  struct report report = {.cli = cli, .flags = flags};
  struct swc_files files = {0};
  uint32_t i;
  int code;
  if (!cli->words.count)
    return cli_fail(cli, EXIT_USAGE, "which files? usage: %s %s", cli->program->name, cli->program->usage);
  code = swc_list(cli, &cli->words, &files);
  if (code == EXIT_OK && cli->json) json_open(&report.json, NULL, '{'), json_open(&report.json, "files", '[');
  for (i = 0; i < files.count && code == EXIT_OK; i++) {
    if (progress_report(&cli->progress, "files", i, files.count))
      code = cli_fail(cli, EXIT_CANCELLED, "cancelled after %u of %u files", i, files.count);
    else
      check_file(&report, files.file[i].path);
  }
  progress_clear(&cli->progress);
  if (code == EXIT_OK) {
    print_summary(&report, files.count);
    if (report.unread)
      code = cli_fail(cli, EXIT_IO, "%llu of %u files could not be read", (unsigned long long)report.unread,
                      files.count);
    else if (report.refused)
      code = cli_fail(cli, EXIT_INPUT, "%llu of %u files refused", (unsigned long long)report.refused,
                      files.count);
  }
  swc_list_free(&files);
  return code;
}

int swc_check(int argc, char **argv) {
  const char *floating = NULL, *somata = NULL;
  int strict = 0;
  uint32_t flags = 0;
  const struct cli_option options[] = {
      {"strict", 0, NULL, "refuse what other programs would not read", &strict, NULL, NULL},
      {"somata", 0, "refuse|split", "several somata: an error (default), or a cell each", NULL, &somata,
       NULL},
      {"floating", 0, "keep|drop|attach", "trees beside the soma: kept (default), left out, or joined to it",
       NULL, &floating, NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  const struct cli_program program = {
      .name = "conceg swc check",
      .usage = "FILES|FOLDERS... [--strict] [--json] [options]",
      .summary = "every problem of SWC files (spec/swc-plus.md), and whether they are accepted",
      .example = "conceg swc check --strict cells/",
      .options = options,
      .most_words = UINT32_MAX};
  struct cli cli;
  int code = cli_begin(&cli, &program, argc, argv);
  if (code < 0) {
    code = swc_choices(&cli, floating, somata, &flags);
    if (code == EXIT_OK) code = check_files(&cli, flags | (strict ? CONCEG_SWC_STRICT : 0));
    code = cli_close_stdout(&cli, code);
  }
  return cli_end(&cli, code);
}
