/* SPDX-License-Identifier: BSD-3-Clause
 * YAML in and out for the library: a tree of nodes with line numbers. Only yaml.c calls libyaml; node.c owns
 * the tree. */
#ifndef CONCEG_SRC_YAML_H
#define CONCEG_SRC_YAML_H

#include "conceg/params.h"

#include "text.h"

/* Bounds on what is read: a recipe is untrusted input. */
#define YAML_MAX_BYTES ((size_t)16 << 20)
#define YAML_MAX_NODES 1000000u
#define YAML_MAX_DEPTH 32u
#define YAML_MAX_KEYS 4096u /* of one map: keys are looked up one by one */
#define YAML_MAX_ANCHORS 256u
#define YAML_MAX_COPIED YAML_MAX_BYTES /* keys and values that aliases stand for */

enum node_kind { NODE_SCALAR = 1, NODE_LIST = 2, NODE_MAP = 3 };

struct conceg_node {
  enum node_kind kind;
  int quoted;    /* scalar in quotes: text, never a number, boolean or null */
  uint32_t line; /* 1-based; 0 = from the command line */
  uint32_t count, capacity;
  const struct conceg_node *parent;
  char *file; /* root of a file: its name, for messages */
  char *text; /* scalar */
  char **key; /* map */
  struct conceg_node **child;
};

struct yamltree;

/* Parses one YAML document. E_FORMAT "name:line: ..." for bad syntax, duplicate keys, tags, more than one
 * document, or more depth, nodes or bytes than the bounds. An empty text gives a tree whose root is NULL. */
conceg_status yamltree_parse(conceg_ctx *ctx, const char *text, size_t length, const char *name,
                             struct yamltree **out) CONCEG_NODISCARD;
const conceg_node *yamltree_root(const struct yamltree *tree);
void yamltree_free(struct yamltree *tree);
/* Takes the root away from the tree, to be changed with node_* and freed with node_free. */
conceg_node *yamltree_take_root(struct yamltree *tree);

conceg_node *node_new(enum node_kind kind, uint32_t line);
conceg_node *node_new_scalar(const char *text, size_t length, int quoted, uint32_t line);
conceg_node *node_clone(const conceg_node *node);
void node_free(conceg_node *node);
/* Where a node comes from, for messages: its file, or "--set" when its line is 0. */
const char *node_file(const conceg_node *node);
/* Sets the line of a node and all below it. */
void node_set_line(conceg_node *node, uint32_t line);
/* Appends to a list (key NULL) or a map; takes the child. Returns 0 when out of memory (the child is freed).
 */
int node_append(conceg_node *parent, const char *key, conceg_node *child);
/* Puts `child` under `key`, replacing what was there. Returns 0 when out of memory (the child is freed). */
int node_put(conceg_node *map, const char *key, conceg_node *child);
void node_remove(conceg_node *map, const char *key);
/* The child of a map by plain key; NULL when absent. */
conceg_node *node_find(const conceg_node *map, const char *key);
int node_is_null(const conceg_node *node); /* absent, or plain "", ~ or null */
/* Dotted path of a node from its root, for messages: "types[2].fraction". */
void node_path(const conceg_node *node, struct text *out);
int node_equal(const conceg_node *a, const conceg_node *b);

/* Deterministic YAML: the same tree gives the same bytes. Numbers keep their text. */
void node_emit_block(const conceg_node *node, struct text *out);
void node_emit_flow(const conceg_node *node, struct text *out);
/* One scalar as it appears in flow style. */
void node_emit_scalar(const char *text, int quoted, struct text *out);

/* Strict number of YAML's core schema, finite, whatever the locale. Returns 0 when the text is not one. */
int text_to_f64(const char *text, double *out);
int text_to_i64(const char *text, int64_t *out);
int text_to_bool(const char *text, int *out);

/* The name among `names` (NULL-terminated) that is closest to `word`, or NULL when none is near. */
const char *nearest_name(const char *word, const char *const *names);

#endif
