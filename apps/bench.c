/* SPDX-License-Identifier: BSD-3-Clause
 * conceg bench scaling: the stages of a recipe in boxes of several sizes, each stage in a process of its own.
 */
#define _GNU_SOURCE
#include "bench.h"

#include "array_text.h"
#include "pipeline.h"
#include "tools.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define DEFAULT_SIDES "20,30,40,50,60,80,100,100:14"

struct bench {
  struct cli cli;
  const char *sides, *until;
  const char *recipe_path, *folder;
  struct words kinds;
  struct bench_key key;
  struct bench_rows asked, done;
  char self[4096]; /* this program */
};

static int is_same_box(const struct bench_row *a, const struct bench_row *b) {
  return a->side_um == b->side_um && a->cells_asked == b->cells_asked;
}

/* "20,30,100:14": sides in um, with a number of cells after a colon. */
static int read_sides(struct bench *bench) {
  const char *at = bench->sides;
  while (*at) {
    struct bench_row row;
    char *end;
    double cells = 0;
    uint32_t i;
    memset(&row, 0, sizeof row);
    row.side_um = strtod(at, &end);
    if (*end == ':') cells = strtod(end + 1, &end);
    if ((*end && *end != ',') || !(row.side_um >= 1 && row.side_um <= 10000) ||
        !(cells >= 0 && cells <= 1e9) || cells != (double)(uint64_t)cells)
      return cli_fail(
          &bench->cli, EXIT_USAGE,
          "--sides: expected sides of 1 to 10000 um with commas between, each alone or as SIDE:CELLS, got "
          "\"%.60s\"",
          bench->sides);
    row.cells_asked = (uint64_t)cells;
    for (i = 0; i < bench->asked.count; i++)
      if (is_same_box(&bench->asked.row[i], &row))
        return cli_fail(&bench->cli, EXIT_USAGE, "--sides: %g um stands twice", row.side_um);
    if (bench->asked.count == BENCH_ROWS)
      return cli_fail(&bench->cli, EXIT_USAGE, "--sides: expected at most %d boxes", BENCH_ROWS);
    bench->asked.row[bench->asked.count++] = row;
    at = end + (*end == ',');
  }
  return bench->asked.count ? EXIT_OK
                            : cli_fail(&bench->cli, EXIT_USAGE, "--sides: expected at least one side");
}

/* FNV-1a of the canonical recipe and of the stages. */
static void hash_recipe(struct bench *bench, const char *text) {
  uint64_t hash = 0xcbf29ce484222325u;
  uint32_t i;
  for (; *text; text++)
    hash = (hash ^ (unsigned char)*text) * 0x100000001b3u;
  for (i = 0; i < bench->kinds.count; i++)
    for (text = bench->kinds.word[i]; *text; text++)
      hash = (hash ^ (unsigned char)*text) * 0x100000001b3u;
  snprintf(bench->key.recipe, sizeof bench->key.recipe, "%016llx", (unsigned long long)hash);
}

/* Checks the recipe and what is set, chooses the stages, makes the key of the rows. */
static int read_recipe(struct bench *bench) {
  struct cli *cli = &bench->cli;
  conceg_recipe *recipe = NULL;
  const char *const *set, *text;
  int64_t seed = 1;
  conceg_status status = conceg_recipe_load(cli->ctx, bench->recipe_path, &recipe);
  int code;
  for (set = cli->sets.word; status == CONCEG_OK && *set; set++)
    status = conceg_recipe_set(cli->ctx, recipe, *set);
  if (status == CONCEG_OK && conceg_node_get(conceg_recipe_root(recipe), "seed"))
    status = conceg_node_i64(cli->ctx, conceg_node_get(conceg_recipe_root(recipe), "seed"), &seed);
  code = status == CONCEG_OK ? pipeline_choose(cli, recipe, NULL, bench->until, 0, &bench->kinds)
                             : cli_fail_status(cli, status);
  if (code == EXIT_OK && bench->kinds.count > BENCH_STAGES)
    code = cli_fail(cli, EXIT_USAGE, "%s: expected at most %d stages", bench->recipe_path, BENCH_STAGES);
  text = code == EXIT_OK ? conceg_recipe_text(recipe) : NULL;
  if (text) hash_recipe(bench, text);
  if (code == EXIT_OK && !text) code = cli_fail(cli, EXIT_STAGE, "out of memory");
  conceg_recipe_free(recipe);
  bench->key.version = conceg_version(), bench->key.seed = (uint64_t)seed;
  bench->key.threads = conceg_ctx_threads(cli->ctx);
  return code;
}

/* ---- One stage in a process of its own ---- */

static const char *in_folder(struct bench *bench, const char *name) {
  return cli_keep(&bench->cli, "%s/%s", bench->folder, name);
}

static void stage_words(struct bench *bench, const struct bench_row *row, uint32_t index, struct words *out) {
  struct cli *cli = &bench->cli;
  const double side = row->side_um;
  uint32_t i;
  words_add(out, "conceg");
  words_add(out, bench->kinds.word[index]);
  if (index) words_add(out, in_folder(bench, "before.cgx"));
  words_add(out, "-q"), words_add(out, "--threads"), words_add(out, cli_keep(cli, "%u", bench->key.threads));
  words_add(out, "-o"), words_add(out, in_folder(bench, "after.cgx"));
  if (index) return;
  words_add(out, "-p"), words_add(out, bench->recipe_path);
  for (i = 0; i < cli->sets.count; i++)
    words_add(out, "--set"), words_add(out, cli->sets.word[i]);
  words_add(out, "--set");
  words_add(out, cli_keep(cli, "domain.size_um=[%.17g, %.17g, %.17g]", side, side, side));
  if (!row->cells_asked) return;
  words_add(out, "--set");
  words_add(out, cli_keep(cli, "density_per_um3=%.17g", (double)row->cells_asked / (side * side * side)));
}

static int wait_for(struct bench *bench, pid_t child, const char *kind, struct rusage *usage) {
  struct cli *cli = &bench->cli;
  int state;
  while (wait4(child, &state, 0, usage) < 0)
    if (errno != EINTR)
      return cli_fail(cli, EXIT_STAGE, "%s: %s", kind, strerror(errno));
    else if (signals_cancelled())
      kill(child, SIGTERM);
  if (signals_cancelled())
    return cli_fail(cli, EXIT_CANCELLED, "cancelled; the boxes that are done are kept");
  if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return EXIT_OK;
  if (WIFEXITED(state) && WEXITSTATUS(state) <= EXIT_CANCELLED) { /* the stage has said why */
    fprintf(stderr, "conceg bench: %s failed; the boxes that are done are kept\n", kind);
    return WEXITSTATUS(state);
  }
  if (WIFEXITED(state))
    return cli_fail(cli, EXIT_MISSING, "%s cannot be run (exit code %d)", kind, WEXITSTATUS(state));
  return cli_fail(cli, EXIT_STAGE, "%s was ended by signal %d", kind,
                  WIFSIGNALED(state) ? WTERMSIG(state) : 0);
}

static double seconds(const struct timeval *t) {
  return (double)t->tv_sec + 1e-6 * (double)t->tv_usec;
}

static int run_stage(struct bench *bench, struct bench_row *row, uint32_t index) {
  struct bench_stage *stage = &row->stage[row->stages];
  struct words words = {0};
  struct rusage usage;
  const double began = seconds_now();
  pid_t child;
  int code;
  stage_words(bench, row, index, &words);
  child = fork();
  if (child == 0) {
    const int nowhere = open("/dev/null", O_RDONLY | O_CLOEXEC);
    signal(SIGPIPE, SIG_DFL);
    if (nowhere >= 0) dup2(nowhere, STDIN_FILENO);
    execv(bench->self, (char *const *)(uintptr_t)words.word);
    _exit(127);
  }
  code = child < 0 ? cli_fail(&bench->cli, EXIT_STAGE, "%s: %s", bench->kinds.word[index], strerror(errno))
                   : wait_for(bench, child, bench->kinds.word[index], &usage);
  words_free(&words);
  if (code != EXIT_OK) return code;
  snprintf(stage->kind, sizeof stage->kind, "%s", bench->kinds.word[index]);
  stage->wall_s = seconds_now() - began;
  stage->user_s = seconds(&usage.ru_utime), stage->system_s = seconds(&usage.ru_stime);
  stage->peak_mib = (double)usage.ru_maxrss / 1024;
  row->stages++;
  return EXIT_OK;
}

/* ---- What a document says of its size ---- */

static int has_array(struct bench *bench, conceg_doc *doc, const char *path, conceg_array *out) {
  memset(out, 0, sizeof *out);
  return conceg_doc_has(doc, path) && read_array(&bench->cli, doc, path, out) == EXIT_OK &&
         conceg_array_count(out) > 0;
}

static int read_sizes(struct bench *bench, struct bench_row *row) {
  conceg_doc *doc = NULL;
  conceg_array array;
  int code = cli_open(&bench->cli, in_folder(bench, "after.cgx"), &doc);
  if (code != EXIT_OK) return code;
  if (has_array(bench, doc, "/cells/id", &array)) row->cells = conceg_array_count(&array);
  if (has_array(bench, doc, "/network/edge_offset", &array)) row->nodes = conceg_array_count(&array) - 1;
  if (has_array(bench, doc, "/meshes/face_offset", &array))
    row->triangles = (uint64_t)value_number(&array, conceg_array_count(&array) - 1);
  if (has_array(bench, doc, "/meshes@icvf", &array)) row->icvf = value_number(&array, 0);
  return conceg_doc_close(doc) == CONCEG_OK ? EXIT_OK : cli_fail_status(&bench->cli, CONCEG_E_IO);
}

/* ---- A box, and all of them ---- */

static int run_box(struct bench *bench, struct bench_row *row, uint32_t number) {
  struct cli *cli = &bench->cli;
  double load;
  uint32_t i;
  int code = EXIT_OK;
  row->load = getloadavg(&load, 1) == 1 ? load : 0;
  for (i = 0; code == EXIT_OK && i < bench->kinds.count; i++) {
    code = run_stage(bench, row, i);
    if (code == EXIT_OK) code = read_sizes(bench, row);
    if (code == EXIT_OK && rename(in_folder(bench, "after.cgx"), in_folder(bench, "before.cgx")))
      code = cli_fail(cli, EXIT_IO, "%s: %s", in_folder(bench, "after.cgx"), strerror(errno));
    if (code == EXIT_OK && !cli->quiet)
      fprintf(stderr, "conceg bench: box %u of %u, %g um: %s %.1f s, %.1f s of CPU, %.0f MiB\n", number,
              bench->asked.count, row->side_um, row->stage[i].kind, row->stage[i].wall_s,
              row->stage[i].user_s, row->stage[i].peak_mib);
  }
  unlink(in_folder(bench, "before.cgx")), unlink(in_folder(bench, "after.cgx"));
  return code;
}

static int write_all(struct bench *bench) {
  static const struct {
    const char *name;
    bench_writer write;
  } file[] = {{"scaling.csv", bench_csv}, {"scaling.json", bench_json}, {"scaling.svg", bench_svg}};
  int code = EXIT_OK;
  for (uint32_t i = 0; code == EXIT_OK && i < sizeof file / sizeof *file; i++)
    code = bench_write(&bench->cli, in_folder(bench, file[i].name), file[i].write, &bench->done, &bench->key);
  return code;
}

static int is_done(const struct bench *bench, const struct bench_row *row) {
  uint32_t i;
  for (i = 0; i < bench->done.count; i++)
    if (is_same_box(&bench->done.row[i], row)) return bench->done.row[i].stages == bench->kinds.count;
  return 0;
}

static int run_boxes(struct bench *bench) {
  uint32_t i;
  int code = bench_read(&bench->cli, in_folder(bench, "scaling.csv"), &bench->key, &bench->done);
  for (i = 0; code == EXIT_OK && i < bench->asked.count; i++) {
    struct bench_row row = bench->asked.row[i];
    if (is_done(bench, &row)) {
      if (!bench->cli.quiet)
        fprintf(stderr, "conceg bench: box %u of %u, %g um: kept from before\n", i + 1, bench->asked.count,
                row.side_um);
      continue;
    }
    if (bench->done.count == BENCH_ROWS)
      return cli_fail(&bench->cli, EXIT_USAGE, "%s: holds %d boxes already; choose another folder",
                      bench->folder, BENCH_ROWS);
    code = run_box(bench, &row, i + 1);
    if (code != EXIT_OK) break;
    bench->done.row[bench->done.count++] = row;
    code = write_all(bench);
  }
  return code == EXIT_OK ? write_all(bench) : code;
}

static void print_fit(const char *what, const struct bench_fit *fit) {
  if (fit->rows < 3)
    printf("%s: void: fewer than 3 boxes of the recipe's density\n", what);
  else
    printf("%s: V^%.3f +- %.3f over %u boxes from %g um, %.0f s at 100 um (paper: V^%.3f, %.0f s)\n", what,
           fit->exponent, fit->error, fit->rows, fit->from_um, fit->seconds_at_100_um, BENCH_PAPER_EXPONENT,
           BENCH_PAPER_SECONDS);
}

static void print_table(struct bench *bench) {
  struct cli *cli = &bench->cli;
  struct table table = {.columns = 8};
  const struct bench_fit wall = bench_fit_rows(&bench->done, NULL, 0),
                         user = bench_fit_rows(&bench->done, NULL, 1);
  static const char *const title[] = {"side [um]", "cells",    "nodes",   "triangles",
                                      "icvf",      "wall [s]", "CPU [s]", "peak [MiB]"};
  uint32_t i, k;
  for (i = 0; i < 8; i++)
    words_add(&table.cells, title[i]);
  for (i = 0; i < bench->done.count; i++) {
    const struct bench_row *r = &bench->done.row[i];
    double peak = 0;
    for (k = 0; k < r->stages; k++)
      if (r->stage[k].peak_mib > peak) peak = r->stage[k].peak_mib;
    words_add(&table.cells, cli_keep(cli, "%g", r->side_um));
    words_add(&table.cells, cli_keep(cli, "%llu", (unsigned long long)r->cells));
    words_add(&table.cells, cli_keep(cli, "%llu", (unsigned long long)r->nodes));
    words_add(&table.cells, cli_keep(cli, "%llu", (unsigned long long)r->triangles));
    words_add(&table.cells, cli_keep(cli, "%.4f", r->icvf));
    words_add(&table.cells, cli_keep(cli, "%.1f", bench_wall(r)));
    words_add(&table.cells, cli_keep(cli, "%.1f", bench_user(r)));
    words_add(&table.cells, cli_keep(cli, "%.0f", peak));
  }
  table_print(&table, 0);
  table_free(&table);
  print_fit("wall time", &wall), print_fit("user CPU time", &user);
}

/* The folder, which one bench at a time works in: a descriptor that holds the lock, or -1 after an error
 * line. */
static int lock_folder(struct bench *bench) {
  int folder;
  if (mkdir(bench->folder, 0777) && errno != EEXIST) {
    cli_fail(&bench->cli, EXIT_IO, "%s: cannot make this folder: %s", bench->folder, strerror(errno));
    return -1;
  }
  folder = open(bench->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) {
    cli_fail(&bench->cli, EXIT_IO, "%s: expected a folder: %s", bench->folder, strerror(errno));
    return -1;
  }
  if (flock(folder, LOCK_EX | LOCK_NB) == 0) return folder;
  cli_fail(&bench->cli, EXIT_IO, "%s: another conceg bench is at work in it", bench->folder);
  close(folder);
  return -1;
}

static int bench_scaling(struct bench *bench) {
  struct cli *cli = &bench->cli;
  const ssize_t length = readlink("/proc/self/exe", bench->self, sizeof bench->self - 1);
  int code, folder;
  if (length <= 0)
    return cli_fail(cli, EXIT_MISSING, "the system does not tell where this program is (/proc)");
  bench->self[length] = '\0';
  bench->recipe_path = cli->recipe ? cli->recipe : cli->words.count ? cli->words.word[0] : NULL;
  if (!bench->recipe_path || (cli->recipe && cli->words.count))
    return cli_fail(cli, EXIT_USAGE, "which recipe? usage: %s %s", cli->program->name, cli->program->usage);
  if (!cli->output) return cli_fail(cli, EXIT_USAGE, "where to? give a folder with -o DIR");
  bench->folder = cli->output;
  code = read_sides(bench);
  if (code == EXIT_OK) code = read_recipe(bench);
  if (code != EXIT_OK) return code;
  folder = lock_folder(bench);
  if (folder < 0) return EXIT_IO;
  code = run_boxes(bench);
  close(folder);
  if (code != EXIT_OK) return code;
  if (cli->json)
    bench_json(stdout, &bench->done, &bench->key);
  else if (!cli->quiet)
    print_table(bench);
  return cli_close_stdout(cli, EXIT_OK);
}

static int scaling_main(int argc, char **argv) {
  static struct bench bench;
  const struct cli_option options[] = {
      {"sides", 0, "LIST",
       "sides of the boxes in um, each alone or as SIDE:CELLS (default " DEFAULT_SIDES ")", NULL,
       &bench.sides, NULL},
      {"until", 0, "STAGE", "end after this stage (default mesh)", NULL, &bench.until, NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  const struct cli_program program = {
      .name = "conceg bench scaling",
      .usage = "RECIPE [options] -o DIR",
      .summary =
          "what a recipe costs: DIR/scaling.csv, .json and .svg; boxes that DIR holds already are kept",
      .example = "conceg bench scaling cube.yaml --sides 20,30,40 -o scaling",
      .options = options,
      .most_words = 1};
  int code;
  memset(&bench, 0, sizeof bench);
  bench.sides = DEFAULT_SIDES, bench.until = "mesh";
  code = cli_begin(&bench.cli, &program, argc, argv);
  if (code < 0) code = bench_scaling(&bench);
  words_free(&bench.kinds);
  return cli_end(&bench.cli, code);
}

int tool_bench(int argc, char **argv) {
  static const struct cli_word words[] = {
      {"scaling",
       "seconds, memory and sizes of every stage in boxes of several sides, and the exponent in the volume"},
      {NULL, NULL}};
  static const struct cli_program program = {.name = "conceg bench",
                                             .usage = "scaling RECIPE [options] -o DIR",
                                             .summary = "what a recipe costs",
                                             .example = "conceg bench scaling cube.yaml -o scaling",
                                             .words = words};
  const char *const word = argc > 1 ? argv[1] : "";
  if (!strcmp(word, "scaling")) return scaling_main(argc - 1, argv + 1);
  if (!strncmp(word, "--help", 6) || !strcmp(word, "-h")) {
    struct cli cli;
    return cli_end(&cli, cli_begin(&cli, &program, argc, argv));
  }
  fprintf(stderr,
          "usage: conceg bench scaling RECIPE [options] -o DIR\nconceg bench: error: expected scaling%s%s "
          "(conceg bench --help)\n",
          *word ? ", got " : "", word);
  return EXIT_USAGE;
}
