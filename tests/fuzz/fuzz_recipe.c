/* SPDX-License-Identifier: BSD-3-Clause
 * Bytes as a recipe. Its canonical text is a recipe with the same canonical text; --set with parts of the
 * bytes never breaks it. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  conceg_ctx *ctx = fuzz_ctx();
  conceg_recipe *recipe = NULL, *again = NULL;
  if (size > (size_t)1 << 18) return 0;
  planted_bug(data, size);
  char *text = malloc(size + 1);
  DEMAND(text != NULL);
  memcpy(text, data, size);
  text[size] = 0;
  if (conceg_recipe_parse(ctx, text, "fuzz", &recipe) == CONCEG_OK) {
    const char *canonical = conceg_recipe_text(recipe);
    DEMAND(canonical != NULL);
    char *kept = strdup(canonical);
    DEMAND(kept && conceg_recipe_parse(ctx, kept, "again", &again) == CONCEG_OK);
    DEMAND(!strcmp(conceg_recipe_text(again), kept));
    conceg_recipe_free(again);
    char *line = strchr(text, '\n');
    if (conceg_recipe_set(ctx, recipe, line ? line + 1 : text) != CONCEG_OK) {
      DEMAND(*conceg_ctx_error(ctx));
      DEMAND(!strcmp(conceg_recipe_text(recipe), kept)); /* a failed set changes nothing */
    }
    free(kept);
  } else
    DEMAND(*conceg_ctx_error(ctx));
  conceg_recipe_free(recipe);
  free(text);
  return 0;
}
