/* SPDX-License-Identifier: BSD-3-Clause
 * One stage as a program: read a document, run the stage as the host must, write the document. */
#include "stage_program.h"

#include "cli.h"
#include "contain.h"
#include "exec_stage.h"

#include <stdlib.h>
#include <string.h>

struct job {
  struct cli *cli;
  const char *kind;
  conceg_registry *registry;
  conceg_recipe *recipe; /* of -p */
  conceg_doc *doc;
};

static int has_flag(const conceg_stage *stage, uint64_t flag) {
  return stage && (stage->flags & flag) != 0;
}

/* A sink with a parameter `page` takes it from -o too, when that names a page (.html) and no document:
 * conceg report cube.cgx -o report.html. */
static void name_page(struct cli *cli, const conceg_stage *stage) {
  const size_t length = cli->output ? strlen(cli->output) : 0;
  const conceg_param *param;
  if (!has_flag(stage, CONCEG_STAGE_SINK) || length < 5 || strcmp(cli->output + length - 5, ".html") != 0)
    return;
  for (param = stage->params; param && param->name; param++)
    if (!strcmp(param->name, "page")) {
      words_add(&cli->sets, cli_keep(cli, "%s.page=%s", stage->kind, cli->output));
      words_add(&cli->unquoted, cli->sets.word[cli->sets.count - 1]);
      cli->output = NULL;
      return;
    }
}

/* The stage that the options name, before any input is read: it says whether there is an input at all. The
 * document's /recipe may still name another implementation. Returns 0 or an exit code. */
static int expected_stage(struct job *job, const conceg_stage **out) {
  const char *impl = cli_impl(job->cli, job->kind, job->recipe, NULL);
  const int runs_program = exec_command(impl) != NULL;
  const conceg_status status = conceg_registry_find(job->registry, job->kind, runs_program ? "" : impl, out);
  if (status == CONCEG_OK) name_page(job->cli, *out), cli_quote_params(job->cli, (*out)->params);
  /* With --allow-exec the document may name a program for a stage that this build lacks. */
  else if (!job->cli->allow_exec)
    return cli_fail_stage_missing(job->cli, status);
  return EXIT_OK;
}

/* Sources begin with an empty document; others read FILE or standard input. */
static int open_input(struct job *job, const conceg_stage *expected) {
  struct cli *cli = job->cli;
  conceg_status status;
  if (!has_flag(expected, CONCEG_STAGE_SOURCE))
    return cli_open(cli, cli->words.count ? cli->words.word[0] : NULL, &job->doc);
  if (has_flag(expected, CONCEG_STAGE_RECIPE) && !cli->recipe)
    return cli_fail(cli, EXIT_USAGE, "needs a recipe: %s -p RECIPE (see %s --help)", cli->program->name,
                    cli->program->name);
  if (cli->words.count && !has_flag(expected, CONCEG_STAGE_ARGUMENTS))
    return cli_fail(cli, EXIT_USAGE, "takes no input, got %s (a recipe goes after -p)", cli->words.word[0]);
  status = conceg_doc_new(cli->ctx, &job->doc);
  return status == CONCEG_OK ? EXIT_OK : cli_fail_status(cli, status);
}

static const char *const *stage_arguments(const struct job *job, const conceg_stage *stage) {
  const struct words *words = &job->cli->words;
  if (!has_flag(stage, CONCEG_STAGE_ARGUMENTS)) return NULL;
  if (has_flag(stage, CONCEG_STAGE_SOURCE)) return words->word;
  return words->count > 1 ? words->word + 1 : NULL;
}

static int run_stage(struct job *job) {
  struct cli *cli = job->cli;
  const char *impl = cli_impl(cli, job->kind, job->recipe, job->doc), *command = exec_command(impl);
  const conceg_stage *stage;
  conceg_params *params;
  const uint32_t counters = conceg_ctx_counters(cli->ctx);
  const double wall = seconds_now(), cpu = seconds_of_cpu();
  conceg_status status;
  if (command) return exec_stage(cli, job->kind, command, job->recipe, cli->sets.word, &job->doc);
  status = conceg_registry_find(job->registry, job->kind, impl, &stage);
  if (status != CONCEG_OK) return cli_fail_stage_missing(cli, status);
  status = conceg_params_new(cli->ctx, stage, job->doc, job->recipe, cli->sets.word,
                             stage_arguments(job, stage), &params);
  if (status == CONCEG_OK) status = contain_stage(cli, stage, job->doc, params);
  conceg_params_free(params);
  if (status != CONCEG_OK) return cli_fail_status(cli, status);
  if (cli->verbose) cli_print_costs(cli, job->kind, counters, seconds_now() - wall, seconds_of_cpu() - cpu);
  return EXIT_OK;
}

static int run_job(struct job *job) {
  struct cli *cli = job->cli;
  const conceg_stage *expected = NULL;
  int code, writes;
  conceg_status status = conceg_registry_new(cli->ctx, conceg_builtins, &job->registry);
  if (status == CONCEG_OK && cli->recipe) status = conceg_recipe_load(cli->ctx, cli->recipe, &job->recipe);
  if (status != CONCEG_OK) return cli_fail_status(cli, status);
  code = expected_stage(job, &expected);
  writes = cli->output || !has_flag(expected, CONCEG_STAGE_SINK);
  if (code == EXIT_OK && writes) code = cli_check_output(cli, cli->output);
  if (code == EXIT_OK) code = open_input(job, expected);
  if (code == EXIT_OK) code = run_stage(job);
  if (code == EXIT_OK && writes) code = cli_save(cli, job->doc, cli->output);
  return code;
}

/* The built-in stage of a kind, for its table and its help; NULL when a plugin stands in. */
static const conceg_stage *builtin_of(const char *kind) {
  uint32_t i;
  for (i = 0; conceg_builtins[i]; i++)
    if (!strcmp(conceg_builtins[i]->kind, kind)) return conceg_builtins[i];
  return NULL;
}

static const char *usage_of(const conceg_stage *stage) {
  if (has_flag(stage, CONCEG_STAGE_SOURCE) && has_flag(stage, CONCEG_STAGE_ARGUMENTS))
    return "FILES... [options] -o FILE";
  if (has_flag(stage, CONCEG_STAGE_SOURCE)) return "-p RECIPE [options] -o FILE";
  if (has_flag(stage, CONCEG_STAGE_SINK)) return "[FILE.cgx] [options]";
  return "[FILE.cgx] [options] -o FILE";
}

int stage_program(const char *kind, const char *name, int argc, char **argv) {
  const conceg_stage *builtin = builtin_of(kind);
  struct cli_program program = {.name = name, .summary = "a stage of the ConCeG pipeline", .kind = kind};
  struct cli cli;
  struct job job = {.cli = &cli, .kind = kind};
  int code;
  program.usage = usage_of(builtin);
  program.most_words = has_flag(builtin, CONCEG_STAGE_ARGUMENTS) || !builtin ? UINT32_MAX : 1;
  if (builtin) {
    program.summary = builtin->summary ? builtin->summary : program.summary;
    program.example = builtin->example;
    program.params = builtin->params;
  }
  code = cli_begin(&cli, &program, argc, argv);
  if (code < 0) code = run_job(&job);
  if (job.doc && conceg_doc_close(job.doc) != CONCEG_OK && code == EXIT_OK)
    code = cli_fail_status(&cli, CONCEG_E_IO);
  conceg_recipe_free(job.recipe);
  conceg_registry_free(job.registry);
  return cli_end(&cli, code);
}
