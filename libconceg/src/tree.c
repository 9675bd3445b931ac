/* SPDX-License-Identifier: BSD-3-Clause
 * The document as a tree in memory. */
#define _POSIX_C_SOURCE 200809L
#include "tree.h"
#include "schema.h"

#include <stdlib.h>
#include <string.h>

static int is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         (c && strchr("_.+-", c));
}

/* One name, ended by /, @ or the end: its length, 0 when it is no name. */
static size_t name_length(const char *name) {
  size_t length = 0;
  while (is_name_character(name[length]))
    length++;
  const int dots = (length == 1 && name[0] == '.') || (length == 2 && name[0] == '.' && name[1] == '.');
  return dots ? 0 : length;
}

int path_is_valid(const char *path) {
  if (!path || path[0] != '/' || strlen(path) >= PATH_BYTES) return 0;
  const char *at = path + 1;
  for (int depth = 0; depth < PATH_DEPTH; depth++) {
    if (*at != '@') {
      const size_t length = name_length(at);
      if (!length) return 0;
      at += length;
    }
    if (*at == '@') { /* the attribute ends the path */
      const size_t length = name_length(at + 1);
      return length && !at[1 + length];
    }
    if (!*at) return 1;
    if (*at++ != '/') return 0;
  }
  return 0;
}

static char *make_path(enum entry_kind kind, const struct entry *parent, const char *name, int attribute) {
  if (!parent) return strdup("/");
  const size_t before = strlen(parent->path), length = strlen(name);
  char *path = malloc(before + length + 3);
  if (!path) return NULL;
  memcpy(path, parent->path, before);
  size_t end = before;
  if (attribute) {
    if (end > 1 && path[end - 1] == '/') end--; /* "/cells/" + "@x", but "/" + "@x" */
    path[end++] = '@';
  }
  memcpy(path + end, name, length + 1);
  end += length;
  if (kind == ENTRY_GROUP && !attribute) memcpy(path + end, "/", 2);
  return path;
}

struct entry *entry_new(enum entry_kind kind, struct entry *parent, const char *name, int attribute,
                        const struct schema *schema) {
  struct entry *entry = calloc(1, sizeof *entry);
  if (!entry) return NULL;
  entry->kind = kind;
  entry->attribute = attribute;
  entry->parent = parent;
  entry->path = make_path(kind, parent, name, attribute);
  char *own = strdup(name);
  entry->name = own;
  if (!entry->path || !own) {
    free(own);
    free(entry->path);
    free(entry);
    return NULL;
  }
  entry->order = parent ? schema_order(schema, entry->path) : 0;
  return entry;
}

void entry_free(struct budget *budget, struct entry *entry) {
  if (!entry) return;
  for (size_t i = 0; i < entry->children; i++)
    entry_free(budget, entry->child[i]);
  for (size_t i = 0; i < entry->attrs; i++)
    entry_free(budget, entry->attr[i]);
  store_free(budget, &entry->store);
  free(entry->child);
  free(entry->attr);
  free(entry->path);
  free((char *)entry->name);
  free(entry->why);
  free(entry);
}

/* Canonical order: what the schema knows comes first, in its order; the rest follows by name. */
static int compare(const struct entry *a, const struct entry *b) {
  if (a->order != b->order) return a->order < b->order ? -1 : 1;
  return strcmp(a->name, b->name);
}

/* First place whose entry is not before `entry`. */
static size_t lower_bound(struct entry *const *list, size_t count, const struct entry *entry) {
  size_t lo = 0, hi = count;
  while (lo < hi) {
    const size_t middle = lo + (hi - lo) / 2;
    if (compare(list[middle], entry) < 0)
      lo = middle + 1;
    else
      hi = middle;
  }
  return lo;
}

struct entry *entry_child(const struct entry *entry, const char *name, size_t length, int attribute) {
  struct entry *const *list = attribute ? entry->attr : entry->child;
  const size_t count = attribute ? entry->attrs : entry->children;
  size_t hi = count, lo = 0;
  /* Those that the schema knows come first and are few; the rest, which may be a million, follows by name. */
  for (; lo < count && list[lo]->order != UINT32_MAX; lo++)
    if (strncmp(list[lo]->name, name, length) == 0 && !list[lo]->name[length]) return list[lo];
  while (lo < hi) {
    const size_t middle = lo + (hi - lo) / 2;
    int order = strncmp(list[middle]->name, name, length);
    if (!order) order = list[middle]->name[length] != '\0';
    if (!order) return list[middle];
    if (order < 0)
      lo = middle + 1;
    else
      hi = middle;
  }
  return NULL;
}

static int make_room(struct entry ***list, size_t count, size_t *room) {
  if (count < *room) return 1;
  const size_t more = *room ? *room * 2 : 8;
  struct entry **grown = realloc(*list, more * sizeof *grown);
  if (!grown) return 0;
  *list = grown;
  *room = more;
  return 1;
}

int entry_append(struct entry *entry) {
  struct entry *parent = entry->parent;
  if (entry->attribute) {
    if (!make_room(&parent->attr, parent->attrs, &parent->attr_room)) return 0;
    parent->attr[parent->attrs++] = entry;
  } else {
    if (!make_room(&parent->child, parent->children, &parent->child_room)) return 0;
    parent->child[parent->children++] = entry;
  }
  return 1;
}

static int compare_places(const void *a, const void *b) {
  return compare(*(struct entry *const *)a, *(struct entry *const *)b);
}

void entry_sort(struct budget *budget, struct entry *parent, int attributes) {
  struct entry **list = attributes ? parent->attr : parent->child;
  size_t *count = attributes ? &parent->attrs : &parent->children, kept = 0;
  if (*count < 2) return;
  qsort(list, *count, sizeof *list, compare_places);
  for (size_t i = 1; i < *count; i++) {
    if (compare(list[kept], list[i]) == 0) /* only a damaged file gives a name twice */
      entry_free(budget, list[kept]);
    else
      kept++;
    list[kept] = list[i];
  }
  *count = kept + 1;
}

int entry_attach(struct budget *budget, struct entry *entry) {
  struct entry *parent = entry->parent;
  struct entry ***list = entry->attribute ? &parent->attr : &parent->child;
  size_t *count = entry->attribute ? &parent->attrs : &parent->children;
  size_t *room = entry->attribute ? &parent->attr_room : &parent->child_room;
  const size_t place = lower_bound(*list, *count, entry);
  if (place < *count && compare((*list)[place], entry) == 0) {
    entry_free(budget, (*list)[place]);
    (*list)[place] = entry;
    return 1;
  }
  if (!make_room(list, *count, room)) return 0;
  if (place < *count) memmove(*list + place + 1, *list + place, (*count - place) * sizeof **list);
  (*list)[place] = entry;
  (*count)++;
  return 1;
}

void entry_detach(struct entry *entry) {
  struct entry *parent = entry->parent;
  struct entry **list = entry->attribute ? parent->attr : parent->child;
  size_t *count = entry->attribute ? &parent->attrs : &parent->children;
  for (size_t i = 0; i < *count; i++)
    if (list[i] == entry) {
      memmove(list + i, list + i + 1, (*count - i - 1) * sizeof *list);
      (*count)--;
      return;
    }
}

struct entry *tree_find(const struct entry *root, const char *path) {
  if (!path || path[0] != '/') return NULL;
  const struct entry *at = root;
  path++;
  while (*path) {
    if (*path == '@') return path[1] ? entry_child(at, path + 1, strlen(path + 1), 1) : NULL;
    const size_t length = strcspn(path, "/@");
    if (!length || !(at = entry_child(at, path, length, 0))) return NULL;
    path += length;
    if (*path == '/') {
      if (at->kind != ENTRY_GROUP) return NULL;
      path++;
    }
  }
  return (struct entry *)at;
}

uint64_t entry_count(const struct entry *entry) {
  uint64_t count = 1;
  for (uint32_t axis = 0; axis < entry->rank; axis++)
    count *= entry->shape[axis];
  return count;
}

uint64_t entry_bytes(const struct entry *entry) {
  return entry_count(entry) * conceg_dtype_bytes(entry->dtype);
}

const char *entry_text(const struct entry *entry) {
  if (!entry || entry->kind != ENTRY_ARRAY || entry->dtype != CONCEG_TEXT || entry->rank ||
      !entry->store.data)
    return NULL;
  return *(const char *const *)entry->store.data;
}

const char *entry_unit(const struct entry *entry) {
  return entry_text(entry_child(entry, "unit", 4, 1));
}
