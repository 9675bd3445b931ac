/* SPDX-License-Identifier: BSD-3-Clause
 * The context: last error, log, progress and cancel, settings, counters. */
#define _GNU_SOURCE
#include "ctx_internal.h"
#include "schema.h"

#include <pthread.h>
#include <sched.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LINE_BYTES = 4096, COUNTERS = 128, WORKERS = 256 };

struct counter {
  char *name;
  uint32_t workers; /* highest worker that counted, plus one */
  uint64_t value[WORKERS];
};

struct conceg_ctx {
  pthread_mutex_t error_mutex, log_mutex, progress_mutex, counter_mutex, schema_mutex;
  char error[LINE_BYTES];
  conceg_log_level log_level;
  conceg_log_fn log;
  void *log_user;
  conceg_progress_fn progress;
  void *progress_user;
  atomic_int cancelled;
  uint64_t seed, memory;
  uint32_t threads;
  char *tmpdir;
  _Atomic(struct counter *) counter[COUNTERS];
  atomic_uint counters;
  struct schema *schema;
};

static uint32_t processors(void) {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) return (uint32_t)CPU_COUNT(&set);
  const long online = sysconf(_SC_NPROCESSORS_ONLN);
  return online > 0 ? (uint32_t)online : 1;
}

static uint64_t half_of_memory(void) {
  const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page <= 0) return (uint64_t)1 << 30;
  return (uint64_t)pages * (uint64_t)page / 2;
}

static const char *default_tmpdir(void) {
  const char *path = getenv("TMPDIR");
  return path && *path ? path : "/tmp";
}

conceg_ctx *conceg_ctx_new(void) {
  conceg_ctx *ctx = calloc(1, sizeof *ctx);
  if (!ctx) return NULL;
  ctx->tmpdir = strdup(default_tmpdir());
  if (!ctx->tmpdir) {
    free(ctx);
    return NULL;
  }
  pthread_mutex_init(&ctx->error_mutex, NULL);
  pthread_mutex_init(&ctx->log_mutex, NULL);
  pthread_mutex_init(&ctx->progress_mutex, NULL);
  pthread_mutex_init(&ctx->counter_mutex, NULL);
  pthread_mutex_init(&ctx->schema_mutex, NULL);
  ctx->log_level = CONCEG_LOG_INFO;
  ctx->seed = 1;
  ctx->memory = half_of_memory();
  ctx->threads = processors();
  return ctx;
}

void conceg_ctx_free(conceg_ctx *ctx) {
  if (!ctx) return;
  for (uint32_t i = 0; i < atomic_load(&ctx->counters); i++) {
    struct counter *counter = atomic_load(&ctx->counter[i]);
    free(counter->name);
    free(counter);
  }
  schema_free(ctx->schema);
  pthread_mutex_destroy(&ctx->error_mutex);
  pthread_mutex_destroy(&ctx->log_mutex);
  pthread_mutex_destroy(&ctx->progress_mutex);
  pthread_mutex_destroy(&ctx->counter_mutex);
  pthread_mutex_destroy(&ctx->schema_mutex);
  free(ctx->tmpdir);
  free(ctx);
}

const struct schema *ctx_schema(conceg_ctx *ctx) {
  pthread_mutex_lock(&ctx->schema_mutex);
  if (!ctx->schema && schema_new(ctx, &ctx->schema) != CONCEG_OK) ctx->schema = NULL;
  const struct schema *schema = ctx->schema;
  pthread_mutex_unlock(&ctx->schema_mutex);
  return schema;
}

void conceg_ctx_set_log(conceg_ctx *ctx, conceg_log_level level, conceg_log_fn fn, void *user) {
  pthread_mutex_lock(&ctx->log_mutex);
  ctx->log_level = level;
  ctx->log = fn;
  ctx->log_user = user;
  pthread_mutex_unlock(&ctx->log_mutex);
}

void conceg_ctx_set_progress(conceg_ctx *ctx, conceg_progress_fn fn, void *user) {
  pthread_mutex_lock(&ctx->progress_mutex);
  ctx->progress = fn;
  ctx->progress_user = user;
  pthread_mutex_unlock(&ctx->progress_mutex);
}

void conceg_ctx_set_seed(conceg_ctx *ctx, uint64_t seed) {
  ctx->seed = seed;
}
uint64_t conceg_ctx_seed(const conceg_ctx *ctx) {
  return ctx->seed;
}
void conceg_ctx_set_threads(conceg_ctx *ctx, uint32_t threads) {
  ctx->threads = threads ? threads : processors();
}
uint32_t conceg_ctx_threads(const conceg_ctx *ctx) {
  return ctx->threads;
}
void conceg_ctx_set_memory(conceg_ctx *ctx, uint64_t bytes) {
  ctx->memory = bytes;
}
uint64_t conceg_ctx_memory(const conceg_ctx *ctx) {
  return ctx->memory;
}
const char *conceg_ctx_tmpdir(const conceg_ctx *ctx) {
  return ctx->tmpdir;
}

conceg_status conceg_ctx_set_tmpdir(conceg_ctx *ctx, const char *path) {
  struct stat info;
  if (!path || !*path) path = default_tmpdir();
  if (stat(path, &info) != 0 || !S_ISDIR(info.st_mode) || access(path, W_OK | X_OK) != 0)
    return conceg_ctx_fail(ctx, CONCEG_E_IO, "temporary folder: %s: expected a folder that can be written to",
                           path);
  char *copy = strdup(path);
  if (!copy) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "temporary folder: out of memory");
  free(ctx->tmpdir);
  ctx->tmpdir = copy;
  return CONCEG_OK;
}

/* One line of text: control characters become spaces, a line that is too long ends in "...". */
static void format_line(char line[LINE_BYTES], const char *format, va_list arguments) {
  const int length = vsnprintf(line, LINE_BYTES, format, arguments);
  if (length >= LINE_BYTES) memcpy(line + LINE_BYTES - 4, "...", 4);
  if (length < 0) line[0] = '\0';
  for (char *c = line; *c; c++)
    if ((unsigned char)*c < 0x20 || *c == 0x7f) *c = ' ';
}

const char *conceg_ctx_error(const conceg_ctx *ctx) {
  return ctx->error;
}

void conceg_ctx_clear_error(conceg_ctx *ctx) {
  pthread_mutex_lock(&ctx->error_mutex);
  ctx->error[0] = '\0';
  pthread_mutex_unlock(&ctx->error_mutex);
}

conceg_status conceg_ctx_fail(conceg_ctx *ctx, conceg_status status, const char *format, ...) {
  char line[LINE_BYTES]; /* the arguments may be the present error line itself */
  va_list arguments;
  va_start(arguments, format);
  format_line(line, format, arguments);
  va_end(arguments);
  pthread_mutex_lock(&ctx->error_mutex);
  memcpy(ctx->error, line, strlen(line) + 1);
  pthread_mutex_unlock(&ctx->error_mutex);
  return status;
}

void conceg_ctx_log(conceg_ctx *ctx, conceg_log_level level, const char *format, ...) {
  char line[LINE_BYTES];
  pthread_mutex_lock(&ctx->log_mutex);
  if (ctx->log && level <= ctx->log_level) {
    va_list arguments;
    va_start(arguments, format);
    format_line(line, format, arguments);
    va_end(arguments);
    ctx->log(ctx->log_user, level, line);
  }
  pthread_mutex_unlock(&ctx->log_mutex);
}

conceg_status conceg_ctx_progress(conceg_ctx *ctx, const char *what, uint64_t done, uint64_t total) {
  /* A worker never waits for another one's report; only the last report of a loop must arrive. */
  const int last = total && done >= total;
  const int locked =
      last ? pthread_mutex_lock(&ctx->progress_mutex) == 0 : pthread_mutex_trylock(&ctx->progress_mutex) == 0;
  if (locked) {
    if (!atomic_load(&ctx->cancelled) && ctx->progress &&
        ctx->progress(ctx->progress_user, what, done, total))
      atomic_store(&ctx->cancelled, 1);
    pthread_mutex_unlock(&ctx->progress_mutex);
  }
  if (!atomic_load(&ctx->cancelled)) return CONCEG_OK;
  return conceg_ctx_fail(ctx, CONCEG_E_CANCELLED, "%s: cancelled", what);
}

static struct counter *find_counter(conceg_ctx *ctx, const char *name) {
  const uint32_t count = atomic_load_explicit(&ctx->counters, memory_order_acquire);
  for (uint32_t i = 0; i < count; i++) {
    struct counter *counter = atomic_load_explicit(&ctx->counter[i], memory_order_relaxed);
    if (strcmp(counter->name, name) == 0) return counter;
  }
  return NULL;
}

static struct counter *add_counter(conceg_ctx *ctx, const char *name) {
  pthread_mutex_lock(&ctx->counter_mutex);
  struct counter *counter = find_counter(ctx, name);
  const uint32_t count = atomic_load(&ctx->counters);
  if (!counter && count < COUNTERS) {
    counter = calloc(1, sizeof *counter);
    if (counter && !(counter->name = strdup(name))) {
      free(counter);
      counter = NULL;
    }
    if (counter) {
      atomic_store(&ctx->counter[count], counter);
      atomic_store_explicit(&ctx->counters, count + 1, memory_order_release);
    }
  }
  pthread_mutex_unlock(&ctx->counter_mutex);
  return counter;
}

void conceg_ctx_count(conceg_ctx *ctx, const char *name, uint32_t worker, uint64_t add) {
  if (worker >= WORKERS) worker = WORKERS - 1;
  struct counter *counter = find_counter(ctx, name);
  if (!counter) counter = add_counter(ctx, name);
  if (!counter) return; /* counters only inform */
  __atomic_fetch_add(&counter->value[worker], add, __ATOMIC_RELAXED);
  uint32_t seen = __atomic_load_n(&counter->workers, __ATOMIC_RELAXED);
  while (seen < worker + 1 && !__atomic_compare_exchange_n(&counter->workers, &seen, worker + 1, 0,
                                                           __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
}

uint32_t conceg_ctx_counters(const conceg_ctx *ctx) {
  return atomic_load(&ctx->counters);
}

const char *conceg_ctx_counter(const conceg_ctx *ctx, uint32_t index, const uint64_t **values,
                               uint32_t *workers) {
  if (index >= atomic_load(&ctx->counters)) return NULL;
  const struct counter *counter = atomic_load(&ctx->counter[index]);
  if (values) *values = counter->value;
  if (workers) *workers = __atomic_load_n(&counter->workers, __ATOMIC_RELAXED);
  return counter->name;
}
