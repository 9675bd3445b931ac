/* SPDX-License-Identifier: BSD-3-Clause
 * Stages for tests only: a source that makes a tiny valid document without any other library, and stages that
 * misbehave. The build makes one library per stage out of this file; TOY_KIND, TOY_NAME and TOY_RUN choose.
 */
#include <conceg/conceg.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static conceg_status write_array(conceg_doc *doc, const char *path, conceg_dtype dtype, uint64_t rows,
                                 uint64_t columns, const void *data) {
  const conceg_array array = {
      sizeof array, dtype, columns == 0 ? 0u : columns == 1 ? 1u : 2u, 0, {rows, columns, 0, 0}, data, NULL};
  return conceg_doc_write(doc, path, &array);
}

#define TRY(call)                                                                                            \
  do {                                                                                                       \
    const conceg_status try_status = (call);                                                                 \
    if (try_status != CONCEG_OK) return try_status;                                                          \
  } while (0)

/* Two cells of one type in a box of the recipe's size, each with one process of three points. */
static conceg_status make_tissue(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  static const uint8_t periodic[3] = {1, 1, 1}, kind[6] = {3, 3, 3, 3, 3, 3};
  static const char *const names[] = {"toy"}, *const classes[] = {"other"};
  static const uint64_t id[2] = {0, 1}, offset[3] = {0, 3, 6};
  static const uint32_t type[2] = {0, 0};
  static const float radius[2] = {2, 2}, target[6] = {1, 1, 1, 1, 1, 1};
  static const int64_t parent[6] = {-1, 0, 1, -1, 0, 1};
  static const double pia[3] = {0, 0, 1};
  double lo[3] = {0, 0, 0}, hi[3], step = CONCEG_LATTICE_STEP_UM, soma[6], position[18];
  float thin[6];
  conceg_recipe *recipe;
  conceg_rng rng = conceg_rng_stream(conceg_ctx_seed(ctx), "toy", 0);
  TRY(conceg_recipe_from_doc(ctx, doc, &recipe));
  const conceg_node *size = conceg_node_get(conceg_recipe_root(recipe), "domain.size_um");
  for (uint32_t axis = 0; axis < 3; axis++) {
    hi[axis] = 20;
    if (conceg_node_at(size, axis) &&
        conceg_node_f64(ctx, conceg_node_at(size, axis), &hi[axis]) != CONCEG_OK)
      hi[axis] = 0;
  }
  conceg_recipe_free(recipe);
  for (uint32_t i = 0; i < 6; i++) {
    soma[i] = conceg_snap(hi[i % 3] * conceg_rng_uniform(&rng));
    thin[i] = (float)conceg_params_f64(params, "radius_um");
  }
  for (uint32_t point = 0; point < 6; point++)
    for (uint32_t axis = 0; axis < 3; axis++)
      position[3 * point + axis] = soma[3 * (point / 3) + axis] + (axis == 0) * (2.0 + point % 3);
  conceg_ctx_count(ctx, "toy.cells", 0, 2);
  TRY(write_array(doc, "/domain@lo", CONCEG_F64, 3, 1, lo));
  TRY(write_array(doc, "/domain@hi", CONCEG_F64, 3, 1, hi));
  TRY(write_array(doc, "/domain@periodic", CONCEG_U8, 3, 1, periodic));
  TRY(write_array(doc, "/domain@pia", CONCEG_F64, 3, 1, pia));
  TRY(write_array(doc, "/domain@lattice_step", CONCEG_F64, 1, 0, &step));
  TRY(write_array(doc, "/types/name", CONCEG_TEXT, 1, 1, names));
  TRY(write_array(doc, "/types/class", CONCEG_TEXT, 1, 1, classes));
  TRY(write_array(doc, "/cells/id", CONCEG_U64, 2, 1, id));
  TRY(write_array(doc, "/cells/type", CONCEG_U32, 2, 1, type));
  TRY(write_array(doc, "/cells/soma", CONCEG_F64, 2, 3, soma));
  TRY(write_array(doc, "/cells/radius", CONCEG_F32, 2, 1, radius));
  TRY(write_array(doc, "/skeleton/cell_offset", CONCEG_U64, 3, 1, offset));
  TRY(write_array(doc, "/skeleton/position", CONCEG_F64, 6, 3, position));
  TRY(write_array(doc, "/skeleton/radius", CONCEG_F32, 6, 1, thin));
  TRY(write_array(doc, "/skeleton/target_radius", CONCEG_F32, 6, 1, target));
  TRY(write_array(doc, "/skeleton/parent", CONCEG_I64, 6, 1, parent));
  return write_array(doc, "/skeleton/kind", CONCEG_U8, 6, 1, kind);
}

/* Spheres that stand for what depends on the skeleton. */
static conceg_status make_spheres(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  static const uint64_t offset[3] = {0, 1, 2};
  static const double center[6] = {1, 1, 1, 2, 2, 2};
  static const float radius[2] = {1, 1};
  (void)ctx, (void)params;
  TRY(write_array(doc, "/spheres/cell_offset", CONCEG_U64, 3, 1, offset));
  TRY(write_array(doc, "/spheres/center", CONCEG_F64, 2, 3, center));
  return write_array(doc, "/spheres/radius", CONCEG_F32, 2, 1, radius);
}

/* Radii that the format forbids. */
static conceg_status break_rules(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  static const float radius[6] = {1, 1, -1, 1, 1, 1};
  (void)ctx, (void)params;
  return write_array(doc, "/skeleton/radius", CONCEG_F32, 6, 1, radius);
}

static conceg_status write_elsewhere(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  static const uint8_t one = 1;
  (void)ctx, (void)params;
  return write_array(doc, "/volumes/label", CONCEG_U8, 1, 1, &one);
}

static conceg_status ask_for_nothing(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)doc;
  return conceg_params_f64(params, "no_such_row") > 0 ? CONCEG_OK : CONCEG_OK;
}

static conceg_status fail_silently(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)doc, (void)params;
  return CONCEG_E_STAGE;
}

/* Groups of others, in the document that they trust. */
static conceg_status change_cells(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  static const float radius[2] = {7, 7};
  (void)ctx, (void)params;
  return write_array(doc, "/cells/radius", CONCEG_F32, 2, 1, radius);
}
static conceg_status drop_cells(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)params;
  return conceg_doc_drop(doc, "/cells");
}
static conceg_status forge_provenance(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)params;
  return conceg_doc_drop(doc, "/provenance");
}

/* The process itself. */
static conceg_status return_nonsense(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)doc, (void)params;
  return (conceg_status)7;
}
static conceg_status end_program(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)doc, (void)params;
  exit(0);
}
static conceg_status crash(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  volatile int *nowhere = NULL;
  (void)ctx, (void)doc, (void)params;
  *nowhere = 1;
  return CONCEG_OK;
}
static conceg_status print_to_stdout(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)doc, (void)params;
  puts("a stage that prints");
  return CONCEG_OK;
}

/* Reports progress until somebody cancels. */
static conceg_status wait_for_cancel(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  conceg_status status = CONCEG_OK;
  (void)doc, (void)params;
  for (uint64_t i = 0; status == CONCEG_OK; i++)
    status = conceg_ctx_progress(ctx, "waiting", i % 1000, 1000);
  return status;
}

typedef conceg_status (*run_fn)(conceg_ctx *, conceg_doc *, const conceg_params *);

static const conceg_param table[] = {
    {"radius_um", "um", "radius of every process", "0.5", NULL, CONCEG_PARAM_F64, 0, 0.1, 5},
    {"steps", "", "a whole number", "10", NULL, CONCEG_PARAM_I64, 0, 0, 1000},
    {"smooth", "", "a switch", "false", NULL, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"mode", "", "a choice", "first", "first|second", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"label", "", "a text", "", NULL, CONCEG_PARAM_TEXT, 0, 0, 0},
    {"table", "", "a file", "", NULL, CONCEG_PARAM_FILE, 0, 0, 0},
    {NULL, NULL, NULL, NULL, NULL, 0, 0, 0, 0},
};
/* Tables that a host must not believe; TOY_TABLE chooses. */
#define LAST_ROW                                                                                             \
  { NULL, NULL, NULL, NULL, NULL, 0, 0, 0, 0 }
static const conceg_param twice[] = {{"a", "", "", "1", NULL, CONCEG_PARAM_I64, 0, 0, 9},
                                     {"a", "", "", "1", NULL, CONCEG_PARAM_I64, 0, 0, 9},
                                     LAST_ROW},
                          beyond[] = {{"a", "", "", "12", NULL, CONCEG_PARAM_I64, 0, 0, 9}, LAST_ROW},
                          turned[] = {{"a", "", "", "1", NULL, CONCEG_PARAM_F64, 0, 9, 0}, LAST_ROW},
                          shouting[] = {{"Not a name", "", "", "1", NULL, CONCEG_PARAM_F64, 0, 0, 9},
                                        LAST_ROW},
                          typeless[] = {{"a", "", "", "1", NULL, 99, 0, 0, 9}, LAST_ROW},
                          defaultless[] = {{"a", "", "", NULL, NULL, CONCEG_PARAM_TEXT, 0, 0, 9}, LAST_ROW},
                          choiceless[] = {{"a", "", "", "x", NULL, CONCEG_PARAM_CHOICE, 0, 0, 9}, LAST_ROW};
static conceg_param endless[300];
#ifndef TOY_TABLE
#define TOY_TABLE table
#endif

static const char *const source_writes[] = {"/domain", "/types", "/cells", "/skeleton", NULL};
static const char *const needs[] = {"/cells", "/skeleton", NULL};
/* What may be absent stands with a question mark, among the groups that are read alone. */
static const char *const may_be_there[] = {"/cells", "/skeleton", "?volumes", NULL}, *const unsure[] = {
                                                                                         "?spheres", NULL};
#ifndef TOY_READS
#define TOY_READS needs
#endif
#ifndef TOY_WRITES
#define TOY_WRITES spheres
#endif
static const char *const skeleton[] = {"/skeleton", NULL}, *const spheres[] = {"/spheres", NULL};

static const conceg_stage *describe(void) {
  static conceg_stage stage;
  const run_fn run = TOY_RUN;
  stage.abi = CONCEG_STAGE_ABI + TOY_ABI_OFFSET;
  stage.size = (uint32_t)sizeof stage - TOY_SIZE_OFFSET;
  stage.kind = TOY_KIND, stage.name = TOY_NAME, stage.version = "1.0.0";
  stage.summary = "a stage for tests";
  /* Every table is used by one of the libraries made of this file. */
  const conceg_param *const all[] = {table,    twice,    beyond,      turned,
                                     shouting, typeless, defaultless, choiceless};
  static char names[300][8];
  for (int i = 0; i < 300; i++) {
    snprintf(names[i], sizeof names[i], "a%d", i);
    endless[i] = beyond[0];
    endless[i].name = names[i];
    endless[i].fallback = "1";
  }
  stage.params = all[0] ? TOY_TABLE : NULL;
  stage.run = run;
  if (run == make_tissue) {
    stage.writes = source_writes;
    stage.flags = CONCEG_STAGE_SOURCE | CONCEG_STAGE_RECIPE;
  } else {
    /* As the tables: every list is used by one of the libraries. */
    const char *const *const lists[] = {needs, may_be_there, spheres, unsure};
    stage.reads = lists[0] ? TOY_READS : NULL;
    stage.writes = run == break_rules ? skeleton : run == make_spheres ? TOY_WRITES : NULL;
  }
  return &stage;
}

const conceg_stage *conceg_stage_entry(uint32_t host_abi, uint32_t index) {
  /* Every function is used by one of the libraries made of this file. */
  static const run_fn all[] = {make_tissue,     make_spheres,     break_rules,     write_elsewhere,
                               ask_for_nothing, fail_silently,    wait_for_cancel, change_cells,
                               drop_cells,      forge_provenance, return_nonsense, end_program,
                               crash,           print_to_stdout};
  (void)host_abi;
  return index == 0 && all[0] ? describe() : NULL;
}
