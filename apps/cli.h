/* SPDX-License-Identifier: BSD-3-Clause
 * The command line that all programs share: options, messages, input and output (spec/cli.md). */
#ifndef CONCEG_APPS_CLI_H
#define CONCEG_APPS_CLI_H

#include "conceg/conceg.h"

#include "exitcode.h"
#include "progress.h"

#include <stdio.h>

/* A list of words, ending with NULL. */
struct words {
  const char **word;
  uint32_t count, capacity;
};
void words_add(struct words *words, const char *word); /* borrowed; ends the program when out of memory */
void words_free(struct words *words);

/* One option of a program: a flag when `value` is NULL. Exactly one of the targets is set. */
struct cli_option {
  const char *name;  /* "until" */
  char letter;       /* 'o', or 0 */
  const char *value; /* "FILE" */
  const char *help;
  int *flag;          /* counts how often it was given */
  const char **text;  /* the last value */
  struct words *list; /* every value */
};

/* A word that a program takes before its options: "check" of conceg swc. */
struct cli_word {
  const char *name, *summary;
};

/* What a program is, for --help and for the parser. */
struct cli_program {
  const char *name;  /* "conceg info" */
  const char *usage; /* "[FILE] [options]" */
  const char *summary;
  const char *example;
  const struct cli_option *options; /* its own, ending with a row without a name; NULL = none */
  const char *kind;                 /* a stage's word: unknown options become --set kind.name=value */
  const conceg_param *params;       /* the table that is known before the input is read; may be NULL */
  const struct cli_word *words;     /* its words, ending with a row without a name; NULL = none */
  uint32_t most_words;              /* positional words allowed */
};

struct cli {
  const struct cli_program *program;
  conceg_ctx *ctx;
  struct progress progress;
  const char *recipe, *output, *impl, *seed, *threads, *memory, *progress_word;
  struct words sets, words; /* --set in order; positional words */
  struct words owned;       /* texts made by the parser */
  struct words unquoted; /* those of `sets` that came as --name of a parameter whose type was not known yet */
  const char *help_format; /* of --help=FORMAT; NULL = the plain page */
  int quiet, verbose, json, version, help, allow_exec;
};

/* Parses the command line and makes the context. Returns -1 to go on, else the exit code (help, version,
 * usage error). */
int cli_begin(struct cli *cli, const struct cli_program *program, int argc, char **argv);
/* Frees everything and returns the code, or EXIT_CANCELLED when a signal came and the program had failed. */
int cli_end(struct cli *cli, int code);

/* "conceg grow: error: ..." on standard error. Each returns its exit code. */
int cli_fail(struct cli *cli, int code, const char *format, ...) CONCEG_PRINTF(3, 4);
int cli_fail_status(struct cli *cli, conceg_status status); /* the context's error */
int cli_fail_stage_missing(struct cli *cli,
                           conceg_status status); /* as above; a missing stage is EXIT_MISSING */

/* The line without a leading "grow: " when the program says that already. */
const char *cli_without_word(const struct cli_program *program, const char *line);

/* Opens the input document: `path`, or standard input for NULL and "-" (never a terminal). Returns 0 or the
 * exit code. */
int cli_open(struct cli *cli, const char *path, conceg_doc **out);
/* Refuses before any work what could not be written at the end: standard output that is a terminal, -o into
 * nowhere. */
int cli_check_output(struct cli *cli, const char *output);
/* Saves to -o, else to standard output. Returns 0 or the exit code. */
int cli_save(struct cli *cli, conceg_doc *doc, const char *output);
/* Flushes standard output at the end of a tool: a full disk is an error. Returns `code` or EXIT_IO. */
int cli_close_stdout(struct cli *cli, int code);

/* "--step-um" -> "step_um" in a new text owned by the cli. */
const char *cli_keep(struct cli *cli, const char *format, ...) CONCEG_PRINTF(2, 3);

/* Once the stage is known: texts and paths among its parameters are taken literally, not as YAML. */
void cli_quote_params(struct cli *cli, const conceg_param *params);

/* The value of `kind`.impl by --impl, --set, -p and the document's /recipe, in this order; "" = none.
 * Borrowed from cli. */
const char *cli_impl(struct cli *cli, const char *kind, const conceg_recipe *own, conceg_doc *doc);

/* Lines of -v after a stage: counters from `first_counter`, seconds, peak memory. */
void cli_print_costs(struct cli *cli, const char *kind, uint32_t first_counter, double wall, double cpu);

/* The names and licences of what is built in; made by CMake. */
extern const char *const conceg_libraries;
extern const char *const conceg_licence;
/* Built-in stages of this program, NULL-terminated; made by CMake. */
extern const conceg_stage *const conceg_builtins[];

void cli_print_params(FILE *out, const conceg_param *params);

#endif
