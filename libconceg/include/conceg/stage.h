/* SPDX-License-Identifier: BSD-3-Clause
 * The stage ABI (spec/stage-abi.md): what a built-in stage and a plugin are to the host. */
#ifndef CONCEG_STAGE_H
#define CONCEG_STAGE_H

#include "conceg/params.h"

CONCEG_BEGIN_C

/* A plain counter; the host refuses a plugin with another number. */
#define CONCEG_STAGE_ABI 1u

#define CONCEG_STAGE_SOURCE 1u     /* needs no input document */
#define CONCEG_STAGE_SINK 2u       /* writes named files; passes the document on only with -o */
#define CONCEG_STAGE_THREADED 4u   /* uses conceg_ctx_threads */
#define CONCEG_STAGE_RECIPE 8u     /* a source that needs a recipe (-p) */
#define CONCEG_STAGE_ARGUMENTS 16u /* takes positional arguments (input files) */
#define CONCEG_STAGE_RESTORES 32u  /* a source that may restore a document: conceg_params_restored */

typedef struct conceg_stage {
  uint32_t abi;        /* CONCEG_STAGE_ABI */
  uint32_t size;       /* sizeof(conceg_stage) as the plugin saw it */
  const char *kind;    /* "grow": the word of the pipeline that it stands for */
  const char *name;    /* "barcode": which implementation of it */
  const char *version; /* of the implementation, "1.0.0" */
  const char *summary; /* one line */
  const char *example; /* one command line for --help */
  const conceg_param *params;
  const char *const *reads;  /* groups that must be there ("?skeleton": may be), NULL-terminated */
  const char *const *writes; /* groups that the stage makes; what depends on them is dropped by the host */
  const char *const *drops;  /* groups that are no longer wanted afterwards (unless the recipe says keep) */
  uint64_t flags;
  /* Cheap test before any work; may be NULL. */
  conceg_status (*check)(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params);
  conceg_status (*run)(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params);
} conceg_stage;

/* The one symbol of a plugin libconceg_stage_<kind>_<name>.so: its index-th stage, NULL past the last one. */
typedef const conceg_stage *(*conceg_stage_entry_fn)(uint32_t host_abi, uint32_t index);
CONCEG_EXPORT const conceg_stage *conceg_stage_entry(uint32_t host_abi, uint32_t index);

CONCEG_END_C
#endif
