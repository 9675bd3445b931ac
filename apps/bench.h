/* SPDX-License-Identifier: BSD-3-Clause
 * conceg bench scaling: what a recipe costs in boxes of several sizes. Rows of figures, kept as CSV. */
#ifndef CONCEG_APPS_BENCH_H
#define CONCEG_APPS_BENCH_H

#include "cli.h"

#define BENCH_STAGES 16
#define BENCH_ROWS 64
#define BENCH_NAME 24

struct bench_stage {
  char kind[BENCH_NAME];
  double wall_s, user_s, system_s, peak_mib; /* of the stage's process, reading and writing included */
};

/* One box. */
struct bench_row {
  double side_um;
  uint64_t cells_asked; /* 0 = as many as the recipe's density says */
  uint64_t cells, nodes, triangles;
  double icvf, load; /* load: runnable processes of the machine before the row began */
  struct bench_stage stage[BENCH_STAGES];
  uint32_t stages;
};

/* What figures must have in common to stand in one table. */
struct bench_key {
  char recipe[17]; /* hash of the canonical recipe and of the stages that are run */
  const char *version;
  uint64_t seed;
  uint32_t threads;
};

struct bench_rows {
  struct bench_row row[BENCH_ROWS];
  uint32_t count;
};

double bench_wall(const struct bench_row *row); /* of all stages, s */
double bench_user(const struct bench_row *row);

/* ln t = a + exponent ln V, least squares over the rows of the recipe's own density from 30 um on (all of
 * them when these are fewer than 3). */
struct bench_fit {
  uint32_t rows;                     /* fewer than 3: nothing was fitted */
  double exponent, error;            /* standard error, from the residuals */
  double seconds_at_100_um, from_um; /* from_um: the smallest box that was fitted */
};
/* `stage` NULL = all; `cpu` 1 = user CPU time, 0 = wall time. */
struct bench_fit bench_fit_rows(const struct bench_rows *rows, const char *stage, int cpu);

/* Reads FOLDER/scaling.csv where there is one. EXIT_USAGE when it is of another key. */
int bench_read(struct cli *cli, const char *path, const struct bench_key *key, struct bench_rows *out);
/* Text, temporary name, rename. `write` prints the file. */
typedef void (*bench_writer)(FILE *out, const struct bench_rows *rows, const struct bench_key *key);
int bench_write(struct cli *cli, const char *path, bench_writer write, const struct bench_rows *rows,
                const struct bench_key *key);
void bench_csv(FILE *out, const struct bench_rows *rows, const struct bench_key *key);
void bench_json(FILE *out, const struct bench_rows *rows, const struct bench_key *key);
void bench_svg(FILE *out, const struct bench_rows *rows, const struct bench_key *key);

/* The paper's: about 3 hours for (100 um)^3, exponent 1.077 (Computational time). */
#define BENCH_PAPER_SECONDS 10800.0
#define BENCH_PAPER_EXPONENT 1.077

#endif
