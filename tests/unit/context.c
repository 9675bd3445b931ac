/* SPDX-License-Identifier: BSD-3-Clause
 * The context: one error line, log levels, cancel, and counters from many threads. */
#define _XOPEN_SOURCE 700
#include "check.h"

#include "conceg/conceg.h"

#include <pthread.h>

enum { THREADS = 8, STEPS = 20000 };

struct worker {
  conceg_ctx *ctx;
  uint32_t index;
};

static void *count(void *user) {
  const struct worker *worker = user;
  for (int i = 0; i < STEPS; i++) {
    conceg_ctx_count(worker->ctx, "grow.steps", worker->index, 2);
    if (i % 100 == 0) conceg_ctx_count(worker->ctx, i % 200 ? "odd" : "even", 0, 1);
  }
  return NULL;
}

static void run(conceg_ctx *ctx, void *(*body)(void *)) {
  pthread_t thread[THREADS];
  struct worker worker[THREADS];
  for (uint32_t i = 0; i < THREADS; i++) {
    worker[i] = (struct worker){ctx, i};
    pthread_create(&thread[i], NULL, body, &worker[i]);
  }
  for (int i = 0; i < THREADS; i++)
    pthread_join(thread[i], NULL);
}

static void test_counters(void) {
  conceg_ctx *ctx = conceg_ctx_new();
  run(ctx, count);
  CHECK_EQUAL(conceg_ctx_counters(ctx), 3);
  uint64_t seen = 0;
  for (uint32_t c = 0; c < conceg_ctx_counters(ctx); c++) {
    const uint64_t *values = NULL;
    uint32_t workers = 0;
    const char *name = conceg_ctx_counter(ctx, c, &values, &workers);
    uint64_t sum = 0;
    for (uint32_t w = 0; w < workers; w++)
      sum += values[w];
    if (strcmp(name, "grow.steps") == 0) {
      CHECK_EQUAL(workers, THREADS);
      CHECK_EQUAL(sum, 2 * THREADS * STEPS);
      CHECK_EQUAL(values[3], 2 * STEPS);
    } else {
      CHECK_EQUAL(workers, 1);
      CHECK_EQUAL(sum, THREADS * STEPS / 200);
    }
    seen++;
  }
  CHECK_EQUAL(seen, 3);
  CHECK(conceg_ctx_counter(ctx, 3, NULL, NULL) == NULL);
  conceg_ctx_free(ctx);
}

struct progress {
  int inside, calls, overlap;
  uint64_t last;
};

static int on_progress(void *user, const char *what, uint64_t done, uint64_t total) {
  struct progress *progress = user;
  (void)what;
  (void)total;
  if (__atomic_fetch_add(&progress->inside, 1, __ATOMIC_SEQ_CST)) progress->overlap = 1;
  progress->calls++;
  progress->last = done;
  __atomic_fetch_sub(&progress->inside, 1, __ATOMIC_SEQ_CST);
  return done == 500; /* cancels there */
}

static void *report(void *user) {
  const struct worker *worker = user;
  for (uint64_t i = 1; i < 400; i++)
    (void)conceg_ctx_progress(worker->ctx, "work", i, 1000);
  return NULL;
}

static void test_progress(void) {
  struct progress progress = {0};
  conceg_ctx *ctx = conceg_ctx_new();
  CHECK_EQUAL(conceg_ctx_progress(ctx, "work", 1, 2), CONCEG_OK);
  conceg_ctx_set_progress(ctx, on_progress, &progress);
  run(ctx, report);
  CHECK(progress.calls > 0 && !progress.overlap);
  CHECK_EQUAL(conceg_ctx_progress(ctx, "work", 1000, 1000), CONCEG_OK);
  CHECK_EQUAL(progress.last, 1000);
  CHECK_EQUAL(conceg_ctx_progress(ctx, "work", 500, 1000), CONCEG_E_CANCELLED);
  CHECK(strstr(conceg_ctx_error(ctx), "cancelled") != NULL);
  const int calls = progress.calls;
  CHECK_EQUAL(conceg_ctx_progress(ctx, "more", 1, 1000), CONCEG_E_CANCELLED); /* it stays cancelled */
  CHECK_EQUAL(progress.calls, calls);
  conceg_ctx_free(ctx);
}

static void test_error(void) {
  conceg_ctx *ctx = conceg_ctx_new();
  CHECK_TEXT(conceg_ctx_error(ctx), "");
  CHECK_EQUAL(conceg_ctx_fail(ctx, CONCEG_E_RANGE, "cells[%d]: expected %s,\ngot %g", 3, "a radius", -1.0),
              CONCEG_E_RANGE);
  CHECK_TEXT(conceg_ctx_error(ctx), "cells[3]: expected a radius, got -1"); /* one line */
  (void)conceg_ctx_fail(ctx, CONCEG_E_STAGE, "grow: %s", conceg_ctx_error(ctx));
  CHECK_TEXT(conceg_ctx_error(ctx), "grow: cells[3]: expected a radius, got -1");
  conceg_ctx_clear_error(ctx);
  CHECK_TEXT(conceg_ctx_error(ctx), "");
  char *text = calloc(10000, 1);
  memset(text, 'x', 9999);
  (void)conceg_ctx_fail(ctx, CONCEG_E_STAGE, "%s", text);
  CHECK(strlen(conceg_ctx_error(ctx)) < 5000 && strstr(conceg_ctx_error(ctx), "...") != NULL);
  free(text);
  CHECK_TEXT(conceg_status_name(CONCEG_E_VERSION), "E_VERSION");
  CHECK_TEXT(conceg_status_name(CONCEG_OK), "OK");
  CHECK_TEXT(conceg_status_name((conceg_status)-999), "E_UNKNOWN");
  CHECK(strlen(conceg_status_text(CONCEG_E_IO)) > 0);
  CHECK_TEXT(conceg_version(), CONCEG_VERSION_TEXT);
  conceg_ctx_free(ctx);
  conceg_ctx_free(NULL);
}

static void keep(void *user, conceg_log_level level, const char *line) {
  char *text = user;
  snprintf(text, 128, "%d %s", (int)level, line);
}

static void test_settings(void) {
  char line[128] = "";
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_log(ctx, CONCEG_LOG_WARNING, keep, line);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "not shown");
  CHECK_TEXT(line, "");
  conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "cell %d", 7);
  CHECK_TEXT(line, "1 cell 7");
  CHECK_EQUAL(conceg_ctx_seed(ctx), 1);
  CHECK(conceg_ctx_threads(ctx) >= 1);
  conceg_ctx_set_threads(ctx, 3);
  CHECK_EQUAL(conceg_ctx_threads(ctx), 3);
  conceg_ctx_set_threads(ctx, 0);
  CHECK(conceg_ctx_threads(ctx) >= 1);
  conceg_ctx_set_memory(ctx, 12345);
  CHECK_EQUAL(conceg_ctx_memory(ctx), 12345);
  CHECK_EQUAL(conceg_ctx_set_tmpdir(ctx, "."), CONCEG_OK);
  CHECK_TEXT(conceg_ctx_tmpdir(ctx), ".");
  conceg_ctx_free(ctx);
}

int main(void) {
  test_counters();
  test_progress();
  test_error();
  test_settings();
  return check_done();
}
