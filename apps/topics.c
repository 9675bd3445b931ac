/* SPDX-License-Identifier: BSD-3-Clause
 * The topics of conceg help: each is a file of spec/, one section of it, or a table that the man
 * pages print too, so that there is one text only. */
#include "topics.h"

#include "exitcode.h"
#include "help.h"

#include <stdio.h>
#include <string.h>

extern const char conceg_spec_cli[], conceg_spec_cgx[], conceg_spec_schema[], conceg_spec_stream[],
    conceg_spec_stage_abi[], conceg_spec_swc_plus[];

struct topic {
  const char *name, *summary, *text;
  const char *section; /* its "## " heading; NULL = the whole file. Without a text: the environment */
};

static const struct topic topics[] = {
    {"programs", "the programs and what each does", conceg_spec_cli, "Programs"},
    {"pipes", "input and output: streams, files, progress, signals", conceg_spec_cli, "Input and output"},
    {"parameters", "options of every program, and parameters of stages as options", conceg_spec_cli,
     "Options of every program"},
    {"recipes", "what a recipe may say", conceg_spec_cli, "Recipe"},
    {"values", "which of several values holds: --set, -p, the document, defaults; seeds", conceg_spec_cli,
     "Values"},
    {"exit-codes", "what the exit codes mean", conceg_spec_cli, "Exit codes"},
    {"environment", "variables of the environment", NULL, NULL},
    {"units", "names and units", conceg_spec_cgx, "2. Names and units"},
    {"format", "arrays of a document with types, shapes and units; conceg help format /cells: one group",
     conceg_spec_schema, NULL},
    {"cgx", "the rules of the format", conceg_spec_cgx, NULL},
    {"streams", "documents in pipes, and replacing a stage by any program", conceg_spec_stream, NULL},
    {"plugins", "the stage ABI", conceg_spec_stage_abi, NULL},
    {"swc", "how SWC files are read, and SWC-plus", conceg_spec_swc_plus, NULL},
    {NULL, NULL, NULL, NULL}};

static const char *next_line(const char *line) {
  const char *const end = strchr(line, '\n');
  return end ? end + 1 : line + strlen(line);
}

/* Prints from the line `from` up to the next one that begins with `mark`. */
static void print_until(const char *from, const char *mark) {
  const char *end = next_line(from);
  while (*end && strncmp(end, mark, strlen(mark)) != 0)
    end = next_line(end);
  fwrite(from, 1, (size_t)(end - from), stdout);
}

static const char *find_line(const char *text, const char *start) {
  while (*text && strncmp(text, start, strlen(start)) != 0)
    text = next_line(text);
  return *text ? text : NULL;
}

static int print_group(const char *group) {
  static const char mark[] = "  - name: ";
  const char *line = conceg_spec_schema;
  if (*group == '/') group++;
  while ((line = find_line(line, mark)) != NULL) {
    const char *const name = line + sizeof mark - 1;
    const size_t length = strcspn(name, " \n");
    if (length == strlen(group) && !memcmp(name, group, length)) return print_until(line, mark), 1;
    line = next_line(line);
  }
  return 0;
}

static int finish(void) {
  return fflush(stdout) || ferror(stdout) ? EXIT_IO : EXIT_OK;
}

int topic_print(const char *name, const char *detail) {
  const struct topic *topic = topics;
  char heading[128];
  const char *from;
  if (!strcmp(name, "topics")) {
    for (; topic->name; topic++)
      printf("  %-13s %s\n", topic->name, topic->summary);
    return finish();
  }
  while (topic->name && strcmp(topic->name, name) != 0)
    topic++;
  if (!topic->name) return -1;
  if (!topic->text) {
#define ENVIRONMENT_ROW(variable, meaning) printf("  %-18s %s\n", variable, meaning);
    CONCEG_ENVIRONMENT(ENVIRONMENT_ROW)
#undef ENVIRONMENT_ROW
    return finish();
  }
  if (detail && topic->text == conceg_spec_schema) {
    if (print_group(detail)) return finish();
    fprintf(stderr, "conceg help: error: %s: no such group (conceg help format lists them)\n", detail);
    return EXIT_USAGE;
  }
  if (!topic->section) return fputs(topic->text, stdout), finish();
  snprintf(heading, sizeof heading, "## %s\n", topic->section);
  from = find_line(topic->text, heading);
  if (from) print_until(from, "## ");
  return from ? finish() : EXIT_MISSING;
}

/* Letters that a typed word has in common with a topic from the start, less what differs in length. */
static int nearness(const char *a, const char *b) {
  const int lengths = (int)strlen(a) - (int)strlen(b);
  int same = 0;
  while (a[same] && a[same] == b[same])
    same++;
  return 4 * same - (lengths < 0 ? -lengths : lengths);
}

int topic_unknown(const char *name) {
  const struct topic *topic, *best = topics;
  for (topic = topics; topic->name; topic++)
    if (nearness(name, topic->name) > nearness(name, best->name)) best = topic;
  fprintf(stderr,
          "conceg help: error: %s is neither a word nor a topic; the nearest topic is %s (conceg help topics "
          "lists them)\n",
          name, best->name);
  return EXIT_USAGE;
}
