/* SPDX-License-Identifier: BSD-3-Clause
 * The tree behind recipes and parameters: building, looking up, and the canonical text. */
#define _GNU_SOURCE /* strtod_l */
#include "yaml.h"

#include <errno.h>
#include <locale.h>
#include <math.h>

conceg_node *node_new(enum node_kind kind, uint32_t line) {
  conceg_node *node = calloc(1, sizeof *node);
  if (!node) return NULL;
  node->kind = kind;
  node->line = line;
  return node;
}

conceg_node *node_new_scalar(const char *text, size_t length, int quoted, uint32_t line) {
  conceg_node *node = node_new(NODE_SCALAR, line);
  if (!node) return NULL;
  node->quoted = quoted;
  node->text = text_copy(text, length);
  if (node->text) return node;
  free(node);
  return NULL;
}

void node_free(conceg_node *node) {
  uint32_t i;
  if (!node) return;
  for (i = 0; i < node->count; i++) {
    node_free(node->child[i]);
    if (node->key) free(node->key[i]);
  }
  free(node->child);
  free(node->key);
  free(node->text);
  free(node->file);
  free(node);
}

conceg_node *node_clone(const conceg_node *node) {
  conceg_node *copy;
  uint32_t i;
  if (node->kind == NODE_SCALAR)
    return node_new_scalar(node->text, strlen(node->text), node->quoted, node->line);
  copy = node_new(node->kind, node->line);
  if (!copy) return NULL;
  if (node->file) copy->file = text_copy(node->file, strlen(node->file));
  for (i = 0; i < node->count; i++) {
    conceg_node *child = node_clone(node->child[i]);
    if (child && node_append(copy, node->key ? node->key[i] : NULL, child)) continue;
    node_free(copy);
    return NULL;
  }
  return copy;
}

const char *node_file(const conceg_node *node) {
  const conceg_node *root = node;
  while (root->parent)
    root = root->parent;
  return node->line && root->file ? root->file : "--set";
}

void node_set_line(conceg_node *node, uint32_t line) {
  uint32_t i;
  node->line = line;
  for (i = 0; i < node->count; i++)
    node_set_line(node->child[i], line);
}

static int grow_children(conceg_node *parent) {
  const uint32_t capacity = parent->capacity ? parent->capacity * 2 : 8;
  conceg_node **child = realloc(parent->child, capacity * sizeof *child);
  if (!child) return 0;
  parent->child = child;
  if (parent->kind == NODE_MAP) {
    char **key = realloc(parent->key, capacity * sizeof *key);
    if (!key) return 0;
    parent->key = key;
  }
  parent->capacity = capacity;
  return 1;
}

int node_append(conceg_node *parent, const char *key, conceg_node *child) {
  char *name = NULL;
  if (parent->count == parent->capacity && !grow_children(parent)) goto failed;
  if (parent->kind == NODE_MAP) {
    name = text_copy(key, strlen(key));
    if (!name) goto failed;
    parent->key[parent->count] = name;
  }
  parent->child[parent->count++] = child;
  child->parent = parent;
  return 1;
failed:
  node_free(child);
  return 0;
}

static uint32_t find_index(const conceg_node *map, const char *key, size_t length) {
  uint32_t i;
  for (i = 0; i < map->count; i++)
    if (strlen(map->key[i]) == length && memcmp(map->key[i], key, length) == 0) break;
  return i;
}

int node_put(conceg_node *map, const char *key, conceg_node *child) {
  const uint32_t i = find_index(map, key, strlen(key));
  if (i == map->count) return node_append(map, key, child);
  node_free(map->child[i]);
  map->child[i] = child;
  child->parent = map;
  return 1;
}

void node_remove(conceg_node *map, const char *key) {
  const uint32_t i = find_index(map, key, strlen(key));
  if (i == map->count) return;
  node_free(map->child[i]);
  free(map->key[i]);
  map->count--;
  memmove(map->child + i, map->child + i + 1, (map->count - i) * sizeof *map->child);
  memmove(map->key + i, map->key + i + 1, (map->count - i) * sizeof *map->key);
}

conceg_node *node_find(const conceg_node *map, const char *key) {
  uint32_t i;
  if (!map || map->kind != NODE_MAP) return NULL;
  i = find_index(map, key, strlen(key));
  return i == map->count ? NULL : map->child[i];
}

static int is_null_text(const char *text) {
  return !*text || !strcmp(text, "~") || !strcmp(text, "null") || !strcmp(text, "Null") ||
         !strcmp(text, "NULL");
}

int node_is_null(const conceg_node *node) {
  return !node || (node->kind == NODE_SCALAR && !node->quoted && is_null_text(node->text));
}

void node_path(const conceg_node *node, struct text *out) {
  const conceg_node *parent = node->parent;
  uint32_t i;
  if (!parent) return;
  node_path(parent, out);
  for (i = 0; i < parent->count && parent->child[i] != node;)
    i++;
  if (i == parent->count) return;
  if (parent->kind == NODE_LIST) {
    text_format(out, "[%u]", i);
  } else {
    if (out->length) text_put(out, ".");
    text_put(out, parent->key[i]);
  }
}

int node_equal(const conceg_node *a, const conceg_node *b) {
  uint32_t i;
  if (!a || !b || a->kind != b->kind) return a == b;
  if (a->kind == NODE_SCALAR) return strcmp(a->text, b->text) == 0;
  if (a->count != b->count) return 0;
  for (i = 0; i < a->count; i++) {
    if (a->kind == NODE_MAP && strcmp(a->key[i], b->key[i]) != 0) return 0;
    if (!node_equal(a->child[i], b->child[i])) return 0;
  }
  return 1;
}

/* ---- Numbers ---- */

static const char *skip_digits(const char *p, int *count) {
  const char *start = p;
  while (*p >= '0' && *p <= '9')
    p++;
  *count = (int)(p - start > 1000 ? 1000 : p - start);
  return p;
}

int text_to_f64(const char *text, double *out) {
  const char *p = text;
  int whole, fraction = 0, digits;
  locale_t plain;
  if (*p == '+' || *p == '-') p++;
  p = skip_digits(p, &whole);
  if (*p == '.') p = skip_digits(p + 1, &fraction);
  if (whole + fraction == 0) return 0;
  if (*p == 'e' || *p == 'E') {
    p++;
    if (*p == '+' || *p == '-') p++;
    p = skip_digits(p, &digits);
    if (!digits) return 0;
  }
  if (*p) return 0;
  plain = newlocale(LC_ALL_MASK, "C", (locale_t)0); /* a decimal comma of the user's locale must not matter */
  if (!plain) return 0;
  *out = strtod_l(text, NULL, plain);
  freelocale(plain);
  return isfinite(*out);
}

int text_to_i64(const char *text, int64_t *out) {
  const char *p = text;
  int digits;
  if (*p == '+' || *p == '-') p++;
  p = skip_digits(p, &digits);
  if (!digits || *p) return 0;
  errno = 0;
  *out = strtoll(text, NULL, 10);
  return errno == 0;
}

int text_to_bool(const char *text, int *out) {
  static const char *const yes[] = {"true", "True", "TRUE"}, *const no[] = {"false", "False", "FALSE"};
  int i;
  for (i = 0; i < 3; i++) {
    if (!strcmp(text, yes[i])) return *out = 1, 1;
    if (!strcmp(text, no[i])) return *out = 0, 1;
  }
  return 0;
}

/* ---- Public accessors ---- */

const conceg_node *conceg_node_get(const conceg_node *node, const char *path) {
  while (node && path && *path) {
    const char *end = strchr(path, '.');
    const size_t length = end ? (size_t)(end - path) : strlen(path);
    uint32_t i;
    if (node->kind != NODE_MAP) return NULL;
    i = find_index(node, path, length);
    node = i == node->count ? NULL : node->child[i];
    path += length + (end != NULL);
  }
  return node;
}

uint32_t conceg_node_count(const conceg_node *node) {
  return node ? node->count : 0;
}

const conceg_node *conceg_node_at(const conceg_node *node, uint32_t index) {
  return node && index < node->count ? node->child[index] : NULL;
}

const char *conceg_node_key(const conceg_node *node, uint32_t index) {
  return node && node->kind == NODE_MAP && index < node->count ? node->key[index] : NULL;
}

int conceg_node_is_map(const conceg_node *node) {
  return node && node->kind == NODE_MAP;
}
int conceg_node_is_list(const conceg_node *node) {
  return node && node->kind == NODE_LIST;
}
uint32_t conceg_node_line(const conceg_node *node) {
  return node ? node->line : 0;
}
const char *conceg_node_text(const conceg_node *node) {
  return node && node->kind == NODE_SCALAR ? node->text : NULL;
}

static conceg_status wrong_scalar(conceg_ctx *ctx, const conceg_node *node, const char *expected) {
  struct text place = {0}, path = {0}, got = {0};
  if (!node) return conceg_ctx_fail(ctx, CONCEG_E_MISSING, "recipe: expected %s, got nothing", expected);
  node_path(node, &path);
  node_emit_flow(node, &got);
  if (node->line)
    text_format(&place, "%s:%u", node_file(node), node->line);
  else
    text_put(&place, node_file(node));
  conceg_ctx_fail(ctx, CONCEG_E_PARAM, "%s: %s: expected %s, got %.60s", place.data ? place.data : "",
                  path.data ? path.data : "value", expected, got.data ? got.data : "");
  text_free(&place);
  text_free(&path);
  text_free(&got);
  return CONCEG_E_PARAM;
}

conceg_status conceg_node_f64(conceg_ctx *ctx, const conceg_node *node, double *out) {
  const char *text = conceg_node_text(node);
  if (text && !node->quoted && text_to_f64(text, out)) return CONCEG_OK;
  return wrong_scalar(ctx, node, "a number");
}

conceg_status conceg_node_i64(conceg_ctx *ctx, const conceg_node *node, int64_t *out) {
  const char *text = conceg_node_text(node);
  if (text && !node->quoted && text_to_i64(text, out)) return CONCEG_OK;
  return wrong_scalar(ctx, node, "a whole number");
}

conceg_status conceg_node_bool(conceg_ctx *ctx, const conceg_node *node, int *out) {
  const char *text = conceg_node_text(node);
  if (text && !node->quoted && text_to_bool(text, out)) return CONCEG_OK;
  return wrong_scalar(ctx, node, "true or false");
}

/* ---- Canonical text ---- */

/* 1 if a plain scalar of this text reads back as the same text in block and in flow style. */
static int plain_is_safe(const char *text) {
  const char *p;
  if (!*text || strchr("-?:,[]{}#&*!|>'\"%@` ", *text)) {
    /* A sign before a digit is a number, not an indicator. */
    if (*text != '-' || !(text[1] == '.' || (text[1] >= '0' && text[1] <= '9'))) return 0;
  }
  for (p = text; *p; p++) {
    if ((unsigned char)*p < 0x20 || (unsigned char)*p >= 0x7f) return 0;
    if (strchr(",[]{}#:", *p)) return 0;
  }
  return p[-1] != ' ' && strcmp(text, "---") != 0 && strcmp(text, "...") != 0;
}

/* 1 if a plain scalar of this text would be read as something else than text, here or by other YAML readers.
 */
static int plain_has_a_type(const char *text) {
  static const char *const words[] = {"y",  "n",   "yes", "no", "on", "off", "Yes", "No",
                                      "On", "Off", "YES", "NO", "ON", "OFF", NULL};
  double number;
  int boolean, i;
  for (i = 0; words[i]; i++)
    if (!strcmp(text, words[i])) return 1;
  return is_null_text(text) || text_to_f64(text, &number) || text_to_bool(text, &boolean) ||
         (*text >= '0' && *text <= '9') || *text == '.' || *text == '+' || *text == '-' || *text == '=' ||
         *text == '<';
}

/* Length in bytes of the UTF-8 character at p, and its code point. The text is valid UTF-8: libyaml has
 * checked it. */
static int utf8_next(const unsigned char *p, uint32_t *code) {
  int length = *p < 0x80 ? 1 : *p < 0xe0 ? 2 : *p < 0xf0 ? 3 : 4, i;
  *code = length == 1 ? *p : *p & (0x7fu >> length);
  for (i = 1; i < length; i++) {
    if ((p[i] & 0xc0) != 0x80) return *code = 0xfffd, i;
    *code = (*code << 6) | (p[i] & 0x3f);
  }
  return length;
}

static void emit_quoted(const char *text, struct text *out) {
  const unsigned char *p = (const unsigned char *)text;
  text_put(out, "\"");
  while (*p) {
    uint32_t code;
    const int length = utf8_next(p, &code);
    if (code == '"' || code == '\\')
      text_format(out, "\\%c", (char)code);
    else if (code == '\n')
      text_put(out, "\\n");
    else if (code == '\t')
      text_put(out, "\\t");
    else if (code < 0x20 || (code >= 0x7f && code < 0xa0))
      text_format(out, "\\x%02x", code);
    else if (code == 0x2028 || code == 0x2029 || code == 0xfeff || code == 0xfffd)
      text_format(out, "\\u%04x", code);
    else
      text_add(out, (const char *)p, (size_t)length);
    p += length;
  }
  text_put(out, "\"");
}

void node_emit_scalar(const char *text, int quoted, struct text *out) {
  if (!quoted && is_null_text(text))
    text_put(out, "null");
  else if (plain_is_safe(text) && !(quoted && plain_has_a_type(text)))
    text_put(out, text);
  else
    emit_quoted(text, out);
}

void node_emit_flow(const conceg_node *node, struct text *out) {
  uint32_t i;
  if (node->kind == NODE_SCALAR) {
    node_emit_scalar(node->text, node->quoted, out);
    return;
  }
  text_put(out, node->kind == NODE_MAP ? "{" : "[");
  for (i = 0; i < node->count; i++) {
    if (i) text_put(out, ", ");
    if (node->kind == NODE_MAP) {
      node_emit_scalar(node->key[i], 1, out);
      text_put(out, ": ");
    }
    node_emit_flow(node->child[i], out);
  }
  text_put(out, node->kind == NODE_MAP ? "}" : "]");
}

/* A list, or a map inside a list, fits on its line; maps open one level of indentation. */
static void emit_block(const conceg_node *node, unsigned indent, struct text *out) {
  uint32_t i;
  for (i = 0; i < node->count; i++) {
    const conceg_node *child = node->child[i];
    unsigned space;
    for (space = 0; space < indent; space++)
      text_put(out, " ");
    if (node->kind == NODE_LIST) {
      text_put(out, "- ");
    } else {
      node_emit_scalar(node->key[i], 1, out);
      text_put(out, ":");
    }
    if (node->kind == NODE_MAP && child->kind != NODE_SCALAR && child->count &&
        (child->kind == NODE_MAP || child->child[0]->kind != NODE_SCALAR)) {
      text_put(out, "\n");
      emit_block(child, indent + 2, out);
    } else {
      if (node->kind == NODE_MAP) text_put(out, " ");
      node_emit_flow(child, out);
      text_put(out, "\n");
    }
  }
}

void node_emit_block(const conceg_node *node, struct text *out) {
  if (node->kind != NODE_SCALAR && node->count) {
    emit_block(node, 0, out);
    return;
  }
  node_emit_flow(node, out);
  text_put(out, "\n");
}

/* ---- Suggestions ---- */

#define NAME_LIMIT 64

static unsigned edit_distance(const char *a, const char *b) {
  unsigned row[NAME_LIMIT + 1], i, j;
  const unsigned rows = (unsigned)strlen(a), columns = (unsigned)strlen(b);
  if (rows > NAME_LIMIT || columns > NAME_LIMIT) return NAME_LIMIT;
  for (j = 0; j <= columns; j++)
    row[j] = j;
  for (i = 1; i <= rows; i++) {
    unsigned diagonal = row[0];
    row[0] = i;
    for (j = 1; j <= columns; j++) {
      const unsigned above = row[j];
      unsigned best = diagonal + (a[i - 1] != b[j - 1]);
      if (above + 1 < best) best = above + 1;
      if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
      diagonal = above;
      row[j] = best;
    }
  }
  return row[columns];
}

const char *nearest_name(const char *word, const char *const *names) {
  const size_t length = strlen(word);
  const unsigned limit = length < 4 ? 1 : length < 8 ? 2 : 3;
  unsigned best = limit + 1;
  const char *nearest = NULL;
  for (; *names; names++) {
    /* The first word of a name, as in size for size_um, is a close miss. */
    const int begins = length > 1 && !strncmp(word, *names, length);
    const unsigned distance = begins ? 1 : edit_distance(word, *names);
    if (distance < best) best = distance, nearest = *names;
  }
  return nearest;
}
