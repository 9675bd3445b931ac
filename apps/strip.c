/* SPDX-License-Identifier: BSD-3-Clause
 * conceg strip: a document without some of its groups. */
#include "cli.h"
#include "tools.h"

#include <string.h>

static conceg_status drop_groups(struct cli *cli, conceg_doc *doc, const char *groups) {
  conceg_status status = CONCEG_OK;
  while (status == CONCEG_OK && *groups) {
    const size_t length = strcspn(groups, ",");
    const char *path = cli_keep(cli, "%s%.*s", *groups == '/' ? "" : "/", (int)length, groups);
    if (length && !conceg_doc_has(doc, path))
      return conceg_ctx_fail(cli->ctx, CONCEG_E_MISSING,
                             "%s: the document does not have it (conceg info lists the groups)", path);
    if (length && strcmp(path, "/") != 0) status = conceg_doc_drop(doc, path);
    groups += length + (groups[length] == ',');
  }
  return status;
}

static int strip_file(struct cli *cli) {
  conceg_doc *doc = NULL;
  conceg_status status;
  int code;
  if (!cli->words.count)
    return cli_fail(cli, EXIT_USAGE, "which groups? usage: %s %s", cli->program->name, cli->program->usage);
  code = cli_check_output(cli, cli->output);
  if (code == EXIT_OK) code = cli_open(cli, cli->words.count > 1 ? cli->words.word[1] : NULL, &doc);
  if (code != EXIT_OK) return code;
  status = drop_groups(cli, doc, cli->words.word[0]);
  code = status == CONCEG_OK ? cli_save(cli, doc, cli->output) : cli_fail_status(cli, status);
  if (conceg_doc_close(doc) != CONCEG_OK && code == EXIT_OK) code = cli_fail_status(cli, CONCEG_E_IO);
  return code;
}

int tool_strip(int argc, char **argv) {
  const struct cli_program program = {.name = "conceg strip",
                                      .usage = "GROUP[,GROUP...] [FILE.cgx] [options] -o FILE",
                                      .summary = "a document without some of its groups or datasets",
                                      .example = "conceg strip network,volumes cube.cgx -o small.cgx",
                                      .most_words = 2};
  struct cli cli;
  int code = cli_begin(&cli, &program, argc, argv);
  if (code < 0) code = strip_file(&cli);
  return cli_end(&cli, code);
}
