/* SPDX-License-Identifier: BSD-3-Clause
 * Parameters of a stage: from the table's defaults, the document's recipe, an own recipe and the command line
 * to values. */
#include "params_internal.h"

#include "conceg/run.h"

#include <math.h>

#define TABLE_LIMIT 256 /* rows of a table */

/* ---- Values, as the stage reads them ---- */

static const struct param_value *find_value(const conceg_params *params, const char *name) {
  const conceg_param *table = params->stage->params;
  uint32_t i;
  for (i = 0; i < params->count; i++)
    if (!strcmp(table[i].name, name)) return &params->value[i];
  if (!__atomic_exchange_n(&params->told->misuse, 1, __ATOMIC_ACQ_REL))
    snprintf(params->told->name, sizeof params->told->name, "%s", name);
  return NULL;
}

double conceg_params_f64(const conceg_params *params, const char *name) {
  const struct param_value *value = find_value(params, name);
  return value ? value->number : (double)NAN;
}

int64_t conceg_params_i64(const conceg_params *params, const char *name) {
  const struct param_value *value = find_value(params, name);
  return value ? value->whole : 0;
}

int conceg_params_bool(const conceg_params *params, const char *name) {
  const struct param_value *value = find_value(params, name);
  return value ? value->boolean : 0;
}

const char *conceg_params_text(const conceg_params *params, const char *name) {
  const struct param_value *value = find_value(params, name);
  return value ? value->text : "";
}

void conceg_params_restored(const conceg_params *params) {
  __atomic_store_n(&params->told->restored, 1, __ATOMIC_RELEASE);
}

int conceg_params_given(const conceg_params *params, const char *name) {
  const struct param_value *value = find_value(params, name);
  return value ? value->given : 0;
}

const char *conceg_params_argument(const conceg_params *params, uint32_t index) {
  return index < params->arguments ? params->argument[index] : NULL;
}

const char *conceg_params_canonical(const conceg_params *params) {
  return params->canonical.data;
}

/* ---- From text to a checked value ---- */

/* 1 if `text` is one of the words of a |-separated list. */
static int is_choice(const char *choices, const char *text) {
  const size_t length = strlen(text);
  while (choices && *choices) {
    const size_t word = strcspn(choices, "|");
    if (word == length && !memcmp(choices, text, length)) return 1;
    choices += word + (choices[word] == '|');
  }
  return 0;
}

static void describe(const conceg_param *row, char *out, size_t size) {
  const char *unit = row->unit && *row->unit && strcmp(row->unit, "1") != 0 ? row->unit : "";
  switch (row->type) {
  case CONCEG_PARAM_F64:
  case CONCEG_PARAM_I64:
    snprintf(out, size, "%s from %.15g to %.15g%s%s",
             row->type == CONCEG_PARAM_F64 ? "a number" : "a whole number", row->lo, row->hi,
             *unit ? " " : "", unit);
    break;
  case CONCEG_PARAM_BOOL:
    snprintf(out, size, "true or false");
    break;
  case CONCEG_PARAM_CHOICE:
    snprintf(out, size, "one of %s", row->choices);
    break;
  default:
    snprintf(out, size, "text");
    break;
  }
}

/* Reads a scalar as the row's type. Returns 0 when it is not of that type or outside the range. */
static int convert(const conceg_param *row, const char *text, int quoted, struct param_value *out) {
  switch (row->type) {
  case CONCEG_PARAM_F64:
    if (quoted || !text_to_f64(text, &out->number)) return 0;
    return out->number >= row->lo && out->number <= row->hi;
  case CONCEG_PARAM_I64:
    if (quoted || !text_to_i64(text, &out->whole)) return 0;
    out->number = (double)out->whole;
    return out->number >= row->lo && out->number <= row->hi;
  case CONCEG_PARAM_BOOL:
    return !quoted && text_to_bool(text, &out->boolean);
  case CONCEG_PARAM_CHOICE:
    return is_choice(row->choices, text);
  case CONCEG_PARAM_TEXT:
  case CONCEG_PARAM_FILE:
    return 1;
  default:
    return 0;
  }
}

static int keep_text(struct param_value *value, const char *text, int quoted) {
  char *copy = text_copy(text, strlen(text));
  if (!copy) return 0;
  free(value->text);
  value->text = copy;
  value->quoted = quoted;
  return 1;
}

static conceg_status no_memory(conceg_ctx *ctx) {
  return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "parameters: out of memory");
}

static int is_param_name(const char *name) {
  const char *p;
  for (p = name; (*p >= 'a' && *p <= 'z') || (p > name && ((*p >= '0' && *p <= '9') || *p == '_'));)
    p++;
  return p > name && !*p && p - name <= 64;
}

/* What is wrong with one row of a table, given the rows before it; NULL = nothing. */
static const char *row_fault(const conceg_param *table, uint32_t i) {
  const conceg_param *row = &table[i];
  struct param_value value;
  uint32_t before;
  memset(&value, 0, sizeof value);
  if (!is_param_name(row->name)) return "a name of at most 64 lower-case letters, digits and _";
  if (row->type < CONCEG_PARAM_F64 || row->type > CONCEG_PARAM_FILE) return "a known type";
  if (row->type == CONCEG_PARAM_CHOICE && (!row->choices || !*row->choices)) return "choices";
  if ((row->type == CONCEG_PARAM_F64 || row->type == CONCEG_PARAM_I64) && !(row->lo <= row->hi))
    return "a range with lo <= hi";
  if (!row->fallback || !convert(row, row->fallback, 0, &value)) return "a default that fits the row";
  for (before = 0; before < i; before++)
    if (!strcmp(table[before].name, row->name)) return "a name that no other row has";
  return NULL;
}

conceg_status params_check_table(conceg_ctx *ctx, const conceg_stage *stage, const char *from) {
  uint32_t i;
  for (i = 0; stage->params && stage->params[i].name; i++) {
    const char *fault = i < TABLE_LIMIT ? row_fault(stage->params, i) : "a table of at most 256 rows";
    if (fault)
      return conceg_ctx_fail(ctx, CONCEG_E_ABI, "%s: parameter %u (%.64s): expected %s", from, i,
                             stage->params[i].name, fault);
  }
  return CONCEG_OK;
}

static conceg_status set_defaults(conceg_ctx *ctx, conceg_params *params) {
  const conceg_param *table = params->stage->params;
  uint32_t i;
  for (i = 0; table && table[i].name; i++)
    if (i == TABLE_LIMIT)
      return conceg_ctx_fail(ctx, CONCEG_E_INTERNAL, "%s: the table has more than %d rows",
                             params->stage->kind, TABLE_LIMIT);
  params->count = i;
  if (!params->value) params->value = calloc(params->count + 1, sizeof *params->value);
  if (!params->value) return no_memory(ctx);
  for (i = 0; i < params->count; i++) {
    const int is_text = table[i].type == CONCEG_PARAM_TEXT || table[i].type == CONCEG_PARAM_FILE;
    if (!table[i].fallback || !convert(&table[i], table[i].fallback, 0, &params->value[i]))
      return conceg_ctx_fail(
          ctx, CONCEG_E_INTERNAL, "%s.%s: the default \"%s\" does not fit its own row of the table",
          params->stage->kind, table[i].name, table[i].fallback ? table[i].fallback : "(null)");
    if (!keep_text(&params->value[i], table[i].fallback, is_text)) return no_memory(ctx);
    params->value[i].given = 0;
  }
  return CONCEG_OK;
}

static conceg_status unknown_parameter(conceg_ctx *ctx, const conceg_params *params, const conceg_node *node,
                                       const char *key) {
  const char *names[TABLE_LIMIT + 2], *near;
  uint32_t i;
  for (i = 0; i < params->count; i++)
    names[i] = params->stage->params[i].name;
  names[i++] = "impl";
  names[i] = NULL;
  near = nearest_name(key, names);
  return fail_node(ctx, CONCEG_E_PARAM, node, "unknown key %s.%.80s%s%s%s", params->stage->kind, key,
                   near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
}

/* Takes the values of one recipe's section for this stage. */
static conceg_status take_section(conceg_ctx *ctx, conceg_params *params, const conceg_recipe *recipe) {
  const conceg_node *section = node_find(recipe->root, params->stage->kind);
  uint32_t i, row;
  for (i = 0; section && i < section->count; i++) {
    const conceg_node *node = section->child[i];
    const char *key = section->key[i];
    if (!strcmp(key, "impl")) continue;
    for (row = 0; row < params->count && strcmp(params->stage->params[row].name, key) != 0;)
      row++;
    if (row == params->count) return unknown_parameter(ctx, params, node, key);
    if (!convert(&params->stage->params[row], node->text, node->quoted, &params->value[row])) {
      char expected[200];
      describe(&params->stage->params[row], expected, sizeof expected);
      return fail_node(ctx, CONCEG_E_PARAM, node, "%s.%s: expected %s, got %.80s", params->stage->kind, key,
                       expected, node->text);
    }
    if (!keep_text(&params->value[row], node->text, node->quoted)) return no_memory(ctx);
    params->value[row].given = 1;
  }
  return CONCEG_OK;
}

/* ---- Layers of recipes ---- */

/* Puts a copy of `node` under `key` of a map. */
static int put_copy(conceg_node *map, const char *key, const conceg_node *node) {
  conceg_node *copy = node_clone(node);
  if (!copy) return 0;
  node_set_line(copy, 0);
  return node_put(map, key, copy);
}

/* The stage's own -p over the document's recipe: its section and its seed. */
static conceg_status overlay(conceg_ctx *ctx, conceg_params *params, const conceg_recipe *own) {
  const conceg_node *section = node_find(own->root, params->stage->kind),
                    *seed = node_find(own->root, "seed");
  conceg_node *target;
  uint32_t i;
  if (seed && !put_copy(params->recipe->root, "seed", seed)) return no_memory(ctx);
  if (!section || !section->count) return recipe_check(ctx, params->recipe->root);
  target = recipe_section(params->recipe, params->stage->kind);
  if (!target) return no_memory(ctx);
  for (i = 0; i < section->count; i++)
    if (!put_copy(target, section->key[i], section->child[i])) return no_memory(ctx);
  return recipe_check(ctx, params->recipe->root);
}

/* What only the source stage reads cannot be changed later: /recipe would no longer say what the document
 * holds. */
static conceg_status check_late_set(conceg_ctx *ctx, const conceg_stage *stage, const char *assignment) {
  static const char *const early[] = {"conceg",          "title",  "domain", "dictionary", "density_per_um3",
                                      "density_profile", "layers", "types",  "perturb",    NULL};
  const size_t length = strcspn(assignment, ".[=");
  int i;
  for (i = 0; early[i]; i++)
    if (strlen(early[i]) == length && !memcmp(early[i], assignment, length))
      return conceg_ctx_fail(ctx, CONCEG_E_PARAM,
                             "--set %.80s: %s does not read %s; set it where the document is made, at place",
                             assignment, stage->kind, early[i]);
  return CONCEG_OK;
}

static void warn_overridden(conceg_ctx *ctx, const conceg_params *params, const conceg_recipe *before) {
  const conceg_node *old = node_find(before->root, params->stage->kind),
                    *now = node_find(params->recipe->root, params->stage->kind);
  const conceg_node *seed = node_find(before->root, "seed"),
                    *new_seed = node_find(params->recipe->root, "seed");
  uint32_t i;
  if (seed && new_seed && !node_equal(seed, new_seed))
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "seed: %s overrides %s of the document's /recipe", new_seed->text,
                   seed->text);
  for (i = 0; old && i < old->count; i++) {
    const conceg_node *value = now ? node_find(now, old->key[i]) : NULL;
    if (!node_equal(old->child[i], value))
      conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "%s.%s: %s overrides %s of the document's /recipe",
                     params->stage->kind, old->key[i], value ? value->text : "the default",
                     old->child[i]->text);
  }
}

/* Paths of this machine stay out of the document. */
static void remove_files(conceg_params *params) {
  conceg_node *section = node_find(params->recipe->root, params->stage->kind);
  uint32_t i;
  for (i = 0; section && section->kind == NODE_MAP && i < params->count; i++)
    if (params->stage->params[i].type == CONCEG_PARAM_FILE)
      node_remove(section, params->stage->params[i].name);
  if (section && section->count == 0) node_remove(params->recipe->root, params->stage->kind);
}

static conceg_status take_seed(conceg_ctx *ctx, conceg_params *params) {
  const conceg_node *seed = node_find(params->recipe->root, "seed");
  char text[32];
  int64_t value;
  if (seed) {
    const conceg_status status = conceg_node_i64(ctx, seed, &value);
    if (status != CONCEG_OK) return status;
    params->seed = (uint64_t)value;
  } else if (params->recipe_is_new) {
    conceg_node *node;
    snprintf(text, sizeof text, "%llu", (unsigned long long)params->seed);
    node = node_new_scalar(text, strlen(text), 0, 0);
    if (!node || !node_put(params->recipe->root, "seed", node)) return no_memory(ctx);
    return recipe_check(ctx, params->recipe->root);
  }
  return CONCEG_OK;
}

/* Makes params->recipe out of the document's recipe, the own one and the sets; decides whether /recipe is to
 * be written. */
static conceg_status merge(conceg_ctx *ctx, conceg_params *params, conceg_doc *doc, const conceg_recipe *own,
                           const char *const *sets) {
  conceg_recipe *before = NULL;
  conceg_status status = CONCEG_OK;
  const char *text, *old;
  if (doc && conceg_doc_has(doc, "/recipe")) {
    status = conceg_recipe_from_doc(ctx, doc, &before);
    if (status != CONCEG_OK) return status;
  }
  if (!before && !own && !(sets && *sets)) return CONCEG_OK;
  params->recipe = before ? recipe_clone(before) : own ? recipe_clone(own) : recipe_new();
  if (!params->recipe) status = no_memory(ctx);
  if (status == CONCEG_OK && before) status = take_section(ctx, params, before);
  if (status == CONCEG_OK && own) status = take_section(ctx, params, own);
  if (status == CONCEG_OK && before && own) status = overlay(ctx, params, own);
  for (; status == CONCEG_OK && sets && *sets; sets++) {
    if (before) status = check_late_set(ctx, params->stage, *sets);
    if (status == CONCEG_OK) status = conceg_recipe_set(ctx, params->recipe, *sets);
  }
  if (status == CONCEG_OK) status = set_defaults(ctx, params); /* a value set to null is the default again */
  if (status == CONCEG_OK) status = take_section(ctx, params, params->recipe);
  if (status == CONCEG_OK && before) warn_overridden(ctx, params, before);
  if (status == CONCEG_OK) {
    remove_files(params);
    params->recipe_is_new = before == NULL;
    status = take_seed(ctx, params);
  }
  if (status == CONCEG_OK) {
    recipe_changed(params->recipe);
    text = conceg_recipe_text(params->recipe);
    old = before ? conceg_recipe_text(before) : "";
    if (!text || !old)
      status = no_memory(ctx);
    else
      params->recipe_is_new |= strcmp(text, old) != 0;
  }
  conceg_recipe_free(before);
  return status;
}

/* ---- Making and freeing ---- */

static int make_canonical(conceg_params *params) {
  uint32_t i, written = 0;
  text_put(&params->canonical, "{");
  for (i = 0; i < params->count; i++) {
    if (params->stage->params[i].type == CONCEG_PARAM_FILE) continue;
    if (written++) text_put(&params->canonical, ", ");
    node_emit_scalar(params->stage->params[i].name, 1, &params->canonical);
    text_put(&params->canonical, ": ");
    node_emit_scalar(params->value[i].text,
                     params->value[i].quoted || params->stage->params[i].type == CONCEG_PARAM_TEXT,
                     &params->canonical);
  }
  text_put(&params->canonical, "}");
  return !params->canonical.failed;
}

static int keep_arguments(conceg_params *params, const char *const *arguments) {
  uint32_t count = 0;
  while (arguments && arguments[count])
    count++;
  params->argument = calloc(count + 1, sizeof *params->argument);
  if (!params->argument) return 0;
  for (; params->arguments < count; params->arguments++) {
    const char *argument = arguments[params->arguments];
    params->argument[params->arguments] = text_copy(argument, strlen(argument));
    if (!params->argument[params->arguments]) return 0;
  }
  return 1;
}

conceg_status conceg_params_new(conceg_ctx *ctx, const conceg_stage *stage, conceg_doc *doc,
                                const conceg_recipe *recipe, const char *const *sets,
                                const char *const *arguments, conceg_params **out) {
  conceg_params *params = calloc(1, sizeof *params);
  conceg_status status;
  *out = NULL;
  if (!params) return no_memory(ctx);
  params->stage = stage;
  params->seed = conceg_ctx_seed(ctx);
  params->told = calloc(1, sizeof *params->told);
  status = params->told ? set_defaults(ctx, params) : no_memory(ctx);
  if (status == CONCEG_OK) status = merge(ctx, params, doc, recipe, sets);
  if (status == CONCEG_OK && !(make_canonical(params) && keep_arguments(params, arguments)))
    status = no_memory(ctx);
  if (status != CONCEG_OK) {
    conceg_params_free(params);
    return status;
  }
  *out = params;
  return CONCEG_OK;
}

void conceg_params_free(conceg_params *params) {
  uint32_t i;
  if (!params) return;
  for (i = 0; params->value && i < params->count; i++)
    free(params->value[i].text);
  free(params->value);
  for (i = 0; i < params->arguments; i++)
    free(params->argument[i]);
  free(params->argument);
  text_free(&params->canonical);
  free(params->told);
  conceg_recipe_free(params->recipe);
  free(params);
}
