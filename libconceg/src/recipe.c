/* SPDX-License-Identifier: BSD-3-Clause
 * Recipes: loading, setting values from the command line, and the canonical text that travels in /recipe. */
#include "recipe.h"

#include <errno.h>

conceg_status fail_node(conceg_ctx *ctx, conceg_status status, const conceg_node *node, const char *format,
                        ...) {
  char line[600];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  if (node->line) return conceg_ctx_fail(ctx, status, "%s:%u: %s", node_file(node), node->line, line);
  return conceg_ctx_fail(ctx, status, "%s: %s", node_file(node), line);
}

static const char short_of_memory[] = "out of memory";

static conceg_status no_memory(conceg_ctx *ctx) {
  return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "recipe: out of memory");
}

static conceg_recipe *wrap_root(conceg_node *root) {
  conceg_recipe *recipe = root ? calloc(1, sizeof *recipe) : NULL;
  if (recipe)
    recipe->root = root;
  else
    node_free(root);
  return recipe;
}

static conceg_status parse_text(conceg_ctx *ctx, const char *text, size_t length, const char *name,
                                conceg_recipe **out) {
  struct yamltree *tree;
  conceg_recipe *recipe;
  conceg_status status = yamltree_parse(ctx, text, length, name, &tree);
  *out = NULL;
  if (status != CONCEG_OK) return status;
  if (!conceg_node_is_map(yamltree_root(tree))) {
    yamltree_free(tree);
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT,
                           "%s:1: expected a recipe (a YAML mapping that begins with conceg: 1), got %s",
                           name, length ? "something else" : "an empty file");
  }
  recipe = wrap_root(yamltree_take_root(tree));
  yamltree_free(tree);
  if (!recipe) return no_memory(ctx);
  status = recipe_check(ctx, recipe->root);
  if (status != CONCEG_OK) {
    conceg_recipe_free(recipe);
    return status;
  }
  *out = recipe;
  return CONCEG_OK;
}

conceg_status conceg_recipe_parse(conceg_ctx *ctx, const char *text, const char *name, conceg_recipe **out) {
  return parse_text(ctx, text, strlen(text), name, out);
}

/* The whole file, up to the bound on recipes. */
static conceg_status read_file(conceg_ctx *ctx, const char *path, struct text *out) {
  FILE *file = fopen(path, "rb");
  char block[8192];
  size_t count;
  int error;
  if (!file)
    return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot open the recipe: %s", path, strerror(errno));
  errno = 0;
  while ((count = fread(block, 1, sizeof block, file)) > 0 && out->length <= YAML_MAX_BYTES)
    text_add(out, block, count);
  error = ferror(file) ? errno : 0;
  fclose(file);
  if (out->failed) return no_memory(ctx);
  if (error)
    return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot read the recipe: %s", path, strerror(error));
  return CONCEG_OK;
}

conceg_status conceg_recipe_load(conceg_ctx *ctx, const char *path, conceg_recipe **out) {
  struct text text = {0};
  conceg_status status;
  *out = NULL;
  status = read_file(ctx, path, &text);
  if (status == CONCEG_OK) status = parse_text(ctx, text.data ? text.data : "", text.length, path, out);
  text_free(&text);
  return status;
}

conceg_status conceg_recipe_from_doc(conceg_ctx *ctx, conceg_doc *doc, conceg_recipe **out) {
  const char *text;
  conceg_status status;
  *out = NULL;
  if (!conceg_doc_has(doc, "/recipe"))
    return conceg_ctx_fail(ctx, CONCEG_E_MISSING, "/recipe: the document has no recipe");
  status = conceg_doc_read_text(doc, "/recipe", &text);
  if (status != CONCEG_OK) return status;
  status = parse_text(ctx, text, strlen(text), "/recipe", out);
  return status == CONCEG_E_PARAM ? CONCEG_E_FORMAT
                                  : status; /* the document is wrong, not the command line */
}

void conceg_recipe_free(conceg_recipe *recipe) {
  if (!recipe) return;
  node_free(recipe->root);
  text_free(&recipe->text);
  free(recipe);
}

void recipe_changed(conceg_recipe *recipe) {
  text_free(&recipe->text);
}

conceg_recipe *recipe_new(void) {
  conceg_recipe *recipe = wrap_root(node_new(NODE_MAP, 0));
  conceg_node *version = recipe ? node_new_scalar("1", 1, 0, 0) : NULL;
  if (version && node_append(recipe->root, "conceg", version)) return recipe;
  conceg_recipe_free(recipe);
  return NULL;
}

conceg_recipe *recipe_clone(const conceg_recipe *recipe) {
  return wrap_root(node_clone(recipe->root));
}

conceg_node *recipe_section(conceg_recipe *recipe, const char *kind) {
  conceg_node *section = node_find(recipe->root, kind);
  if (section && section->kind == NODE_MAP) return section;
  section = node_new(NODE_MAP, 0);
  return section && node_put(recipe->root, kind, section) ? section : NULL;
}

/* ---- --set ---- */

/* One step of a --set path: "types[2]" from `map`. Makes maps on the way. NULL: *problem says why. */
static conceg_node *step_into(conceg_node *map, const char *word, const char **problem) {
  char name[128];
  const char *bracket = strchr(word, '[');
  const size_t length = bracket ? (size_t)(bracket - word) : strlen(word);
  conceg_node *child;
  if (length == 0 || length >= sizeof name) return *problem = "expected a dotted path of keys", NULL;
  memcpy(name, word, length);
  name[length] = '\0';
  child = node_find(map, name);
  if (bracket) {
    char *end;
    const unsigned long index = strtoul(bracket + 1, &end, 10);
    if (end == bracket + 1 || strcmp(end, "]") != 0)
      return *problem = "expected a number between [ and ]", NULL;
    if (!child || child->kind != NODE_LIST || index >= child->count)
      return *problem = "no such entry in the list", NULL;
    return child->child[index];
  }
  if (child && child->kind == NODE_MAP) return child;
  if (child && !node_is_null(child)) return *problem = "a key on the path holds a value, not keys", NULL;
  child = node_new(NODE_MAP, 0);
  if (!child || !node_put(map, name, child)) return *problem = short_of_memory, NULL;
  return child;
}

/* Puts the value (taken) at a dotted path; null removes what is there. Returns NULL, or what is wrong. */
static const char *put_at(conceg_node *root, char *path, conceg_node *value) {
  const char *problem = "expected a dotted path of keys";
  conceg_node *map = root;
  char *word = path, *dot;
  while (map && (dot = strchr(word, '.')) != NULL) {
    *dot = '\0';
    map = step_into(map, word, &problem);
    word = dot + 1;
  }
  if (!map || map->kind != NODE_MAP || !*word || strchr(word, '[')) {
    node_free(value);
    return problem;
  }
  if (node_is_null(value)) {
    node_remove(map, word);
    node_free(value);
    return NULL;
  }
  return node_put(map, word, value) ? NULL : short_of_memory;
}

static conceg_status parse_value(conceg_ctx *ctx, const char *text, conceg_node **out) {
  struct yamltree *tree;
  const conceg_status status = yamltree_parse(ctx, text, strlen(text), "--set", &tree);
  if (status != CONCEG_OK) return status;
  *out = yamltree_take_root(tree);
  yamltree_free(tree);
  if (!*out) *out = node_new_scalar("", 0, 0, 0);
  if (!*out) return no_memory(ctx);
  node_set_line(*out, 0);
  return CONCEG_OK;
}

conceg_status conceg_recipe_set(conceg_ctx *ctx, conceg_recipe *recipe, const char *assignment) {
  const char *equals = strchr(assignment, '=');
  conceg_node *value, *backup;
  const char *problem;
  conceg_status status;
  char *path;
  if (!equals || equals == assignment)
    return conceg_ctx_fail(ctx, CONCEG_E_PARAM,
                           "--set %.80s: expected stage.key=value, for example grow.lambda=2", assignment);
  status = parse_value(ctx, equals + 1, &value);
  if (status != CONCEG_OK) return status;
  path = text_copy(assignment, (size_t)(equals - assignment));
  backup = node_clone(recipe->root);
  if (!path || !backup) {
    free(path);
    node_free(backup);
    node_free(value);
    return no_memory(ctx);
  }
  problem = put_at(recipe->root, path, value);
  if (problem)
    status = conceg_ctx_fail(ctx, problem == short_of_memory ? CONCEG_E_NOMEM : CONCEG_E_PARAM,
                             "--set %.80s: %s", assignment, problem);
  else
    status = recipe_check(ctx, recipe->root);
  if (status != CONCEG_OK) {
    node_free(recipe->root);
    recipe->root = backup;
  } else {
    node_free(backup);
  }
  free(path);
  recipe_changed(recipe);
  return status;
}

const char *conceg_recipe_text(conceg_recipe *recipe) {
  if (!recipe->text.data) node_emit_block(recipe->root, &recipe->text);
  if (!recipe->text.failed) return recipe->text.data;
  text_free(&recipe->text);
  return NULL;
}

const conceg_node *conceg_recipe_root(const conceg_recipe *recipe) {
  return recipe ? recipe->root : NULL;
}
