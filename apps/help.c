/* SPDX-License-Identifier: BSD-3-Clause
 * The plain page of a program, and its tables as lines for shell completion. */
#include "help.h"

#include "cli_parse.h"

#include <string.h>

void help_bounds(const conceg_param *row, char *out, size_t size) {
  char range[96] = "";
  const int has_unit = row->unit && *row->unit && strcmp(row->unit, "1") != 0;
  if (row->type == CONCEG_PARAM_F64 || row->type == CONCEG_PARAM_I64)
    snprintf(range, sizeof range, ", %g to %g", row->lo, row->hi);
  else if (row->type == CONCEG_PARAM_BOOL)
    snprintf(range, sizeof range, ", true or false");
  snprintf(out, size, "%s%s%s%s%s%s%s", *row->fallback ? row->fallback : "none", has_unit ? " " : "",
           has_unit ? row->unit : "", range, row->choices ? ", one of " : "",
           row->choices ? row->choices : "", row->type == CONCEG_PARAM_FILE ? ", a path" : "");
}

static void print_option(const struct cli_option *option) {
  char left[64];
  snprintf(left, sizeof left, "%c%c%s--%s%s%s", option->letter ? '-' : ' ',
           option->letter ? option->letter : ' ', option->letter ? ", " : "  ", option->name,
           option->value ? " " : "", option->value ? option->value : "");
  printf("  %-30s %s\n", left, option->help);
}

void cli_print_params(FILE *out, const conceg_param *params) {
  const conceg_param *row;
  for (row = params; row && row->name; row++) {
    char left[96], bounds[512];
    snprintf(left, sizeof left, "--%s", row->name);
    help_bounds(row, bounds, sizeof bounds);
    fprintf(out, "  %-30s %s [%s]\n", left, row->help ? row->help : "", bounds);
  }
}

static void print_plain(const struct cli_program *program, const struct cli_option *common) {
  const struct cli_option *option;
  const struct cli_word *word;
  printf("%s: %s\n\nusage: %s %s\n", program->name, program->summary, program->name, program->usage);
  if (program->words) {
    puts("\nwords:");
    for (word = program->words; word->name; word++)
      printf("  %-13s %s\n", word->name, word->summary);
  }
  if (program->options && program->options->name) {
    puts("\noptions of this program:");
    for (option = program->options; option->name; option++)
      print_option(option);
  }
  if (program->params && program->params->name) {
    printf("\nparameters [default]; in a recipe they stand under %s:\n", program->kind);
    cli_print_params(stdout, program->params);
  }
  puts("\noptions of every program:");
  for (option = common; option->name; option++)
    print_option(option);
  if (program->example) printf("\nexample:\n  %s\n", program->example);
}

/* One line per row: what, name, letter, value, help; separated by tabs. */
static void list_options(const struct cli_option *option) {
  for (; option && option->name; option++)
    printf("option\t--%s\t%c\t%s\t%s\n", option->name, option->letter ? option->letter : '-',
           option->value ? option->value : "-", option->help);
}

static void print_list(const struct cli_program *program, const struct cli_option *common) {
  const struct cli_word *word;
  const conceg_param *row;
  for (word = program->words; word && word->name; word++)
    printf("word\t%s\t-\t-\t%s\n", word->name, word->summary);
  list_options(program->options);
  for (row = program->params; row && row->name; row++)
    printf("param\t--%s\t-\t%s\t%s\n", row->name,
           row->choices                     ? row->choices
           : row->type == CONCEG_PARAM_BOOL ? "true|false"
           : row->type == CONCEG_PARAM_FILE ? "FILE"
                                            : "VALUE",
           row->help ? row->help : "");
  list_options(common);
}

int help_print(const struct cli_program *program, const char *format) {
  struct cli_option common[COMMON_COUNT];
  struct cli scratch;
  memset(&scratch, 0, sizeof scratch);
  cli_common_options(&scratch, common);
  if (!format || !strcmp(format, "plain"))
    print_plain(program, common);
  else if (!strcmp(format, "man"))
    help_print_man(program, common);
  else if (!strcmp(format, "list"))
    print_list(program, common);
  else
    return 0;
  return 1;
}
