/* SPDX-License-Identifier: BSD-3-Clause
 * Stages in shared libraries. A library is opened only when its stage is asked for, and stays open. */
#define _GNU_SOURCE /* dladdr, RTLD_LOCAL */
#include "plugin.h"
#include "provenance.h"

#include "params_internal.h"
#include "text.h"

#include <dirent.h>
#include <dlfcn.h>

#define STAGES_PER_PLUGIN 64u
#define GROUPS_PER_LIST 64u
#define PREFIX "libconceg_stage_"
#define SUFFIX ".so"

static conceg_status no_memory(conceg_ctx *ctx) {
  return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "plugins: out of memory");
}

void plugin_list_free(struct plugin_list *list) {
  uint32_t i;
  for (i = 0; i < list->count; i++) {
    free(list->item[i].file);
    free(list->item[i].kind);
    free(list->item[i].name);
  }
  free(list->item);
  memset(list, 0, sizeof *list);
}

/* Splits "libconceg_stage_grow_barcode.so" into kind and name. Returns 0 when the name is of another form. */
static int split_name(const char *file, const char **kind, size_t *kind_length, const char **name,
                      size_t *name_length) {
  const size_t length = strlen(file), prefix = strlen(PREFIX), suffix = strlen(SUFFIX);
  const char *bar;
  if (length <= prefix + suffix || strncmp(file, PREFIX, prefix) != 0 ||
      strcmp(file + length - suffix, SUFFIX) != 0)
    return 0;
  *kind = file + prefix;
  bar = strchr(*kind, '_');
  if (!bar || bar == *kind || bar + 1 >= file + length - suffix) return 0;
  *kind_length = (size_t)(bar - *kind);
  *name = bar + 1;
  *name_length = (size_t)(file + length - suffix - *name);
  return 1;
}

/* A folder may be named twice. */
static int is_listed(const struct plugin_list *list, const char *file) {
  uint32_t i;
  for (i = 0; i < list->count; i++)
    if (!strcmp(list->item[i].file, file)) return 1;
  return 0;
}

static int add_plugin(struct plugin_list *list, const char *folder, const char *file) {
  struct plugin *plugin;
  struct text path = {0};
  const char *kind, *name;
  size_t kind_length, name_length;
  if (!split_name(file, &kind, &kind_length, &name, &name_length)) return 1;
  text_put(&path, folder);
  text_put(&path, "/");
  text_put(&path, file);
  if (path.failed || is_listed(list, path.data)) {
    const int good = !path.failed;
    text_free(&path);
    return good;
  }
  if (list->count == list->capacity) {
    const uint32_t capacity = list->capacity ? list->capacity * 2 : 8;
    struct plugin *item = realloc(list->item, capacity * sizeof *item);
    if (!item) {
      text_free(&path);
      return 0;
    }
    list->item = item;
    list->capacity = capacity;
  }
  plugin = &list->item[list->count];
  plugin->stage = NULL;
  plugin->file = path.data;
  plugin->kind = text_copy(kind, kind_length);
  plugin->name = text_copy(name, name_length);
  list->count++;
  return plugin->kind && plugin->name;
}

static int by_name(const struct dirent **a, const struct dirent **b) {
  return strcmp((*a)->d_name, (*b)->d_name);
}

conceg_status plugin_scan(conceg_ctx *ctx, const char *folder, struct plugin_list *list) {
  struct dirent **entries;
  const int count = scandir(folder, &entries, NULL, by_name);
  int i, good = 1;
  for (i = 0; i < count; i++) {
    good = good && add_plugin(list, folder, entries[i]->d_name);
    free(entries[i]);
  }
  if (count >= 0) free(entries);
  return good ? CONCEG_OK : no_memory(ctx);
}

/* Where an install keeps its plugins: beside this very library, so that an install can be moved. */
static int install_folder(struct text *out) {
  Dl_info info;
  const char *slash;
  if (!dladdr((void *)(uintptr_t)&plugin_scan, &info) || !info.dli_fname) return 0;
  slash = strrchr(info.dli_fname, '/');
  if (slash)
    text_add(out, info.dli_fname, (size_t)(slash - info.dli_fname));
  else
    text_put(out, ".");
  text_put(out, "/conceg/plugins");
  return !out->failed;
}

conceg_status plugin_find_all(conceg_ctx *ctx, struct plugin_list *list) {
  const char *path = getenv("CONCEG_STAGE_PATH");
  struct text install = {0};
  conceg_status status = install_folder(&install) ? CONCEG_OK : no_memory(ctx);
  while (status == CONCEG_OK && path && *path) {
    const size_t length = strcspn(path, ":");
    char *folder = text_copy(path, length);
    if (!folder)
      status = no_memory(ctx);
    else
      status = plugin_scan(ctx, length ? folder : install.data, list);
    free(folder);
    path += length + (path[length] == ':');
  }
  if (status == CONCEG_OK) status = plugin_scan(ctx, install.data, list);
  text_free(&install);
  return status;
}

/* "/cells" or "cells"; the list ends with NULL. */
static int is_group_list(const char *const *group, int may_be_absent) {
  uint32_t i;
  for (i = 0; group && group[i]; i++) {
    const char *name = may_be_absent || !group_optional(group[i]) ? group_name(group[i]) : "";
    if (i == GROUPS_PER_LIST || !*name || strlen(name) > 64 ||
        name[strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_")])
      return 0;
  }
  return 1;
}

conceg_status stage_check(conceg_ctx *ctx, const conceg_stage *stage, const char *from) {
  if (stage->abi != CONCEG_STAGE_ABI)
    return conceg_ctx_fail(
        ctx, CONCEG_E_ABI,
        "%s: built for stage ABI %u, this library has %u; rebuild it with the headers of ConCeG %s", from,
        stage->abi, CONCEG_STAGE_ABI, conceg_version());
  if (stage->size < sizeof *stage)
    return conceg_ctx_fail(ctx, CONCEG_E_ABI,
                           "%s: expected a descriptor of at least %zu bytes, got %u; rebuild it", from,
                           sizeof *stage, stage->size);
  if (!stage->kind || !stage->name || !*stage->kind || !*stage->name || !stage->run)
    return conceg_ctx_fail(ctx, CONCEG_E_ABI, "%s: expected kind, name and run in the descriptor, got NULL",
                           from);
  if (!is_group_list(stage->reads, 1) || !is_group_list(stage->writes, 0) || !is_group_list(stage->drops, 0))
    return conceg_ctx_fail(
        ctx, CONCEG_E_ABI,
        "%s: expected reads, writes and drops of at most %u names of groups each, ending with NULL", from,
        GROUPS_PER_LIST);
  return params_check_table(ctx, stage, from);
}

/* The stage of the plugin's own kind and name among those that the library offers. */
static conceg_status choose_stage(conceg_ctx *ctx, struct plugin *plugin, conceg_stage_entry_fn entry) {
  const conceg_stage *stage = NULL;
  char found[200] = "nothing";
  uint32_t i;
  for (i = 0; i < STAGES_PER_PLUGIN && (stage = entry(CONCEG_STAGE_ABI, i)) != NULL; i++) {
    const conceg_status status = stage_check(ctx, stage, plugin->file);
    if (status != CONCEG_OK) return status;
    if (!strcmp(stage->kind, plugin->kind) && !strcmp(stage->name, plugin->name)) {
      plugin->stage = stage;
      return CONCEG_OK;
    }
    snprintf(found, sizeof found, "%.80s %.80s", stage->kind, stage->name);
  }
  return conceg_ctx_fail(ctx, CONCEG_E_ABI, "%s: by its file name expected the stage %s %s, got %s",
                         plugin->file, plugin->kind, plugin->name, found);
}

conceg_status plugin_open(conceg_ctx *ctx, struct plugin *plugin) {
  conceg_stage_entry_fn entry;
  void *library, *symbol;
  if (plugin->stage) return CONCEG_OK;
  library = dlopen(plugin->file, RTLD_NOW | RTLD_LOCAL);
  if (!library)
    return conceg_ctx_fail(ctx, CONCEG_E_ABI, "%s: cannot be opened: %s", plugin->file, dlerror());
  symbol = dlsym(library, "conceg_stage_entry");
  if (!symbol) {
    dlclose(library);
    return conceg_ctx_fail(ctx, CONCEG_E_ABI,
                           "%s: has no symbol conceg_stage_entry; is it exported (CONCEG_EXPORT)?",
                           plugin->file);
  }
  memcpy(&entry, &symbol, sizeof entry); /* ISO C has no cast from void * to a function */
  return choose_stage(ctx, plugin, entry);
}
