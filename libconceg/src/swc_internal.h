/* SPDX-License-Identifier: BSD-3-Clause
 * What the files of the SWC reader share. Not installed. */
#ifndef CONCEG_SWC_INTERNAL_H
#define CONCEG_SWC_INTERNAL_H

#include "conceg/swc.h"

#include <stddef.h>
#include <stdint.h>

#define SWC_NONE (-1)
#define SWC_USES 5

/* A row or sample by number: a text of less than 4 GiB has fewer than 2^31 rows. */
typedef int32_t swc_index;

/* One row of the file, as written. */
typedef struct swc_row {
  int64_t id, parent_id;
  double position[3];
  double radius;
  int32_t kind;
  uint32_t line;
} swc_row;

typedef struct swc_problem {
  uint32_t severity, line, order;
  const char *code;
  char *text;
} swc_problem;

/* A value beside a row: an extra column of the row itself, or a column of the footer. */
typedef struct swc_column {
  char *name;
  double *value; /* by row while reading, by sample afterwards; NAN = absent */
} swc_column;

typedef struct swc_header {
  char *key, *value;
} swc_header;

/* Row properties that are reported once per file: first line, how many. */
typedef enum swc_note {
  SWC_NOTE_EOL,
  SWC_NOTE_PROSE,
  SWC_NOTE_DELIMITER,
  SWC_NOTE_TRAILING,
  SWC_NOTE_COLUMNS,
  SWC_NOTE_COLUMN_TEXT,
  SWC_NOTE_FLOAT_ID,
  SWC_NOTE_ENCODING,
  SWC_NOTE_TYPE,
  SWC_NOTE_RADIUS,
  SWC_NOTE_CNIC,
  SWC_NOTE_ZERO_LENGTH,
  SWC_NOTE_COUNT
} swc_note;

/* A soma as a sphere. */
typedef struct swc_sphere {
  conceg_soma_form form;
  double center[3], radius;
} swc_sphere;

struct conceg_swc {
  conceg_ctx *ctx;
  char *name;
  uint32_t flags;
  int out_of_memory;

  swc_row *row; /* by id once the text is read; freed when the samples are made */
  size_t row_count, row_room;
  int unsorted; /* 1 = the ids of the file do not ascend */
  swc_problem *problem;
  size_t problem_count, problem_room;
  size_t error_count; /* without those of strict mode */
  uint32_t note_line[SWC_NOTE_COUNT];
  uint64_t note_count[SWC_NOTE_COUNT];
  swc_header *header;
  size_t header_count, header_room;
  swc_column *column;
  size_t column_count, column_room;

  /* By row, made by swc_build_tree and freed at its end. */
  swc_index *parent; /* row index, SWC_NONE = root */
  uint8_t *merged;   /* 1 = left out: an identical copy of an earlier row, or of a floating tree */
  uint8_t *is_soma;  /* 1 = part of a soma */
  swc_index *first_child, *next_sibling;
  uint32_t *row_cell;   /* of soma rows; NULL while there is one cell */
  swc_index *soma_row;  /* rows of all somas, each in preorder */
  uint64_t *soma_first; /* [soma_count + 1] in soma_row */

  /* Neurite samples in preorder. */
  uint64_t count;
  swc_index *sample_row;
  double *position, *radius;
  int32_t *kind;
  int64_t *sample_parent;
  uint8_t *on_soma;
  uint32_t *line;

  /* Cells: one, but for CONCEG_SWC_SPLIT. */
  uint32_t cell_count, soma_count; /* cells without a soma come last: soma_count <= cell_count */
  uint64_t *cell_first;            /* [cell_count + 1], samples */
  swc_sphere *soma;                /* [cell_count] */
  uint64_t use[SWC_USES];          /* by conceg_swc_use */
};

/* Footer rows ("# @n ...") wait here until the ids of the rows are known. */
typedef struct swc_footer_row {
  int64_t id;
  size_t first_value;
  uint32_t line;
} swc_footer_row;

typedef struct swc_footer {
  int open; /* between @begin nodes and @end nodes */
  size_t width;
  char **name;
  swc_footer_row *row;
  size_t row_count, row_room;
  double *value;
  size_t value_count, value_room;
} swc_footer;

/* swc.c: growing arrays, problems, notes. All tolerate an earlier failure to allocate. */
void *swc_alloc(conceg_swc *swc, size_t count, size_t size);
int swc_reserve(conceg_swc *swc, void **array, size_t *room, size_t need, size_t size);
char *swc_copy(conceg_swc *swc, const char *text, size_t length);
void swc_error(conceg_swc *swc, uint32_t line, const char *code, const char *format, ...) CONCEG_PRINTF(4, 5);
void swc_warn(conceg_swc *swc, uint32_t line, const char *code, const char *format, ...) CONCEG_PRINTF(4, 5);
/* A warning that strict mode turns into an error: reading goes on, so that the same problems are found. */
void swc_warn_strict(conceg_swc *swc, uint32_t line, const char *code, const char *format, ...)
    CONCEG_PRINTF(4, 5);
void swc_remark(conceg_swc *swc, swc_note note, uint32_t line);

/* swc_number.c: numbers without a locale, correctly rounded. Return the first byte after the number, or NULL.
 */
const char *swc_read_double(const char *text, const char *end, double *out);
const char *swc_read_integer(const char *text, const char *end, int64_t *out);
/* Both write at most 40 bytes and return the length. */
size_t swc_write_fixed6(char *out, double value);
size_t swc_write_hex(char *out, double value);

/* swc_parse.c: text to rows, piece by piece. Each piece starts where the one before was read to; returns how
 * many bytes were read, all of them when it is the last piece. */
typedef struct swc_parser {
  conceg_swc *swc;
  swc_footer footer;
  uint32_t line;
  int started, stopped; /* 1 = the beginning was looked at; nothing more is to be read */
} swc_parser;
size_t swc_parse_piece(swc_parser *parser, const char *text, size_t length, int is_last);
void swc_parse_end(swc_parser *parser);
/* swc_file.c: a file to rows. */
conceg_status swc_parse_file(conceg_ctx *ctx, const char *path, swc_parser *parser);
/* swc_plus.c: comment lines, footer blocks. */
void swc_read_comment(conceg_swc *swc, swc_footer *footer, const char *text, const char *end, uint32_t line);
void swc_apply_footer(conceg_swc *swc, swc_footer *footer);
void swc_free_footer(swc_footer *footer);
double *swc_add_column(conceg_swc *swc, const char *name, size_t length);
/* swc_ids.c: rows by id, and which row has an id (the first one of several). */
void swc_sort_rows(conceg_swc *swc);
typedef struct swc_ids swc_ids;
swc_ids *swc_ids_new(conceg_swc *swc);
int64_t swc_ids_find(const swc_ids *ids, int64_t id);
void swc_ids_free(swc_ids *ids);
/* swc_link.c: parents, cycles, duplicates, which somas there are. Returns 0 after an error. */
int swc_link_rows(conceg_swc *swc);
/* swc_tree.c: somas and neurites told apart, kinds, preorder. */
void swc_build_tree(conceg_swc *swc);
void swc_link_children(conceg_swc *swc);
/* swc_floating.c: trees beside the soma are reported, and left out or joined to it as the flags say.
 * `scratch` has a place for every row. */
void swc_settle_floating(conceg_swc *swc, swc_index *scratch);
/* swc_soma.c: each soma as a sphere. */
void swc_find_somas(conceg_swc *swc);

#endif
