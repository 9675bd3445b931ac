/* SPDX-License-Identifier: BSD-3-Clause
 * Values of arrays as text, walking over a document, aligned tables. */
#include "array_text.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

double value_number(const conceg_array *array, uint64_t index) {
  switch (array->dtype) {
  case CONCEG_U8:
    return ((const uint8_t *)array->data)[index];
  case CONCEG_I8:
    return ((const int8_t *)array->data)[index];
  case CONCEG_U32:
    return ((const uint32_t *)array->data)[index];
  case CONCEG_I32:
    return ((const int32_t *)array->data)[index];
  case CONCEG_U64:
    return (double)((const uint64_t *)array->data)[index];
  case CONCEG_I64:
    return (double)((const int64_t *)array->data)[index];
  case CONCEG_F32:
    return ((const float *)array->data)[index];
  case CONCEG_F64:
    return ((const double *)array->data)[index];
  default:
    return 0;
  }
}

static void shortest_f64(double value, char *out) {
  int digits;
  for (digits = 15; digits < 18; digits++) {
    snprintf(out, VALUE_TEXT, "%.*g", digits, value);
    if (strtod(out, NULL) == value) return;
  }
}

static void shortest_f32(float value, char *out) {
  int digits;
  for (digits = 6; digits < 10; digits++) {
    snprintf(out, VALUE_TEXT, "%.*g", digits, (double)value);
    if (strtof(out, NULL) == value) return;
  }
}

void value_text(const conceg_array *array, uint64_t index, char out[VALUE_TEXT]) {
  if (array->dtype == CONCEG_F64)
    shortest_f64(((const double *)array->data)[index], out);
  else if (array->dtype == CONCEG_F32)
    shortest_f32(((const float *)array->data)[index], out);
  else if (array->dtype == CONCEG_U64)
    snprintf(out, VALUE_TEXT, "%" PRIu64, ((const uint64_t *)array->data)[index]);
  else if (array->dtype == CONCEG_I64)
    snprintf(out, VALUE_TEXT, "%" PRId64, ((const int64_t *)array->data)[index]);
  else
    snprintf(out, VALUE_TEXT, "%.0f", value_number(array, index));
}

const char *value_string(const conceg_array *array, uint64_t index) {
  if (array->dtype != CONCEG_TEXT || index >= conceg_array_count(array)) return "";
  return ((const char *const *)array->data)[index];
}

void shape_text(const conceg_array *array, char *out, size_t size) {
  uint32_t axis;
  size_t used = (size_t)snprintf(out, size, "%s", conceg_dtype_name(array->dtype));
  for (axis = 0; axis < array->rank && used < size; axis++)
    used += (size_t)snprintf(out + used, size - used, "%s%" PRIu64, axis ? "," : "[", array->shape[axis]);
  if (array->rank && used < size) snprintf(out + used, size - used, "]");
}

uint64_t array_bytes(const conceg_array *array) {
  const uint64_t count = conceg_array_count(array);
  uint64_t bytes = 0, i;
  if (array->dtype != CONCEG_TEXT) return count * conceg_dtype_bytes(array->dtype);
  for (i = 0; i < count; i++)
    bytes += strlen(value_string(array, i)) + 1;
  return bytes;
}

int read_array(struct cli *cli, conceg_doc *doc, const char *path, conceg_array *out) {
  conceg_status status;
  memset(out, 0, sizeof *out);
  out->size = sizeof *out;
  status = conceg_doc_read(doc, path, out);
  return status == CONCEG_OK ? EXIT_OK : cli_fail_status(cli, status);
}

int describe_array(struct cli *cli, conceg_doc *doc, const char *path, conceg_array *out) {
  conceg_status status;
  memset(out, 0, sizeof *out);
  out->size = sizeof *out;
  status = conceg_doc_describe(doc, path, out);
  if (status == CONCEG_OK && out->dtype == CONCEG_TEXT) status = conceg_doc_read(doc, path, out);
  return status == CONCEG_OK ? EXIT_OK : cli_fail_status(cli, status);
}

/* 1 for a dataset or an attribute: among its parent's children a group would end in "/". */
static int is_array(struct cli *cli, conceg_doc *doc, const char *path) {
  const char *slash = strrchr(path, '/');
  const char *parent = slash && slash != path ? cli_keep(cli, "%.*s", (int)(slash - path), path) : "/";
  const uint64_t count = conceg_doc_children(doc, parent);
  uint64_t i;
  if (strchr(path, '@')) return 1;
  for (i = 0; i < count; i++)
    if (!strcmp(conceg_doc_child(doc, parent, i), path)) return 1;
  return 0;
}

void list_arrays(struct cli *cli, conceg_doc *doc, const char *group, struct words *out) {
  const uint64_t count = conceg_doc_children(doc, group);
  uint64_t i;
  if (is_array(cli, doc, group)) {
    words_add(out, cli_keep(cli, "%s", group));
    return;
  }
  for (i = 0; i < count; i++) {
    const char *child = cli_keep(cli, "%s", conceg_doc_child(doc, group, i));
    const size_t length = strlen(child);
    if (length && child[length - 1] == '/')
      list_arrays(cli, doc, child, out);
    else
      words_add(out, child);
  }
}

void bytes_text(uint64_t bytes, char *out, size_t size) {
  static const char *const units[] = {"B", "kB", "MB", "GB", "TB"};
  double value = (double)bytes;
  int unit = 0;
  while (value >= 1000 && unit < 4)
    value /= 1000, unit++;
  snprintf(out, size, unit ? "%.1f %s" : "%.0f %s", value, units[unit]);
}

/* Characters, not bytes, so that names with accents line up. */
static uint32_t width_of(const char *text) {
  uint32_t width = 0;
  for (; *text; text++)
    width += ((unsigned char)*text & 0xc0) != 0x80;
  return width;
}

static int is_number(const char *text) {
  char *end;
  strtod(text, &end);
  return end != text && !*end;
}

void table_print(const struct table *table, int indent) {
  uint32_t width[64] = {0}, i, pad;
  const uint32_t columns = table->columns < 64 ? table->columns : 64;
  if (!columns) return;
  for (i = 0; i < table->cells.count; i++) {
    const uint32_t cell = width_of(table->cells.word[i]), column = i % table->columns;
    if (column < columns && cell > width[column]) width[column] = cell;
  }
  for (i = 0; i < table->cells.count; i++) {
    const char *cell = table->cells.word[i];
    const uint32_t column = i % table->columns;
    int right;
    if (column >= columns) continue;
    /* A heading stands over its column as the first value does. */
    right = column > 0 && is_number(i < table->columns && i + table->columns < table->cells.count
                                        ? table->cells.word[i + table->columns]
                                        : cell);
    if (column == 0) printf("%*s", indent, "");
    pad = width[column] - width_of(cell);
    printf("%s%*s%s", column ? "  " : "", right ? (int)pad : 0, "", cell);
    if (column + 1 == columns)
      putchar('\n');
    else if (!right)
      printf("%*s", (int)pad, "");
  }
}

void table_free(struct table *table) {
  words_free(&table->cells);
}
