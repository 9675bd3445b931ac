/* SPDX-License-Identifier: BSD-3-Clause
 * Recipes and parameters: grammar, messages with lines, --set, precedence, canonical text. */
#include "conceg/conceg.h"

#include "check.h"

static const char *const good = "conceg: 1 # comment\n"
                                "grow: {lambda: 2.50, impl: barcode, mode: 'first'}\n"
                                "title: \"a: b, \\u00e9\"\n"
                                "domain:\n"
                                "  periodic: [true, true, false]\n"
                                "  size_um: [40, 4e1, 40.0]\n"
                                "types:\n"
                                "- {class: other, name: x, fraction: 1}\n"
                                "- {radius_um: {sd: .1, mean: 0.4}, direction: {kappa: 2, axis: [1, 0, 0]},\n"
                                "   name: y, class: axon, length_um: 50, cable_density_per_um2: 0.350}\n";

static const conceg_param table[] = {{"lambda", "um^-1", "", "1.0", NULL, CONCEG_PARAM_F64, 0, 0, 10},
                                     {"steps", "", "", "5", NULL, CONCEG_PARAM_I64, 0, 1, 100},
                                     {"smooth", "", "", "false", NULL, CONCEG_PARAM_BOOL, 0, 0, 0},
                                     {"mode", "", "", "first", "first|second", CONCEG_PARAM_CHOICE, 0, 0, 0},
                                     {"label", "", "", "", NULL, CONCEG_PARAM_TEXT, 0, 0, 0},
                                     {"file", "", "", "", NULL, CONCEG_PARAM_FILE, 0, 0, 0},
                                     {NULL, NULL, NULL, NULL, NULL, 0, 0, 0, 0}};

static conceg_status mark_run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)doc, (void)params;
  return CONCEG_OK;
}

static const conceg_stage stage = {.abi = CONCEG_STAGE_ABI,
                                   .size = sizeof(conceg_stage),
                                   .kind = "grow",
                                   .name = "test",
                                   .version = "1",
                                   .params = table,
                                   .run = mark_run};

static char last_log[400];
static void keep_log(void *user, conceg_log_level level, const char *line) {
  (void)user, (void)level;
  snprintf(last_log, sizeof last_log, "%s", line);
}

/* The text must be refused with this status and exactly this line. */
static void refuse(conceg_ctx *ctx, const char *text, conceg_status status, const char *line) {
  conceg_recipe *recipe = NULL;
  CHECK_EQUAL(conceg_recipe_parse(ctx, text, "r.yaml", &recipe), status);
  CHECK(recipe == NULL);
  CHECK_TEXT(conceg_ctx_error(ctx), line);
  conceg_recipe_free(recipe);
}

static void check_canonical(conceg_ctx *ctx) {
  conceg_recipe *recipe, *again;
  const conceg_node *node;
  double number = 0;
  CHECK_EQUAL(conceg_recipe_parse(ctx, good, "r.yaml", &recipe), CONCEG_OK);
  /* Keys in canonical order, numbers with their own text, quotes only where they are needed. */
  CHECK_TEXT(conceg_recipe_text(recipe),
             "conceg: 1\n"
             "title: \"a: b, \xc3\xa9\"\n"
             "domain:\n"
             "  size_um: [40, 4e1, 40.0]\n"
             "  periodic: [true, true, false]\n"
             "types:\n"
             "  - {name: x, class: other, fraction: 1}\n"
             "  - {name: y, class: axon, cable_density_per_um2: 0.350, length_um: "
             "50, radius_um: {mean: 0.4, sd: .1}, direction: {axis: [1, 0, 0], "
             "kappa: 2}}\n"
             "grow:\n"
             "  impl: barcode\n"
             "  lambda: 2.50\n"
             "  mode: first\n");
  CHECK_EQUAL(conceg_recipe_parse(ctx, conceg_recipe_text(recipe), "again", &again), CONCEG_OK);
  CHECK_TEXT(conceg_recipe_text(again), conceg_recipe_text(recipe));
  conceg_recipe_free(again);
  /* A factor of 1 changes nothing and leaves no trace. */
  CHECK_EQUAL(conceg_recipe_parse(ctx, "conceg: 1\nperturb: {ecs: 1.0, neurons: 0.7}\n", "p", &again),
              CONCEG_OK);
  CHECK_TEXT(conceg_recipe_text(again), "conceg: 1\nperturb:\n  neurons: 0.7\n");
  CHECK_EQUAL(conceg_recipe_set(ctx, again, "perturb.neurons=1"), CONCEG_OK);
  CHECK_TEXT(conceg_recipe_text(again), "conceg: 1\n");
  conceg_recipe_free(again);
  node = conceg_node_get(conceg_recipe_root(recipe), "domain.size_um");
  CHECK_EQUAL(conceg_node_count(node), 3);
  CHECK_EQUAL(conceg_node_line(node), 6);
  CHECK_EQUAL(conceg_node_f64(ctx, conceg_node_at(node, 1), &number), CONCEG_OK);
  CHECK_NEAR(number, 40, 0);
  CHECK_EQUAL(conceg_node_f64(ctx, NULL, &number), CONCEG_E_MISSING);
  CHECK_EQUAL(conceg_node_f64(ctx, conceg_node_get(conceg_recipe_root(recipe), "title"), &number),
              CONCEG_E_PARAM);
  CHECK_TEXT(conceg_ctx_error(ctx), "r.yaml:3: title: expected a number, got \"a: b, \xc3\xa9\"");
  CHECK(conceg_node_get(conceg_recipe_root(recipe), "domain.nothing.below") == NULL);
  conceg_recipe_free(recipe);
}

static void check_grammar(conceg_ctx *ctx) {
  refuse(ctx, "", CONCEG_E_FORMAT,
         "r.yaml:1: expected a recipe (a YAML mapping that begins with conceg: 1), got an empty file");
  refuse(ctx, "title: x\n", CONCEG_E_PARAM, "r.yaml:1: key conceg is missing");
  refuse(ctx, "conceg: 2\n", CONCEG_E_VERSION, "r.yaml:1: conceg: expected recipe version 1, got 2");
  refuse(ctx, "conceg: 1\ndomian: {}\n", CONCEG_E_PARAM,
         "r.yaml:2: unknown key domian; did you mean domain?");
  refuse(ctx, "conceg: 1\ndomain: {size: [1, 1, 1]}\n", CONCEG_E_PARAM,
         "r.yaml:2: unknown key domain.size; did you mean size_um?");
  refuse(ctx, "conceg: 1\ntypes:\n  - {name: a, class: other, farction: 1}\n", CONCEG_E_PARAM,
         "r.yaml:3: unknown key types[0].farction; did you mean fraction?");
  refuse(ctx, "conceg: 1\ntypes:\n  - {name: a, class: neuron}\n", CONCEG_E_PARAM,
         "r.yaml:3: types[0].class: expected pyramidal, interneuron, astrocyte, microglia, axon or other, "
         "got neuron");
  refuse(ctx, "conceg: 1\ndomain: {size_um: [1, -1, 1]}\n", CONCEG_E_PARAM,
         "r.yaml:2: domain.size_um: expected three numbers above 0, [x, y, z], got [1, -1, 1]");
  refuse(ctx, "conceg: 1\ndomain: {size_um: [1, .nan, 1]}\n", CONCEG_E_PARAM,
         "r.yaml:2: domain.size_um: expected three numbers above 0, [x, y, z], got [1, .nan, 1]");
  refuse(ctx, "conceg: 1\ndensity_per_um3: 1\ndensity_profile: [{z_um: 0, per_um3: 1}]\n", CONCEG_E_PARAM,
         "r.yaml:3: expected only one of density_per_um3, density_profile and densities of layers");
  refuse(ctx, "conceg: 1\nseed: -4\n", CONCEG_E_PARAM,
         "r.yaml:2: seed: expected a whole number from 0 to 9223372036854775807, got -4");
  refuse(ctx, "conceg: 1\nstages: [place, gorw]\n", CONCEG_E_PARAM,
         "r.yaml:2: stages[1]: no stage is called gorw; did you mean grow?");
  refuse(ctx, "conceg: 1\nkeep: [network, netwrok]\n", CONCEG_E_PARAM,
         "r.yaml:2: keep[1]: no group is called netwrok; did you mean network?");
  refuse(ctx, "conceg: 1\ntypes: [{name: a, class: other, layer: 5}]\n", CONCEG_E_PARAM,
         "r.yaml:2: types[0].layer: no layer is named 5");
  refuse(ctx, "conceg: 1\ntypes: [{name: a, class: axon, radius_um: {meen: 1}}]\n", CONCEG_E_PARAM,
         "r.yaml:2: unknown key types[0].radius_um.meen; did you mean mean?");
  refuse(ctx, "conceg: 1\ntypes: [{name: a, class: axon, direction: {axis: [0, 0, 0], kappa: 1}}]\n",
         CONCEG_E_PARAM,
         "r.yaml:2: types[0].direction.axis: expected a direction [x, y, z], not zero, got [0, 0, 0]");
  refuse(ctx, "conceg: 1\ntypes: [{name: a, class: axon, direction: {axis: [0, 0, 1]}}]\n", CONCEG_E_PARAM,
         "r.yaml:2: key kappa is missing");
  refuse(ctx, "conceg: 1\ntypes: [{name: a, class: axon, fraction: 0.1}]\n", CONCEG_E_PARAM,
         "r.yaml:2: types[0].fraction: passing axons (class axon without entry) have none; give "
         "cable_density_per_um2, or an entry");
  refuse(ctx, "conceg: 1\ntypes: [{name: a, class: axon, entry: b, length_um: 9}]\n", CONCEG_E_PARAM,
         "r.yaml:2: types[0].length_um: only passing axons have it, a type of class axon without entry");
  refuse(ctx, "conceg: 1\nperturb: {neuron: 0.5}\n", CONCEG_E_PARAM,
         "r.yaml:2: unknown key perturb.neuron; did you mean neurons?");
  refuse(ctx, "conceg: 1\nperturb:\n  ecs: 2\n  glia: 20\n", CONCEG_E_PARAM,
         "r.yaml:4: perturb.glia: expected a factor from 0 to 10, got 20");
  refuse(ctx, "conceg: 1\nperturb: 0.5\n", CONCEG_E_PARAM, "r.yaml:2: perturb: expected a mapping, got 0.5");
  refuse(ctx, "conceg: 1\ngrow: {lambda: [1]}\n", CONCEG_E_PARAM,
         "r.yaml:2: grow.lambda: expected one value, got [1]");
}

/* A recipe is untrusted input: bad syntax, bombs and cycles end in a line. */
static void check_hostile(conceg_ctx *ctx) {
  char deep[400] = "conceg: 1\nx_a: ";
  char bomb[2000] = "conceg: 1\nx_a: &a [1,1,1,1,1,1,1,1,1,1]\n";
  conceg_recipe *recipe;
  int i;
  refuse(ctx, "conceg: 1\ntitle: [a\n", CONCEG_E_FORMAT,
         "r.yaml:3: not valid YAML: did not find expected ',' or ']' while parsing a flow sequence");
  refuse(ctx, "conceg: 1\nconceg: 1\n", CONCEG_E_FORMAT, "r.yaml:2: key conceg is given twice");
  refuse(ctx, "conceg: 1\ntitle: !!int 3\n", CONCEG_E_FORMAT,
         "r.yaml:2: tags (!...) are not supported; remove the tag");
  refuse(ctx, "conceg: 1\n---\nconceg: 1\n", CONCEG_E_FORMAT,
         "r.yaml:2: a second document begins; only one is allowed");
  refuse(ctx, "conceg: 1\nx_a: &a [*a]\n", CONCEG_E_FORMAT, "r.yaml:2: alias inside its own anchor");
  refuse(ctx, "conceg: 1\nx_a: *b\n", CONCEG_E_FORMAT, "r.yaml:2: alias of an anchor that is not there");
  refuse(ctx, "conceg: 1\n? [a]\n: 1\n", CONCEG_E_FORMAT, "r.yaml:2: a key must be a word");
  for (i = 0; i < 100; i++)
    strcat(deep, "[");
  refuse(ctx, deep, CONCEG_E_FORMAT, "r.yaml:2: nested more than 32 deep");
  for (i = 0; i < 9; i++) {
    char line[100];
    snprintf(line, sizeof line, "x_%c: &%c [*%c,*%c,*%c,*%c,*%c,*%c,*%c,*%c,*%c,*%c]\n", 'b' + i, 'b' + i,
             'a' + i, 'a' + i, 'a' + i, 'a' + i, 'a' + i, 'a' + i, 'a' + i, 'a' + i, 'a' + i, 'a' + i);
    strcat(bomb, line);
  }
  refuse(ctx, bomb, CONCEG_E_FORMAT, "r.yaml:7: more than 1000000 values");
  CHECK_EQUAL(conceg_recipe_parse(ctx, "conceg: 1\n\xff\xfe: 1\n", "r.yaml", &recipe), CONCEG_E_FORMAT);
  CHECK_EQUAL(conceg_recipe_load(ctx, "/nowhere/at/all.yaml", &recipe), CONCEG_E_IO);
}

static void check_set(conceg_ctx *ctx) {
  conceg_recipe *recipe;
  CHECK_EQUAL(conceg_recipe_parse(ctx, good, "r.yaml", &recipe), CONCEG_OK);
  CHECK_EQUAL(conceg_recipe_set(ctx, recipe, "domain.size_um=[20,20,20]"), CONCEG_OK);
  CHECK_EQUAL(conceg_recipe_set(ctx, recipe, "types[0].fraction=0.5"), CONCEG_OK);
  CHECK_EQUAL(conceg_recipe_set(ctx, recipe, "mesh.step_um=0.3"), CONCEG_OK);
  CHECK_EQUAL(conceg_recipe_set(ctx, recipe, "grow.lambda=null"), CONCEG_OK);
  CHECK_TEXT(
      conceg_node_text(conceg_node_at(conceg_node_get(conceg_recipe_root(recipe), "domain.size_um"), 2)),
      "20");
  CHECK_TEXT(conceg_node_text(conceg_node_get(conceg_recipe_root(recipe), "mesh.step_um")), "0.3");
  CHECK(conceg_node_get(conceg_recipe_root(recipe), "grow.lambda") == NULL);
  /* A refused assignment changes nothing. */
  CHECK_EQUAL(conceg_recipe_set(ctx, recipe, "domain.size_um=[20,20]"), CONCEG_E_PARAM);
  CHECK_TEXT(conceg_ctx_error(ctx),
             "--set: domain.size_um: expected three numbers above 0, [x, y, z], got [20, 20]");
  CHECK_EQUAL(conceg_node_count(conceg_node_get(conceg_recipe_root(recipe), "domain.size_um")), 3);
  CHECK_EQUAL(conceg_recipe_set(ctx, recipe, "types[7].fraction=1"), CONCEG_E_PARAM);
  CHECK_EQUAL(conceg_recipe_set(ctx, recipe, "seed"), CONCEG_E_PARAM);
  CHECK_EQUAL(conceg_recipe_set(ctx, recipe, "sed=4"), CONCEG_E_PARAM);
  CHECK_TEXT(conceg_ctx_error(ctx), "--set: unknown key sed; did you mean seed?");
  conceg_recipe_free(recipe);
}

static void refuse_value(conceg_ctx *ctx, const char *set, const char *line) {
  const char *sets[] = {NULL, NULL};
  conceg_params *params = NULL;
  sets[0] = set;
  CHECK_EQUAL(conceg_params_new(ctx, &stage, NULL, NULL, sets, NULL, &params), CONCEG_E_PARAM);
  CHECK_TEXT(conceg_ctx_error(ctx), line);
  conceg_params_free(params);
}

static void check_values(conceg_ctx *ctx) {
  static const char *const sets[] = {"grow.lambda=3", "grow.smooth=true", "grow.file='some/x.csv'",
                                     "grow.label='007'", NULL};
  static const char *const arguments[] = {"a.swc", "b.swc", NULL};
  conceg_recipe *recipe;
  conceg_params *params;
  CHECK_EQUAL(conceg_recipe_parse(ctx, "conceg: 1\ngrow: {lambda: 2, steps: 7}\n", "r.yaml", &recipe),
              CONCEG_OK);
  CHECK_EQUAL(conceg_params_new(ctx, &stage, NULL, recipe, sets, arguments, &params), CONCEG_OK);
  CHECK_NEAR(conceg_params_f64(params, "lambda"), 3, 0);
  CHECK_EQUAL(conceg_params_i64(params, "steps"), 7);
  CHECK_EQUAL(conceg_params_bool(params, "smooth"), 1);
  CHECK_TEXT(conceg_params_text(params, "mode"), "first");
  CHECK_TEXT(conceg_params_text(params, "label"), "007");
  CHECK_TEXT(conceg_params_text(params, "file"), "some/x.csv");
  CHECK_EQUAL(conceg_params_given(params, "lambda"), 1);
  CHECK_EQUAL(conceg_params_given(params, "mode"), 0);
  CHECK_TEXT(conceg_params_argument(params, 1), "b.swc");
  CHECK(conceg_params_argument(params, 2) == NULL);
  /* The file is this machine's business and stays out of the canonical text. */
  CHECK_TEXT(conceg_params_canonical(params),
             "{lambda: 3, steps: 7, smooth: true, mode: first, label: \"007\"}");
  conceg_params_free(params);
  conceg_recipe_free(recipe);
  refuse_value(ctx, "grow.lamda=1", "--set: unknown key grow.lamda; did you mean lambda?");
  refuse_value(ctx, "grow.lambda=11", "--set: grow.lambda: expected a number from 0 to 10 um^-1, got 11");
  refuse_value(ctx, "grow.lambda='3'", "--set: grow.lambda: expected a number from 0 to 10 um^-1, got 3");
  refuse_value(ctx, "grow.steps=2.5", "--set: grow.steps: expected a whole number from 1 to 100, got 2.5");
  refuse_value(ctx, "grow.smooth=maybe", "--set: grow.smooth: expected true or false, got maybe");
  refuse_value(ctx, "grow.mode=third", "--set: grow.mode: expected one of first|second, got third");
  CHECK_EQUAL(conceg_recipe_parse(ctx, "conceg: 1\n\ngrow:\n  lamda: 2\n", "cube.yaml", &recipe), CONCEG_OK);
  CHECK_EQUAL(conceg_params_new(ctx, &stage, NULL, recipe, NULL, NULL, &params), CONCEG_E_PARAM);
  CHECK_TEXT(conceg_ctx_error(ctx), "cube.yaml:4: unknown key grow.lamda; did you mean lambda?");
  conceg_recipe_free(recipe);
}

/* default < /recipe < own -p < --set; what overrides is warned about and written back. */
static void check_precedence(conceg_ctx *ctx) {
  static const char *const set_lambda[] = {"grow.lambda=4", NULL}, *const set_domain[] = {
                                                                       "domain.size_um=[1,1,1]", NULL};
  conceg_recipe *own;
  conceg_params *params;
  conceg_doc *doc;
  const char *text = "";
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_write_text(doc, "/recipe", "conceg: 1\nseed: 9\ngrow:\n  lambda: 2\n  steps: 8\n"),
              CONCEG_OK);
  CHECK_EQUAL(conceg_params_new(ctx, &stage, doc, NULL, NULL, NULL, &params), CONCEG_OK);
  CHECK_NEAR(conceg_params_f64(params, "lambda"), 2, 0);
  CHECK_TEXT(last_log, "");
  conceg_params_free(params);
  CHECK_EQUAL(conceg_recipe_parse(ctx, "conceg: 1\ngrow: {lambda: 3, smooth: true}\nmesh: {step_um: 9}\n",
                                  "own.yaml", &own),
              CONCEG_OK);
  CHECK_EQUAL(conceg_params_new(ctx, &stage, doc, own, NULL, NULL, &params), CONCEG_OK);
  CHECK_NEAR(conceg_params_f64(params, "lambda"), 3, 0);
  CHECK_EQUAL(conceg_params_i64(params, "steps"), 8);
  CHECK_TEXT(last_log, "grow.lambda: 3 overrides 2 of the document's /recipe");
  conceg_params_free(params);
  CHECK_EQUAL(conceg_params_new(ctx, &stage, doc, own, set_lambda, NULL, &params), CONCEG_OK);
  CHECK_NEAR(conceg_params_f64(params, "lambda"), 4, 0);
  CHECK_EQUAL(conceg_stage_run(ctx, &stage, doc, params), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_read_text(doc, "/recipe", &text), CONCEG_OK);
  CHECK_TEXT(text, "conceg: 1\nseed: 9\ngrow:\n  lambda: 4\n  smooth: true\n  steps: 8\n");
  CHECK_EQUAL(conceg_ctx_seed(ctx), 9);
  conceg_params_free(params);
  CHECK_EQUAL(conceg_params_new(ctx, &stage, doc, NULL, set_domain, NULL, &params), CONCEG_E_PARAM);
  CHECK_TEXT(
      conceg_ctx_error(ctx),
      "--set domain.size_um=[1,1,1]: grow does not read domain; set it where the document is made, at place");
  conceg_recipe_free(own);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

int main(void) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_log(ctx, CONCEG_LOG_WARNING, keep_log, NULL);
  check_canonical(ctx);
  check_grammar(ctx);
  check_hostile(ctx);
  check_set(ctx);
  check_values(ctx);
  check_precedence(ctx);
  conceg_ctx_free(ctx);
  return check_done();
}
