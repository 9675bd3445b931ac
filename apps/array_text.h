/* SPDX-License-Identifier: BSD-3-Clause
 * Values of arrays as text, and walking over a document. */
#ifndef CONCEG_APPS_ARRAY_TEXT_H
#define CONCEG_APPS_ARRAY_TEXT_H

#include "cli.h"

#define VALUE_TEXT 64

/* The index-th value in its shortest exact form; texts are not for this function. */
void value_text(const conceg_array *array, uint64_t index, char out[VALUE_TEXT]);
/* The index-th value as a double; 0 for a text. */
double value_number(const conceg_array *array, uint64_t index);
/* The index-th string; "" when the array holds none. */
const char *value_string(const conceg_array *array, uint64_t index);
/* "f64[13,3]" */
void shape_text(const conceg_array *array, char *out, size_t size);
/* Bytes of the values; for texts the bytes of the strings. */
uint64_t array_bytes(const conceg_array *array);

/* Reads into *out. Returns 0, or an exit code after an error line. */
int read_array(struct cli *cli, conceg_doc *doc, const char *path, conceg_array *out);
/* The same without the values of numbers; texts, whose bytes count, are read. */
int describe_array(struct cli *cli, conceg_doc *doc, const char *path, conceg_array *out);

/* Paths of all arrays and attributes below a group, or the path itself when it is an array, in canonical
 * order; the texts are owned by the cli. */
void list_arrays(struct cli *cli, conceg_doc *doc, const char *group, struct words *out);

/* "12.3 kB" */
void bytes_text(uint64_t bytes, char *out, size_t size);

/* Columns of text, aligned when printed: the first to the left, numbers to the right. */
struct table {
  struct words cells;
  uint32_t columns;
};
void table_print(const struct table *table, int indent);
void table_free(struct table *table);

#endif
