/* SPDX-License-Identifier: BSD-3-Clause
 * The host: a registry of built-in stages and plugins, and running one of them or a whole recipe. */
#ifndef CONCEG_RUN_H
#define CONCEG_RUN_H

#include "conceg/stage.h"

CONCEG_BEGIN_C

typedef struct conceg_registry conceg_registry;

/* A registry of `builtins` (NULL-terminated, borrowed) and of the plugins found by file name in
 * CONCEG_STAGE_PATH and then the install folder. Plugins are opened when first asked for and stay open until
 * the process ends. */
CONCEG_API conceg_status conceg_registry_new(conceg_ctx *ctx, const conceg_stage *const *builtins,
                                             conceg_registry **out) CONCEG_NODISCARD;
CONCEG_API void conceg_registry_free(conceg_registry *registry);
/* Stage of a kind; `impl` NULL or "" = the built-in one, else the first plugin. Errors: E_MISSING, E_ABI
 * (names the file). */
CONCEG_API conceg_status conceg_registry_find(conceg_registry *registry, const char *kind, const char *impl,
                                              const conceg_stage **out) CONCEG_NODISCARD;
/* Every stage known: kind, name, the answering file ("built in" or a path). Returns 0 past the end, else 1.
 */
CONCEG_API int conceg_registry_at(conceg_registry *registry, uint32_t index, const char **kind,
                                  const char **name, const char **file);

/* Makes the values of a stage: table defaults < the document's /recipe < `recipe` (may be NULL) < `sets`
 * (NULL-terminated "stage.key=value", may be NULL). Unknown keys: E_PARAM with file and line. Owned. */
CONCEG_API conceg_status conceg_params_new(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                                           const conceg_recipe *recipe, const char *const *sets,
                                           const char *const *arguments,
                                           conceg_params **out) CONCEG_NODISCARD;
CONCEG_API void conceg_params_free(conceg_params *params);
/* Canonical one-line YAML of the values (FILE parameters left out); borrowed. */
CONCEG_API const char *conceg_params_canonical(const conceg_params *params);

/* Runs one stage on a document as the host must: checks `reads`, runs check() and run(), drops what became
 * stale and `drops`, writes @made_from and a /provenance row, validates what was written. On failure the
 * document is unusable. The context's progress function is told of each phase with the text "phase: check
 * KIND", "phase: run KIND", "phase: validate KIND" and a total of 0. */
CONCEG_API conceg_status conceg_stage_run(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                                          const conceg_params *params) CONCEG_NODISCARD;

/* The order of the pipeline's kinds: "characterise", "place", ... NULL past the end. */
CONCEG_API const char *conceg_pipeline_kind(uint32_t index);

CONCEG_END_C
#endif
