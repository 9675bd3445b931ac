/* SPDX-License-Identifier: BSD-3-Clause
 * Options of all programs, of one program, and of a stage's parameter table. */
#define _GNU_SOURCE
#include "cli_parse.h"

#include <stdlib.h>
#include <string.h>

void words_add(struct words *words, const char *word) {
  if (words->count + 1 >= words->capacity) {
    const uint32_t capacity = words->capacity ? words->capacity * 2 : 16;
    const char **grown = realloc(words->word, capacity * sizeof *grown);
    if (!grown) {
      fputs("conceg: error: out of memory\n", stderr);
      exit(EXIT_STAGE);
    }
    words->word = grown;
    words->capacity = capacity;
  }
  words->word[words->count++] = word;
  words->word[words->count] = NULL;
}

void words_free(struct words *words) {
  free(words->word);
  memset(words, 0, sizeof *words);
}

void cli_common_options(struct cli *cli, struct cli_option out[COMMON_COUNT]) {
  const struct cli_option rows[] = {
      {"recipe", 'p', "RECIPE", "the recipe; for a later stage only its own section and seed", NULL,
       &cli->recipe, NULL},
      {"set", 0, "stage.key=VALUE", "a value of the recipe; may be repeated", NULL, NULL, &cli->sets},
      {"seed", 0, "N", "the seed (default: the recipe's, else 1)", NULL, &cli->seed, NULL},
      {"threads", 0, "N", "worker threads (default 0 = all processors); the result never depends on it", NULL,
       &cli->threads, NULL},
      {"memory", 0, "SIZE", "array data to keep in memory, such as 4G (default: half of the machine)", NULL,
       &cli->memory, NULL},
      {"output", 'o', "FILE", "write the document to FILE instead of standard output", NULL, &cli->output,
       NULL},
      {"impl", 0, "NAME", "which implementation of the stage (conceg stages lists them)", NULL, &cli->impl,
       NULL},
      {"allow-exec", 0, NULL, "let impl: exec:PROG of a recipe run a program", &cli->allow_exec, NULL, NULL},
      {"progress", 0, "auto|json|none", "how progress is shown on standard error", NULL, &cli->progress_word,
       NULL},
      {"json", 0, NULL, "print results as JSON", &cli->json, NULL, NULL},
      {"quiet", 'q', NULL, "errors only", &cli->quiet, NULL, NULL},
      {"verbose", 'v', NULL, "notes, counters per worker, times; twice: more", &cli->verbose, NULL, NULL},
      {"version", 0, NULL, "versions, libraries and licence", &cli->version, NULL, NULL},
      {"help", 'h', NULL, "this page", &cli->help, NULL, NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  memcpy(out, rows, sizeof rows);
}

static const struct cli_option *find_option(const struct cli_option *options, const char *name, size_t length,
                                            char letter) {
  for (; options && options->name; options++)
    if (letter ? options->letter == letter
               : strlen(options->name) == length && !memcmp(options->name, name, length))
      return options;
  return NULL;
}

static int apply(struct cli *cli, const struct cli_option *option, const char *value) {
  if (option->flag) {
    if (value) return cli_fail(cli, EXIT_USAGE, "--%s takes no value", option->name);
    ++*option->flag;
  } else if (!value) {
    return cli_fail(cli, EXIT_USAGE, "--%s: expected %s after it", option->name, option->value);
  } else if (option->list) {
    words_add(option->list, value);
  } else {
    *option->text = value;
  }
  return EXIT_OK;
}

static const conceg_param *find_param(const conceg_param *row, const char *name, size_t length) {
  for (; row && row->name; row++)
    if (strlen(row->name) == length && !memcmp(row->name, name, length)) return row;
  return NULL;
}

static int is_literal(const conceg_param *row) {
  return row && (row->type == CONCEG_PARAM_TEXT || row->type == CONCEG_PARAM_FILE);
}

/* A text as a single-quoted YAML scalar, so that a path such as "a: b" stays a text. */
static const char *quoted_value(struct cli *cli, const char *text) {
  char *out = malloc(2 * strlen(text) + 3), *p = out;
  const char *kept;
  if (!out) return text;
  *p++ = '\'';
  for (; *text; text++) {
    if (*text == '\'') *p++ = '\'';
    *p++ = *text;
  }
  *p++ = '\'';
  *p = '\0';
  kept = cli_keep(cli, "%s", out);
  free(out);
  return kept;
}

/* --step-um VALUE of a stage. Returns how many words were used, 0 after an error line. */
static int apply_param(struct cli *cli, const char *word, const char *equals, const char *next) {
  const char *name = cli_keep(cli, "%.*s", equals ? (int)(equals - word) : (int)strlen(word), word);
  const char *value = equals ? equals + 1 : next;
  const conceg_param *row;
  char *p;
  for (p = (char *)(uintptr_t)name; *p; p++)
    if (*p == '-') *p = '_';
  row = find_param(cli->program->params, name, strlen(name));
  /* A switch needs no value; a parameter of a plugin that is not open yet may be one. */
  if (!equals && (row ? row->type == CONCEG_PARAM_BOOL : !next || !strncmp(next, "--", 2))) {
    words_add(&cli->sets, cli_keep(cli, "%s.%s=true", cli->program->kind, name));
    return 1;
  }
  if (!value) {
    cli_fail(cli, EXIT_USAGE, "--%s: expected a value after it", word);
    return 0;
  }
  if (is_literal(row)) value = quoted_value(cli, value);
  words_add(&cli->sets, cli_keep(cli, "%s.%s=%s", cli->program->kind, name, value));
  if (!row) words_add(&cli->unquoted, cli->sets.word[cli->sets.count - 1]);
  return equals ? 1 : 2;
}

void cli_quote_params(struct cli *cli, const conceg_param *params) {
  uint32_t i, j;
  for (i = 0; i < cli->unquoted.count; i++) {
    const char *set = cli->unquoted.word[i], *name = set + strlen(cli->program->kind) + 1,
               *equals = strchr(name, '=');
    if (!is_literal(find_param(params, name, (size_t)(equals - name)))) continue;
    for (j = 0; j < cli->sets.count; j++)
      if (cli->sets.word[j] == set)
        cli->sets.word[j] = cli_keep(cli, "%.*s=%s", (int)(equals - set), set, quoted_value(cli, equals + 1));
  }
  cli->unquoted.count = 0;
}

/* One long option at argv[i]. Returns how many words were used, 0 after an error line. */
static int parse_long(struct cli *cli, const struct cli_option *common, int argc, char **argv, int i) {
  const char *word = argv[i] + 2, *equals = strchr(word, '='), *next = i + 1 < argc ? argv[i + 1] : NULL;
  const size_t length = equals ? (size_t)(equals - word) : strlen(word);
  const struct cli_option *option = find_option(cli->program->options, word, length, 0);
  if (!option) option = find_option(common, word, length, 0);
  if (option && option->flag == &cli->help && equals) return cli->help_format = equals + 1, ++cli->help;
  if (!option && cli->program->kind) return apply_param(cli, word, equals, next);
  if (!option) {
    cli_fail(cli, EXIT_USAGE, "unknown option --%.*s (%s --help lists them)", (int)length, word,
             cli->program->name);
    return 0;
  }
  if (option->flag || equals) return apply(cli, option, equals ? equals + 1 : NULL) == EXIT_OK;
  return apply(cli, option, next) == EXIT_OK ? 2 : 0;
}

/* -v, -qv, -oFILE or -o FILE. Returns how many words were used, 0 after an error line. */
static int parse_short(struct cli *cli, const struct cli_option *common, int argc, char **argv, int i) {
  const char *letter;
  for (letter = argv[i] + 1; *letter; letter++) {
    const struct cli_option *option = find_option(cli->program->options, NULL, 0, *letter);
    if (!option) option = find_option(common, NULL, 0, *letter);
    if (!option) {
      cli_fail(cli, EXIT_USAGE, "unknown option -%c (%s --help lists them)", *letter, cli->program->name);
      return 0;
    }
    if (option->flag) {
      apply(cli, option, NULL);
      continue;
    }
    if (letter[1]) return apply(cli, option, letter + 1) == EXIT_OK;
    return apply(cli, option, i + 1 < argc ? argv[i + 1] : NULL) == EXIT_OK ? 2 : 0;
  }
  return 1;
}

int cli_parse(struct cli *cli, int argc, char **argv) {
  struct cli_option common[COMMON_COUNT];
  int i, used, only_words = 0;
  cli_common_options(cli, common);
  words_add(&cli->sets, NULL), cli->sets.count = 0;
  words_add(&cli->words, NULL), cli->words.count = 0;
  for (i = 1; i < argc; i += used) {
    used = 1;
    if (!only_words && !strcmp(argv[i], "--"))
      only_words = 1;
    else if (only_words || argv[i][0] != '-' || !argv[i][1])
      words_add(&cli->words, argv[i]);
    else if (argv[i][1] == '-')
      used = parse_long(cli, common, argc, argv, i);
    else
      used = parse_short(cli, common, argc, argv, i);
    if (!used) return EXIT_USAGE;
  }
  if (cli->help || cli->version || cli->words.count <= cli->program->most_words) return EXIT_OK;
  return cli_fail(cli, EXIT_USAGE, "unexpected word %s (usage: %s %s)",
                  cli->words.word[cli->program->most_words], cli->program->name, cli->program->usage);
}
