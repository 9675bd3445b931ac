/* SPDX-License-Identifier: BSD-3-Clause
 * Rates of locate and intersect on a meshed document, as one JSON object on standard error.  bench_query FILE
 * THREADS */
#define _POSIX_C_SOURCE 200809L
#include "conceg/query.h"
#include "conceg/conceg.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

enum { COUNT = 1000000, MOST_THREADS = 64 };

struct clocks {
  double wall, cpu;
};
static struct clocks now(void) {
  struct timespec wall;
  struct rusage usage;
  clock_gettime(CLOCK_MONOTONIC, &wall);
  getrusage(RUSAGE_SELF, &usage);
  return (struct clocks){(double)wall.tv_sec + 1e-9 * (double)wall.tv_nsec,
                         (double)usage.ru_utime.tv_sec + 1e-6 * (double)usage.ru_utime.tv_usec};
}
static long resident_mib(void) {
  long pages = 0, unused;
  FILE *file = fopen("/proc/self/statm", "r");
  if (!file || fscanf(file, "%ld %ld", &unused, &pages) != 2) pages = 0;
  if (file) fclose(file);
  return pages * 4 / 1024;
}

struct work {
  const conceg_query *query;
  const double *point, *direction, *length;
  int64_t *cell;
  conceg_hit *hit;
  uint64_t first, count;
  int failed;
};
static void *run_part(void *user) {
  struct work *w = user;
  const double *point = w->point + 3 * w->first;
  w->failed = w->hit ? conceg_query_intersect(w->query, w->count, point, w->direction + 3 * w->first,
                                              w->length + w->first, w->hit + w->first)
                     : conceg_query_locate(w->query, w->count, point, w->cell + w->first, NULL);
  return NULL;
}

/* All of the work on that many threads: its clocks. */
static struct clocks run(struct work all, unsigned threads) {
  pthread_t thread[MOST_THREADS];
  struct work part[MOST_THREADS];
  const struct clocks start = now();
  for (unsigned i = 0; i < threads; i++) {
    part[i] = all;
    part[i].first = COUNT / threads * i,
    part[i].count = i + 1 == threads ? COUNT - part[i].first : COUNT / threads;
    if (pthread_create(&thread[i], NULL, run_part, &part[i])) exit(1);
  }
  for (unsigned i = 0; i < threads; i++) {
    pthread_join(thread[i], NULL);
    if (part[i].failed) exit(1);
  }
  const struct clocks end = now();
  return (struct clocks){end.wall - start.wall, end.cpu - start.cpu};
}

static void print(const char *name, struct clocks one, struct clocks many, uint64_t found, int same) {
  fprintf(
      stderr,
      ", \"%s\": {\"count\": %d, \"found\": %llu, \"one_thread_wall_s\": %.3f, \"one_thread_user_s\": %.3f, "
      "\"wall_s\": %.3f, \"user_s\": %.3f, \"per_s\": %.0f, \"same\": %s}",
      name, COUNT, (unsigned long long)found, one.wall, one.cpu, many.wall, many.cpu, COUNT / many.wall,
      same ? "true" : "false");
}

int main(int argc, char **argv) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_substrate *substrate = NULL;
  conceg_query *query = NULL;
  const unsigned threads = argc == 3 ? (unsigned)atoi(argv[2]) : 0;
  if (!ctx || !threads || threads > MOST_THREADS) return 2;
  const struct clocks begin = now();
  if (conceg_substrate_open_file(ctx, argv[1], &substrate) != CONCEG_OK) return 1;
  const struct clocks opened = now();
  const long open_mib = resident_mib();
  if (conceg_query_new(ctx, substrate, &query) != CONCEG_OK) return 1;
  const struct clocks built = now();
  fprintf(stderr,
          "{\"threads\": %u, \"open_s\": %.3f, \"open_rss_mib\": %ld, \"build_wall_s\": %.3f, "
          "\"build_user_s\": %.3f, "
          "\"build_rss_mib\": %ld",
          threads, opened.wall - begin.wall, open_mib, built.wall - opened.wall, built.cpu - opened.cpu,
          resident_mib());

  double lo[3], hi[3], *point = malloc(3 * COUNT * sizeof *point),
                       *direction = malloc(3 * COUNT * sizeof *direction),
                       *length = malloc(COUNT * sizeof *length);
  int64_t *cell[2] = {malloc(COUNT * sizeof(int64_t)), malloc(COUNT * sizeof(int64_t))};
  conceg_hit *hit[2] = {calloc(COUNT, sizeof(conceg_hit)), calloc(COUNT, sizeof(conceg_hit))};
  uint8_t periodic[3];
  if (!point || !direction || !length || !cell[0] || !cell[1] || !hit[0] || !hit[1]) return 1;
  conceg_substrate_box(substrate, lo, hi, periodic);
  conceg_rng rng = conceg_rng_stream(1, "bench.query", 0);
  for (uint64_t i = 0; i < COUNT; i++) {
    double norm = 0, *d = direction + 3 * i;
    for (int axis = 0; axis < 3; axis++) {
      point[3 * i + (uint64_t)axis] = lo[axis] + (hi[axis] - lo[axis]) * conceg_rng_uniform(&rng);
      d[axis] = conceg_rng_normal(&rng), norm += d[axis] * d[axis];
    }
    for (int axis = 0; axis < 3; axis++)
      d[axis] /= __builtin_sqrt(norm);
  }
  struct work work = {query, point, direction, length, cell[0], NULL, 0, 0, 0};
  struct clocks one = run(work, 1);
  work.cell = cell[1];
  struct clocks many = run(work, threads);
  uint64_t found = 0;
  for (int i = 0; i < COUNT; i++)
    found += cell[0][i] >= 0;
  print("locate", one, many, found, !memcmp(cell[0], cell[1], COUNT * sizeof(int64_t)));
  static const double lengths[] = {0.5, 10.0};
  static const char *const names[] = {"rays_of_0.5_um", "rays_of_10_um"};
  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < COUNT; i++)
      length[i] = lengths[k];
    work.hit = hit[0], one = run(work, 1);
    work.hit = hit[1], many = run(work, threads);
    found = 0;
    for (int i = 0; i < COUNT; i++)
      found += hit[0][i].cell >= 0;
    print(names[k], one, many, found, !memcmp(hit[0], hit[1], COUNT * sizeof(conceg_hit)));
  }
  fprintf(stderr, "}\n");
  void *const memory[] = {point, direction, length, cell[0], cell[1], hit[0], hit[1]};
  for (size_t i = 0; i < sizeof memory / sizeof *memory; i++)
    free(memory[i]);
  conceg_query_free(query);
  conceg_substrate_free(substrate);
  conceg_ctx_free(ctx);
  return 0;
}
