/* SPDX-License-Identifier: BSD-3-Clause
 * SWC and SWC-plus (spec/swc-plus.md): a tolerant reader that reports every problem with its line, and a
 * writer. Lengths in um. */
#ifndef CONCEG_SWC_H
#define CONCEG_SWC_H

#include "conceg/ctx.h"

CONCEG_BEGIN_C

/* Flags of reading; others are an error (E_PARAM). */
#define CONCEG_SWC_STRICT 1u /* warnings that spec/swc-plus.md marks S become errors */
#define CONCEG_SWC_SPLIT 2u  /* several somata are several cells (W_SOMATA) instead of an error (E_SOMATA) */
/* Trees that are not joined to the soma of a file that has one: left out, or joined to the nearest sample or
 * soma. Without either they are kept as trees of their own. */
#define CONCEG_SWC_DROP_FLOATING 4u
#define CONCEG_SWC_ATTACH_FLOATING 8u

/* SWC structure codes that ConCeG gives a meaning to. */
#define CONCEG_SWC_UNDEFINED 0
#define CONCEG_SWC_SOMA 1
#define CONCEG_SWC_AXON 2
#define CONCEG_SWC_BASAL 3
#define CONCEG_SWC_APICAL 4
#define CONCEG_SWC_GLIA 7

typedef struct conceg_swc conceg_swc;

/* Reads a file or text. All problems are collected first, then decided: E_FORMAT when one is an error (the
 * context's error names the first: file:line: code: text), and *out is still set so that the problems can be
 * listed. Other errors: E_IO, E_NOMEM, E_RANGE (4 GiB and more), E_PARAM (flags). *out is NULL or set, with
 * any status: free it always. Memory: at most 64 bytes per byte of text and 1 MiB, while it reads, for files
 * of seven columns; about 3 bytes per byte for usual ones. Each further column of a row or of the footer
 * takes 8 bytes more per row. Objects of one context belong to one thread at a time. */
CONCEG_API conceg_status conceg_swc_read(conceg_ctx *ctx, const char *path, uint32_t flags,
                                         conceg_swc **out) CONCEG_NODISCARD;
CONCEG_API conceg_status conceg_swc_parse(conceg_ctx *ctx, const char *text, size_t length, const char *name,
                                          uint32_t flags, conceg_swc **out) CONCEG_NODISCARD;
CONCEG_API void conceg_swc_free(conceg_swc *swc);

/* Neurite samples, soma samples left out, in preorder (parent < child; children and trees in the order of
 * their ids). Borrowed views, until the object is freed. */
CONCEG_API uint64_t conceg_swc_count(const conceg_swc *swc);
CONCEG_API const double *conceg_swc_position(const conceg_swc *swc); /* [count][3], um */
CONCEG_API const double *conceg_swc_radius(const conceg_swc *swc);   /* [count], um, as written */
CONCEG_API const int32_t *conceg_swc_kind(const conceg_swc *swc);    /* [count], SWC code */
CONCEG_API const int64_t *
conceg_swc_parent(const conceg_swc *swc); /* [count], index; -1 = soma or no parent */
CONCEG_API const uint8_t *conceg_swc_on_soma(
    const conceg_swc *swc); /* [count], 1 = its parent is the soma, 0 = floating root or inner */
CONCEG_API const uint32_t *conceg_swc_line(const conceg_swc *swc); /* [count], line in the file */

typedef enum conceg_soma_form {
  CONCEG_SOMA_NONE = 0,
  CONCEG_SOMA_POINT = 1,
  CONCEG_SOMA_THREE_POINT = 2,
  CONCEG_SOMA_CHAIN = 3,
  CONCEG_SOMA_CONTOUR = 4,
  CONCEG_SOMA_TREE = 5,
  CONCEG_SOMA_MAXIMUM = 0x7fffffff
} conceg_soma_form;
/* The soma as a sphere: form, centre (um) and radius (um; 0 when there is none). */
CONCEG_API conceg_soma_form conceg_swc_soma(const conceg_swc *swc, double center[3], double *radius);

/* Cells: 1, or with CONCEG_SWC_SPLIT one per soma, and a last one without soma for floating trees that are
 * kept; 0 after an error. Cell k has the samples from conceg_swc_cell_first(k) to conceg_swc_cell_first(k +
 * 1), and a soma as above. */
CONCEG_API uint32_t conceg_swc_cell_count(const conceg_swc *swc);
CONCEG_API uint64_t conceg_swc_cell_first(const conceg_swc *swc, uint32_t cell);
CONCEG_API conceg_soma_form conceg_swc_cell_soma(const conceg_swc *swc, uint32_t cell, double center[3],
                                                 double *radius);

/* What became of the rows of the file: ALL = SAMPLES + SOMA + COPIES + DROPPED unless there was an error. */
typedef enum conceg_swc_use {
  CONCEG_SWC_USE_ALL = 0,
  CONCEG_SWC_USE_SAMPLES = 1, /* samples of neurites */
  CONCEG_SWC_USE_SOMA = 2,
  CONCEG_SWC_USE_COPIES = 3,  /* W_DUP, W_SOMA_DUP */
  CONCEG_SWC_USE_DROPPED = 4, /* by CONCEG_SWC_DROP_FLOATING */
  CONCEG_SWC_USE_MAXIMUM = 0x7fffffff
} conceg_swc_use;
CONCEG_API uint64_t conceg_swc_rows(const conceg_swc *swc, conceg_swc_use use);

/* Problems in line order: severity (0 error, 1 warning), line (0 = whole file), code such as "W_ORPHAN" (a
 * constant), text (borrowed). 0 past the end. */
CONCEG_API int conceg_swc_problem(const conceg_swc *swc, uint32_t index, uint32_t *severity, uint32_t *line,
                                  const char **code, const char **text);

/* SWC-plus extras: value of an INCF "#key value" or "# @conceg {json}" line; exact per-node columns of the
 * footer. A column is [count] doubles in the order of the views above, or NULL when the file has none of that
 * name. */
CONCEG_API const char *conceg_swc_header(const conceg_swc *swc, const char *key);
CONCEG_API const double *conceg_swc_column(const conceg_swc *swc, const char *name);
/* All of them, by number in the order of the file; 0 and NULL past the end. Borrowed. */
CONCEG_API int conceg_swc_header_at(const conceg_swc *swc, uint32_t index, const char **key,
                                    const char **value);
CONCEG_API const char *conceg_swc_column_at(const conceg_swc *swc, uint32_t index);

/* A parent that makes a sample a root of its own although the cell has a soma (pieces cut at the sides of a
 * box). */
#define CONCEG_SWC_FLOATING (-2)

/* One cell to write. Arrays are borrowed. parent -1 = on the soma (or a root when soma_radius is 0). */
typedef struct conceg_swc_cell {
  uint32_t size;
  uint32_t column_count;
  uint64_t count;
  const double *position; /* [count][3] um, unwrapped */
  const double *radius;   /* [count] um, > 0 */
  const uint8_t *kind;    /* [count] SWC code */
  const int64_t *parent;  /* [count], parent < child; -1 or CONCEG_SWC_FLOATING for a root */
  double soma[3];
  double soma_radius; /* 0 = no soma row */
  const char *const
      *header; /* NULL-terminated lines without the leading "# ", e.g. "@conceg {...}" ; may be NULL */
  const char *const *column_name; /* [column_count] */
  const double *const *column;    /* [column_count][count], written as exact hex floats in the footer */
  const char *const *footer; /* as `header`, but after the rows, for what is long; may be NULL. A caller whose
                                `size` ends before it has none */
} conceg_swc_cell;

/* Writes SWC-plus: one cell, whole or not at all. Errors: E_IO, E_RANGE (radius <= 0, not finite), E_FORMAT
 * (parent order). */
CONCEG_API conceg_status conceg_swc_write(conceg_ctx *ctx, const char *path,
                                          const conceg_swc_cell *cell) CONCEG_NODISCARD;

CONCEG_END_C
#endif
