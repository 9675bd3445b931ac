/* SPDX-License-Identifier: BSD-3-Clause
 * Rows of conceg bench scaling: fits, files. */
#define _GNU_SOURCE
#include "bench.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

double bench_wall(const struct bench_row *row) {
  double sum = 0;
  uint32_t i;
  for (i = 0; i < row->stages; i++)
    sum += row->stage[i].wall_s;
  return sum;
}
double bench_user(const struct bench_row *row) {
  double sum = 0;
  uint32_t i;
  for (i = 0; i < row->stages; i++)
    sum += row->stage[i].user_s;
  return sum;
}

static double seconds_of(const struct bench_row *row, const char *stage, int cpu) {
  double sum = 0;
  uint32_t i;
  if (!stage) return cpu ? bench_user(row) : bench_wall(row);
  for (i = 0; i < row->stages; i++)
    if (!strcmp(row->stage[i].kind, stage)) sum += cpu ? row->stage[i].user_s : row->stage[i].wall_s;
  return sum;
}

struct bench_fit bench_fit_rows(const struct bench_rows *rows, const char *stage, int cpu) {
  struct bench_fit fit = {0, 0, 0, 0, 30};
  double x[BENCH_ROWS], y[BENCH_ROWS], mean_x = 0, mean_y = 0, xx = 0, xy = 0, rest = 0;
  uint32_t i, pass, n = 0;
  for (pass = 0; pass < 2 && n < 3; pass++) {
    if (pass) fit.from_um = 0;
    for (i = n = 0; i < rows->count; i++) {
      const struct bench_row *row = &rows->row[i];
      const double seconds = seconds_of(row, stage, cpu);
      if (row->cells_asked || row->side_um < fit.from_um || !(seconds > 0)) continue;
      x[n] = 3 * log(row->side_um), y[n++] = log(seconds);
    }
  }
  if (n < 3) return fit;
  for (i = 0; i < n; i++)
    mean_x += x[i] / n, mean_y += y[i] / n;
  for (i = 0; i < n; i++)
    xx += (x[i] - mean_x) * (x[i] - mean_x), xy += (x[i] - mean_x) * (y[i] - mean_y);
  if (!(xx > 0)) return fit;
  fit.rows = n, fit.exponent = xy / xx;
  for (i = 0; i < n; i++) {
    const double off = y[i] - mean_y - fit.exponent * (x[i] - mean_x);
    rest += off * off;
  }
  fit.error = sqrt(rest / (n - 2) / xx);
  fit.seconds_at_100_um = exp(mean_y + fit.exponent * (3 * log(100.0) - mean_x));
  fit.from_um = exp(x[0] / 3);
  for (i = 1; i < n; i++)
    fit.from_um = fmin(fit.from_um, exp(x[i] / 3));
  return fit;
}

/* ---- CSV: a line per box and stage ---- */

static const char header[] =
    "recipe,version,seed,threads,side_um,cells_asked,cells,nodes,triangles,icvf,load,stage,"
    "wall_s,user_s,system_s,peak_mib";
#define COLUMNS 16

void bench_csv(FILE *out, const struct bench_rows *rows, const struct bench_key *key) {
  uint32_t i, k;
  fprintf(out, "%s\n", header);
  for (i = 0; i < rows->count; i++)
    for (k = 0; k < rows->row[i].stages; k++) {
      const struct bench_row *r = &rows->row[i];
      const struct bench_stage *s = &r->stage[k];
      fprintf(out, "%s,%s,%llu,%u,%g,%llu,%llu,%llu,%llu,%.6f,%.2f,%s,%.3f,%.3f,%.3f,%.1f\n", key->recipe,
              key->version, (unsigned long long)key->seed, key->threads, r->side_um,
              (unsigned long long)r->cells_asked, (unsigned long long)r->cells, (unsigned long long)r->nodes,
              (unsigned long long)r->triangles, r->icvf, r->load, s->kind, s->wall_s, s->user_s, s->system_s,
              s->peak_mib);
    }
}

/* Splits a line in place; 1 when it has as many fields as there should be. */
static int split(char *line, char *field[COLUMNS]) {
  uint32_t n = 0;
  line[strcspn(line, "\r\n")] = '\0';
  for (;;) {
    if (n == COLUMNS) return 0;
    field[n++] = line;
    line = strchr(line, ',');
    if (!line) return n == COLUMNS;
    *line++ = '\0';
  }
}

static int is_number(const char *text, double *out) {
  char *end;
  *out = strtod(text, &end);
  return end != text && !*end && isfinite(*out) && *out >= 0 && *out < 1e15;
}

/* Adds the line to its box, which is the last one or a new one. */
static int keep_line(struct bench_rows *rows, char *const field[COLUMNS]) {
  double value[COLUMNS];
  struct bench_row *row = rows->count ? &rows->row[rows->count - 1] : NULL;
  struct bench_stage *stage;
  uint32_t i;
  for (i = 4; i < COLUMNS; i++)
    if (i != 11 && !is_number(field[i], &value[i])) return 0;
  if (strlen(field[11]) >= BENCH_NAME || !*field[11]) return 0;
  if (!row || row->side_um != value[4] || row->cells_asked != (uint64_t)value[5]) {
    if (rows->count == BENCH_ROWS) return 0;
    row = &rows->row[rows->count++];
    memset(row, 0, sizeof *row);
    row->side_um = value[4], row->cells_asked = (uint64_t)value[5], row->cells = (uint64_t)value[6];
    row->nodes = (uint64_t)value[7], row->triangles = (uint64_t)value[8], row->icvf = value[9];
    row->load = value[10];
  }
  if (row->stages == BENCH_STAGES) return 0;
  stage = &row->stage[row->stages++];
  strcpy(stage->kind, field[11]);
  stage->wall_s = value[12], stage->user_s = value[13], stage->system_s = value[14],
  stage->peak_mib = value[15];
  return 1;
}

static int read_lines(struct cli *cli, const char *path, FILE *in, const struct bench_key *key,
                      struct bench_rows *out) {
  char line[512], seed[24], threads[16], *field[COLUMNS];
  uint32_t number = 0;
  snprintf(seed, sizeof seed, "%llu", (unsigned long long)key->seed);
  snprintf(threads, sizeof threads, "%u", key->threads);
  while (fgets(line, sizeof line, in)) {
    if (++number == 1) {
      line[strcspn(line, "\r\n")] = '\0';
      if (strcmp(line, header) != 0)
        return cli_fail(cli, EXIT_INPUT,
                        "%s:1: expected a table of conceg bench scaling; choose another folder", path);
      continue;
    }
    if (!split(line, field))
      return cli_fail(cli, EXIT_INPUT, "%s:%u: expected %d fields", path, number, COLUMNS);
    if (strcmp(field[0], key->recipe) != 0 || strcmp(field[1], key->version) != 0 ||
        strcmp(field[2], seed) != 0 || strcmp(field[3], threads) != 0)
      return cli_fail(
          cli, EXIT_USAGE,
          "%s:%u: is of another recipe, version, seed or number of threads; choose another folder", path,
          number);
    if (!keep_line(out, field))
      return cli_fail(cli, EXIT_INPUT, "%s:%u: expected figures of a stage, all of them 0 or more", path,
                      number);
  }
  return ferror(in) ? cli_fail(cli, EXIT_IO, "%s: cannot be read: %s", path, strerror(errno)) : EXIT_OK;
}

int bench_read(struct cli *cli, const char *path, const struct bench_key *key, struct bench_rows *out) {
  FILE *in = fopen(path, "re");
  int code;
  memset(out, 0, sizeof *out);
  if (!in && errno == ENOENT) return EXIT_OK;
  if (!in) return cli_fail(cli, EXIT_IO, "%s: cannot be read: %s", path, strerror(errno));
  code = read_lines(cli, path, in, key, out);
  fclose(in);
  return code;
}

/* Under a hidden name of the form that conceg clean knows, locked while it has that name. */
int bench_write(struct cli *cli, const char *path, bench_writer write, const struct bench_rows *rows,
                const struct bench_key *key) {
  const char *slash = strrchr(path, '/');
  const char *hidden =
      cli_keep(cli, "%.*s.conceg-%ld-1.tmp", slash ? (int)(slash - path) + 1 : 0, path, (long)getpid());
  FILE *out = fopen(hidden, "we");
  int failed = !out;
  if (out) {
    flock(fileno(out), LOCK_EX | LOCK_NB);
    write(out, rows, key);
    failed = ferror(out) || fflush(out) || rename(hidden, path);
    failed |= fclose(out) != 0;
    if (failed) unlink(hidden);
  }
  return failed ? cli_fail(cli, EXIT_IO, "%s: cannot be written: %s", path, strerror(errno)) : EXIT_OK;
}
