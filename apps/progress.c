/* SPDX-License-Identifier: BSD-3-Clause
 * Progress, clocks and signals of the programs. */
#define _GNU_SOURCE
#include "progress.h"

#include "exitcode.h"
#include "outlook.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#define PHASE "phase: "

static volatile sig_atomic_t cancelled, waiting_for_input;

static void on_signal(int number) {
  static const char line[] = "conceg: error: cancelled while waiting for input\n";
  (void)number;
  cancelled = 1;
  if (!waiting_for_input) return;
  if (write(STDERR_FILENO, line, sizeof line - 1) < 0) _exit(EXIT_CANCELLED);
  _exit(EXIT_CANCELLED);
}

void streams_occupy(void) {
  /* The wrong direction on purpose: EBADF instead of bytes that go nowhere. */
  static const int direction[3] = {O_WRONLY, O_RDONLY, O_RDONLY};
  int stream;
  for (stream = 0; stream < 3; stream++)
    if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", direction[stream]) != stream) return;
}

void signals_catch(void) {
  struct sigaction action;
  memset(&action, 0, sizeof action);
  sigemptyset(&action.sa_mask);
  action.sa_handler = on_signal;
  action.sa_flags = (int)SA_RESETHAND;
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  sigaction(SIGHUP, &action, NULL);
  action.sa_handler = SIG_IGN;
  action.sa_flags = 0;
  sigaction(SIGPIPE, &action, NULL);
  sigaction(SIGXFSZ, &action, NULL);
}

int signals_cancelled(void) {
  return cancelled;
}
void signals_waiting(int waiting) {
  waiting_for_input = waiting;
}

double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double seconds_of_cpu(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

uint64_t peak_memory(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (uint64_t)usage.ru_maxrss * 1024;
}

void progress_init(struct progress *progress, enum progress_mode mode, const char *prefix, const char *word) {
  memset(progress, 0, sizeof *progress);
  progress->mode = mode;
  progress->prefix = prefix;
  progress->word = word;
  progress->is_terminal = isatty(STDERR_FILENO);
}

void progress_clear(struct progress *progress) {
  if (!progress->bar_is_drawn) return;
  fputs("\r\033[K", stderr);
  progress->bar_is_drawn = 0;
}

static void format_rate(char *out, size_t size, double rate) {
  if (rate >= 1e6)
    snprintf(out, size, "%.1fM/s", rate / 1e6);
  else if (rate >= 1e3)
    snprintf(out, size, "%.1fk/s", rate / 1e3);
  else
    snprintf(out, size, "%.1f/s", rate);
}

void progress_run(struct progress *progress, double stage_seconds, double later_seconds) {
  progress->stage_began = seconds_now();
  progress->stage_seconds = stage_seconds;
  progress->later_seconds = later_seconds;
}

/* Of the whole run; below 0 where it is not known. A stage that takes longer than its weight says has at
 * least its own step to end. */
static double run_left(const struct progress *progress, uint64_t done, uint64_t total, double now) {
  const double elapsed = now - progress->began,
               of_stage = progress->stage_seconds - (now - progress->stage_began);
  const double of_step = done && total > done ? elapsed / (double)done * (double)(total - done) : 0;
  if (!(progress->stage_seconds + progress->later_seconds > 0)) return -1;
  return progress->later_seconds + (of_stage > of_step ? of_stage : of_step);
}

static void print_run_left(const struct progress *progress, uint64_t done, uint64_t total, double now) {
  const double left = run_left(progress, done, total, now);
  char text[32];
  if (left < 0) return;
  outlook_time_text(text, sizeof text, left);
  fprintf(stderr, "; about %s left of the run", text);
}

static void draw_bar(struct progress *progress, uint64_t done, uint64_t total, double now) {
  const double elapsed = now - progress->began, rate = elapsed > 0 ? (double)done / elapsed : 0;
  char speed[32], bar[21];
  unsigned filled, i;
  format_rate(speed, sizeof speed, rate);
  if (!total) {
    fprintf(stderr, "\r\033[K%s: %s %llu  %s", progress->prefix, progress->what, (unsigned long long)done,
            speed);
  } else {
    const double part = done < total ? (double)done / (double)total : 1.0;
    filled = (unsigned)(part * 20);
    for (i = 0; i < 20; i++)
      bar[i] = i < filled ? '#' : '.';
    bar[20] = '\0';
    fprintf(stderr, "\r\033[K%s: %s [%s] %3.0f %%  %s", progress->prefix, progress->what, bar, 100 * part,
            speed);
    if (rate > 0 && done < total) fprintf(stderr, "  %.0f s left", (double)(total - done) / rate);
    print_run_left(progress, done, total, now);
  }
  progress->bar_is_drawn = 1;
  progress->drawn = now;
}

static void print_json_text(const char *text) {
  for (; *text; text++) {
    if (*text == '"' || *text == '\\') fputc('\\', stderr);
    if ((unsigned char)*text >= 0x20) fputc(*text, stderr);
  }
}

static void print_json(struct progress *progress, uint64_t done, uint64_t total, double now) {
  fputs("{\"progress\":\"", stderr);
  print_json_text(progress->what);
  fprintf(stderr, "\",\"done\":%llu,\"total\":%llu,\"seconds\":%.3f", (unsigned long long)done,
          (unsigned long long)total, now - progress->began);
  if (run_left(progress, done, total, now) >= 0)
    fprintf(stderr, ",\"run_seconds_left\":%.0f", run_left(progress, done, total, now));
  fputs("}\n", stderr);
  progress->drawn = now;
}

void progress_phase(struct progress *progress, const char *phase, const char *stage) {
  if (progress->mode != PROGRESS_JSON) return;
  fputs("{\"phase\":\"", stderr);
  print_json_text(phase);
  fputs("\",\"stage\":\"", stderr);
  print_json_text(stage ? stage : "");
  fputs("\"}\n", stderr);
}

/* A line each time another tenth is reached, but none for work that is over in a moment. */
static void print_tenth(struct progress *progress, uint64_t done, uint64_t total, double now) {
  const int tenth = total ? (int)((double)done / (double)total * 10) : 0;
  if (!total || tenth <= progress->last_tenth) return;
  progress->last_tenth = tenth;
  if (now - progress->began < 1.0) return;
  fprintf(stderr, "%s: %s %d %%", progress->prefix, progress->what, tenth * 10);
  print_run_left(progress, done, total, now);
  fputc('\n', stderr);
}

int progress_report(void *user, const char *what, uint64_t done, uint64_t total) {
  struct progress *progress = user;
  const size_t word = progress->word ? strlen(progress->word) : 0;
  double now;
  if (progress->mode == PROGRESS_NONE) return cancelled;
  if (!strncmp(what, PHASE, sizeof PHASE - 1)) { /* of the host: "phase: run grow" */
    char phase[16] = "";
    const char *stage = strchr(what + sizeof PHASE - 1, ' ');
    snprintf(phase, sizeof phase, "%.*s", (int)strcspn(what + sizeof PHASE - 1, " "),
             what + sizeof PHASE - 1);
    progress_phase(progress, phase, stage ? stage + 1 : NULL);
    return cancelled;
  }
  if (word && !strncmp(what, progress->word, word) && !strncmp(what + word, ": ", 2)) what += word + 2;
  now = seconds_now();
  if (strncmp(progress->what, what, sizeof progress->what - 1) != 0 || done < progress->done) {
    snprintf(progress->what, sizeof progress->what, "%s", what);
    progress->began = progress->drawn = now;
    progress->last_tenth = 0;
  }
  progress->done = done;
  if (progress->mode == PROGRESS_JSON) {
    if (done == total || now - progress->drawn >= 0.5) print_json(progress, done, total, now);
  } else if (!progress->is_terminal) {
    print_tenth(progress, done, total, now);
  } else if (now - progress->drawn >= 0.1) {
    draw_bar(progress, done, total, now);
  }
  return cancelled;
}
