/* SPDX-License-Identifier: BSD-3-Clause
 * Progress on standard error: a bar on a terminal, a line per 10 % otherwise, or JSON lines. */
#ifndef CONCEG_APPS_PROGRESS_H
#define CONCEG_APPS_PROGRESS_H

#include <stdint.h>

enum progress_mode { PROGRESS_AUTO, PROGRESS_JSON, PROGRESS_NONE };

struct progress {
  enum progress_mode mode;
  int is_terminal, bar_is_drawn;
  const char *prefix; /* "conceg grow" */
  const char *word;   /* "grow": taken off the front of what is reported; NULL for tools */
  char what[80];
  uint64_t done;
  int last_tenth;
  double began, drawn; /* seconds */
  /* Of a whole run, by the weights of its stages: when this stage began, what it and all later ones take. */
  double stage_began, stage_seconds, later_seconds;
};

void progress_init(struct progress *progress, enum progress_mode mode, const char *prefix, const char *word);
/* A conceg_progress_fn; `user` is a struct progress. Returns 1 once SIGINT or SIGTERM has come. */
int progress_report(void *user, const char *what, uint64_t done, uint64_t total);
/* What a program is at: "read", "run", "write" of a stage. A JSON line; nothing in the other modes. */
void progress_phase(struct progress *progress, const char *phase, const char *stage);
/* From here on the stage takes so many seconds by its weight, and all later ones together so many: the time
 * that is left of the whole run is then shown too. Both 0: not known. */
void progress_run(struct progress *progress, double stage_seconds, double later_seconds);
/* Takes the bar off the terminal, before a line is printed and at the end. */
void progress_clear(struct progress *progress);

double seconds_now(void);    /* monotonic */
double seconds_of_cpu(void); /* user and system, of this process */
uint64_t peak_memory(void);  /* bytes resident at most, of this process */

/* Standard streams that were closed are occupied, so that no file that is opened later is taken for one of
 * them: reading or writing them is an error. */
void streams_occupy(void);

/* Catches SIGINT, SIGTERM and SIGHUP (the second one kills) and ignores SIGPIPE and SIGXFSZ, so that a closed
 * pipe or a file that may not grow is an error with a line. */
void signals_catch(void);
int signals_cancelled(void);
/* While a program only waits for its input there is nothing to clean up: a signal then ends it at once. */
void signals_waiting(int waiting);

#endif
