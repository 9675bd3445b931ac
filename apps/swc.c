/* SPDX-License-Identifier: BSD-3-Clause
 * conceg swc: which of its words, and the files that are meant. */
#define _GNU_SOURCE
#include "swc.h"

#include "tools.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define DEEPEST_FOLDER 64

static void add_file(struct swc_files *files, const char *path, const char *inside) {
  if (files->count == files->capacity) {
    const uint32_t capacity = files->capacity ? 2 * files->capacity : 64;
    struct swc_file *grown = realloc(files->file, capacity * sizeof *grown);
    if (!grown) {
      fputs("conceg swc: error: out of memory\n", stderr);
      exit(EXIT_STAGE);
    }
    files->file = grown, files->capacity = capacity;
  }
  files->file[files->count].path = path, files->file[files->count].inside = inside;
  files->count++;
}

void swc_list_free(struct swc_files *files) {
  free(files->file);
  memset(files, 0, sizeof *files);
}

static int is_swc(const char *name) {
  const size_t length = strlen(name);
  return length > 4 && !strcasecmp(name + length - 4, ".swc");
}

static int by_name(const struct dirent **a, const struct dirent **b) {
  return strcmp((*a)->d_name, (*b)->d_name);
}

/* Links to folders are not followed: they could lead round in a circle. */
static int list_folder(struct cli *cli, const char *folder, size_t base, int depth, struct swc_files *out) {
  struct dirent **item = NULL;
  const int count = scandir(folder, &item, NULL, by_name);
  int i, code = EXIT_OK;
  if (count < 0) return cli_fail(cli, EXIT_IO, "%s: cannot be read: %s", folder, strerror(errno));
  for (i = 0; i < count; i++) {
    const char *const name = item[i]->d_name, *path;
    struct stat about;
    if (code == EXIT_OK && *name != '.') {
      path = cli_keep(cli, "%s%s%s", folder, folder[strlen(folder) - 1] == '/' ? "" : "/", name);
      if (lstat(path, &about) == 0 && S_ISDIR(about.st_mode))
        code = depth < DEEPEST_FOLDER
                   ? list_folder(cli, path, base, depth + 1, out)
                   : cli_fail(cli, EXIT_IO, "%s: more than %d folders deep", path, DEEPEST_FOLDER);
      else if (is_swc(name) && stat(path, &about) == 0 && S_ISREG(about.st_mode))
        add_file(out, path, path + base + (path[base] == '/'));
    }
    free(item[i]);
  }
  free(item);
  return code;
}

int swc_list(struct cli *cli, const struct words *names, struct swc_files *out) {
  uint32_t i;
  int code = EXIT_OK;
  for (i = 0; i < names->count && code == EXIT_OK; i++) {
    const char *const name = names->word[i], *slash = strrchr(name, '/');
    const uint32_t before = out->count;
    struct stat about;
    if (*name && stat(name, &about) == 0 && S_ISDIR(about.st_mode)) {
      code = list_folder(cli, name, strlen(name), 0, out);
      if (code == EXIT_OK && out->count == before)
        code = cli_fail(cli, EXIT_INPUT, "%s: no file whose name ends in .swc is in this folder or below it",
                        name);
    } else
      add_file(out, name, slash ? slash + 1 : name);
  }
  return code;
}

int swc_choices(struct cli *cli, const char *floating, const char *somata, uint32_t *flags) {
  if (floating && !strcmp(floating, "drop"))
    *flags |= CONCEG_SWC_DROP_FLOATING;
  else if (floating && !strcmp(floating, "attach"))
    *flags |= CONCEG_SWC_ATTACH_FLOATING;
  else if (floating && strcmp(floating, "keep") != 0)
    return cli_fail(cli, EXIT_USAGE, "--floating %s: expected keep, drop or attach", floating);
  if (somata && (!strcmp(somata, "split") || !strcmp(somata, "first")))
    *flags |= CONCEG_SWC_SPLIT;
  else if (somata && strcmp(somata, "refuse") != 0)
    return cli_fail(cli, EXIT_USAGE, "--somata %s: expected refuse, split or first", somata);
  return EXIT_OK;
}

int tool_swc(int argc, char **argv) {
  static const struct cli_word words[] = {
      {"check", "every problem of SWC files, and whether they are accepted"},
      {"repair", "write what can be read as plain SWC"},
      {NULL, NULL}};
  static const struct cli_program program = {
      .name = "conceg swc",
      .usage = "check|repair FILES|FOLDERS... [options]",
      .summary = "check and repair SWC files (spec/swc-plus.md)",
      .example = "conceg swc check --strict cells/ || conceg swc repair cells/ -o repaired/",
      .words = words};
  const char *const word = argc > 1 ? argv[1] : "";
  if (!strcmp(word, "check")) return swc_check(argc - 1, argv + 1);
  if (!strcmp(word, "repair")) return swc_repair(argc - 1, argv + 1);
  if (!strncmp(word, "--help", 6) || !strcmp(word, "-h")) {
    struct cli cli;
    return cli_end(&cli, cli_begin(&cli, &program, argc, argv));
  }
  fprintf(stderr,
          "usage: conceg swc check|repair FILES|FOLDERS... [options]\nconceg swc: error: expected check or "
          "repair%s%s "
          "(conceg swc --help)\n",
          *word ? ", got " : "", word);
  return EXIT_USAGE;
}
