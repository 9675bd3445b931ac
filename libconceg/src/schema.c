/* SPDX-License-Identifier: BSD-3-Clause
 * Compiles the embedded spec/schema.yaml and answers questions about it. */
#define _POSIX_C_SOURCE 200809L
#include "schema.h"
#include "yaml.h"

#include <stdlib.h>
#include <string.h>

/* spec/schema.yaml, put here by the build. */
extern const char conceg_schema_yaml[];
extern const unsigned long conceg_schema_yaml_size;

struct compiler {
  conceg_ctx *ctx;
  conceg_status status;
};

/* The schema is part of the library, so a mistake in it is a mistake of the build. */
static void fail(struct compiler *compiler, const conceg_node *node, const char *what) {
  if (compiler->status == CONCEG_OK)
    compiler->status =
        conceg_ctx_fail(compiler->ctx, CONCEG_E_INTERNAL, "schema.yaml:%u: %s", conceg_node_line(node), what);
}

static char *copy_text(struct compiler *compiler, const conceg_node *node, const char *fallback) {
  const char *text = node ? conceg_node_text(node) : fallback;
  if (!text) {
    fail(compiler, node, "expected a scalar");
    return NULL;
  }
  char *copy = strdup(text);
  if (!copy) compiler->status = conceg_ctx_fail(compiler->ctx, CONCEG_E_NOMEM, "schema.yaml: out of memory");
  return copy;
}

static void *make_list(struct compiler *compiler, uint32_t count, size_t size) {
  void *list = calloc(count ? count : 1, size);
  if (!list) compiler->status = conceg_ctx_fail(compiler->ctx, CONCEG_E_NOMEM, "schema.yaml: out of memory");
  return list;
}

static int is_true(const conceg_node *node) {
  const char *text = conceg_node_text(node);
  return text && strcmp(text, "true") == 0;
}

static conceg_dtype dtype_of(struct compiler *compiler, const conceg_node *node) {
  const char *text = conceg_node_text(node);
  for (int dtype = CONCEG_U8; text && dtype <= CONCEG_TEXT; dtype++)
    if (strcmp(text, conceg_dtype_name(dtype)) == 0) return dtype;
  fail(compiler, node, "expected a type: u8 i8 u32 i32 u64 i64 f32 f64 text");
  return 0;
}

static void compile_extent(struct compiler *compiler, const conceg_node *node, struct schema_extent *out) {
  char *text = copy_text(compiler, node, NULL);
  if (!text) return;
  char *end = NULL;
  out->fixed = strtoull(text, &end, 10);
  if (end != text && !*end) {
    free(text);
    return;
  }
  const size_t length = strlen(text);
  out->plus_one = length > 2 && strcmp(text + length - 2, "+1") == 0;
  if (out->plus_one) text[length - 2] = '\0';
  out->name = text;
}

static void compile_rule(struct compiler *compiler, const conceg_node *node, struct schema_item *item) {
  static const struct {
    const char *name;
    uint32_t rule;
  } plain[] = {{"finite", RULE_FINITE},
               {"positive", RULE_POSITIVE},
               {"nonnegative", RULE_NONNEGATIVE},
               {"unit_vector", RULE_UNIT_VECTOR},
               {"unique", RULE_UNIQUE}},
    naming[] = {{"index_of", RULE_INDEX_OF}, {"index_or_none", RULE_INDEX_OR_NONE}, {"csr_of", RULE_CSR_OF}};
  const char *text = conceg_node_text(node);
  for (size_t i = 0; text && i < sizeof plain / sizeof *plain; i++)
    if (strcmp(text, plain[i].name) == 0) {
      item->rules |= plain[i].rule;
      return;
    }
  for (size_t i = 0; !text && i < sizeof naming / sizeof *naming; i++) {
    const conceg_node *extent = conceg_node_get(node, naming[i].name);
    if (!extent || item->rule_extent) continue;
    item->rules |= naming[i].rule;
    item->rule_extent = copy_text(compiler, extent, NULL);
    return;
  }
  fail(compiler, node, "unknown rule");
}

static void compile_item(struct compiler *compiler, const conceg_node *node, const char *name,
                         struct schema_item *item) {
  const conceg_node *kind = conceg_node_get(node, "kind"), *shape = conceg_node_get(node, "shape");
  const conceg_node *rules = conceg_node_get(node, "rules"), *choices = conceg_node_get(node, "choices");
  item->name = copy_text(compiler, conceg_node_get(node, "name"), name);
  item->attribute = kind && conceg_node_text(kind) && strcmp(conceg_node_text(kind), "attribute") == 0;
  item->required = is_true(conceg_node_get(node, "required"));
  item->dtype = dtype_of(compiler, conceg_node_get(node, "type"));
  item->unit = copy_text(compiler, conceg_node_get(node, "unit"), "");
  if (!conceg_node_is_list(shape) || conceg_node_count(shape) > 4)
    fail(compiler, node, "expected a shape of at most 4 extents");
  else
    for (item->rank = 0; item->rank < conceg_node_count(shape); item->rank++)
      compile_extent(compiler, conceg_node_at(shape, item->rank), &item->extent[item->rank]);
  for (uint32_t i = 0; i < conceg_node_count(rules); i++)
    compile_rule(compiler, conceg_node_at(rules, i), item);
  const uint32_t count = conceg_node_count(choices);
  item->choice = make_list(compiler, count, sizeof *item->choice);
  for (; item->choice && item->choices < count; item->choices++)
    item->choice[item->choices] = copy_text(compiler, conceg_node_at(choices, item->choices), NULL);
}

static void compile_items(struct compiler *compiler, const conceg_node *items, struct schema_group *group) {
  const uint32_t count = conceg_node_count(items);
  group->item = make_list(compiler, count, sizeof *group->item);
  for (; group->item && group->items < count; group->items++)
    compile_item(compiler, conceg_node_at(items, group->items), NULL, &group->item[group->items]);
}

static void compile_group(struct compiler *compiler, const conceg_node *node, struct schema_group *group) {
  const conceg_node *dataset = conceg_node_get(node, "dataset");
  group->name = copy_text(compiler, conceg_node_get(node, "name"), NULL);
  group->tables = is_true(conceg_node_get(node, "tables"));
  if (!dataset) {
    compile_items(compiler, conceg_node_get(node, "items"), group);
    return;
  }
  group->dataset = 1;
  group->item = make_list(compiler, 1, sizeof *group->item);
  if (!group->item) return;
  group->items = 1;
  compile_item(compiler, dataset, group->name, group->item);
}

static void compile(struct compiler *compiler, const conceg_node *root, struct schema *schema) {
  const conceg_node *groups = conceg_node_get(root, "groups"), *globals = conceg_node_get(root, "global");
  const uint32_t count = conceg_node_count(groups) + 1;
  schema->group = make_list(compiler, count, sizeof *schema->group);
  schema->global = make_list(compiler, conceg_node_count(globals), sizeof *schema->global);
  if (!schema->group || !schema->global) return;
  schema->groups = 1;
  schema->group[0].name = copy_text(compiler, NULL, "");
  compile_items(compiler, conceg_node_get(root, "root"), &schema->group[0]);
  for (; schema->groups < count; schema->groups++)
    compile_group(compiler, conceg_node_at(groups, schema->groups - 1), &schema->group[schema->groups]);
  for (; schema->globals < conceg_node_count(globals); schema->globals++)
    schema->global[schema->globals] = copy_text(compiler, conceg_node_at(globals, schema->globals), NULL);
}

conceg_status schema_new(conceg_ctx *ctx, struct schema **out) {
  struct compiler compiler = {.ctx = ctx};
  struct yamltree *tree = NULL;
  *out = NULL;
  compiler.status = yamltree_parse(ctx, conceg_schema_yaml, conceg_schema_yaml_size, "schema.yaml", &tree);
  if (compiler.status != CONCEG_OK) return compiler.status;
  struct schema *schema = make_list(&compiler, 1, sizeof *schema);
  if (schema) compile(&compiler, yamltree_root(tree), schema);
  yamltree_free(tree);
  if (compiler.status == CONCEG_OK)
    *out = schema;
  else
    schema_free(schema);
  return compiler.status;
}

static void free_item(struct schema_item *item) {
  free(item->name);
  free(item->unit);
  free(item->rule_extent);
  for (uint32_t i = 0; i < 4; i++)
    free(item->extent[i].name);
  for (uint32_t i = 0; i < item->choices; i++)
    free(item->choice[i]);
  free(item->choice);
}

void schema_free(struct schema *schema) {
  if (!schema) return;
  for (uint32_t g = 0; g < schema->groups; g++) {
    for (uint32_t i = 0; i < schema->group[g].items; i++)
      free_item(&schema->group[g].item[i]);
    free(schema->group[g].item);
    free(schema->group[g].name);
  }
  for (uint32_t i = 0; i < schema->globals; i++)
    free(schema->global[i]);
  free(schema->global);
  free(schema->group);
  free(schema);
}

const struct schema_group *schema_group(const struct schema *schema, const char *name, size_t length) {
  for (uint32_t g = 0; g < schema->groups; g++)
    if (strlen(schema->group[g].name) == length && memcmp(schema->group[g].name, name, length) == 0)
      return &schema->group[g];
  return NULL;
}

const struct schema_item *schema_item(const struct schema_group *group, const char *name, int attribute) {
  for (uint32_t i = 0; group && !group->dataset && i < group->items; i++)
    if (group->item[i].attribute == attribute && strcmp(group->item[i].name, name) == 0)
      return &group->item[i];
  return NULL;
}

const struct schema_item *schema_find(const struct schema *schema, const char *path) {
  if (path[0] != '/') return NULL;
  const size_t length = strcspn(path + 1, "/@");
  const struct schema_group *group = schema_group(schema, path + 1, length);
  const char *rest = path + 1 + length;
  if (!group) return NULL;
  if (!*rest) return group->dataset ? group->item : NULL;
  return schema_item(group, rest + 1, *rest == '@');
}

uint32_t schema_order(const struct schema *schema, const char *path) {
  const size_t length = strcspn(path + 1, "/@");
  const struct schema_group *group = schema_group(schema, path + 1, length);
  const char *rest = path + 1 + length;
  if (!group) return UINT32_MAX;
  if (!*rest || strcmp(rest, "/") == 0) return (uint32_t)(group - schema->group);
  const struct schema_item *item = schema_item(group, rest + 1, *rest == '@');
  return item ? (uint32_t)(item - group->item) : UINT32_MAX;
}

int schema_is_global(const struct schema *schema, const char *extent) {
  for (uint32_t i = 0; i < schema->globals; i++)
    if (strcmp(schema->global[i], extent) == 0) return 1;
  return 0;
}
