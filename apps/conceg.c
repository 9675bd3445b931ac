/* SPDX-License-Identifier: BSD-3-Clause
 * The umbrella: conceg <word> is a tool built in here, or the program conceg-<word>. */
#define _GNU_SOURCE
#include "cli.h"
#include "stage_program.h"
#include "tools.h"
#include "topics.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct word {
  const char *name, *summary;
  int (*run)(int argc, char **argv);
};

static const struct word tools[] = {
    {"run", "a whole recipe in one process", tool_run},
    {"info", "what a document holds", tool_info},
    {"validate", "check a document against every rule of the format", tool_validate},
    {"check", "whether a document can be believed: every integrity gate", tool_check},
    {"dump", "a document as text, in canonical order", tool_dump},
    {"diff", "compare two documents", tool_diff},
    {"strip", "a document without some of its groups", tool_strip},
    {"clean", "remove unfinished files that killed runs have left", tool_clean},
    {"stages", "which stages there are and which file answers", tool_stages},
    {"params", "the parameters of a stage", tool_params},
    {"swc", "check and repair SWC files", tool_swc},
    {"bench", "what a recipe costs in boxes of several sizes", tool_bench},
    {NULL, NULL, NULL}};

#define WORDS_MOST 64

static const struct word *tool_of(const char *word) {
  const struct word *tool;
  for (tool = tools; tool->name; tool++)
    if (!strcmp(tool->name, word)) return tool;
  return NULL;
}

/* The page of the umbrella: stages in the order of the pipe, tools, help and version. */
static int print_help(int argc, char **argv) {
  struct cli_word words[WORDS_MOST];
  const struct cli_program program = {
      .name = "conceg",
      .usage = "WORD [options]    (conceg WORD --help says more)",
      .summary = "dense grey-matter substrates grown from real cell reconstructions",
      .example = "conceg run recipe.yaml --until mesh -o cube.cgx\n  conceg place -p recipe.yaml | "
                 "conceg triangulate | conceg grow | conceg relax | conceg mesh > cube.cgx",
      .words = words};
  const struct word *tool;
  uint32_t i, j, count = 0;
  struct cli cli;
  for (i = 0; conceg_pipeline_kind(i); i++)
    for (j = 0; conceg_builtins[j]; j++)
      if (!strcmp(conceg_builtins[j]->kind, conceg_pipeline_kind(i)) && !tool_of(conceg_pipeline_kind(i)) &&
          count < WORDS_MOST / 2)
        words[count++] = (struct cli_word){conceg_builtins[j]->kind,
                                           conceg_builtins[j]->summary ? conceg_builtins[j]->summary : ""};
  for (tool = tools; tool->name && count < WORDS_MOST - 3; tool++)
    words[count++] = (struct cli_word){tool->name, tool->summary};
  words[count++] =
      (struct cli_word){"help", "this page, the page of a word, or a topic (conceg help topics)"};
  words[count++] = (struct cli_word){"version", "versions, libraries and licence"};
  words[count] = (struct cli_word){NULL, NULL};
  return cli_end(&cli, cli_begin(&cli, &program, argc, argv));
}

static int print_version(void) {
  char *arguments[] = {(char *)(uintptr_t) "conceg", (char *)(uintptr_t) "--version", NULL};
  static const struct cli_program program = {.name = "conceg", .usage = "WORD [options]", .summary = ""};
  struct cli cli;
  return cli_end(&cli, cli_begin(&cli, &program, 2, arguments));
}

/* The folder of this very program, with a closing "/"; "" when the system does not tell. */
static void own_folder(char *out, size_t size) {
  const ssize_t length = readlink("/proc/self/exe", out, size - 1);
  char *slash;
  out[length > 0 ? length : 0] = '\0';
  slash = strrchr(out, '/');
  if (slash)
    slash[1] = '\0';
  else
    *out = '\0';
}

/* conceg-<word> from PATH, so that a user's program replaces a stage; then the one beside this program.
 * Returns only when there is none (0) or when it cannot be started (exit code). */
static int run_program(const char *word, char **argv) {
  char name[128], path[4096 + 128], folder[4096];
  if (strchr(word, '/') || strlen(word) > 64) return 0;
  snprintf(name, sizeof name, "conceg-%s", word);
  argv[0] = name;
  execvp(name, argv);
  if (errno == ENOENT || errno == EACCES) {
    own_folder(folder, sizeof folder);
    snprintf(path, sizeof path, "%s%s", folder, name);
    if (*folder) execv(path, argv);
  }
  argv[0] = (char *)(uintptr_t)word;
  if (errno == ENOENT || errno == EACCES) return 0;
  fprintf(stderr, "conceg: error: %s: cannot be started: %s\n", word, strerror(errno));
  return EXIT_MISSING;
}

static int is_stage_word(const char *word) {
  uint32_t i;
  for (i = 0; conceg_pipeline_kind(i); i++)
    if (!strcmp(conceg_pipeline_kind(i), word)) return 1;
  return 0;
}

static int run_word(const char *word, int argc, char **argv) {
  const struct word *tool = tool_of(word);
  char name[96];
  int code;
  if (tool) return tool->run(argc, argv);
  code = run_program(word, argv);
  if (code) return code;
  snprintf(name, sizeof name, "conceg %.80s", word);
  if (is_stage_word(word)) return stage_program(word, name, argc, argv); /* a plugin may stand in */
  fprintf(stderr,
          "conceg: error: unknown word %s, and PATH has no program conceg-%s (conceg help lists the words)\n",
          word, word);
  return EXIT_USAGE;
}

static int is_word(const char *word) {
  return tool_of(word) || is_stage_word(word);
}

int main(int argc, char **argv) {
  static char help_flag[] = "--help";
  const char *word = argc > 1 ? argv[1] : NULL;
  if (!word) {
    fputs("usage: conceg WORD [options]\nconceg: error: which word? (conceg help lists them)\n", stderr);
    return EXIT_USAGE;
  }
  if (!strcmp(word, "help") && argc > 2) {
    const int code = topic_print(argv[2], argc > 3 ? argv[3] : NULL);
    if (code >= 0) return code;
    char *page[] = {argv[2], help_flag, NULL};
    if (is_word(argv[2])) return run_word(argv[2], 2, page);
    const int started = run_program(argv[2], page);
    return started ? started : topic_unknown(argv[2]);
  }
  if (!strcmp(word, "help")) {
    char *page[] = {argv[0], help_flag, NULL};
    return print_help(2, page);
  }
  if (!strncmp(word, "--help", 6) || !strcmp(word, "-h")) return print_help(argc, argv);
  if (!strcmp(word, "version") || !strcmp(word, "--version")) return print_version();
  if (*word == '-') {
    fprintf(stderr, "conceg: error: expected a word before %s (conceg help lists them)\n", word);
    return EXIT_USAGE;
  }
  return run_word(word, argc - 1, argv + 1);
}
