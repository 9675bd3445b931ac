/* SPDX-License-Identifier: BSD-3-Clause
 * The context: last error, log, progress and cancel, seed, threads, temporary folder, memory budget.
 * One context belongs to one thread at a time; the functions marked "any thread" may be called from workers.
 */
#ifndef CONCEG_CTX_H
#define CONCEG_CTX_H

#include "conceg/base.h"

CONCEG_BEGIN_C

typedef struct conceg_ctx conceg_ctx;

typedef enum conceg_log_level {
  CONCEG_LOG_ERROR = 0,
  CONCEG_LOG_WARNING = 1,
  CONCEG_LOG_RESULT = 2, /* what was asked for, such as a table of figures; shown unless quiet */
  CONCEG_LOG_INFO = 3,
  CONCEG_LOG_DEBUG = 4,
  CONCEG_LOG_MAXIMUM = 0x7fffffff
} conceg_log_level;

typedef void (*conceg_log_fn)(void *user, conceg_log_level level, const char *line);

/* Called with the work done and the total (total 0 = unknown). A non-zero return cancels the run. Never
 * called concurrently. */
typedef int (*conceg_progress_fn)(void *user, const char *what, uint64_t done, uint64_t total);

/* New context with seed 1, all processors, TMPDIR or /tmp, half of the machine's memory, and no log. NULL
 * when out of memory. */
CONCEG_API conceg_ctx *conceg_ctx_new(void);
CONCEG_API void conceg_ctx_free(conceg_ctx *ctx);

/* Lines up to `level` go to `fn`, which may come from any thread; NULL = no log. `user` is borrowed. */
CONCEG_API void conceg_ctx_set_log(conceg_ctx *ctx, conceg_log_level level, conceg_log_fn fn, void *user);
/* Who is told of progress and may cancel; NULL = nobody. `user` is borrowed. */
CONCEG_API void conceg_ctx_set_progress(conceg_ctx *ctx, conceg_progress_fn fn, void *user);
/* The seed of all random draws of the stages that run next; 1 in a new context. */
CONCEG_API void conceg_ctx_set_seed(conceg_ctx *ctx, uint64_t seed);
CONCEG_API uint64_t conceg_ctx_seed(const conceg_ctx *ctx);
/* Number of worker threads, >= 1; 0 sets one per processor. Results never depend on it. */
CONCEG_API void conceg_ctx_set_threads(conceg_ctx *ctx, uint32_t threads);
CONCEG_API uint32_t conceg_ctx_threads(const conceg_ctx *ctx);
CONCEG_API conceg_status conceg_ctx_set_tmpdir(conceg_ctx *ctx, const char *path);
CONCEG_API const char *conceg_ctx_tmpdir(const conceg_ctx *ctx);
/* Bytes of array data that a document keeps in memory before it moves arrays to a file in the temporary
 * folder. */
CONCEG_API void conceg_ctx_set_memory(conceg_ctx *ctx, uint64_t bytes);
CONCEG_API uint64_t conceg_ctx_memory(const conceg_ctx *ctx);

/* The last error as one line "what: path[index]: expected, got"; "" when none. Borrowed until the next
 * failing call. */
CONCEG_API const char *conceg_ctx_error(const conceg_ctx *ctx);
CONCEG_API void conceg_ctx_clear_error(conceg_ctx *ctx);
/* Stores a formatted error line and returns `status`, so that a stage can write: return conceg_ctx_fail(ctx,
 * ...). Any thread. */
CONCEG_API conceg_status conceg_ctx_fail(conceg_ctx *ctx, conceg_status status, const char *format, ...)
    CONCEG_PRINTF(3, 4);
/* Sends one line to the log. Any thread. */
CONCEG_API void conceg_ctx_log(conceg_ctx *ctx, conceg_log_level level, const char *format, ...)
    CONCEG_PRINTF(3, 4);
/* Reports progress; returns CONCEG_E_CANCELLED (with the error set) once the caller asked to stop, else
 * CONCEG_OK. Any thread. */
CONCEG_API conceg_status conceg_ctx_progress(conceg_ctx *ctx, const char *what, uint64_t done,
                                             uint64_t total);

/* Adds to a named counter ("grow.steps") of one worker (0-based, below 256). Any thread. Read back in tests
 * and by -v. */
CONCEG_API void conceg_ctx_count(conceg_ctx *ctx, const char *counter, uint32_t worker, uint64_t add);
/* Number of counters, and the i-th one: its name and values per worker (borrowed; `workers` receives how
 * many). */
CONCEG_API uint32_t conceg_ctx_counters(const conceg_ctx *ctx);
CONCEG_API const char *conceg_ctx_counter(const conceg_ctx *ctx, uint32_t index, const uint64_t **values,
                                          uint32_t *workers);

CONCEG_END_C
#endif
