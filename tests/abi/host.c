/* SPDX-License-Identifier: BSD-3-Clause
 * conceg_stage_run: what is read must be there, what is stale goes, what is kept stays, what was done is
 * noted. */
#define _POSIX_C_SOURCE 200809L /* unsetenv */
#include "conceg/conceg.h"

#include "check.h"

static char last_log[400];
static void keep_log(void *user, conceg_log_level level, const char *line) {
  (void)user, (void)level;
  snprintf(last_log, sizeof last_log, "%s", line);
}

static conceg_status put(conceg_doc *doc, const char *path, conceg_dtype dtype, uint64_t rows,
                         uint64_t columns, const void *data) {
  const conceg_array array = {sizeof array, dtype, columns > 1 ? 2u : 1u, 0, {rows, columns, 0, 0},
                              data,         NULL};
  return conceg_doc_write(doc, path, &array);
}

static conceg_status write_cells(conceg_doc *doc, uint64_t first_id) {
  static const char *const names[] = {"a"}, *const classes[] = {"other"};
  static const uint32_t type[1] = {0};
  static const double soma[3] = {1, 2, 3};
  static const float radius[1] = {4};
  conceg_status status = put(doc, "/types/name", CONCEG_TEXT, 1, 1, names);
  if (status == CONCEG_OK) status = put(doc, "/types/class", CONCEG_TEXT, 1, 1, classes);
  if (status == CONCEG_OK) status = put(doc, "/cells/id", CONCEG_U64, 1, 1, &first_id);
  if (status == CONCEG_OK) status = put(doc, "/cells/type", CONCEG_U32, 1, 1, type);
  if (status == CONCEG_OK) status = put(doc, "/cells/soma", CONCEG_F64, 1, 3, soma);
  if (status == CONCEG_OK) status = put(doc, "/cells/radius", CONCEG_F32, 1, 1, radius);
  return status;
}

static conceg_status write_skeleton(conceg_doc *doc) {
  static const uint64_t offset[2] = {0, 1};
  static const double position[3] = {5, 2, 3};
  static const float radius[1] = {1};
  static const int64_t parent[1] = {-1};
  static const uint8_t kind[1] = {3};
  conceg_status status = put(doc, "/skeleton/cell_offset", CONCEG_U64, 2, 1, offset);
  if (status == CONCEG_OK) status = put(doc, "/skeleton/position", CONCEG_F64, 1, 3, position);
  if (status == CONCEG_OK) status = put(doc, "/skeleton/radius", CONCEG_F32, 1, 1, radius);
  if (status == CONCEG_OK) status = put(doc, "/skeleton/target_radius", CONCEG_F32, 1, 1, radius);
  if (status == CONCEG_OK) status = put(doc, "/skeleton/parent", CONCEG_I64, 1, 1, parent);
  if (status == CONCEG_OK) status = put(doc, "/skeleton/kind", CONCEG_U8, 1, 1, kind);
  return status;
}

static conceg_status write_spheres(conceg_doc *doc) {
  static const uint64_t offset[2] = {0, 1};
  static const double center[3] = {5, 2, 3};
  static const float radius[1] = {1};
  conceg_status status = put(doc, "/spheres/cell_offset", CONCEG_U64, 2, 1, offset);
  if (status == CONCEG_OK) status = put(doc, "/spheres/center", CONCEG_F64, 1, 3, center);
  if (status == CONCEG_OK) status = put(doc, "/spheres/radius", CONCEG_F32, 1, 1, radius);
  return status;
}

static conceg_status run_place(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)params;
  return write_cells(doc, conceg_ctx_seed(ctx));
}
static conceg_status run_grow(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)params;
  return write_skeleton(doc);
}
static conceg_status run_relax(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)params;
  return write_spheres(doc);
}
static conceg_status run_nothing(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)doc, (void)params;
  return CONCEG_OK;
}
static conceg_status refuse(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)doc, (void)params;
  return conceg_ctx_fail(ctx, CONCEG_E_RANGE, "checked and refused");
}

static const char *const cells[] = {"/types", "/cells", NULL}, *const only_cells[] = {"/cells", NULL},
                         *const skeleton[] = {"/skeleton", NULL}, *const spheres[] = {"/spheres", NULL},
                         *const network[] = {"/network", NULL};

static conceg_stage make(const char *kind, const char *const *reads, const char *const *writes,
                         const char *const *drops,
                         conceg_status (*run)(conceg_ctx *, conceg_doc *, const conceg_params *)) {
  conceg_stage stage;
  memset(&stage, 0, sizeof stage);
  stage.abi = CONCEG_STAGE_ABI, stage.size = sizeof stage;
  stage.kind = kind, stage.name = "test", stage.version = "1";
  stage.reads = reads, stage.writes = writes, stage.drops = drops, stage.run = run;
  return stage;
}

static conceg_status run(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                         const conceg_recipe *recipe) {
  conceg_params *params;
  conceg_status status = conceg_params_new(ctx, stage, doc, recipe, NULL, NULL, &params);
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, stage, doc, params);
  conceg_params_free(params);
  return status;
}

static uint64_t provenance_rows(conceg_doc *doc) {
  conceg_array array = {sizeof array, CONCEG_TEXT, 0, 0, {0, 0, 0, 0}, NULL, NULL};
  if (!conceg_doc_has(doc, "/provenance/stage") ||
      conceg_doc_read(doc, "/provenance/stage", &array) != CONCEG_OK)
    return 0;
  return array.shape[0];
}

static void check_stale(conceg_ctx *ctx, const char *recipe_text, int keeps_network) {
  const conceg_stage place = make("place", NULL, cells, NULL, run_place),
                     grow = make("grow", only_cells, skeleton, network, run_grow),
                     relax = make("relax", skeleton, spheres, NULL, run_relax);
  static const double position[3] = {1, 1, 1};
  conceg_recipe *recipe;
  conceg_doc *doc;
  const char *text = "";
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  CHECK_EQUAL(conceg_recipe_parse(ctx, recipe_text, "r.yaml", &recipe), CONCEG_OK);
  CHECK_EQUAL(run(ctx, &grow, doc, recipe), CONCEG_E_MISSING);
  CHECK_TEXT(conceg_ctx_error(ctx),
             "grow: needs /cells, which the document does not have; run conceg place before it");
  CHECK_EQUAL(run(ctx, &place, doc, recipe), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_read_text(doc, "/recipe", &text), CONCEG_OK);
  CHECK(strstr(text, "seed: 5\n") != NULL);
  CHECK_EQUAL(put(doc, "/network/position", CONCEG_F64, 1, 3, position), CONCEG_OK);
  CHECK_EQUAL(run(ctx, &grow, doc, NULL), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_has(doc, "/network"), keeps_network);
  CHECK_EQUAL(run(ctx, &relax, doc, NULL), CONCEG_OK);
  CHECK_EQUAL(provenance_rows(doc), 3);
  CHECK_EQUAL(conceg_doc_has(doc, "/spheres@made_from"), 1);
  /* New cells: the skeleton goes, and the spheres that were made from it. */
  CHECK_EQUAL(run(ctx, &place, doc, NULL), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_has(doc, "/skeleton"), 0);
  CHECK_EQUAL(conceg_doc_has(doc, "/spheres"), 0);
  CHECK_EQUAL(conceg_doc_has(doc, "/cells"), 1);
  conceg_recipe_free(recipe);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

static void check_origins(conceg_ctx *ctx) {
  const conceg_stage place = make("place", NULL, cells, NULL, run_place),
                     grow = make("grow", only_cells, skeleton, NULL, run_grow),
                     reader = make("relax", skeleton, NULL, NULL, run_nothing);
  conceg_doc *doc;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  CHECK_EQUAL(run(ctx, &place, doc, NULL), CONCEG_OK);
  CHECK_EQUAL(run(ctx, &grow, doc, NULL), CONCEG_OK);
  last_log[0] = '\0';
  CHECK_EQUAL(run(ctx, &reader, doc, NULL), CONCEG_OK);
  CHECK_TEXT(last_log, "");
  CHECK_EQUAL(write_cells(doc, 77), CONCEG_OK); /* behind the host's back */
  CHECK_EQUAL(run(ctx, &reader, doc, NULL), CONCEG_OK);
  CHECK_TEXT(last_log, "/skeleton was made from another /cells than the one in this document");
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

static void check_refusals(conceg_ctx *ctx) {
  conceg_stage place = make("place", NULL, cells, NULL, run_place);
  conceg_registry *registry;
  const conceg_stage *const builtins[] = {&place, NULL}, *found = NULL;
  conceg_doc *doc;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  place.check = refuse;
  CHECK_EQUAL(run(ctx, &place, doc, NULL), CONCEG_E_RANGE);
  CHECK_EQUAL(conceg_doc_has(doc, "/cells"), 0);
  CHECK_EQUAL(conceg_registry_new(ctx, builtins, &registry), CONCEG_OK);
  CHECK_EQUAL(conceg_registry_find(registry, "place", "", &found), CONCEG_OK);
  CHECK(found == &place);
  CHECK_EQUAL(conceg_registry_find(registry, "place", "other", &found), CONCEG_E_MISSING);
  CHECK_TEXT(conceg_ctx_error(ctx), "stage place: no implementation is named other; there is test");
  CHECK_EQUAL(conceg_registry_find(registry, "place", "plugin:test", &found), CONCEG_E_MISSING);
  conceg_registry_free(registry);
  place.abi = CONCEG_STAGE_ABI + 1;
  CHECK_EQUAL(conceg_registry_new(ctx, builtins, &registry), CONCEG_E_ABI);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

int main(void) {
  conceg_ctx *ctx = conceg_ctx_new();
  unsetenv("CONCEG_STAGE_PATH");
  conceg_ctx_set_log(ctx, CONCEG_LOG_WARNING, keep_log, NULL);
  check_stale(ctx, "conceg: 1\nseed: 5\n", 0);
  check_stale(ctx, "conceg: 1\nseed: 5\nkeep: [network]\n", 1);
  check_origins(ctx);
  check_refusals(ctx);
  conceg_ctx_free(ctx);
  return check_done();
}
