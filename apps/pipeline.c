/* SPDX-License-Identifier: BSD-3-Clause
 * Which stages a run takes. */
#include "pipeline.h"

#include <string.h>

static uint32_t find_kind(const struct words *kinds, const char *kind) {
  uint32_t i;
  for (i = 0; i < kinds->count && strcmp(kinds->word[i], kind) != 0;)
    i++;
  return i;
}

static uint32_t find_last(const struct words *kinds, const char *kind) {
  uint32_t i;
  for (i = kinds->count; i-- > 0;)
    if (!strcmp(kinds->word[i], kind)) return i;
  return kinds->count;
}

static int fail_absent(struct cli *cli, const char *option, const char *kind, const struct words *kinds) {
  char list[256] = "";
  size_t used = 0;
  uint32_t i;
  for (i = 0; i < kinds->count && used < sizeof list; i++)
    used += (size_t)snprintf(list + used, sizeof list - used, " %s", kinds->word[i]);
  return cli_fail(cli, EXIT_USAGE,
                  "%s %s: not among the stages of this run:%s (the recipe's stages: can name others)", option,
                  kind, list);
}

/* Puts `block` before the first mesh, unless the recipe has it somewhere. */
static int insert_block(struct cli *cli, struct words *kinds) {
  const uint32_t at = find_kind(kinds, "mesh");
  if (find_kind(kinds, "block") < kinds->count) return EXIT_OK;
  if (at == kinds->count) return fail_absent(cli, "--block", "mesh", kinds);
  words_add(kinds, "block");
  memmove(kinds->word + at + 1, kinds->word + at, (kinds->count - 1 - at) * sizeof *kinds->word);
  kinds->word[at] = "block";
  return EXIT_OK;
}

int pipeline_choose(struct cli *cli, const conceg_recipe *recipe, const char *from, const char *until,
                    int with_block, struct words *kinds) {
  static const char *const standard[] = {"place", "triangulate", "grow",    "relax",
                                         "mesh",  "simulate",    "analyse", NULL};
  const conceg_node *own = conceg_node_get(conceg_recipe_root(recipe), "stages");
  /* Signals take longer than all the rest, so they are made when they are asked for. */
  const int simulates = (until && !strcmp(until, "simulate")) || (from && !strcmp(from, "simulate")) ||
                        conceg_node_get(conceg_recipe_root(recipe), "simulate");
  uint32_t i, first = 0;
  for (i = 0; i < conceg_node_count(own); i++)
    words_add(kinds, conceg_node_text(conceg_node_at(own, i)));
  for (i = 0; !own && standard[i]; i++)
    if (simulates || strcmp(standard[i], "simulate")) words_add(kinds, standard[i]);
  if (!kinds->count) return cli_fail(cli, EXIT_USAGE, "the recipe's list of stages is empty");
  if (with_block && insert_block(cli, kinds) != EXIT_OK) return EXIT_USAGE;
  if (from) {
    first = find_kind(kinds, from);
    if (first == kinds->count) return fail_absent(cli, "--from", from, kinds);
  }
  if (until) {
    const uint32_t last = find_last(kinds, until); /* a stage can stand there twice: relax, grow, relax */
    if (last == kinds->count) return fail_absent(cli, "--until", until, kinds);
    if (last < first) return cli_fail(cli, EXIT_USAGE, "--until %s comes before --from %s", until, from);
    kinds->count = last + 1;
  }
  kinds->count -= first;
  memmove(kinds->word, kinds->word + first, kinds->count * sizeof *kinds->word);
  kinds->word[kinds->count] = NULL;
  return EXIT_OK;
}

static void print_quoted(const char *text) {
  if (*text && strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=,:+-") ==
                   strlen(text)) {
    fputs(text, stdout);
    return;
  }
  putchar('\'');
  for (; *text; text++) {
    if (*text == '\'')
      fputs("'\\''", stdout);
    else
      putchar(*text);
  }
  putchar('\'');
}

void pipeline_print(const struct cli *cli, const char *recipe, const char *input, const struct words *kinds) {
  uint32_t i, set;
  for (i = 0; i < kinds->count; i++) {
    printf("%sconceg %s", i ? " | " : "", kinds->word[i]);
    if (i == 0 && !input) fputs(" -p ", stdout), print_quoted(recipe);
    if (i == 0 && input) putchar(' '), print_quoted(input);
    if (i > 0 && input) fputs(" -p ", stdout), print_quoted(recipe);
    for (set = 0; i == 0 && set < cli->sets.count; set++)
      fputs(" --set ", stdout), print_quoted(cli->sets.word[set]);
    if (!strcmp(kinds->word[i], "export") || !strcmp(kinds->word[i], "render") ||
        !strcmp(kinds->word[i], "report"))
      if (i + 1 < kinds->count) fputs(" -o -", stdout);
  }
  if (cli->output) fputs(" > ", stdout), print_quoted(cli->output);
  putchar('\n');
}
