/* SPDX-License-Identifier: BSD-3-Clause
 * Input, output, messages and the life of a program. The parser is in cli_parse.c. */
#define _GNU_SOURCE
#include "cli.h"

#include "cli_parse.h"
#include "contain.h"
#include "help.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char *cli_without_word(const struct cli_program *program, const char *line) {
  const size_t length = program->kind ? strlen(program->kind) : 0;
  return length && !strncmp(line, program->kind, length) && !strncmp(line + length, ": ", 2)
             ? line + length + 2
             : line;
}

static void print_log(void *user, conceg_log_level level, const char *line) {
  static const char *const words[] = {"error", "warning", NULL, "note", "debug"};
  struct cli *cli = user;
  progress_clear(&cli->progress);
  if (level == CONCEG_LOG_RESULT) {
    fprintf(stderr, "%s\n", cli_without_word(cli->program, line));
    return;
  }
  fprintf(stderr, "%s: %s: %s\n", cli->program->name,
          words[level > CONCEG_LOG_DEBUG ? CONCEG_LOG_DEBUG : level], cli_without_word(cli->program, line));
}

int cli_fail(struct cli *cli, int code, const char *format, ...) {
  va_list arguments;
  progress_clear(&cli->progress);
  fprintf(stderr, "%s: error: ", cli->program->name);
  va_start(arguments, format);
  vfprintf(stderr, format, arguments);
  va_end(arguments);
  fputc('\n', stderr);
  return code;
}

int cli_fail_status(struct cli *cli, conceg_status status) {
  const char *line = conceg_ctx_error(cli->ctx);
  return cli_fail(cli, exit_code(status), "%s",
                  line && *line ? cli_without_word(cli->program, line) : conceg_status_text(status));
}

int cli_fail_stage_missing(struct cli *cli, conceg_status status) {
  const int code = cli_fail_status(cli, status);
  return status == CONCEG_E_MISSING ? EXIT_MISSING : code;
}

/* 1K, 4G: bytes. Returns 0 when the text is not a size. */
static int parse_bytes(const char *text, uint64_t *out) {
  static const char suffixes[] = "KMGT";
  char *end;
  const char *suffix;
  unsigned long long value;
  unsigned shift = 0;
  errno = 0;
  value = strtoull(text, &end, 10);
  if (end == text || *text == '-' || errno || !value) return 0;
  if (*end) {
    suffix = strchr(suffixes, *end);
    if (!suffix || (end[1] && strcmp(end + 1, "B") != 0 && strcmp(end + 1, "iB") != 0)) return 0;
    shift = 10u * (unsigned)(suffix - suffixes + 1);
  }
  if (value > UINT64_MAX >> shift) return 0;
  *out = (uint64_t)value << shift;
  return 1;
}

static int parse_count(const char *text, uint64_t most, uint64_t *out) {
  char *end;
  errno = 0;
  *out = strtoull(text, &end, 10);
  return end != text && !*end && *text != '-' && !errno && *out <= most;
}

static int set_up(struct cli *cli) {
  enum progress_mode mode = PROGRESS_AUTO;
  uint64_t value;
  if (cli->progress_word && !strcmp(cli->progress_word, "json"))
    mode = PROGRESS_JSON;
  else if (cli->progress_word && !strcmp(cli->progress_word, "none"))
    mode = PROGRESS_NONE;
  else if (cli->progress_word && strcmp(cli->progress_word, "auto") != 0)
    return cli_fail(cli, EXIT_USAGE, "--progress %s: expected auto, json or none", cli->progress_word);
  if (cli->quiet && mode == PROGRESS_AUTO) mode = PROGRESS_NONE;
  progress_init(&cli->progress, mode, cli->program->name, cli->program->kind);
  cli->ctx = conceg_ctx_new();
  if (!cli->ctx) return cli_fail(cli, EXIT_STAGE, "out of memory");
  conceg_ctx_set_log(cli->ctx,
                     cli->quiet         ? CONCEG_LOG_ERROR
                     : cli->verbose > 1 ? CONCEG_LOG_DEBUG
                     : cli->verbose     ? CONCEG_LOG_INFO
                                        : CONCEG_LOG_RESULT,
                     print_log, cli);
  conceg_ctx_set_progress(cli->ctx, progress_report, &cli->progress);
  if (cli->threads) {
    if (!parse_count(cli->threads, 256, &value))
      return cli_fail(cli, EXIT_USAGE, "--threads %s: expected a number from 0 (all) to 256", cli->threads);
    conceg_ctx_set_threads(cli->ctx, (uint32_t)value);
  }
  if (cli->memory) {
    if (!parse_bytes(cli->memory, &value))
      return cli_fail(cli, EXIT_USAGE, "--memory %s: expected a size such as 512M or 4G", cli->memory);
    conceg_ctx_set_memory(cli->ctx, value);
  }
  if (cli->seed) {
    if (!parse_count(cli->seed, INT64_MAX, &value))
      return cli_fail(cli, EXIT_USAGE, "--seed %s: expected a whole number from 0 to 9223372036854775807",
                      cli->seed);
    words_add(&cli->sets, cli_keep(cli, "seed=%llu", (unsigned long long)value));
  }
  if (cli->impl && cli->program->kind)
    words_add(&cli->sets, cli_keep(cli, "%s.impl='%s'", cli->program->kind, cli->impl));
  return -1;
}

int cli_begin(struct cli *cli, const struct cli_program *program, int argc, char **argv) {
  int code;
  memset(cli, 0, sizeof *cli);
  cli->program = program;
  streams_occupy();
  signals_catch();
  code = cli_parse(cli, argc, argv);
  if (code != EXIT_OK) return code;
  if (cli->help) {
    if (!help_print(program, cli->help_format))
      return cli_fail(cli, EXIT_USAGE, "--help=%s: expected plain, man or list", cli->help_format);
    return cli_close_stdout(cli, EXIT_OK);
  }
  if (cli->version) {
    printf("%s (ConCeG) %s\nlibconceg %s, CGX %u.%u, stage ABI %u\nlibraries: %s\nlicence of this program as "
           "built: %s\n",
           program->name, CONCEG_VERSION_TEXT, conceg_version(), CONCEG_CGX_MAJOR, CONCEG_CGX_MINOR,
           CONCEG_STAGE_ABI, conceg_libraries, conceg_licence);
    return cli_close_stdout(cli, EXIT_OK);
  }
  return set_up(cli);
}

int cli_end(struct cli *cli, int code) {
  uint32_t i;
  progress_clear(&cli->progress);
  conceg_ctx_free(cli->ctx);
  words_free(&cli->sets);
  words_free(&cli->words);
  words_free(&cli->unquoted);
  for (i = 0; i < cli->owned.count; i++)
    free((void *)(uintptr_t)cli->owned.word[i]);
  words_free(&cli->owned);
  return code != EXIT_OK && signals_cancelled() ? EXIT_CANCELLED : code;
}

/* ---- Input and output ---- */

static int is_stdio(const char *path) {
  return !path || !strcmp(path, "-");
}

int cli_open(struct cli *cli, const char *path, conceg_doc **out) {
  conceg_status status;
  if (is_stdio(path) && isatty(STDIN_FILENO)) {
    fprintf(stderr, "usage: %s %s\n", cli->program->name, cli->program->usage);
    return cli_fail(cli, EXIT_USAGE,
                    "no input: name a .cgx file, or pipe a document into standard input (--help says more)");
  }
  progress_phase(&cli->progress, "read", cli->program->kind);
  contain_input(cli, is_stdio(path) ? "standard input" : path);
  signals_waiting(1);
  status = conceg_doc_open(cli->ctx, is_stdio(path) ? "-" : path, out);
  signals_waiting(0);
  if (status == CONCEG_OK) return EXIT_OK;
  return cli_fail_status(cli, status);
}

int cli_check_output(struct cli *cli, const char *output) {
  struct stat info;
  char folder[4096];
  const char *slash;
  if (is_stdio(output)) {
    if (!isatty(STDOUT_FILENO)) return EXIT_OK;
    return cli_fail(cli, EXIT_USAGE,
                    "standard output is a terminal and a document is binary: use -o FILE, or pipe it into "
                    "the next program");
  }
  slash = strrchr(output, '/');
  if (slash && (size_t)(slash - output) >= sizeof folder)
    return cli_fail(cli, EXIT_IO, "%s: the path is too long", output);
  snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - output) : 1, slash ? output : ".");
  if (!*folder) snprintf(folder, sizeof folder, "/");
  if (stat(folder, &info) || !S_ISDIR(info.st_mode))
    return cli_fail(cli, EXIT_IO, "%s: cannot be written: the folder %s is not there", output, folder);
  if (!stat(output, &info) && S_ISDIR(info.st_mode))
    return cli_fail(cli, EXIT_IO, "%s: is a folder; name a file", output);
  return EXIT_OK;
}

int cli_save(struct cli *cli, conceg_doc *doc, const char *output) {
  conceg_status status;
  if (signals_cancelled()) return cli_fail(cli, EXIT_CANCELLED, "cancelled; nothing was written");
  progress_phase(&cli->progress, "write", cli->program->kind);
  status = conceg_doc_save(doc, is_stdio(output) ? "-" : output);
  if (status != CONCEG_OK) return cli_fail_status(cli, status);
  if (is_stdio(output) && close(STDOUT_FILENO))
    return cli_fail(cli, EXIT_IO, "standard output: %s", strerror(errno));
  return EXIT_OK;
}

int cli_close_stdout(struct cli *cli, int code) {
  errno = 0;
  if (fflush(stdout) || ferror(stdout) || fclose(stdout))
    return cli_fail(cli, EXIT_IO, "standard output: %s", errno ? strerror(errno) : "write failed");
  return code;
}

const char *cli_keep(struct cli *cli, const char *format, ...) {
  va_list arguments;
  char *text = NULL;
  va_start(arguments, format);
  if (vasprintf(&text, format, arguments) < 0) text = NULL;
  va_end(arguments);
  if (!text) {
    fprintf(stderr, "%s: error: out of memory\n", cli->program->name);
    exit(EXIT_STAGE);
  }
  words_add(&cli->owned, text);
  return text;
}

/* ---- Stages ---- */

static const char *impl_of_recipe(struct cli *cli, const conceg_recipe *recipe, const char *path) {
  const char *text = conceg_node_text(conceg_node_get(conceg_recipe_root(recipe), path));
  return text ? cli_keep(cli, "%s", text) : NULL;
}

const char *cli_impl(struct cli *cli, const char *kind, const conceg_recipe *own, conceg_doc *doc) {
  const char *path = cli_keep(cli, "%s.impl", kind), *found;
  const size_t length = strlen(path);
  conceg_recipe *carried = NULL;
  uint32_t i;
  if (cli->impl && cli->program->kind && !strcmp(cli->program->kind, kind)) return cli->impl;
  for (i = cli->sets.count; i > 0; i--)
    if (!strncmp(cli->sets.word[i - 1], path, length) && cli->sets.word[i - 1][length] == '=')
      return cli->sets.word[i - 1] + length + 1;
  found = impl_of_recipe(cli, own, path);
  if (!found && doc && conceg_doc_has(doc, "/recipe") &&
      conceg_recipe_from_doc(cli->ctx, doc, &carried) == CONCEG_OK) {
    found = impl_of_recipe(cli, carried, path);
    conceg_recipe_free(carried);
  }
  return found ? found : "";
}

void cli_print_costs(struct cli *cli, const char *kind, uint32_t first_counter, double wall, double cpu) {
  const uint32_t counters = conceg_ctx_counters(cli->ctx);
  uint32_t i, worker, workers;
  progress_clear(&cli->progress);
  for (i = first_counter; i < counters; i++) {
    const uint64_t *values;
    const char *name = conceg_ctx_counter(cli->ctx, i, &values, &workers);
    fprintf(stderr, "%s: counter %s:", cli->program->name, name);
    for (worker = 0; worker < workers; worker++)
      fprintf(stderr, "%s worker %u: %llu", worker ? "," : "", worker, (unsigned long long)values[worker]);
    fputc('\n', stderr);
  }
  fprintf(stderr, "%s: %s took %.2f s of wall time, %.2f s of CPU time; peak memory %.0f MiB\n",
          cli->program->name, kind, wall, cpu, (double)peak_memory() / 1048576.0);
}
