/* SPDX-License-Identifier: BSD-3-Clause
 * The smallest third-party stage: stands for `relax` and multiplies every radius by one factor.
 * Copy this folder, change the names, and put your algorithm into run(). */
#include <conceg/conceg.h>

#include <stdlib.h>
#include <string.h>

static conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const double factor = conceg_params_f64(params, "factor");
  conceg_array radius = {.size = sizeof radius};
  conceg_status status = conceg_doc_read(doc, "/skeleton/radius", &radius);
  if (status != CONCEG_OK) return status; /* the library has set the error line */
  if (radius.dtype != CONCEG_F32 || radius.rank != 1)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "/skeleton/radius: expected f32 of one extent, got %s of %u",
                           conceg_dtype_name(radius.dtype), radius.rank);

  /* A view ends when its path is written, so the result is made beside it. */
  const uint64_t count = radius.shape[0];
  const float *old = radius.data;
  float *scaled = malloc((count ? count : 1) * sizeof *scaled);
  if (!scaled)
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "template: out of memory for %llu radii",
                           (unsigned long long)count);
  for (uint64_t i = 0; i < count && status == CONCEG_OK; i++) {
    scaled[i] = (float)(old[i] * factor);
    if (i % 65536 == 0)
      status = conceg_ctx_progress(ctx, "scaling radii", i, count); /* not OK: the user cancelled */
  }
  radius.data = scaled;
  if (status == CONCEG_OK) status = conceg_doc_write(doc, "/skeleton/radius", &radius);
  free(scaled);
  return status;
}

/* Drives --factor, relax.factor in a recipe, --help and the range check. */
static const conceg_param params[] = {
    {"factor", "1", "multiplies every radius", "0.5", NULL, CONCEG_PARAM_F64, 0, 0.01, 1.0},
    {NULL, NULL, NULL, NULL, NULL, 0, 0, 0, 0},
};
static const char *const reads[] = {"/cells", "/skeleton", NULL};
static const char *const writes[] = {"/skeleton", NULL};
static const char *const drops[] = {NULL};

/* The host checks reads, values and results, drops what no longer matches, and writes the provenance. */
static const conceg_stage stage = {
    .abi = CONCEG_STAGE_ABI,
    .size = sizeof(conceg_stage),
    .kind = "relax",
    .name = "template",
    .version = "1.0.0",
    .summary = "multiplies every radius by one factor (the template of a third-party stage)",
    .example = "conceg relax --impl template --factor 0.8 < grown.cgx > thinner.cgx",
    .params = params,
    .reads = reads,
    .writes = writes,
    .drops = drops,
    .run = run,
};

const conceg_stage *conceg_stage_entry(uint32_t host_abi, uint32_t index) {
  return host_abi == CONCEG_STAGE_ABI && index == 0 ? &stage : NULL;
}
