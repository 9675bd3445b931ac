/* SPDX-License-Identifier: BSD-3-Clause
 * Keeping a stage's accidents from passing for results. */
#define _GNU_SOURCE
#include "contain.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t running;
static char who[200];    /* "conceg relax: error: relax (beads)" */
static char input[1200]; /* "conceg info: error: a.cgx"; empty before a document is opened */

/* Only what a signal handler may call. */
static void say(const char *text) {
  if (write(STDERR_FILENO, text, strlen(text)) < 0) _exit(EXIT_STAGE);
}

static void on_crash(int number) {
  char digits[3] = {(char)('0' + number / 10), (char)('0' + number % 10), '\0'};
  if (running) {
    say(who);
    say(" crashed while it ran: signal ");
    say(number < 10 ? digits + 1 : digits);
    say("; nothing was written\n");
  }
  if (!running && *input) {
    say(input);
    say(": damaged: the program crashed while it read the document: signal ");
    say(number < 10 ? digits + 1 : digits);
    say("\n");
  }
  if ((running || *input) && !getenv("CONCEG_CORE")) _exit(running ? EXIT_STAGE : EXIT_INPUT);
  signal(number, SIG_DFL);
  raise(number);
}

static void on_exit_call(void) {
  if (!running) return;
  say(who);
  say(" ended the program while it ran; nothing was written\n");
  _exit(EXIT_STAGE);
}

static void install(void) {
  static int installed;
  if (installed) return;
  installed = 1;
  atexit(on_exit_call);
#ifndef __SANITIZE_ADDRESS__ /* which reports crashes itself, and better */
  static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
  static char stack[1 << 16]; /* a stack that overflowed cannot serve the handler */
  const stack_t aside = {.ss_sp = stack, .ss_size = sizeof stack};
  struct sigaction action;
  size_t i;
  sigaltstack(&aside, NULL);
  memset(&action, 0, sizeof action);
  sigemptyset(&action.sa_mask);
  action.sa_handler = on_crash;
  action.sa_flags = (int)SA_ONSTACK;
  for (i = 0; i < sizeof signals / sizeof *signals; i++)
    sigaction(signals[i], &action, NULL);
#else
  (void)on_crash;
#endif
}

void contain_input(const struct cli *cli, const char *name) {
  install();
  snprintf(input, sizeof input, "%.60s: error: %.1000s", cli->program->name, name);
}

conceg_status contain_stage(struct cli *cli, const conceg_stage *stage, conceg_doc *doc,
                            const conceg_params *params) {
  conceg_status status;
  int standard_output;
  install();
  fflush(stdout);
  standard_output = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  if (standard_output < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
    if (standard_output >= 0) close(standard_output);
    return conceg_ctx_fail(cli->ctx, CONCEG_E_IO, "standard output: %s", strerror(errno));
  }
  snprintf(who, sizeof who, "%.60s: error: %.60s (%.60s)", cli->program->name, stage->kind, stage->name);
  running = 1;
  status = conceg_stage_run(cli->ctx, stage, doc, params);
  running = 0;
  fflush(stdout);
  if (dup2(standard_output, STDOUT_FILENO) < 0 && status == CONCEG_OK)
    status = conceg_ctx_fail(cli->ctx, CONCEG_E_IO, "standard output: %s", strerror(errno));
  close(standard_output);
  return status;
}
