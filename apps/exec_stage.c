/* SPDX-License-Identifier: BSD-3-Clause
 * Running another program as a stage: its standard input and output are documents in
 * temporary files that have no name. */
#define _GNU_SOURCE
#include "exec_stage.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

const char *exec_command(const char *impl) {
  return impl && !strncmp(impl, "exec:", 5) && impl[5] ? impl + 5 : NULL;
}

/* A file of the temporary folder that has no name any more; -1 after an error line. */
static int nameless_file(struct cli *cli) {
  char *path = (char *)(uintptr_t)cli_keep(cli, "%s/conceg-exec-XXXXXX", conceg_ctx_tmpdir(cli->ctx));
  const int file = mkostemp(path, O_CLOEXEC);
  if (file < 0)
    cli_fail(cli, EXIT_IO, "%s: cannot make a temporary file: %s", path, strerror(errno));
  else
    unlink(path);
  return file;
}

static const char *path_of(struct cli *cli, int file) {
  return cli_keep(cli, "/proc/self/fd/%d", file);
}

static int wait_for(struct cli *cli, pid_t child, const char *kind, const char *command) {
  int state;
  while (waitpid(child, &state, 0) < 0)
    if (errno != EINTR)
      return cli_fail(cli, EXIT_STAGE, "%s: %s: %s", kind, command, strerror(errno));
    else if (signals_cancelled())
      kill(child, SIGTERM);
  if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return EXIT_OK;
  if (WIFEXITED(state) && WEXITSTATUS(state) == 127)
    return cli_fail(cli, EXIT_MISSING, "%s: %s: cannot be run; is it in PATH?", kind, command);
  if (WIFEXITED(state))
    return cli_fail(cli, EXIT_STAGE, "%s: %s ended with exit code %d", kind, command, WEXITSTATUS(state));
  return cli_fail(cli, EXIT_STAGE, "%s: %s was ended by signal %d", kind, command,
                  WIFSIGNALED(state) ? WTERMSIG(state) : 0);
}

static int run_command(struct cli *cli, const char *kind, const char *command, int input, int output) {
  const pid_t child = lseek(input, 0, SEEK_SET) < 0 ? -1 : fork();
  if (child == 0) {
    signal(SIGPIPE, SIG_DFL);
    dup2(input, STDIN_FILENO);
    dup2(output, STDOUT_FILENO);
    execlp(command, command, (char *)NULL);
    _exit(127);
  }
  if (child < 0) return cli_fail(cli, EXIT_STAGE, "%s: %s: %s", kind, command, strerror(errno));
  return wait_for(cli, child, kind, command);
}

/* Puts the own recipe's section for this stage over the one that travels in the document. */
static conceg_status overlay(struct cli *cli, const char *kind, const conceg_recipe *own,
                             conceg_recipe *carried) {
  const conceg_node *section = conceg_node_get(conceg_recipe_root(own), kind);
  conceg_status status = CONCEG_OK;
  uint32_t i;
  for (i = 0; status == CONCEG_OK && i < conceg_node_count(section); i++) {
    const char *value = conceg_node_text(conceg_node_at(section, i));
    status = conceg_recipe_set(
        cli->ctx, carried, cli_keep(cli, "%s.%s=%s", kind, conceg_node_key(section, i), value ? value : ""));
  }
  return status;
}

/* The parameters reach the program through /recipe. */
static conceg_status carry_recipe(struct cli *cli, const char *kind, const conceg_recipe *own,
                                  const char *const *sets, conceg_doc *doc) {
  conceg_recipe *carried = NULL;
  conceg_status status;
  const char *text;
  if (conceg_doc_has(doc, "/recipe")) {
    status = conceg_recipe_from_doc(cli->ctx, doc, &carried);
    if (status == CONCEG_OK && own) status = overlay(cli, kind, own, carried);
  } else if (own) {
    status = conceg_recipe_parse(cli->ctx, conceg_recipe_text((conceg_recipe *)(uintptr_t)own), "recipe",
                                 &carried);
  } else {
    status = conceg_recipe_parse(cli->ctx, "conceg: 1\n", "recipe", &carried);
  }
  for (; status == CONCEG_OK && sets && *sets; sets++)
    status = conceg_recipe_set(cli->ctx, carried, *sets);
  if (status == CONCEG_OK && !conceg_node_get(conceg_recipe_root(carried), "seed"))
    status = conceg_recipe_set(cli->ctx, carried,
                               cli_keep(cli, "seed=%llu", (unsigned long long)conceg_ctx_seed(cli->ctx)));
  if (status == CONCEG_OK) {
    text = conceg_recipe_text(carried);
    status = text ? conceg_doc_write_text(doc, "/recipe", text) : CONCEG_E_NOMEM;
  }
  conceg_recipe_free(carried);
  return status;
}

int exec_stage(struct cli *cli, const char *kind, const char *command, const conceg_recipe *own,
               const char *const *sets, conceg_doc **doc) {
  int input, output;
  conceg_doc *result = NULL;
  conceg_status status;
  int code = EXIT_OK;
  if (!cli->allow_exec)
    return cli_fail(cli, EXIT_USAGE,
                    "%s: the recipe asks to run the program %s (impl: exec:); allow it with --allow-exec",
                    kind, command);
  input = nameless_file(cli);
  output = input >= 0 ? nameless_file(cli) : -1;
  if (output < 0) code = EXIT_IO;
  if (code == EXIT_OK) {
    status = carry_recipe(cli, kind, own, sets, *doc);
    if (status == CONCEG_OK) status = conceg_doc_save(*doc, path_of(cli, input));
    if (status != CONCEG_OK) code = cli_fail_status(cli, status);
  }
  if (code == EXIT_OK) code = run_command(cli, kind, command, input, output);
  if (code == EXIT_OK) {
    status = conceg_doc_open(cli->ctx, path_of(cli, output), &result);
    if (status == CONCEG_OK) status = conceg_doc_validate(result, NULL, NULL, NULL);
    if (status != CONCEG_OK)
      code = cli_fail(cli, EXIT_STAGE, "%s: %s wrote no valid document: %s", kind, command,
                      conceg_ctx_error(cli->ctx));
  }
  if (input >= 0) close(input);
  if (output >= 0) close(output);
  if (code != EXIT_OK) {
    if (result && conceg_doc_close(result) != CONCEG_OK) cli_fail_status(cli, CONCEG_E_IO);
    return code;
  }
  status = conceg_doc_close(*doc);
  *doc = result;
  return status == CONCEG_OK ? EXIT_OK : cli_fail_status(cli, status);
}
