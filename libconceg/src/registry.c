/* SPDX-License-Identifier: BSD-3-Clause
 * The registry: built-in stages in an explicit array, and plugins found by file name. */
#include "plugin.h"

#include "conceg/run.h"

#include "text.h"

static const char *const pipeline[] = {"characterise", "import", "place",  "triangulate", "grow", "relax",
                                       "block",        "mesh",   "check",  "simulate",    "fit",  "analyse",
                                       "export",       "render", "report", NULL};

const char *conceg_pipeline_kind(uint32_t index) {
  return index < sizeof pipeline / sizeof *pipeline ? pipeline[index] : NULL;
}

struct conceg_registry {
  conceg_ctx *ctx;
  const conceg_stage *const *builtins; /* borrowed */
  uint32_t builtin_count;
  struct plugin_list plugins;
};

conceg_status conceg_registry_new(conceg_ctx *ctx, const conceg_stage *const *builtins,
                                  conceg_registry **out) {
  conceg_registry *registry = calloc(1, sizeof *registry);
  conceg_status status = CONCEG_OK;
  *out = NULL;
  if (!registry) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "registry: out of memory");
  registry->ctx = ctx;
  registry->builtins = builtins;
  for (; status == CONCEG_OK && builtins && builtins[registry->builtin_count]; registry->builtin_count++)
    status = stage_check(ctx, builtins[registry->builtin_count], "built-in stage");
  if (status == CONCEG_OK) status = plugin_find_all(ctx, &registry->plugins);
  if (status != CONCEG_OK) {
    conceg_registry_free(registry);
    return status;
  }
  *out = registry;
  return CONCEG_OK;
}

void conceg_registry_free(conceg_registry *registry) {
  if (!registry) return;
  plugin_list_free(&registry->plugins);
  free(registry);
}

/* Names of what there is for a kind, for the error line. */
static void list_known(const conceg_registry *registry, const char *kind, struct text *out) {
  uint32_t i;
  for (i = 0; i < registry->builtin_count; i++)
    if (!strcmp(registry->builtins[i]->kind, kind))
      text_format(out, "%s%s", out->length ? ", " : "", registry->builtins[i]->name);
  for (i = 0; i < registry->plugins.count; i++)
    if (!strcmp(registry->plugins.item[i].kind, kind))
      text_format(out, "%s%s", out->length ? ", " : "", registry->plugins.item[i].name);
}

static conceg_status fail_missing(conceg_registry *registry, const char *kind, const char *impl) {
  struct text known = {0};
  conceg_status status;
  list_known(registry, kind, &known);
  if (known.length)
    status = conceg_ctx_fail(registry->ctx, CONCEG_E_MISSING,
                             "stage %s: no implementation is named %s; there is %s", kind, impl, known.data);
  else
    status = conceg_ctx_fail(registry->ctx, CONCEG_E_MISSING,
                             "stage %s: this build has none; rebuild with its libraries, or put a plugin "
                             "libconceg_stage_%s_NAME.so into a "
                             "folder of CONCEG_STAGE_PATH",
                             kind, kind);
  text_free(&known);
  return status;
}

conceg_status conceg_registry_find(conceg_registry *registry, const char *kind, const char *impl,
                                   const conceg_stage **out) {
  const int plugins_only = impl && !strncmp(impl, "plugin:", 7); /* past a built-in of the same name */
  const char *name = plugins_only ? impl + 7 : impl;
  uint32_t i;
  *out = NULL;
  for (i = 0; !plugins_only && i < registry->builtin_count; i++) {
    const conceg_stage *stage = registry->builtins[i];
    if (strcmp(stage->kind, kind) != 0 || (name && *name && strcmp(stage->name, name) != 0)) continue;
    *out = stage;
    return CONCEG_OK;
  }
  for (i = 0; i < registry->plugins.count; i++) {
    struct plugin *plugin = &registry->plugins.item[i];
    conceg_status status;
    if (strcmp(plugin->kind, kind) != 0 || (name && *name && strcmp(plugin->name, name) != 0)) continue;
    status = plugin_open(registry->ctx, plugin);
    if (status == CONCEG_OK) *out = plugin->stage;
    return status;
  }
  return fail_missing(registry, kind, name ? name : "");
}

int conceg_registry_at(conceg_registry *registry, uint32_t index, const char **kind, const char **name,
                       const char **file) {
  if (index < registry->builtin_count) {
    *kind = registry->builtins[index]->kind, *name = registry->builtins[index]->name, *file = "built in";
    return 1;
  }
  index -= registry->builtin_count;
  if (index >= registry->plugins.count) return 0;
  *kind = registry->plugins.item[index].kind, *name = registry->plugins.item[index].name,
  *file = registry->plugins.item[index].file;
  return 1;
}
