/* SPDX-License-Identifier: BSD-3-Clause
 * conceg run: a whole recipe in one process. The result has the bytes of the pipe of the same stages. */
#include "cli.h"
#include "contain.h"
#include "exec_stage.h"
#include "outlook.h"
#include "pipeline.h"
#include "room.h"
#include "tools.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct run {
  struct cli cli;
  const char *from, *until, *checkpoint, *block;
  int resume, print_pipe, ignore_space;
  struct words kinds;
  conceg_registry *registry;
  conceg_recipe *recipe;
  conceg_doc *doc;
  struct stage_cost *cost; /* of each stage, once place has said what is asked for; NULL before */
  double foretold, taken;  /* seconds of the stages that are done, by their weights and by the clock */
  int has_input; /* 1 = the document came from a file: the recipe is then the later stages' own one */
};

/* ---- Checkpoints: DIR/NN-KIND.cgx after each stage, DIR/NN-KIND.part while one runs ---- */

static const char *checkpoint_path(struct run *run, uint32_t index) {
  return cli_keep(&run->cli, "%s/%02u-%s.cgx", run->checkpoint, index + 1, run->kinds.word[index]);
}

static int save_checkpoint(struct run *run, uint32_t index) {
  conceg_status status;
  if (!run->checkpoint) return EXIT_OK;
  status = conceg_doc_save(run->doc, checkpoint_path(run, index));
  return status == CONCEG_OK ? EXIT_OK : cli_fail_status(&run->cli, status);
}

/* What a stage keeps of its own unfinished work: DIR/NN-KIND.part. */
static const char *part_path(struct run *run, uint32_t index) {
  return cli_keep(&run->cli, "%s/%02u-%s.part", run->checkpoint, index + 1, run->kinds.word[index]);
}

/* A run from the beginning does not go on from what another one left. */
static void drop_parts(struct run *run) {
  uint32_t i;
  for (i = 0; i < run->kinds.count; i++)
    remove(part_path(run, i));
}

/* The recipe as the source stage writes it: what a checkpoint must carry. NULL after an error line. */
static const char *intended_recipe(struct run *run) {
  conceg_status status = CONCEG_OK;
  if (!conceg_node_get(conceg_recipe_root(run->recipe), "seed"))
    status = conceg_recipe_set(run->cli.ctx, run->recipe, "seed=1");
  if (status == CONCEG_OK) return conceg_recipe_text(run->recipe);
  cli_fail_status(&run->cli, status);
  return NULL;
}

static int last_text(conceg_doc *doc, const char *path, const char **out) {
  conceg_array array = {sizeof array, CONCEG_TEXT, 0, 0, {0, 0, 0, 0}, NULL, NULL};
  if (!conceg_doc_has(doc, path) || conceg_doc_read(doc, path, &array) != CONCEG_OK) return 0;
  if (array.dtype != CONCEG_TEXT || array.rank != 1 || !array.shape[0]) return 0;
  *out = ((const char *const *)array.data)[array.shape[0] - 1];
  return 1;
}

/* A checkpoint of another recipe or build must not be continued. */
static int check_checkpoint(struct run *run, const char *path, conceg_doc *doc) {
  const char *carried = NULL, *build = NULL, *intended = intended_recipe(run);
  if (!intended) return EXIT_USAGE;
  if (!conceg_doc_has(doc, "/recipe") || conceg_doc_read_text(doc, "/recipe", &carried) != CONCEG_OK ||
      strcmp(carried, intended) != 0)
    return cli_fail(
        &run->cli, EXIT_USAGE,
        "%s: was made from another recipe; use another --checkpoint folder, or run without --resume", path);
  if (!last_text(doc, "/provenance/library_version", &build) || strcmp(build, conceg_version()) != 0)
    return cli_fail(&run->cli, EXIT_USAGE, "%s: was made by ConCeG %s, this is %s; run without --resume",
                    path, build ? build : "of unknown version", conceg_version());
  return EXIT_OK;
}

/* Opens the newest checkpoint; *next becomes the stage to go on with. */
static int resume(struct run *run, uint32_t *next) {
  uint32_t i;
  struct stat info;
  for (i = run->kinds.count; i > 0; i--) {
    const char *path = checkpoint_path(run, i - 1);
    int code;
    if (stat(path, &info)) continue;
    code = cli_open(&run->cli, path, &run->doc);
    if (code == EXIT_OK) code = check_checkpoint(run, path, run->doc);
    if (code == EXIT_OK && run->cli.verbose)
      fprintf(stderr, "%s: going on after %s\n", run->cli.program->name, path);
    *next = i;
    return code;
  }
  return EXIT_OK;
}

/* ---- Stages ---- */

/* Parameters of a stage: the first one takes recipe and --set, the others find them in /recipe, as in a pipe.
 */
static conceg_status make_params_with(struct run *run, const conceg_stage *stage, int is_first,
                                      const char *const *sets, conceg_params **out) {
  const int given = is_first || run->has_input;
  return conceg_params_new(run->cli.ctx, stage, run->doc, given ? run->recipe : NULL, sets, NULL, out);
}

static conceg_status make_params(struct run *run, const conceg_stage *stage, int is_first,
                                 conceg_params **out) {
  const int given = is_first || run->has_input;
  return make_params_with(run, stage, is_first, given ? run->cli.sets.word : NULL, out);
}

/* 1 for a stage that can keep unfinished work in a file that its parameter `checkpoint` names. */
static int keeps_parts(const conceg_stage *stage) {
  const conceg_param *row;
  for (row = stage->params; row && row->name; row++)
    if (!strcmp(row->name, "checkpoint")) return row->type == CONCEG_PARAM_FILE;
  return 0;
}

/* "mesh.checkpoint='DIR/05-mesh.part'", quoted for YAML. */
static const char *part_set(struct run *run, const char *kind, uint32_t index) {
  const char *path = part_path(run, index);
  char *quoted = malloc(2 * strlen(path) + 1), *to = quoted;
  const char *set;
  if (!quoted) return NULL;
  for (; *path; path++) {
    if (*path == '\'') *to++ = '\'';
    *to++ = *path;
  }
  *to = '\0';
  set = cli_keep(&run->cli, "%s.checkpoint='%s'", kind, quoted);
  free(quoted);
  return set;
}

/* Parameters once more with `checkpoint` in the run's folder, where the recipe does not name a file itself.
 */
static conceg_status keep_parts(struct run *run, const conceg_stage *stage, uint32_t index, int is_first,
                                conceg_params **params) {
  struct words sets = {0};
  const char *const *given = is_first || run->has_input ? run->cli.sets.word : NULL;
  conceg_status status;
  if (!run->checkpoint || !keeps_parts(stage) || conceg_params_given(*params, "checkpoint")) return CONCEG_OK;
  const char *set = part_set(run, stage->kind, index);
  if (!set) return conceg_ctx_fail(run->cli.ctx, CONCEG_E_NOMEM, "run: out of memory");
  for (; given && *given; given++)
    words_add(&sets, *given);
  words_add(&sets, set);
  conceg_params_free(*params);
  *params = NULL;
  status = make_params_with(run, stage, is_first, sets.word, params);
  words_free(&sets);
  return status;
}

static int run_builtin(struct run *run, const char *kind, const char *impl, uint32_t index, int is_first) {
  struct cli *cli = &run->cli;
  const conceg_stage *stage;
  conceg_params *params = NULL;
  const uint32_t counters = conceg_ctx_counters(cli->ctx);
  const double wall = seconds_now(), cpu = seconds_of_cpu();
  conceg_status status = conceg_registry_find(run->registry, kind, impl, &stage);
  if (status != CONCEG_OK) return cli_fail_stage_missing(cli, status);
  status = make_params(run, stage, is_first, &params);
  if (status == CONCEG_OK) status = keep_parts(run, stage, index, is_first, &params);
  if (status == CONCEG_OK) status = contain_stage(cli, stage, run->doc, params);
  conceg_params_free(params);
  if (status != CONCEG_OK) return cli_fail_status(cli, status);
  if (cli->verbose) cli_print_costs(cli, kind, counters, seconds_now() - wall, seconds_of_cpu() - cpu);
  return EXIT_OK;
}

static int run_kind(struct run *run, uint32_t index, int is_first) {
  const char *kind = run->kinds.word[index], *impl = cli_impl(&run->cli, kind, run->recipe, run->doc),
             *command = exec_command(impl);
  const int given = is_first || run->has_input;
  int code;
  if (command)
    code = exec_stage(&run->cli, kind, command, given ? run->recipe : NULL, given ? run->cli.sets.word : NULL,
                      &run->doc);
  else
    code = run_builtin(run, kind, impl, index, is_first);
  if (code == EXIT_OK && signals_cancelled()) code = cli_fail(&run->cli, EXIT_CANCELLED, "cancelled");
  if (code == EXIT_OK) code = save_checkpoint(run, index);
  if (code == EXIT_OK && run->checkpoint) remove(part_path(run, index));
  return code;
}

/* ---- What lies ahead ---- */

static int keeps_group(const struct run *run, const char *group) {
  const conceg_node *keep = conceg_node_get(conceg_recipe_root(run->recipe), "keep");
  uint32_t i;
  for (i = 0; i < conceg_node_count(keep); i++) {
    const char *word = conceg_node_text(conceg_node_at(keep, i));
    if (word && !strcmp(*word == '/' ? word + 1 : word, group)) return 1;
  }
  return 0;
}

/* The costs of the stages from `next` on; those of programs and of stages that cannot be asked are unknown.
 */
static int foretell(struct run *run, uint32_t next) {
  struct outlook outlook;
  uint32_t i;
  if (!outlook_of(run->doc, &outlook)) return EXIT_OK;
  run->cost = calloc(run->kinds.count, sizeof *run->cost);
  if (!run->cost) return cli_fail(&run->cli, EXIT_STAGE, "out of memory");
  for (i = next; i < run->kinds.count; i++) {
    const char *kind = run->kinds.word[i], *impl = cli_impl(&run->cli, kind, run->recipe, run->doc);
    const conceg_stage *stage = NULL;
    conceg_params *params = NULL;
    if (!exec_command(impl) && conceg_registry_find(run->registry, kind, impl, &stage) == CONCEG_OK &&
        conceg_params_new(run->cli.ctx, stage, NULL, run->recipe, run->cli.sets.word, NULL, &params) !=
            CONCEG_OK)
      params = NULL;
    run->cost[i] =
        outlook_cost(&outlook, kind, params, run->checkpoint != NULL && stage && keeps_parts(stage));
    conceg_params_free(params);
  }
  return EXIT_OK;
}

static const char *folder_of(struct run *run, const char *path) {
  const char *slash = strrchr(path, '/');
  if (!slash) return ".";
  return slash == path ? "/" : cli_keep(&run->cli, "%.*s", (int)(slash - path), path);
}

/* Whether what the stages from `next` on write finds room: temporary files, checkpoints, the document. */
static int check_space(struct run *run, uint32_t next) {
  double document = 0, network = 0, temporary = 0, parts = 0, checkpoints = 0;
  struct room_need needs[3];
  uint32_t i, count = 0;
  for (i = next; i < run->kinds.count; i++) {
    const struct stage_cost *cost = &run->cost[i];
    document += cost->document;
    if (!strcmp(run->kinds.word[i], "triangulate")) network = cost->document;
    if (!strcmp(run->kinds.word[i], "grow") && !keeps_group(run, "network")) document -= network, network = 0;
    temporary = cost->temporary > temporary ? cost->temporary : temporary;
    parts = cost->part > parts ? cost->part : parts;
    checkpoints += document;
  }
  if (document > (double)conceg_ctx_memory(run->cli.ctx)) temporary += document;
  needs[count++] = (struct room_need){conceg_ctx_tmpdir(run->cli.ctx), "temporary files", temporary};
  if (run->checkpoint)
    needs[count++] = (struct room_need){run->checkpoint, "checkpoints", checkpoints + parts};
  if (run->cli.output && strcmp(run->cli.output, "-") != 0)
    needs[count++] = (struct room_need){folder_of(run, run->cli.output), "the document", document};
  return room_check(
      &run->cli, needs, count,
      "free some, set TMPDIR to another disk, raise mesh.h_um, take a smaller box, or pass over "
      "this estimate with --ignore-space");
}

/* Tells the progress what this stage and the later ones take, by the speed of those that are done. */
static void tell_outlook(struct run *run, uint32_t index) {
  double later = 0, speed = run->foretold > 1 ? run->taken / run->foretold : 1;
  char left[32];
  uint32_t i;
  if (!run->cost) return;
  speed = speed < 0.2 ? 0.2 : speed > 20 ? 20 : speed;
  for (i = index + 1; i < run->kinds.count; i++)
    later += speed * run->cost[i].seconds;
  progress_run(&run->cli.progress, speed * run->cost[index].seconds, later);
  if (run->cli.quiet || run->cli.progress.mode != PROGRESS_AUTO || later + run->cost[index].seconds < 60)
    return;
  outlook_time_text(left, sizeof left, later + speed * run->cost[index].seconds);
  progress_clear(&run->cli.progress);
  fprintf(stderr, "%s: stage %u of %u, %s: about %s left of the run (by the weights of the stages)\n",
          run->cli.program->name, index + 1, run->kinds.count, run->kinds.word[index], left);
}

/* As soon as the document says what is asked for, before anything that takes long. */
static int look_ahead(struct run *run, uint32_t next) {
  int code = EXIT_OK;
  if (run->cost || next == run->kinds.count) return EXIT_OK;
  code = foretell(run, next);
  if (code == EXIT_OK && run->cost && !run->ignore_space) code = check_space(run, next);
  return code;
}

/* Finds every stage and checks every section before the first one begins. */
static int check_all(struct run *run) {
  struct cli *cli = &run->cli;
  uint32_t i;
  for (i = 0; i < run->kinds.count; i++) {
    const char *kind = run->kinds.word[i], *impl = cli_impl(cli, kind, run->recipe, NULL),
               *command = exec_command(impl);
    const conceg_stage *stage;
    conceg_params *params;
    conceg_status status;
    if (command && !cli->allow_exec)
      return cli_fail(cli, EXIT_USAGE,
                      "%s: the recipe asks to run the program %s (impl: exec:); allow it with --allow-exec",
                      kind, command);
    if (command) continue;
    status = conceg_registry_find(run->registry, kind, impl, &stage);
    if (status != CONCEG_OK) return cli_fail_stage_missing(cli, status);
    if (i == 0 && !run->has_input && !(stage->flags & CONCEG_STAGE_SOURCE))
      return cli_fail(
          cli, EXIT_USAGE,
          "%s needs a document: name one after the recipe (conceg run RECIPE INPUT.cgx --from %s)", kind,
          kind);
    status = conceg_params_new(cli->ctx, stage, NULL, run->recipe, cli->sets.word, NULL, &params);
    conceg_params_free(params);
    if (status != CONCEG_OK) return cli_fail_status(cli, status);
  }
  return EXIT_OK;
}

/* 1 when the last stage only writes files of its own, so that no document is expected on standard output. */
static int ends_in_sink(struct run *run) {
  const char *kind = run->kinds.word[run->kinds.count - 1];
  const conceg_stage *stage;
  const char *impl = cli_impl(&run->cli, kind, run->recipe, NULL);
  if (exec_command(impl) || conceg_registry_find(run->registry, kind, impl, &stage) != CONCEG_OK) return 0;
  return (stage->flags & CONCEG_STAGE_SINK) != 0;
}

static int run_stages(struct run *run) {
  struct cli *cli = &run->cli;
  const int writes = cli->output || !ends_in_sink(run);
  uint32_t i, first = 0;
  int code = writes ? cli_check_output(cli, cli->output) : EXIT_OK;
  if (code == EXIT_OK && run->checkpoint && mkdir(run->checkpoint, 0777) &&
      stat(run->checkpoint, &(struct stat){0}))
    code = cli_fail(cli, EXIT_IO, "%s: cannot make the folder of checkpoints", run->checkpoint);
  if (code == EXIT_OK && run->has_input) code = cli_open(cli, cli->words.word[1], &run->doc);
  if (code == EXIT_OK && run->resume) code = resume(run, &first);
  if (code == EXIT_OK && run->checkpoint && !run->resume) drop_parts(run);
  if (code == EXIT_OK && !run->doc) {
    const conceg_status status = conceg_doc_new(cli->ctx, &run->doc);
    if (status != CONCEG_OK) code = cli_fail_status(cli, status);
  }
  for (i = first; code == EXIT_OK && i < run->kinds.count; i++) {
    const double began = seconds_now();
    code = look_ahead(run, i);
    if (code != EXIT_OK) break;
    tell_outlook(run, i);
    code = run_kind(run, i, i == 0);
    if (run->cost) run->foretold += run->cost[i].seconds, run->taken += seconds_now() - began;
  }
  if (code == EXIT_OK && writes) code = cli_save(cli, run->doc, cli->output);
  return code;
}

/* --block LO:HI as values of the stage block. */
static int take_block(struct run *run) {
  struct cli *cli = &run->cli;
  const char *colon = run->block ? strchr(run->block, ':') : NULL;
  if (!run->block) return EXIT_OK;
  if (!colon || colon == run->block || !colon[1])
    return cli_fail(cli, EXIT_USAGE, "--block %.40s: expected LO:HI in um along z, as 400:490", run->block);
  words_add(&cli->sets, cli_keep(cli, "block.lo_um=%.*s", (int)(colon - run->block), run->block));
  words_add(&cli->sets, cli_keep(cli, "block.hi_um=%s", colon + 1));
  return EXIT_OK;
}

static int run_body(struct run *run) {
  struct cli *cli = &run->cli;
  const char *path = cli->recipe ? cli->recipe : cli->words.count ? cli->words.word[0] : NULL;
  const char *const *set;
  conceg_status status;
  int code;
  if (!path)
    return cli_fail(cli, EXIT_USAGE, "which recipe? usage: %s %s", cli->program->name, cli->program->usage);
  if (cli->recipe && cli->words.count)
    return cli_fail(cli, EXIT_USAGE, "give the recipe either as a word or after -p, not both");
  if (run->resume && !run->checkpoint) return cli_fail(cli, EXIT_USAGE, "--resume needs --checkpoint DIR");
  run->has_input = cli->words.count > 1;
  if (run->has_input && run->checkpoint)
    return cli_fail(cli, EXIT_USAGE,
                    "--checkpoint is for runs that begin with the recipe, not with a document");
  code = take_block(run);
  if (code != EXIT_OK) return code;
  status = conceg_recipe_load(cli->ctx, path, &run->recipe);
  for (set = cli->sets.word; status == CONCEG_OK && *set; set++)
    status = conceg_recipe_set(cli->ctx, run->recipe, *set);
  if (status != CONCEG_OK) return cli_fail_status(cli, status);
  code = pipeline_choose(cli, run->recipe, run->from, run->until, run->block != NULL, &run->kinds);
  if (code != EXIT_OK) return code;
  if (run->print_pipe) {
    pipeline_print(cli, path, run->has_input ? cli->words.word[1] : NULL, &run->kinds);
    return cli_close_stdout(cli, EXIT_OK);
  }
  status = conceg_registry_new(cli->ctx, conceg_builtins, &run->registry);
  if (status != CONCEG_OK) return cli_fail_status(cli, status);
  code = check_all(run);
  return code == EXIT_OK ? run_stages(run) : code;
}

int tool_run(int argc, char **argv) {
  struct run run;
  const struct cli_option options[] = {
      {"from", 0, "STAGE", "begin with this stage, on the document INPUT.cgx", NULL, &run.from, NULL},
      {"until", 0, "STAGE", "end after this stage", NULL, &run.until, NULL},
      {"block", 0, "LO:HI", "mesh and go on with the part from LO to HI um along z alone", NULL, &run.block,
       NULL},
      {"checkpoint", 0, "DIR", "keep the document after each stage, and unfinished stages, in DIR", NULL,
       &run.checkpoint, NULL},
      {"resume", 0, NULL, "go on after the newest checkpoint of the same recipe and build", &run.resume, NULL,
       NULL},
      {"ignore-space", 0, NULL, "begin even where the disk seems too small", &run.ignore_space, NULL, NULL},
      {"print-pipe", 0, NULL, "print the same run as a shell pipe, and do nothing", &run.print_pipe, NULL,
       NULL},
      {NULL, 0, NULL, NULL, NULL, NULL, NULL}};
  const struct cli_program program = {.name = "conceg run",
                                      .usage = "RECIPE [INPUT.cgx] [options] -o FILE",
                                      .summary = "a whole recipe in one process",
                                      .example = "conceg run cube.yaml --until mesh -o cube.cgx",
                                      .options = options,
                                      .most_words = 2};
  int code;
  memset(&run, 0, sizeof run);
  code = cli_begin(&run.cli, &program, argc, argv);
  if (code < 0) code = run_body(&run);
  if (run.doc && conceg_doc_close(run.doc) != CONCEG_OK && code == EXIT_OK)
    code = cli_fail_status(&run.cli, CONCEG_E_IO);
  conceg_recipe_free(run.recipe);
  conceg_registry_free(run.registry);
  words_free(&run.kinds);
  free(run.cost);
  return cli_end(&run.cli, code);
}
