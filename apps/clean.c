/* SPDX-License-Identifier: BSD-3-Clause
 * conceg clean: removes the unfinished files that killed runs have left. */
#include "cli.h"
#include "tools.h"

struct found {
  uint64_t files, bytes;
  int quiet, keep;
};

static void print_found(void *user, const char *path, uint64_t bytes) {
  struct found *found = user;
  found->files++;
  found->bytes += bytes;
  if (!found->quiet)
    printf("%s %s (%.1f MiB)\n", found->keep ? "left behind" : "removed", path, (double)bytes / 1048576.0);
}

static int clean_folders(struct cli *cli, int keep) {
  struct found found = {0, 0, cli->quiet, keep};
  uint32_t i;
  if (!cli->words.count) {
    words_add(&cli->words, ".");
    words_add(&cli->words, conceg_ctx_tmpdir(cli->ctx));
  }
  for (i = 0; i < cli->words.count; i++) {
    const conceg_status status = conceg_clean(cli->ctx, cli->words.word[i], keep, print_found, &found);
    if (status != CONCEG_OK) return cli_fail_status(cli, status);
  }
  if (!cli->quiet)
    printf("%u folders looked at: %llu unfinished files of killed runs %s, %.1f MiB\n", cli->words.count,
           (unsigned long long)found.files, keep ? "found" : "removed", (double)found.bytes / 1048576.0);
  return EXIT_OK;
}

int tool_clean(int argc, char **argv) {
  int keep = 0;
  const struct cli_option options[] = {
      {"dry-run", 'n', NULL, "list the files and remove none", &keep, NULL, NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  const struct cli_program program = {
      .name = "conceg clean",
      .usage = "[FOLDERS...] [options]",
      .summary =
          "remove the unfinished files (.conceg-PID-N.tmp) that killed runs have left in folders, by default "
          "the current one and the temporary one; those of running programs stay",
      .example = "conceg clean results",
      .options = options,
      .most_words = 1000};
  struct cli cli;
  int code = cli_begin(&cli, &program, argc, argv);
  if (code < 0) code = cli_close_stdout(&cli, clean_folders(&cli, keep));
  return cli_end(&cli, code);
}
