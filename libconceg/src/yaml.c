/* SPDX-License-Identifier: BSD-3-Clause
 * Reading YAML: the only file that calls libyaml. */
#include "yaml.h"

#include <yaml.h>

struct yamltree {
  conceg_node *root;
};

struct anchor {
  char *name;
  const conceg_node *node;
  int complete; /* an alias inside its own anchor would never end */
};

struct reader {
  conceg_ctx *ctx;
  const char *name;
  yaml_parser_t parser;
  uint32_t nodes;
  size_t copied; /* bytes of text that aliases stood for */
  struct anchor *anchors;
  size_t anchor_count, anchor_capacity;
  conceg_status status;
};

static conceg_status fail_at(struct reader *reader, size_t line, const char *problem) {
  reader->status = conceg_ctx_fail(reader->ctx, CONCEG_E_FORMAT, "%s:%zu: %s", reader->name, line, problem);
  return reader->status;
}

static conceg_status fail_memory(struct reader *reader) {
  reader->status = conceg_ctx_fail(reader->ctx, CONCEG_E_NOMEM, "%s: out of memory", reader->name);
  return reader->status;
}

static int next_event(struct reader *reader, yaml_event_t *event) {
  if (yaml_parser_parse(&reader->parser, event)) return 1;
  if (reader->parser.error == YAML_MEMORY_ERROR) {
    fail_memory(reader);
  } else {
    const size_t line = (reader->parser.error == YAML_READER_ERROR ? reader->parser.mark.line
                                                                   : reader->parser.problem_mark.line) +
                        1;
    reader->status = conceg_ctx_fail(
        reader->ctx, CONCEG_E_FORMAT, "%s:%zu: not valid YAML: %s%s%s", reader->name, line,
        reader->parser.problem ? reader->parser.problem : "unreadable", reader->parser.context ? " " : "",
        reader->parser.context ? reader->parser.context : "");
  }
  return 0;
}

static int add_anchor(struct reader *reader, const char *name, const conceg_node *node) {
  struct anchor *anchor;
  if (!name) return 1;
  if (reader->anchor_count == YAML_MAX_ANCHORS)
    return fail_at(reader, node->line, "more than 256 anchors"), 0;
  if (reader->anchor_count == reader->anchor_capacity) {
    const size_t capacity = reader->anchor_capacity ? reader->anchor_capacity * 2 : 8;
    struct anchor *anchors = realloc(reader->anchors, capacity * sizeof *anchors);
    if (!anchors) return 0;
    reader->anchors = anchors;
    reader->anchor_capacity = capacity;
  }
  anchor = &reader->anchors[reader->anchor_count];
  anchor->name = text_copy(name, strlen(name));
  anchor->node = node;
  anchor->complete = node->kind == NODE_SCALAR;
  reader->anchor_count += anchor->name != NULL;
  return anchor->name != NULL;
}

static void complete_anchors(struct reader *reader, const conceg_node *node) {
  size_t i;
  for (i = 0; i < reader->anchor_count; i++)
    if (reader->anchors[i].node == node) reader->anchors[i].complete = 1;
}

static uint32_t count_nodes(const conceg_node *node) {
  uint32_t total = 1, i;
  for (i = 0; i < node->count && total < YAML_MAX_NODES; i++)
    total += count_nodes(node->child[i]);
  return total;
}

static size_t count_text(const conceg_node *node) {
  size_t total = node->text ? strlen(node->text) : 0;
  uint32_t i;
  for (i = 0; i < node->count; i++)
    total += count_text(node->child[i]) + (node->key ? strlen(node->key[i]) : 0);
  return total;
}

static unsigned node_depth(const conceg_node *node) {
  unsigned deepest = 0;
  uint32_t i;
  for (i = 0; i < node->count; i++) {
    const unsigned depth = node_depth(node->child[i]);
    if (depth > deepest) deepest = depth;
  }
  return deepest + 1;
}

/* Counts against the bounds; E_FORMAT beyond. */
static int within_bounds(struct reader *reader, uint32_t nodes, unsigned depth, size_t line) {
  if (depth > YAML_MAX_DEPTH) return fail_at(reader, line, "nested more than 32 deep"), 0;
  if (nodes > YAML_MAX_NODES - reader->nodes) return fail_at(reader, line, "more than 1000000 values"), 0;
  reader->nodes += nodes;
  return 1;
}

static conceg_node *read_alias(struct reader *reader, const yaml_event_t *event, unsigned depth) {
  const size_t line = event->start_mark.line + 1;
  const char *name = (const char *)event->data.alias.anchor;
  size_t i = reader->anchor_count;
  conceg_node *copy;
  while (i > 0 && strcmp(reader->anchors[i - 1].name, name) != 0)
    i--;
  if (i == 0) return fail_at(reader, line, "alias of an anchor that is not there"), NULL;
  if (!reader->anchors[i - 1].complete) return fail_at(reader, line, "alias inside its own anchor"), NULL;
  if (!within_bounds(reader, count_nodes(reader->anchors[i - 1].node),
                     depth + node_depth(reader->anchors[i - 1].node) - 1, line))
    return NULL;
  reader->copied += count_text(reader->anchors[i - 1].node);
  if (reader->copied > YAML_MAX_COPIED)
    return fail_at(reader, line, "aliases stand for more than 16 MiB of text"), NULL;
  copy = node_clone(reader->anchors[i - 1].node);
  if (!copy) fail_memory(reader);
  return copy;
}

static conceg_node *read_scalar(struct reader *reader, const yaml_event_t *event) {
  const size_t line = event->start_mark.line + 1;
  const char *text = (const char *)event->data.scalar.value;
  conceg_node *node;
  if (event->data.scalar.tag)
    return fail_at(reader, line, "tags (!...) are not supported; remove the tag"), NULL;
  if (strlen(text) != event->data.scalar.length)
    return fail_at(reader, line, "a NUL character in a value"), NULL;
  node = node_new_scalar(text, event->data.scalar.length, event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE,
                         (uint32_t)line);
  if (!node || !add_anchor(reader, (const char *)event->data.scalar.anchor, node)) {
    node_free(node);
    if (reader->status == CONCEG_OK) fail_memory(reader);
    return NULL;
  }
  return node;
}

static conceg_node *read_node(struct reader *reader, yaml_event_t *event, unsigned depth);

/* Reads one key of a map into *key. Returns 0 at the end of the map or on an error. */
static int read_key(struct reader *reader, const conceg_node *map, const yaml_event_t *event, char **key) {
  const size_t line = event->start_mark.line + 1;
  const char *text;
  if (event->type == YAML_MAPPING_END_EVENT) return 0;
  if (event->type != YAML_SCALAR_EVENT) return fail_at(reader, line, "a key must be a word"), 0;
  text = (const char *)event->data.scalar.value;
  if (event->data.scalar.tag || strlen(text) != event->data.scalar.length || !*text)
    return fail_at(reader, line, "a key must be a word"), 0;
  if (map->count == YAML_MAX_KEYS) return fail_at(reader, line, "more than 4096 keys in one map"), 0;
  if (node_find(map, text)) {
    reader->status = conceg_ctx_fail(reader->ctx, CONCEG_E_FORMAT, "%s:%zu: key %.60s is given twice",
                                     reader->name, line, text);
    return 0;
  }
  *key = text_copy(text, strlen(text));
  if (!*key) fail_memory(reader);
  return *key != NULL;
}

static conceg_node *read_collection(struct reader *reader, const yaml_event_t *start, unsigned depth) {
  const int is_map = start->type == YAML_MAPPING_START_EVENT;
  const yaml_char_t *tag = is_map ? start->data.mapping_start.tag : start->data.sequence_start.tag;
  const yaml_char_t *anchor = is_map ? start->data.mapping_start.anchor : start->data.sequence_start.anchor;
  conceg_node *node;
  if (tag)
    return fail_at(reader, start->start_mark.line + 1, "tags (!...) are not supported; remove the tag"), NULL;
  node = node_new(is_map ? NODE_MAP : NODE_LIST, (uint32_t)start->start_mark.line + 1);
  if (!node || !add_anchor(reader, (const char *)anchor, node)) {
    node_free(node);
    if (reader->status == CONCEG_OK) fail_memory(reader);
    return NULL;
  }
  while (reader->status == CONCEG_OK) {
    yaml_event_t event;
    conceg_node *child = NULL;
    char *key = NULL;
    if (!next_event(reader, &event)) break;
    if (!is_map && event.type == YAML_SEQUENCE_END_EVENT) {
      yaml_event_delete(&event);
      break;
    }
    if (is_map) {
      const int more = read_key(reader, node, &event, &key);
      yaml_event_delete(&event);
      if (!more || !next_event(reader, &event)) {
        free(key);
        break;
      }
    }
    child = read_node(reader, &event, depth + 1);
    yaml_event_delete(&event);
    if (child && !node_append(node, key, child)) fail_memory(reader);
    free(key);
  }
  if (reader->status != CONCEG_OK) {
    node_free(node);
    return NULL;
  }
  complete_anchors(reader, node);
  return node;
}

static conceg_node *read_node(struct reader *reader, yaml_event_t *event, unsigned depth) {
  if (event->type == YAML_ALIAS_EVENT) return read_alias(reader, event, depth);
  if (!within_bounds(reader, 1, depth, event->start_mark.line + 1)) return NULL;
  if (event->type == YAML_SCALAR_EVENT) return read_scalar(reader, event);
  return read_collection(reader, event, depth);
}

/* The one document of the stream; NULL for an empty text or on an error. */
static conceg_node *read_stream(struct reader *reader) {
  conceg_node *root = NULL;
  int done = 0;
  while (!done && reader->status == CONCEG_OK) {
    yaml_event_t event;
    if (!next_event(reader, &event)) break;
    switch (event.type) {
    case YAML_STREAM_END_EVENT:
      done = 1;
      break;
    case YAML_STREAM_START_EVENT:
    case YAML_DOCUMENT_END_EVENT:
      break;
    case YAML_DOCUMENT_START_EVENT:
      if (root) fail_at(reader, event.start_mark.line + 1, "a second document begins; only one is allowed");
      break;
    default:
      root = read_node(reader, &event, 1);
    }
    yaml_event_delete(&event);
  }
  if (reader->status == CONCEG_OK) return root;
  node_free(root);
  return NULL;
}

conceg_status yamltree_parse(conceg_ctx *ctx, const char *text, size_t length, const char *name,
                             struct yamltree **out) {
  struct reader reader;
  struct yamltree *tree;
  size_t i;
  *out = NULL;
  if (length > YAML_MAX_BYTES)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: expected at most 16 MiB of YAML, got %zu bytes", name,
                           length);
  memset(&reader, 0, sizeof reader);
  tree = calloc(1, sizeof *tree);
  if (!tree || !yaml_parser_initialize(&reader.parser)) {
    free(tree);
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", name);
  }
  reader.ctx = ctx;
  reader.name = name;
  yaml_parser_set_encoding(&reader.parser, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(&reader.parser, (const unsigned char *)text, length);
  tree->root = read_stream(&reader);
  yaml_parser_delete(&reader.parser);
  for (i = 0; i < reader.anchor_count; i++)
    free(reader.anchors[i].name);
  free(reader.anchors);
  if (tree->root) {
    tree->root->file = text_copy(name, strlen(name));
    if (!tree->root->file) fail_memory(&reader);
  }
  if (reader.status != CONCEG_OK) {
    yamltree_free(tree);
    return reader.status;
  }
  *out = tree;
  return CONCEG_OK;
}

const conceg_node *yamltree_root(const struct yamltree *tree) {
  return tree ? tree->root : NULL;
}

conceg_node *yamltree_take_root(struct yamltree *tree) {
  conceg_node *root = tree->root;
  tree->root = NULL;
  return root;
}

void yamltree_free(struct yamltree *tree) {
  if (!tree) return;
  node_free(tree->root);
  free(tree);
}
