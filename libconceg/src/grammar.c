/* SPDX-License-Identifier: BSD-3-Clause
 * The grammar of a recipe (spec/cli.md, rules R1 to R14): known keys, their forms and ranges, canonical
 * order. */
#include "recipe.h"

#include "ctx_internal.h"
#include "schema.h"

#include "conceg/run.h"

enum form {
  FORM_VERSION, /* the number 1 */
  FORM_TEXT,
  FORM_SEED, /* whole number >= 0 */
  FORM_POSITIVE,
  FORM_NONNEGATIVE,
  FORM_VECTOR3,
  FORM_DIRECTION, /* not zero */
  FORM_POSITIVE3,
  FORM_BOOL3,
  FORM_RANGE, /* [lo, hi], lo < hi */
  FORM_NUMBER,
  FORM_WORDS,
  FORM_MAP,  /* with `fields` */
  FORM_LIST, /* of maps with `fields` */
  FORM_CLASS,
  FORM_SECTION /* parameters of a stage: checked against the stage's table by the host */
};

struct field {
  const char *name;
  enum form form;
  int required;
  const struct field *fields;
};

static const struct field domain_fields[] = {
    {"size_um", FORM_POSITIVE3, 0, NULL}, {"lo_um", FORM_VECTOR3, 0, NULL}, {"hi_um", FORM_VECTOR3, 0, NULL},
    {"periodic", FORM_BOOL3, 0, NULL},    {"pia", FORM_DIRECTION, 0, NULL}, {NULL, FORM_TEXT, 0, NULL}};

static const struct field profile_fields[] = {
    {"z_um", FORM_NUMBER, 1, NULL}, {"per_um3", FORM_NONNEGATIVE, 1, NULL}, {NULL, FORM_TEXT, 0, NULL}};

static const struct field layer_fields[] = {{"name", FORM_TEXT, 1, NULL},
                                            {"z_um", FORM_RANGE, 1, NULL},
                                            {"density_per_um3", FORM_NONNEGATIVE, 0, NULL},
                                            {NULL, FORM_TEXT, 0, NULL}};

static const struct field radius_fields[] = {{"mean", FORM_POSITIVE, 0, NULL},
                                             {"sd", FORM_NONNEGATIVE, 0, NULL},
                                             {"minimum", FORM_POSITIVE, 0, NULL},
                                             {NULL, FORM_TEXT, 0, NULL}};

static const struct field direction_fields[] = {
    {"axis", FORM_DIRECTION, 1, NULL}, {"kappa", FORM_NONNEGATIVE, 1, NULL}, {NULL, FORM_TEXT, 0, NULL}};

static const struct field type_fields[] = {{"name", FORM_TEXT, 1, NULL},
                                           {"class", FORM_CLASS, 1, NULL},
                                           {"entry", FORM_TEXT, 0, NULL},
                                           {"fraction", FORM_NONNEGATIVE, 0, NULL},
                                           {"density_per_um3", FORM_NONNEGATIVE, 0, NULL},
                                           {"layer", FORM_TEXT, 0, NULL},
                                           {"radius_scale", FORM_POSITIVE, 0, NULL},
                                           {"cable_density_per_um2", FORM_POSITIVE, 0, NULL},
                                           {"length_um", FORM_POSITIVE, 0, NULL},
                                           {"radius_um", FORM_MAP, 0, radius_fields},
                                           {"direction", FORM_MAP, 0, direction_fields},
                                           {NULL, FORM_TEXT, 0, NULL}};

static const struct field perturb_fields[] = {{"neurons", FORM_NONNEGATIVE, 0, NULL},
                                              {"dendrites", FORM_NONNEGATIVE, 0, NULL},
                                              {"glia", FORM_NONNEGATIVE, 0, NULL},
                                              {"ecs", FORM_NONNEGATIVE, 0, NULL},
                                              {NULL, FORM_TEXT, 0, NULL}};

static const struct field recipe_fields[] = {{"conceg", FORM_VERSION, 1, NULL},
                                             {"title", FORM_TEXT, 0, NULL},
                                             {"seed", FORM_SEED, 0, NULL},
                                             {"domain", FORM_MAP, 0, domain_fields},
                                             {"dictionary", FORM_TEXT, 0, NULL},
                                             {"density_per_um3", FORM_NONNEGATIVE, 0, NULL},
                                             {"density_profile", FORM_LIST, 0, profile_fields},
                                             {"layers", FORM_LIST, 0, layer_fields},
                                             {"types", FORM_LIST, 0, type_fields},
                                             {"perturb", FORM_MAP, 0, perturb_fields},
                                             {"stages", FORM_WORDS, 0, NULL},
                                             {"keep", FORM_WORDS, 0, NULL},
                                             {NULL, FORM_TEXT, 0, NULL}};

static const char *const classes[] = {"pyramidal", "interneuron", "astrocyte", "microglia",
                                      "axon",      "other",       NULL};

#define NAME_COUNT 48
#define LIST_LIMIT 4096 /* names of a list are compared in pairs */

/* Names of the fields, and of the stages' sections when `sections` is 1, ending with NULL. */
static void list_names(const struct field *fields, int sections, const char *names[NAME_COUNT]) {
  uint32_t count = 0, i;
  for (i = 0; fields[i].name && count < NAME_COUNT - 1; i++)
    names[count++] = fields[i].name;
  for (i = 0; sections && conceg_pipeline_kind(i) && count < NAME_COUNT - 1; i++)
    names[count++] = conceg_pipeline_kind(i);
  names[count] = NULL;
}

static int is_word_of(const char *word, const char *const *names) {
  for (; *names; names++)
    if (!strcmp(word, *names)) return 1;
  return 0;
}

static conceg_status fail_form(conceg_ctx *ctx, const conceg_node *node, const char *expected) {
  struct text path = {0}, got = {0};
  node_path(node, &path);
  node_emit_flow(node, &got);
  fail_node(ctx, CONCEG_E_PARAM, node, "%s: expected %s, got %.60s", path.data ? path.data : "", expected,
            got.data ? got.data : "");
  text_free(&path);
  text_free(&got);
  return CONCEG_E_PARAM;
}

static int numbers_of(const conceg_node *node, uint32_t count, double *out) {
  uint32_t i;
  if (node->kind != NODE_LIST || node->count != count) return 0;
  for (i = 0; i < count; i++) {
    const conceg_node *item = node->child[i];
    if (item->kind != NODE_SCALAR || item->quoted || !text_to_f64(item->text, &out[i])) return 0;
  }
  return 1;
}

static int number_of(const conceg_node *node, double *out) {
  return node->kind == NODE_SCALAR && !node->quoted && text_to_f64(node->text, out);
}

static int bools_of(const conceg_node *node, uint32_t count) {
  uint32_t i;
  int value;
  if (node->kind != NODE_LIST || node->count != count) return 0;
  for (i = 0; i < count; i++)
    if (node->child[i]->kind != NODE_SCALAR || node->child[i]->quoted ||
        !text_to_bool(node->child[i]->text, &value))
      return 0;
  return 1;
}

static int words_of(const conceg_node *node) {
  uint32_t i;
  if (node->kind != NODE_LIST) return 0;
  for (i = 0; i < node->count; i++)
    if (node->child[i]->kind != NODE_SCALAR) return 0;
  return 1;
}

static conceg_status check_map(conceg_ctx *ctx, conceg_node *map, const struct field *fields, int sections);

static conceg_status check_section(conceg_ctx *ctx, const conceg_node *node) {
  uint32_t i;
  if (node_is_null(node)) return CONCEG_OK;
  if (node->kind != NODE_MAP) return fail_form(ctx, node, "a mapping of the stage's parameters");
  for (i = 0; i < node->count; i++)
    if (node->child[i]->kind != NODE_SCALAR) return fail_form(ctx, node->child[i], "one value");
  return CONCEG_OK;
}

static conceg_status check_list(conceg_ctx *ctx, conceg_node *node, const struct field *fields) {
  uint32_t i;
  if (node->kind != NODE_LIST || node->count > LIST_LIMIT)
    return fail_form(ctx, node, "a list of at most 4096 entries");
  for (i = 0; i < node->count; i++) {
    conceg_status status;
    if (node->child[i]->kind != NODE_MAP)
      return fail_form(ctx, node->child[i], "a mapping such as {name: ...}");
    status = check_map(ctx, node->child[i], fields, 0);
    if (status != CONCEG_OK) return status;
  }
  return CONCEG_OK;
}

static conceg_status check_class(conceg_ctx *ctx, const conceg_node *node) {
  if (node->kind == NODE_SCALAR && is_word_of(node->text, classes)) return CONCEG_OK;
  return fail_form(ctx, node, "pyramidal, interneuron, astrocyte, microglia, axon or other");
}

static conceg_status check_version(conceg_ctx *ctx, const conceg_node *node) {
  if (node->kind == NODE_SCALAR && !strcmp(node->text, "1")) return CONCEG_OK;
  fail_form(ctx, node, "recipe version 1");
  return CONCEG_E_VERSION;
}

static conceg_status check_form(conceg_ctx *ctx, conceg_node *node, const struct field *field) {
  double v[3] = {0, 0, 0};
  int64_t whole;
  int good = 0;
  const char *expected = "a value";
  switch (field->form) {
  case FORM_VERSION:
    return check_version(ctx, node);
  case FORM_CLASS:
    return check_class(ctx, node);
  case FORM_SECTION:
    return check_section(ctx, node);
  case FORM_LIST:
    return check_list(ctx, node, field->fields);
  case FORM_MAP:
    if (node->kind == NODE_MAP) return check_map(ctx, node, field->fields, 0);
    expected = "a mapping";
    break;
  case FORM_TEXT:
    good = node->kind == NODE_SCALAR && *node->text, expected = "text";
    break;
  case FORM_SEED:
    good = node->kind == NODE_SCALAR && !node->quoted && text_to_i64(node->text, &whole) && whole >= 0;
    expected = "a whole number from 0 to 9223372036854775807";
    break;
  case FORM_POSITIVE:
    good = number_of(node, v) && v[0] > 0, expected = "a number above 0";
    break;
  case FORM_NONNEGATIVE:
    good = number_of(node, v) && v[0] >= 0, expected = "a number, 0 or more";
    break;
  case FORM_NUMBER:
    good = number_of(node, v), expected = "a number";
    break;
  case FORM_VECTOR3:
    good = numbers_of(node, 3, v), expected = "three numbers [x, y, z]";
    break;
  case FORM_DIRECTION:
    good = numbers_of(node, 3, v) && (v[0] != 0 || v[1] != 0 || v[2] != 0);
    expected = "a direction [x, y, z], not zero";
    break;
  case FORM_POSITIVE3:
    good = numbers_of(node, 3, v) && v[0] > 0 && v[1] > 0 && v[2] > 0;
    expected = "three numbers above 0, [x, y, z]";
    break;
  case FORM_BOOL3:
    good = bools_of(node, 3), expected = "three of true or false";
    break;
  case FORM_RANGE:
    good = numbers_of(node, 2, v) && v[0] < v[1], expected = "two numbers [lo, hi] with lo < hi";
    break;
  case FORM_WORDS:
    good = words_of(node), expected = "a list of words";
    break;
  }
  return good ? CONCEG_OK : fail_form(ctx, node, expected);
}

static conceg_status unknown_key(conceg_ctx *ctx, const conceg_node *node, const char *key,
                                 const char *const *names) {
  struct text path = {0};
  const char *near = nearest_name(key, names);
  node_path(node, &path);
  fail_node(ctx, CONCEG_E_PARAM, node, "unknown key %.80s%s%s%s", path.data ? path.data : key,
            near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
  text_free(&path);
  return CONCEG_E_PARAM;
}

/* Puts the keys into the order of `names`; unknown ones (local extensions) follow by name. */
static void sort_keys(conceg_node *map, const char *const *names) {
  uint32_t i, j;
  for (i = 1; i < map->count; i++) {
    for (j = i; j > 0; j--) {
      const char *before = map->key[j - 1], *after = map->key[j];
      uint32_t rank_before = 0, rank_after = 0;
      conceg_node *child = map->child[j];
      char *key = map->key[j];
      while (names[rank_before] && strcmp(names[rank_before], before) != 0)
        rank_before++;
      while (names[rank_after] && strcmp(names[rank_after], after) != 0)
        rank_after++;
      if (rank_before < rank_after || (rank_before == rank_after && strcmp(before, after) <= 0)) break;
      map->child[j] = map->child[j - 1], map->key[j] = map->key[j - 1];
      map->child[j - 1] = child, map->key[j - 1] = key;
    }
  }
}

static conceg_status check_map(conceg_ctx *ctx, conceg_node *map, const struct field *fields, int sections) {
  static const struct field section = {"", FORM_SECTION, 0, NULL};
  const char *names[NAME_COUNT];
  uint32_t i, f;
  list_names(fields, sections, names);
  for (i = 0; i < map->count; i++) {
    const struct field *field = NULL;
    conceg_status status;
    if (!strncmp(map->key[i], "x_", 2)) continue;
    if (!is_word_of(map->key[i], names)) return unknown_key(ctx, map->child[i], map->key[i], names);
    for (f = 0; fields[f].name && !field; f++)
      if (!strcmp(fields[f].name, map->key[i])) field = &fields[f];
    status = check_form(ctx, map->child[i], field ? field : &section);
    if (status != CONCEG_OK) return status;
  }
  for (f = 0; fields[f].name; f++)
    if (fields[f].required && !node_find(map, fields[f].name))
      return fail_node(ctx, CONCEG_E_PARAM, map, "key %s is missing", fields[f].name);
  sort_keys(map, names);
  return CONCEG_OK;
}

/* ---- Rules between keys ---- */

static conceg_status check_domain(conceg_ctx *ctx, const conceg_node *domain) {
  const conceg_node *size, *lo, *hi;
  double a[3], b[3];
  int axis;
  if (!domain) return CONCEG_OK;
  size = node_find(domain, "size_um"), lo = node_find(domain, "lo_um"), hi = node_find(domain, "hi_um");
  if ((size && (lo || hi)) || (!size && !(lo && hi)))
    return fail_node(ctx, CONCEG_E_PARAM, domain, "domain: expected either size_um, or lo_um and hi_um");
  if (lo && numbers_of(lo, 3, a) && numbers_of(hi, 3, b))
    for (axis = 0; axis < 3; axis++)
      if (!(a[axis] < b[axis]))
        return fail_node(ctx, CONCEG_E_PARAM, hi, "domain.hi_um: expected more than lo_um on each axis");
  return CONCEG_OK;
}

/* Exactly one way to say how many cells there are. */
static conceg_status check_densities(conceg_ctx *ctx, const conceg_node *root) {
  const conceg_node *uniform = node_find(root, "density_per_um3"),
                    *profile = node_find(root, "density_profile");
  const conceg_node *layers = node_find(root, "layers"), *by_layer = NULL;
  double z, last = 0;
  uint32_t i;
  for (i = 0; i < conceg_node_count(layers); i++)
    if (!by_layer) by_layer = node_find(layers->child[i], "density_per_um3");
  if ((uniform != NULL) + (profile != NULL) + (by_layer != NULL) > 1)
    return fail_node(ctx, CONCEG_E_PARAM, profile ? profile : by_layer,
                     "expected only one of density_per_um3, density_profile and densities of layers");
  for (i = 0; i < conceg_node_count(profile); i++) {
    const conceg_node *row = node_find(profile->child[i], "z_um");
    if (!number_of(row, &z)) continue;
    if (i && !(z > last))
      return fail_node(ctx, CONCEG_E_PARAM, row, "density_profile[%u].z_um: expected ascending depths", i);
    last = z;
  }
  return CONCEG_OK;
}

static conceg_status check_names(conceg_ctx *ctx, const conceg_node *list, const char *what) {
  uint32_t i, j;
  for (i = 0; i < conceg_node_count(list); i++)
    for (j = 0; j < i; j++) {
      const conceg_node *name = node_find(list->child[i], "name");
      if (!strcmp(name->text, node_find(list->child[j], "name")->text))
        return fail_node(ctx, CONCEG_E_PARAM, name, "%s[%u].name: %.60s is given twice", what, i, name->text);
    }
  return CONCEG_OK;
}

/* A type of class axon without entry is passing axons, which have a density of cable where others have one of
 * cells. */
static conceg_status check_passing(conceg_ctx *ctx, const conceg_node *type, uint32_t index) {
  static const char *const of_cells[] = {"fraction", "density_per_um3", "layer", "radius_scale", NULL};
  static const char *const of_cable[] = {"cable_density_per_um2", "length_um", "radius_um", "direction",
                                         NULL};
  const int passing = !strcmp(node_find(type, "class")->text, "axon") && !node_find(type, "entry");
  const char *const *wrong = passing ? of_cells : of_cable;
  for (; *wrong; wrong++) {
    const conceg_node *node = node_find(type, *wrong);
    if (node && passing)
      return fail_node(ctx, CONCEG_E_PARAM, node,
                       "types[%u].%s: passing axons (class axon without entry) have none; give "
                       "cable_density_per_um2, or an entry",
                       index, *wrong);
    if (node)
      return fail_node(ctx, CONCEG_E_PARAM, node,
                       "types[%u].%s: only passing axons have it, a type of class axon without entry", index,
                       *wrong);
  }
  return CONCEG_OK;
}

static conceg_status check_types(conceg_ctx *ctx, const conceg_node *types, const conceg_node *layers) {
  uint32_t i, j;
  for (i = 0; i < conceg_node_count(types); i++) {
    const conceg_node *type = types->child[i], *layer = node_find(type, "layer");
    const conceg_status status = check_passing(ctx, type, i);
    int found = layer == NULL;
    if (status != CONCEG_OK) return status;
    if (node_find(type, "fraction") && node_find(type, "density_per_um3"))
      return fail_node(ctx, CONCEG_E_PARAM, type, "types[%u]: expected fraction or density_per_um3, got both",
                       i);
    for (j = 0; j < conceg_node_count(layers); j++)
      found |= layer && !strcmp(node_find(layers->child[j], "name")->text, layer->text);
    if (!found)
      return fail_node(ctx, CONCEG_E_PARAM, layer, "types[%u].layer: no layer is named %.60s", i,
                       layer->text);
  }
  return CONCEG_OK;
}

/* Factors of a perturbation, in the order of perturb_fields: within bounds, and left out where they change
 * nothing, so that a factor of 1 is the unperturbed recipe to the byte. */
static conceg_status check_perturb(conceg_ctx *ctx, conceg_node *root) {
  static const double bounds[][2] = {{0, 1}, {0.1, 1}, {0, 10}, {0.1, 10}};
  conceg_node *perturb = node_find(root, "perturb");
  uint32_t i;
  if (!perturb) return CONCEG_OK;
  for (i = 0; perturb_fields[i].name; i++) {
    const conceg_node *factor = node_find(perturb, perturb_fields[i].name);
    double value;
    if (!factor || !number_of(factor, &value)) continue;
    if (!(value >= bounds[i][0] && value <= bounds[i][1]))
      return fail_node(ctx, CONCEG_E_PARAM, factor, "perturb.%s: expected a factor from %g to %g, got %.60s",
                       perturb_fields[i].name, bounds[i][0], bounds[i][1], factor->text);
    if (value == 1) node_remove(perturb, perturb_fields[i].name);
  }
  if (!perturb->count) node_remove(root, "perturb");
  return CONCEG_OK;
}

/* Every word of a list must be one of `names`. */
static conceg_status check_words(conceg_ctx *ctx, const conceg_node *list, const char *what,
                                 const char *thing, const char *const *names) {
  uint32_t i;
  for (i = 0; i < conceg_node_count(list); i++) {
    const char *word = list->child[i]->text, *near;
    if (*word == '/') word++;
    if (is_word_of(word, names) || !strncmp(word, "x_", 2)) continue;
    near = nearest_name(word, names);
    return fail_node(ctx, CONCEG_E_PARAM, list->child[i], "%s[%u]: no %s is called %.60s%s%s%s", what, i,
                     thing, word, near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
  }
  return CONCEG_OK;
}

static conceg_status check_stages(conceg_ctx *ctx, const conceg_node *stages) {
  static const struct field none[] = {{NULL, FORM_TEXT, 0, NULL}};
  const char *kinds[NAME_COUNT];
  list_names(none, 1, kinds);
  return check_words(ctx, stages, "stages", "stage", kinds);
}

static conceg_status check_keep(conceg_ctx *ctx, const conceg_node *keep) {
  const char *groups[NAME_COUNT];
  const struct schema *schema;
  uint32_t i, count = 0;
  if (!keep) return CONCEG_OK;
  schema = ctx_schema(ctx);
  if (!schema) return CONCEG_E_NOMEM;
  for (i = 1; i < schema->groups && count < NAME_COUNT - 1; i++)
    groups[count++] = schema->group[i].name;
  groups[count] = NULL;
  return check_words(ctx, keep, "keep", "group", groups);
}

/* Parameters of the stages by name; a section without any is left out. */
static void sort_sections(conceg_node *root) {
  static const char *const first[] = {"impl", NULL};
  uint32_t i;
  for (i = 0; conceg_pipeline_kind(i); i++) {
    conceg_node *section = node_find(root, conceg_pipeline_kind(i));
    if (!section) continue;
    if (section->count == 0)
      node_remove(root, conceg_pipeline_kind(i));
    else
      sort_keys(section, first);
  }
}

conceg_status recipe_check(conceg_ctx *ctx, conceg_node *root) {
  const conceg_node *layers, *types;
  conceg_status status = check_map(ctx, root, recipe_fields, 1);
  layers = node_find(root, "layers"), types = node_find(root, "types");
  if (status == CONCEG_OK) status = check_domain(ctx, node_find(root, "domain"));
  if (status == CONCEG_OK) status = check_densities(ctx, root);
  if (status == CONCEG_OK) status = check_names(ctx, layers, "layers");
  if (status == CONCEG_OK) status = check_names(ctx, types, "types");
  if (status == CONCEG_OK) status = check_types(ctx, types, layers);
  if (status == CONCEG_OK) status = check_perturb(ctx, root);
  if (status == CONCEG_OK) status = check_stages(ctx, node_find(root, "stages"));
  if (status == CONCEG_OK) status = check_keep(ctx, node_find(root, "keep"));
  if (status == CONCEG_OK) sort_sections(root);
  return status;
}
