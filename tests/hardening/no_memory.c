/* SPDX-License-Identifier: BSD-3-Clause
 * Memory that runs out at any moment, all over libconceg: each scenario is run with its first, second, ...
 * allocation failing until none is left to fail. Only allocations that libconceg itself asks for are failed
 * (by the address that the call returns to; strdup counts as the caller's), not those of HDF5 and libyaml.
 * Each failure is E_NOMEM, nothing crashes, nothing is lost, and the document is what it was.  no_memory
 * [each] */
#define _GNU_SOURCE
#include "../unit/sample.h"

#include "conceg/conceg.h"

#if !defined(__GLIBC__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
int main(void) {
  SKIP("this C library or this build has an allocator of its own: no failing memory over libconceg");
}
#else

#include <dlfcn.h>
#include <stdarg.h>

static long countdown;   /* allocations of libconceg until the one that fails; 0 = none does */
static long failed_from; /* the number that failed; 0 = none yet */
static long alive;
static uintptr_t library_begin, library_end;

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void __libc_free(void *memory);

static int fails(const void *caller) {
  const uintptr_t address = (uintptr_t)caller;
  if (countdown <= 0 || address < library_begin || address >= library_end) return 0;
  if (--countdown) return 0;
  failed_from++;
  return 1;
}

#pragma GCC visibility push(default) /* the libraries are to find these */
void *malloc(size_t size) {
  void *const memory = fails(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
  alive += memory != NULL;
  return memory;
}
void *calloc(size_t count, size_t size) {
  void *const memory = fails(__builtin_return_address(0)) ? NULL : __libc_calloc(count, size);
  alive += memory != NULL;
  return memory;
}
void *realloc(void *memory, size_t size) {
  void *const grown = fails(__builtin_return_address(0)) ? NULL : __libc_realloc(memory, size);
  alive += !memory && grown;
  return grown;
}
void free(void *memory) {
  alive -= memory != NULL;
  __libc_free(memory);
}
char *strdup(const char *text) {
  const size_t size = strlen(text) + 1;
  char *const copy = fails(__builtin_return_address(0)) ? NULL : malloc(size);
  return copy ? memcpy(copy, text, size) : NULL;
}
#pragma GCC visibility pop

/* The text segment of libconceg.so. */
static int find_library(void) {
  char line[1024], wanted[512];
  Dl_info info;
  FILE *maps = fopen("/proc/self/maps", "r");
  if (!maps || !dladdr((void *)(uintptr_t)&conceg_version, &info)) return 0;
  char *real = realpath(info.dli_fname, NULL);
  if (!real) return 0;
  snprintf(wanted, sizeof wanted, "%s", real);
  free(real);
  while (fgets(line, sizeof line, maps)) {
    unsigned long begin, end;
    if (sscanf(line, "%lx-%lx", &begin, &end) != 2 || !strstr(line, wanted)) continue;
    if (!library_begin) library_begin = begin;
    library_end = end;
  }
  fclose(maps);
  return library_begin != 0;
}

static long stride = 13; /* 1 with the word "each" */
static void *image;
static size_t image_bytes;
static char sample_digest[65];
static const char *const recipe_text =
    "conceg: 1\nseed: 5\ndomain:\n  size_um: [20, 20, 20]\ntypes:\n  - {name: a, class: other, fraction: "
    "1}\nlayers:\n  - {name: "
    "one, z_um: [0, 20], density_per_um3: 1e-4}\nkeep: [network]\nrelax: {impl: toy, steps: 4}\n";

/* ---- Scenarios: each cleans up after itself whatever happened ---- */

static conceg_status open_image(conceg_ctx *ctx, conceg_doc **doc) {
  return conceg_doc_from_memory(ctx, image, image_bytes, doc);
}

static conceg_status read_everything(conceg_doc *doc, const char *group) {
  const uint64_t count = conceg_doc_children(doc, group);
  conceg_status status = CONCEG_OK;
  for (uint64_t i = 0; i < count && status == CONCEG_OK; i++) {
    char child[1024];
    conceg_array array = {.size = sizeof array};
    snprintf(child, sizeof child, "%s", conceg_doc_child(doc, group, i));
    status =
        child[strlen(child) - 1] == '/' ? read_everything(doc, child) : conceg_doc_read(doc, child, &array);
  }
  return status;
}

static conceg_status scenario_read(conceg_ctx *ctx) {
  conceg_doc *doc = NULL;
  conceg_status status = open_image(ctx, &doc);
  if (status == CONCEG_OK) status = read_everything(doc, "/");
  if (doc && conceg_doc_close(doc) != CONCEG_OK && status == CONCEG_OK) status = CONCEG_E_IO;
  return status;
}

static conceg_status scenario_validate(conceg_ctx *ctx) {
  conceg_doc *doc = NULL;
  char hex[65];
  conceg_status status = open_image(ctx, &doc);
  if (status == CONCEG_OK) status = conceg_doc_validate(doc, NULL, NULL, NULL);
  if (status == CONCEG_OK) status = conceg_doc_digest(doc, "/", hex);
  if (doc && conceg_doc_close(doc) != CONCEG_OK && status == CONCEG_OK) status = CONCEG_E_IO;
  return status;
}

/* A failed write or drop changes nothing: the digest, taken when memory is there again, is that of before or
 * after. */
static conceg_status scenario_write(conceg_ctx *ctx) {
  static const double soma[9] = {1, 1, 1, 2, 2, 2, 3, 3, 3};
  static const char *const names[2] = {"changed", "names"};
  const conceg_array
      numbers = {.size = sizeof numbers, .dtype = CONCEG_F64, .rank = 2, .shape = {3, 3}, .data = soma},
      texts = {.size = sizeof texts, .dtype = CONCEG_TEXT, .rank = 1, .shape = {2}, .data = names};
  const uint64_t shape[1] = {4};
  conceg_doc *doc = NULL;
  void *storage, *bytes = NULL;
  size_t count = 0;
  const long keep = countdown;
  countdown = 0;
  CHECK_EQUAL(open_image(ctx, &doc), CONCEG_OK);
  countdown = keep;
  conceg_status status = conceg_doc_write(doc, "/cells/soma", &numbers);
  if (status != CONCEG_OK) {
    char hex[65] = "";
    countdown = 0;
    CHECK_EQUAL(conceg_doc_digest(doc, "/", hex), CONCEG_OK);
    CHECK_TEXT(hex, sample_digest);
  }
  if (status == CONCEG_OK) status = conceg_doc_write(doc, "/types/name", &texts);
  if (status == CONCEG_OK)
    status = conceg_doc_new_array(doc, "/x_lab/deep/er/array", CONCEG_U8, 1, shape, &storage);
  if (status == CONCEG_OK) status = conceg_doc_write_text(doc, "/recipe", recipe_text);
  if (status == CONCEG_OK) status = conceg_doc_drop(doc, "/skeleton");
  if (status == CONCEG_OK) status = conceg_doc_to_memory(doc, &bytes, &count);
  conceg_free(bytes);
  if (status == CONCEG_OK) status = conceg_doc_save(doc, "no_memory.cgx");
  if (conceg_doc_close(doc) != CONCEG_OK && status == CONCEG_OK) status = CONCEG_E_IO;
  remove("no_memory.cgx");
  return status;
}

static conceg_status scenario_substrate(conceg_ctx *ctx) {
  conceg_doc *doc = NULL;
  conceg_substrate *substrate = NULL;
  conceg_status status = open_image(ctx, &doc);
  if (status == CONCEG_OK) status = conceg_substrate_open(doc, &substrate);
  conceg_substrate_free(substrate);
  if (doc && conceg_doc_close(doc) != CONCEG_OK && status == CONCEG_OK) status = CONCEG_E_IO;
  return status;
}

static conceg_status scenario_recipe(conceg_ctx *ctx) {
  conceg_recipe *recipe = NULL;
  conceg_status status = conceg_recipe_parse(ctx, recipe_text, "recipe", &recipe);
  if (status == CONCEG_OK) status = conceg_recipe_set(ctx, recipe, "types[0].fraction=0.5");
  if (status == CONCEG_OK) status = conceg_recipe_set(ctx, recipe, "domain.size_um=[10, 20, 30]");
  if (status == CONCEG_OK && !conceg_recipe_text(recipe)) /* says nothing itself */
    status = conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "recipe: out of memory");
  conceg_recipe_free(recipe);
  return status;
}

static conceg_status run_toy(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  static const float radius[3] = {5, 5, 5};
  const conceg_array array = {
      .size = sizeof array, .dtype = CONCEG_F32, .rank = 1, .shape = {3}, .data = radius};
  (void)ctx;
  return conceg_params_i64(params, "steps") == 4 ? conceg_doc_write(doc, "/cells/radius", &array)
                                                 : CONCEG_E_STAGE;
}

static conceg_status scenario_stage(conceg_ctx *ctx) {
  static const conceg_param table[] = {{"steps", "1", "", "3", NULL, CONCEG_PARAM_I64, 0, 0, 9},
                                       {"label", "", "", "", NULL, CONCEG_PARAM_TEXT, 0, 0, 0},
                                       {NULL, NULL, NULL, NULL, NULL, 0, 0, 0, 0}};
  static const char *const cells[] = {"/cells", NULL};
  static const conceg_stage toy = {.abi = CONCEG_STAGE_ABI,
                                   .size = sizeof toy,
                                   .kind = "relax",
                                   .name = "toy",
                                   .version = "1",
                                   .params = table,
                                   .reads = cells,
                                   .writes = cells,
                                   .run = run_toy};
  static const conceg_stage *const builtins[] = {&toy, NULL};
  static const char *const sets[] = {"relax.label=short", NULL};
  const conceg_stage *stage;
  conceg_registry *registry = NULL;
  conceg_recipe *recipe = NULL;
  conceg_params *params = NULL;
  conceg_doc *doc = NULL;
  conceg_status status = conceg_registry_new(ctx, builtins, &registry);
  if (status == CONCEG_OK) status = conceg_registry_find(registry, "relax", "toy", &stage);
  if (status == CONCEG_OK) status = conceg_recipe_parse(ctx, recipe_text, "recipe", &recipe);
  if (status == CONCEG_OK) status = open_image(ctx, &doc);
  if (status == CONCEG_OK) status = conceg_params_new(ctx, stage, doc, recipe, sets, NULL, &params);
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, stage, doc, params);
  conceg_params_free(params);
  conceg_recipe_free(recipe);
  conceg_registry_free(registry);
  if (doc && conceg_doc_close(doc) != CONCEG_OK && status == CONCEG_OK) status = CONCEG_E_IO;
  return status;
}

static conceg_status scenario_context(conceg_ctx *ctx) {
  conceg_ctx *own = conceg_ctx_new();
  (void)ctx;
  if (!own) return CONCEG_E_NOMEM;
  conceg_status status = conceg_ctx_set_tmpdir(own, "/tmp");
  conceg_ctx_count(own, "a.counter", 3, 5);
  conceg_doc *doc = NULL;
  if (status == CONCEG_OK) status = conceg_doc_new(own, &doc);
  if (doc && conceg_doc_close(doc) != CONCEG_OK && status == CONCEG_OK) status = CONCEG_E_IO;
  conceg_ctx_free(own);
  return status;
}

static const struct {
  const char *name;
  conceg_status (*run)(conceg_ctx *ctx);
  long fewest; /* allocations that it must have, so that a scenario that does nothing is noticed */
} scenarios[] = {{"open and read", scenario_read, 100},
                 {"validate and digest", scenario_validate, 100},
                 {"write, drop, save", scenario_write, 40},
                 {"substrate", scenario_substrate, 100},
                 {"recipe", scenario_recipe, 50},
                 {"registry, parameters, stage", scenario_stage, 150},
                 {"context and new document", scenario_context, 10}};

/* One run with one failing allocation. Returns what it left behind; *status is that of the run. */
static long run_failing(conceg_ctx *ctx, size_t which, long number, conceg_status *status) {
  const long before = alive;
  failed_from = 0;
  countdown = number;
  *status = scenarios[which].run(ctx);
  countdown = 0;
  return alive - before;
}

static void check_scenario(conceg_ctx *ctx, size_t which) {
  const int failed = check_failed_;
  long number;
  for (number = 1; number < 1000000; number += number < 600 ? 1 : stride) {
    conceg_status status;
    long lost = run_failing(ctx, which, number, &status);
    if (!failed_from) {
      CHECK_EQUAL(status, CONCEG_OK);
      break;
    }
    /* What may be forgotten when memory is short: a counter, the text of a message. */
    if (status != CONCEG_OK) {
      CHECK_EQUAL(status, CONCEG_E_NOMEM);
      CHECK(*conceg_ctx_error(ctx) != '\0' || scenarios[which].run == scenario_context);
    }
    if (failed != check_failed_)
      fprintf(stderr, "  in scenario \"%s\", allocation %ld: %s: %s\n", scenarios[which].name, number,
              conceg_status_name(status), conceg_ctx_error(ctx));
    conceg_ctx_clear_error(ctx);
    /* The caches of HDF5 grow once; what is lost is lost each time. */
    if (lost > 0) lost = run_failing(ctx, which, number, &status);
    if (lost > 0) lost = run_failing(ctx, which, number, &status);
    CHECK(lost <= 0);
    if (failed != check_failed_) {
      fprintf(stderr, "  in scenario \"%s\", allocation %ld: %ld blocks lost\n", scenarios[which].name,
              number, lost);
      break;
    }
    conceg_ctx_clear_error(ctx);
  }
  printf("%-28s %ld allocations, %s failed in turn\n", scenarios[which].name, number - 1,
         stride == 1 ? "each" : "the first 600 and every 13th of the others");
  if (failed == check_failed_) CHECK(number > scenarios[which].fewest);
}

int main(int argc, char **argv) {
  conceg_ctx *ctx = sample_ctx();
  conceg_doc *doc = sample_doc(ctx);
  if (!find_library()) SKIP("no /proc/self/maps: the library is not found");
  if (argc > 1 && !strcmp(argv[1], "each")) stride = 1;
  CHECK_EQUAL(conceg_doc_to_memory(doc, &image, &image_bytes), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_digest(doc, "/", sample_digest), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  for (size_t i = 0; i < sizeof scenarios / sizeof *scenarios; i++)
    CHECK_EQUAL(scenarios[i].run(ctx), CONCEG_OK); /* fills what is made once */
  for (size_t i = 0; i < sizeof scenarios / sizeof *scenarios; i++)
    check_scenario(ctx, i);
  conceg_free(image);
  conceg_ctx_free(ctx);
  return check_done();
}
#endif
