/* SPDX-License-Identifier: BSD-3-Clause
 * Running one stage as the host must: what it reads is there, what it made stale goes, what it wrote is valid
 * and noted. */
#include "conceg/run.h"

#include "ctx_internal.h"
#include "provenance.h"
#include "schema.h"

/* spec/schema.yaml, put here by the build. */
extern const char conceg_schema_yaml[];
extern const unsigned long conceg_schema_yaml_size;

#define GROUP_PATH 256
#define GROUP_LIMIT 64

/* Which word makes a group, for the remedy in the error line. */
static const char *maker_of(const char *group) {
  static const char *const makers[][2] = {{"domain", "place"},
                                          {"types", "place"},
                                          {"cells", "place"},
                                          {"bars", "place"},
                                          {"dictionary", "characterise"},
                                          {"network", "triangulate"},
                                          {"skeleton", "grow"},
                                          {"spheres", "relax"},
                                          {"meshes", "mesh"},
                                          {"volumes", "mesh"},
                                          {"walkers", "simulate"},
                                          {"signals", "simulate"},
                                          {"statistics", "analyse"}};
  size_t i;
  for (i = 0; i < sizeof makers / sizeof *makers; i++)
    if (!strcmp(makers[i][0], group)) return makers[i][1];
  return NULL;
}

static conceg_status check_reads(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc) {
  uint32_t i;
  for (i = 0; stage->reads && stage->reads[i]; i++) {
    const char *group = group_name(stage->reads[i]), *maker = maker_of(group);
    char path[GROUP_PATH];
    snprintf(path, sizeof path, "/%s", group);
    if (!group_optional(stage->reads[i]) && !conceg_doc_has(doc, path))
      return conceg_ctx_fail(ctx, CONCEG_E_MISSING, "%s: needs /%s, which the document does not have%s%s%s",
                             stage->kind, group, maker ? "; run conceg " : "", maker ? maker : "",
                             maker ? " before it" : "");
  }
  return CONCEG_OK;
}

/* Stages read more groups than those they need, so all that stay are looked at; not those that the stage
 * makes anew. */
static conceg_status check_origins(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc) {
  const char *path;
  uint64_t i;
  for (i = 0; (path = conceg_doc_child(doc, "/", i)); i++) {
    char group[GROUP_PATH];
    conceg_status status;
    if (strchr(path, '@')) continue;
    snprintf(group, sizeof group, "%.*s", (int)strcspn(path + 1, "/"), path + 1);
    if (group_in(stage->writes, group)) continue;
    status = origins_warn(ctx, doc, group);
    if (status != CONCEG_OK) return status;
  }
  return CONCEG_OK;
}

static int holds_tables(conceg_ctx *ctx, const char *group) {
  const struct schema *schema = ctx_schema(ctx);
  const struct schema_group *known = schema ? schema_group(schema, group, strlen(group)) : NULL;
  return known && known->tables;
}

/* What the stage makes anew must not survive from an earlier run: it may write less of it this time. */
static conceg_status drop_old_results(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc) {
  uint32_t i;
  for (i = 0; stage->writes && stage->writes[i]; i++) {
    const char *group = group_name(stage->writes[i]);
    char path[GROUP_PATH];
    conceg_status status;
    /* Tables of several stages live side by side; a table is replaced by its own writer. */
    if (group_in(stage->reads, group) || holds_tables(ctx, group)) continue;
    snprintf(path, sizeof path, "/%s", group);
    status = conceg_doc_drop(doc, path);
    if (status != CONCEG_OK) return status;
  }
  return CONCEG_OK;
}

/* Drops all that depends on `group`, directly or not, and was not written in this run. `depends` is the
 * schema's table. */
static conceg_status drop_dependents(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                                     const conceg_node *depends, const char *group, unsigned depth) {
  const conceg_node *list = conceg_node_get(depends, group);
  uint32_t i;
  if (depth > GROUP_LIMIT)
    return conceg_ctx_fail(ctx, CONCEG_E_INTERNAL, "schema.yaml: depends: %s depends on itself", group);
  for (i = 0; i < conceg_node_count(list); i++) {
    const char *dependent = conceg_node_text(conceg_node_at(list, i));
    char path[GROUP_PATH];
    conceg_status status;
    if (!dependent || group_in(stage->writes, dependent)) continue;
    snprintf(path, sizeof path, "/%s", dependent);
    if (conceg_doc_has(doc, path))
      conceg_ctx_log(ctx, CONCEG_LOG_INFO, "%s: %s no longer matches /%s and is dropped", stage->kind, path,
                     group);
    status = conceg_doc_drop(doc, path);
    if (status == CONCEG_OK) status = drop_dependents(ctx, stage, doc, depends, dependent, depth + 1);
    if (status != CONCEG_OK) return status;
  }
  return CONCEG_OK;
}

static conceg_status drop_stale(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc) {
  struct yamltree *schema;
  const conceg_node *depends;
  uint32_t i;
  conceg_status status =
      yamltree_parse(ctx, conceg_schema_yaml, conceg_schema_yaml_size, "schema.yaml", &schema);
  if (status != CONCEG_OK) return status;
  depends = conceg_node_get(yamltree_root(schema), "depends");
  for (i = 0; status == CONCEG_OK && stage->writes && stage->writes[i]; i++)
    status = drop_dependents(ctx, stage, doc, depends, group_name(stage->writes[i]), 0);
  yamltree_free(schema);
  return status;
}

static int recipe_keeps(const conceg_params *params, const char *group) {
  const conceg_node *keep = params->recipe ? conceg_node_get(params->recipe->root, "keep") : NULL;
  uint32_t i;
  for (i = 0; i < conceg_node_count(keep); i++)
    if (!strcmp(group_name(conceg_node_text(conceg_node_at(keep, i))), group)) return 1;
  return 0;
}

static conceg_status drop_unwanted(const conceg_stage *stage, conceg_doc *doc, const conceg_params *params) {
  uint32_t i;
  for (i = 0; stage->drops && stage->drops[i]; i++) {
    const char *group = group_name(stage->drops[i]);
    char path[GROUP_PATH];
    conceg_status status;
    if (recipe_keeps(params, group)) continue;
    snprintf(path, sizeof path, "/%s", group);
    status = conceg_doc_drop(doc, path);
    if (status != CONCEG_OK) return status;
  }
  return CONCEG_OK;
}

/* The stage's fault, not the input's: what it wrote breaks the rules. */
static conceg_status fail_stage(conceg_ctx *ctx, const conceg_stage *stage, const char *what) {
  char line[500];
  snprintf(line, sizeof line, "%s", conceg_ctx_error(ctx));
  return conceg_ctx_fail(ctx, CONCEG_E_STAGE, "%s (%s) %s: %s", stage->kind, stage->name, what, line);
}

/* The same document in another form: its provenance and origins are its own. */
static int is_restored(const conceg_params *params) {
  const uint64_t flags = CONCEG_STAGE_SOURCE | CONCEG_STAGE_RESTORES;
  return (params->stage->flags & flags) == flags &&
         __atomic_load_n(&params->told->restored, __ATOMIC_ACQUIRE);
}

static conceg_status note_written(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                                  const conceg_params *params, const struct origins *origins) {
  uint32_t i;
  for (i = 0; stage->writes && stage->writes[i]; i++) {
    const char *group = group_name(stage->writes[i]);
    char path[GROUP_PATH];
    conceg_status status;
    snprintf(path, sizeof path, "/%s", group);
    if (!conceg_doc_has(doc, path)) continue;
    status = is_restored(params) ? CONCEG_OK : origins_write(doc, group, origins);
    if (status != CONCEG_OK) return status;
    status = conceg_doc_validate(doc, path, NULL, NULL);
    if (status == CONCEG_E_FORMAT) return fail_stage(ctx, stage, "wrote a broken group");
    if (status != CONCEG_OK) return status;
  }
  return CONCEG_OK;
}

/* Groups that were there before the run, with their digests, to find what the stage did beyond what it says.
 */
struct snapshot {
  struct {
    char *path; /* "/cells/", "/recipe" */
    char digest[65];
  } group[GROUP_LIMIT];
  uint32_t count;
};

/* The digests are at hand: the provenance row has just taken that of the whole document. */
static conceg_status snapshot_take(conceg_ctx *ctx, conceg_doc *doc, struct snapshot *out) {
  const uint64_t children = conceg_doc_children(doc, "/");
  uint64_t i;
  memset(out, 0, sizeof *out);
  for (i = 0; i < children && out->count < GROUP_LIMIT; i++) {
    const char *child = conceg_doc_child(doc, "/", i);
    conceg_status status;
    if (strchr(child, '@') || !strncmp(child, "/x_", 3)) continue;
    out->group[out->count].path = text_copy(child, strlen(child));
    if (!out->group[out->count].path) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "run: out of memory");
    status = conceg_doc_digest(doc, child, out->group[out->count].digest);
    out->count++;
    if (status != CONCEG_OK) return status;
  }
  return CONCEG_OK;
}

static void snapshot_free(struct snapshot *snapshot) {
  while (snapshot->count)
    free(snapshot->group[--snapshot->count].path);
}

static void group_of(const char *path, char group[GROUP_PATH]) {
  snprintf(group, GROUP_PATH, "%.*s", (int)strcspn(path + 1, "/"), path + 1);
}

static conceg_status fail_undeclared(conceg_ctx *ctx, const conceg_stage *stage, const char *did,
                                     const char *group) {
  return conceg_ctx_fail(ctx, CONCEG_E_STAGE, "%s (%s): %s /%s, which its descriptor does not list",
                         stage->kind, stage->name, did, group);
}

/* New groups that it does not list. */
static conceg_status check_new(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                               const struct snapshot *before) {
  const uint64_t children = conceg_doc_children(doc, "/");
  uint64_t i;
  uint32_t j;
  if (before->count == GROUP_LIMIT) return CONCEG_OK;
  for (i = 0; i < children; i++) {
    const char *child = conceg_doc_child(doc, "/", i);
    char group[GROUP_PATH];
    for (j = 0; j < before->count && strcmp(before->group[j].path, child) != 0;)
      j++;
    if (j < before->count || strchr(child, '@') || !strncmp(child, "/x_", 3)) continue;
    group_of(child, group);
    if (!group_in(stage->writes, group)) return fail_undeclared(ctx, stage, "wrote", group);
  }
  return CONCEG_OK;
}

/* Old groups that it does not list are as they were. */
static conceg_status check_untouched(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                                     const struct snapshot *before) {
  uint32_t i;
  for (i = 0; i < before->count; i++) {
    char group[GROUP_PATH], digest[65];
    conceg_status status;
    group_of(before->group[i].path, group);
    if (group_in(stage->writes, group)) continue;
    if (!conceg_doc_has(doc, before->group[i].path)) return fail_undeclared(ctx, stage, "dropped", group);
    status = conceg_doc_digest(doc, before->group[i].path, digest);
    if (status != CONCEG_OK) return status;
    if (strcmp(digest, before->group[i].digest) != 0) return fail_undeclared(ctx, stage, "changed", group);
  }
  return CONCEG_OK;
}

static conceg_status tell_phase(conceg_ctx *ctx, const char *phase, const conceg_stage *stage) {
  char text[96];
  snprintf(text, sizeof text, "phase: %s %.64s", phase, stage->kind);
  return conceg_ctx_progress(ctx, text, 0, 0);
}

static conceg_status run_body(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                              const conceg_params *params) {
  conceg_status status = tell_phase(ctx, "check", stage);
  if (status == CONCEG_OK && stage->check) status = stage->check(ctx, doc, params);
  if (status == CONCEG_OK) status = drop_old_results(ctx, stage, doc);
  if (status == CONCEG_OK) status = tell_phase(ctx, "run", stage);
  if (status == CONCEG_OK) status = stage->run(ctx, doc, params);
  if (status != CONCEG_OK && !strcmp(conceg_status_name(status), "E_UNKNOWN"))
    return conceg_ctx_fail(ctx, CONCEG_E_STAGE, "%s (%s): returned %d, which is no status", stage->kind,
                           stage->name, (int)status);
  if (status != CONCEG_OK) {
    if (!*conceg_ctx_error(ctx))
      return conceg_ctx_fail(ctx, status, "%s (%s): %s", stage->kind, stage->name,
                             conceg_status_text(status));
    return status;
  }
  if (__atomic_load_n(&params->told->misuse, __ATOMIC_ACQUIRE))
    return conceg_ctx_fail(ctx, CONCEG_E_INTERNAL,
                           "%s (%s): asked for the parameter \"%s\", which is not in its table", stage->kind,
                           stage->name, params->told->name);
  return CONCEG_OK;
}

/* After /recipe is in place: the run itself and what follows it. */
static conceg_status run_noted(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                               const conceg_params *params, struct origins *origins,
                               struct snapshot *before) {
  char input[65];
  conceg_status status = conceg_doc_digest(doc, "/", input);
  if (status == CONCEG_OK) status = origins_take(ctx, doc, stage, origins);
  if (status == CONCEG_OK) status = snapshot_take(ctx, doc, before);
  if (status == CONCEG_OK) status = run_body(ctx, stage, doc, params);
  if (status == CONCEG_OK) status = tell_phase(ctx, "validate", stage);
  if (status == CONCEG_OK) status = is_restored(params) ? CONCEG_OK : check_new(ctx, stage, doc, before);
  if (status == CONCEG_OK) status = check_untouched(ctx, stage, doc, before);
  if (status == CONCEG_OK) status = drop_stale(ctx, stage, doc);
  if (status == CONCEG_OK) status = drop_unwanted(stage, doc, params);
  if (status == CONCEG_OK) status = note_written(ctx, stage, doc, params, origins);
  if (status == CONCEG_OK && !is_restored(params)) status = provenance_add(ctx, doc, params, input);
  return status;
}

static conceg_status write_recipe(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const char *text = conceg_recipe_text(params->recipe);
  if (!text) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "recipe: out of memory");
  return conceg_doc_write_text(doc, "/recipe", text);
}

conceg_status conceg_stage_run(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                               const conceg_params *params) {
  struct origins origins = {NULL, 0};
  struct snapshot before;
  conceg_status status;
  /* A sink gets the document as it came: it may write a copy of it. */
  const int is_sink = (stage->flags & CONCEG_STAGE_SINK) != 0;
  before.count = 0;
  conceg_ctx_clear_error(ctx);
  status = check_reads(ctx, stage, doc);
  if (status == CONCEG_OK) status = check_origins(ctx, stage, doc);
  if (status == CONCEG_OK && params->recipe_is_new && !is_sink) status = write_recipe(ctx, doc, params);
  if (status == CONCEG_OK) {
    conceg_ctx_set_seed(ctx, params->seed);
    status = run_noted(ctx, stage, doc, params, &origins, &before);
  }
  if (status == CONCEG_OK && params->recipe_is_new && is_sink) status = write_recipe(ctx, doc, params);
  origins_free(&origins);
  snapshot_free(&before);
  return status;
}
