/* SPDX-License-Identifier: BSD-3-Clause
 * A program's man page. No date: the same build gives the same bytes. */
#include "help.h"

#include <ctype.h>
#include <string.h>

/* Text as roff shows it unchanged. */
static void put(const char *text) {
  if (*text == '.' || *text == '\'') fputs("\\&", stdout);
  for (; *text; text++)
    if (*text == '\\')
      fputs("\\e", stdout);
    else if (*text == '-')
      fputs("\\-", stdout);
    else if (*text == '\n')
      putchar(' ');
    else
      putchar(*text);
}

/* A name as a page has it: spaces become dashes. */
static void put_page(const char *name, int upper) {
  for (; *name; name++)
    if (*name == ' ')
      fputs("\\-", stdout);
    else
      putchar(upper ? toupper((unsigned char)*name) : *name);
}

static void put_item(const char *bold, const char *value) {
  fputs(".TP\n\\fB", stdout);
  put(bold);
  fputs("\\fR", stdout);
  if (value) {
    fputs(" \\fI", stdout);
    put(value);
    fputs("\\fR", stdout);
  }
  putchar('\n');
}

static void put_row(const char *bold, const char *value, const char *text) {
  put_item(bold, value);
  put(text);
  putchar('\n');
}

static void put_options(const struct cli_option *option) {
  char name[96];
  for (; option && option->name; option++) {
    if (option->letter)
      snprintf(name, sizeof name, "-%c, --%s", option->letter, option->name);
    else
      snprintf(name, sizeof name, "--%s", option->name);
    put_row(name, option->value, option->help);
  }
}

static void put_params(const struct cli_program *program) {
  const conceg_param *row;
  char text[1024], bounds[512];
  puts(".SH PARAMETERS");
  printf("In a recipe they stand under ");
  put(program->kind);
  puts(". In brackets: default and unit, range or choices.");
  for (row = program->params; row->name; row++) {
    snprintf(text, sizeof text, "--%s", row->name);
    put_item(text, NULL);
    help_bounds(row, bounds, sizeof bounds);
    snprintf(text, sizeof text, "%s [%s]", row->help ? row->help : "", bounds);
    put(text);
    putchar('\n');
  }
}

static void put_words(const struct cli_program *program) {
  const struct cli_word *word;
  puts(".SH WORDS");
  for (word = program->words; word->name; word++)
    put_row(word->name, NULL, word->summary);
}

static void put_exit_codes(void) {
  puts(".SH EXIT STATUS");
#define EXIT_ROW(name, number, meaning) put_row(#number, NULL, meaning);
  CONCEG_EXIT_CODES(EXIT_ROW)
#undef EXIT_ROW
}

static void put_environment(void) {
  puts(".SH ENVIRONMENT");
#define ENVIRONMENT_ROW(name, meaning) put_row(name, NULL, meaning);
  CONCEG_ENVIRONMENT(ENVIRONMENT_ROW)
#undef ENVIRONMENT_ROW
}

void help_print_man(const struct cli_program *program, const struct cli_option *common) {
  fputs(".TH ", stdout);
  put_page(program->name, 1);
  printf(" 1 \"\" \"ConCeG %s\" \"ConCeG\"\n.SH NAME\n", CONCEG_VERSION_TEXT);
  put_page(program->name, 0);
  fputs(" \\- ", stdout);
  put(program->summary);
  fputs("\n.SH SYNOPSIS\n\\fB", stdout);
  put(program->name);
  fputs("\\fR ", stdout);
  put(program->usage);
  puts("\n.SH DESCRIPTION");
  put(program->summary);
  putchar('\n');
  if (program->words) put_words(program);
  if (program->options && program->options->name) {
    puts(".SH OPTIONS OF THIS PROGRAM");
    put_options(program->options);
  }
  if (program->params && program->params->name) put_params(program);
  puts(".SH OPTIONS");
  put_options(common);
  puts(
      ".SH INPUT AND OUTPUT\nStandard output carries data alone; messages and progress go to standard error. "
      "A document is never written to a terminal, and a file appears whole or not at all.");
  put_exit_codes();
  put_environment();
  if (program->example) {
    puts(".SH EXAMPLES\n.nf");
    put(program->example);
    puts("\n.fi");
  }
  puts(".SH SEE ALSO\n.BR conceg (1),\nconceg help topics");
}
