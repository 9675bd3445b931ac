/* SPDX-License-Identifier: BSD-3-Clause
 * The validator: which arrays are there and of which form. */
#define _POSIX_C_SOURCE 200809L
#include "validate.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int is_wanted(const struct validator *validator, const char *path) {
  if (!validator->only) return 1;
  const size_t length = strlen(validator->only);
  if (strncmp(path, validator->only, length) != 0) return 0;
  return path[length] == '\0' || path[length] == '/' || path[length] == '@' || path[length] == '[';
}

/* Everything a problem says; `index` holds `rank` numbers. */
static void tell(struct validator *validator, const char *rule, enum severity severity, const char *path,
                 uint32_t rank, const uint64_t *index, const char *expected, const char *got) {
  if (!is_wanted(validator, path)) return;
  if (severity == MUST && validator->errors++ == 0)
    snprintf(validator->first, sizeof validator->first, "%s: %s: expected %s, got %s", rule, path, expected,
             got);
  conceg_problem problem = {.size = sizeof problem,
                            .severity = severity,
                            .rule = rule,
                            .path = path,
                            .expected = expected,
                            .got = got,
                            .rank = rank};
  for (uint32_t axis = 0; axis < rank; axis++)
    problem.index[axis] = index[axis];
  if (validator->fn) validator->fn(validator->user, &problem);
}

void report(struct validator *validator, const char *rule, enum severity severity, const char *path,
            const char *expected, const char *got) {
  tell(validator, rule, severity, path, 0, NULL, expected, got);
}

void report_value(struct validator *validator, const char *rule, enum severity severity,
                  const struct entry *entry, uint64_t index, uint64_t more, const char *expected,
                  const char *got) {
  char path[PATH_BYTES + 64], text[512];
  int length = snprintf(path, sizeof path, "%s", entry->path);
  uint64_t width = entry_count(entry), rest = index, place[4] = {0};
  for (uint32_t axis = 0; axis < entry->rank && length < PATH_BYTES; axis++) {
    width /= entry->shape[axis];
    place[axis] = rest / width;
    length += snprintf(path + length, sizeof path - (size_t)length, "%s%llu", axis ? "," : "[",
                       (unsigned long long)place[axis]);
    rest %= width;
  }
  if (entry->rank) snprintf(path + length, sizeof path - (size_t)length, "]");
  if (more) snprintf(text, sizeof text, "%s (and %llu more)", got, (unsigned long long)more);
  tell(validator, rule, severity, path, entry->rank, place, expected, more ? text : got);
}

static int starts_with_x(const char *name) {
  return strncmp(name, "x_", 2) == 0;
}

/* Names of everything but what is another owner's. */
static void check_names(struct validator *validator, const struct entry *entry) {
  char path[PATH_BYTES];
  if (starts_with_x(entry->name)) return;
  const int length = snprintf(path, sizeof path, "/%s", entry->name);
  if (entry->parent && (length >= (int)sizeof path || strchr(entry->name, '@') || !path_is_valid(path)))
    report(validator, "CGX-007", MUST, entry->path, "names of letters, digits, _ . + -", "other characters");
  for (size_t i = 0; i < entry->attrs; i++)
    check_names(validator, entry->attr[i]);
  for (size_t i = 0; i < entry->children; i++)
    check_names(validator, entry->child[i]);
}

static void check_unit(struct validator *validator, const struct schema_item *item,
                       const struct entry *entry) {
  const char *unit = entry_unit(entry);
  char expected[128], got[128];
  if (!unit) {
    report(validator, "CGX-010", MUST, entry->path, "an attribute @unit of one text", "none");
  } else if (item && strcmp(unit, item->unit) != 0) {
    snprintf(expected, sizeof expected, "@unit \"%s\"", item->unit);
    snprintf(got, sizeof got, "\"%s\"", unit);
    report(validator, "CGX-011", MUST, entry->path, expected, got);
  }
}

static conceg_status check_known(struct validator *validator, const struct schema_group *group,
                                 const struct schema_item *item, struct entry *entry) {
  if (entry->kind != ENTRY_ARRAY) {
    report(validator, "CGX-025", MUST, entry->path, "an array",
           entry->kind == ENTRY_GROUP ? "a group" : entry->why);
    return CONCEG_OK;
  }
  if (!entry->attribute) check_unit(validator, item, entry);
  return check_form(validator, group, item, entry);
}

static void check_unknown(struct validator *validator, const struct schema_group *group,
                          const struct entry *entry) {
  if (starts_with_x(entry->name)) return;
  if (entry->kind == ENTRY_OPAQUE) {
    report(validator, "CGX-008", MUST, entry->path, "u8 i8 u32 i32 u64 i64 f32 f64 or text", entry->why);
    return;
  }
  if (!entry->attribute && entry->kind == ENTRY_ARRAY) check_unit(validator, NULL, entry);
  const int open_group = group->tables || !group->items;
  const int origin = entry->attribute && strcmp(entry->name, "made_from") == 0;
  if (!open_group && !origin)
    report(validator, "CGX-013", SHOULD, entry->path,
           "a name of spec/schema.yaml, or one that begins with x_", "an unknown name");
}

static void check_required(struct validator *validator, const struct schema_group *group,
                           const struct entry *entry) {
  char path[PATH_BYTES];
  for (uint32_t i = 0; i < group->items; i++) {
    const struct schema_item *item = &group->item[i];
    if (!item->required || entry_child(entry, item->name, strlen(item->name), item->attribute)) continue;
    const char *between = item->attribute ? "@" : "/";
    if (*group->name)
      snprintf(path, sizeof path, "/%s%s%s", group->name, between, item->name);
    else
      snprintf(path, sizeof path, "/%s%s", item->attribute ? "@" : "", item->name);
    report(validator, "CGX-020", MUST, path, item->attribute ? "an attribute" : "a dataset", "nothing");
  }
}

/* Columns of a table have one length. */
static void check_table(struct validator *validator, const struct entry *table) {
  const struct entry *first = NULL;
  char expected[PATH_BYTES + 64], got[64];
  for (size_t i = 0; i < table->children; i++) {
    const struct entry *column = table->child[i];
    if (column->kind == ENTRY_GROUP) {
      check_table(validator, column);
      continue;
    }
    if (column->kind == ENTRY_OPAQUE) {
      report(validator, "CGX-008", MUST, column->path, "u8 i8 u32 i32 u64 i64 f32 f64 or text", column->why);
      continue;
    }
    check_unit(validator, NULL, column);
    if (!column->rank) continue;
    if (!first) first = column;
    if (column->shape[0] == first->shape[0]) continue;
    snprintf(expected, sizeof expected, "%llu rows as in %s", (unsigned long long)first->shape[0],
             first->path);
    snprintf(got, sizeof got, "%llu", (unsigned long long)column->shape[0]);
    report(validator, "CGX-065", MUST, column->path, expected, got);
  }
}

/* Forms of everything in a group that the schema knows. Extents are fixed here, so this runs over all groups
 * first. */
static conceg_status check_group(struct validator *validator, const struct schema_group *group,
                                 struct entry *entry) {
  conceg_status status = CONCEG_OK;
  check_required(validator, group, entry);
  for (size_t pass = 0; pass < 2; pass++) {
    struct entry **list = pass ? entry->child : entry->attr;
    const size_t count = pass ? entry->children : entry->attrs;
    for (size_t i = 0; i < count && status == CONCEG_OK; i++) {
      const struct schema_item *item = schema_item(group, list[i]->name, !pass);
      if (item)
        status = check_known(validator, group, item, list[i]);
      else if (entry->parent || !pass)
        check_unknown(validator, group, list[i]);
    }
  }
  if (group->tables) check_table(validator, entry);
  return status;
}

static int is_newer_minor(const conceg_doc *doc) {
  const struct entry *version = entry_child(doc->root, "version", 7, 1);
  return version && version->kind == ENTRY_ARRAY && version->rank == 1 && version->shape[0] == 2 &&
         conceg_dtype_bytes(version->dtype) == 4 &&
         ((const uint32_t *)version->store.data)[1] > CONCEG_CGX_MINOR;
}

static conceg_status check_top(struct validator *validator, struct entry *entry) {
  const struct schema_group *group = schema_group(validator->doc->schema, entry->name, strlen(entry->name));
  char path[PATH_BYTES];
  snprintf(path, sizeof path, "/%s", entry->name);
  if (!group) {
    if (!starts_with_x(entry->name) && !is_newer_minor(validator->doc))
      report(validator, "CGX-012", SHOULD, path, "a group of spec/schema.yaml, or a name that begins with x_",
             "an unknown name");
    return CONCEG_OK;
  }
  if (group->dataset) return check_known(validator, group, group->item, entry);
  if (entry->kind == ENTRY_GROUP) return check_group(validator, group, entry);
  report(validator, "CGX-025", MUST, path, "a group", "a dataset");
  return CONCEG_OK;
}

static conceg_status check_all_values(struct validator *validator, const struct schema_group *group,
                                      struct entry *entry) {
  conceg_status status = CONCEG_OK;
  for (uint32_t i = 0; i < group->items && status == CONCEG_OK; i++) {
    const struct schema_item *item = &group->item[i];
    struct entry *array =
        group->dataset ? entry : entry_child(entry, item->name, strlen(item->name), item->attribute);
    if (!array || array->kind != ENTRY_ARRAY || !is_wanted(validator, array->path)) continue;
    if (array->dtype != item->dtype || array->rank != item->rank) continue; /* reported already */
    status = check_values(validator, group, item, array);
  }
  return status;
}

/* Groups that were made from something that has changed since. */
static conceg_status check_origin(struct validator *validator, const struct entry *group) {
  const struct entry *origin = entry_child(group, "made_from", 9, 1);
  if (!origin || !is_wanted(validator, origin->path)) return CONCEG_OK;
  if (origin->kind != ENTRY_ARRAY || origin->dtype != CONCEG_TEXT) {
    report(validator, "CGX-071", MUST, origin->path, "texts like cells=SHA-256 in hex", "something else");
    return CONCEG_OK;
  }
  const char *const *lines = origin->store.data;
  for (uint64_t i = 0; i < entry_count(origin); i++) {
    char path[PATH_BYTES], hex[65], expected[160];
    const char *equals = strchr(lines[i], '=');
    if (!equals || equals - lines[i] > 200 || strlen(equals + 1) != 64) {
      report_value(validator, "CGX-071", MUST, origin, i, 0, "a text like cells=SHA-256 in hex", lines[i]);
      continue;
    }
    snprintf(path, sizeof path, "/%.*s", (int)(equals - lines[i]), lines[i]);
    if (!tree_find(validator->doc->root, path)) continue; /* dropped since, which is no fault */
    const conceg_status status = conceg_doc_digest(validator->doc, path, hex);
    if (status != CONCEG_OK) return status;
    snprintf(expected, sizeof expected, "%.64s as it was when this group was made (digest %.12s...)", path,
             equals + 1);
    if (strcmp(hex, equals + 1) != 0) report_value(validator, "CGX-070", SHOULD, origin, i, 0, expected, hex);
  }
  return CONCEG_OK;
}

static conceg_status check_document(struct validator *validator) {
  struct entry *root = validator->doc->root;
  check_names(validator, root);
  conceg_status status = check_group(validator, &validator->doc->schema->group[0], root);
  for (size_t i = 0; i < root->children && status == CONCEG_OK; i++)
    status = check_top(validator, root->child[i]);
  if (status == CONCEG_OK) status = check_all_values(validator, &validator->doc->schema->group[0], root);
  for (size_t i = 0; i < root->children && status == CONCEG_OK; i++) {
    struct entry *entry = root->child[i];
    const struct schema_group *group = schema_group(validator->doc->schema, entry->name, strlen(entry->name));
    if (group && (entry->kind == ENTRY_GROUP || group->dataset))
      status = check_all_values(validator, group, entry);
  }
  if (status == CONCEG_OK) status = check_links(validator);
  if (status == CONCEG_OK) status = check_tissue(validator);
  for (size_t i = 0; i < root->children && status == CONCEG_OK; i++)
    status = check_origin(validator, root->child[i]);
  return status;
}

conceg_status conceg_doc_validate(conceg_doc *doc, const char *group, conceg_problem_fn fn, void *user) {
  char only[PATH_BYTES];
  struct validator validator = {.doc = doc, .ctx = doc->budget.ctx, .fn = fn, .user = user};
  if (group && strcmp(group, "/") != 0) {
    const size_t length = strlen(group);
    if (group[0] != '/' || length >= sizeof only || !tree_find(doc->root, group))
      return conceg_ctx_fail(validator.ctx, CONCEG_E_MISSING,
                             "%s: expected in the document, but it is not there", group);
    memcpy(only, group, length + 1);
    if (only[length - 1] == '/') only[length - 1] = '\0';
    validator.only = only;
  }
  const conceg_status status = check_document(&validator);
  free(validator.extent);
  if (status != CONCEG_OK) return status;
  return validator.errors ? conceg_ctx_fail(validator.ctx, CONCEG_E_FORMAT, "%s", validator.first)
                          : CONCEG_OK;
}
