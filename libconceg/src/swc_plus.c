/* SPDX-License-Identifier: BSD-3-Clause
 * What SWC-plus keeps in comment lines: "#key value" headers and the footer block of exact values per sample.
 */
#include "swc_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_FOOTER_COLUMNS 64
#define AGREEMENT_UM 5e-7 /* half of the last decimal that the columns are written with */

static int is_space(char c) {
  return c == ' ' || c == '\t';
}

static const char *skip_space(const char *p, const char *end) {
  while (p < end && is_space(*p))
    p++;
  return p;
}
static const char *word_end(const char *p, const char *end) {
  while (p < end && !is_space(*p))
    p++;
  return p;
}
static int word_is(const char *p, const char *stop, const char *word) {
  return (size_t)(stop - p) == strlen(word) && !memcmp(p, word, strlen(word));
}

static int is_utf8(const char *text, const char *end) {
  const unsigned char *p = (const unsigned char *)text, *const stop = (const unsigned char *)end;
  while (p < stop) {
    int more = *p < 0x80                 ? 0
               : *p >= 0xc2 && *p < 0xe0 ? 1
               : *p >= 0xe0 && *p < 0xf0 ? 2
               : *p >= 0xf0 && *p < 0xf5 ? 3
                                         : -1;
    if (more < 0 || stop - p <= more) return 0;
    for (p++; more > 0; more--, p++)
      if ((*p & 0xc0) != 0x80) return 0;
  }
  return 1;
}

double *swc_add_column(conceg_swc *swc, const char *name, size_t length) {
  swc_column *column;
  if (!swc_reserve(swc, (void **)&swc->column, &swc->column_room, swc->column_count + 1, sizeof *column))
    return NULL;
  column = &swc->column[swc->column_count];
  column->name = swc_copy(swc, name, strlen(name));
  column->value = swc_alloc(swc, length, sizeof(double));
  swc->column_count++;
  return column->value && column->name ? column->value : NULL;
}

/* "# @begin nodes columns=x,y,z": opens the block. */
static void begin_block(conceg_swc *swc, swc_footer *footer, const char *p, const char *end, uint32_t line) {
  static const char key[] = "columns=";
  const char *stop = word_end(p, end), *value;
  if (!word_is(p, stop, "nodes")) return;
  p = skip_space(stop, end), stop = word_end(p, end);
  if (footer->width || (size_t)(stop - p) < sizeof key || memcmp(p, key, sizeof key - 1)) {
    swc_warn_strict(swc, line, "W_FOOTER",
                    "expected one block '@begin nodes columns=NAME,...'; the block is left out");
    return;
  }
  for (p += sizeof key - 1; p < stop; p = value + (value < stop)) {
    char **grown;
    if (footer->width == MOST_FOOTER_COLUMNS) {
      swc_warn_strict(swc, line, "W_FOOTER", "more than %d columns; those after are left out",
                      MOST_FOOTER_COLUMNS);
      break;
    }
    for (value = p; value < stop && *value != ',';)
      value++;
    grown = realloc(footer->name, (footer->width + 1) * sizeof *grown);
    if (!grown) {
      swc->out_of_memory = 1;
      return;
    }
    footer->name = grown;
    footer->name[footer->width] = swc_copy(swc, p, (size_t)(value - p));
    if (!footer->name[footer->width]) return;
    footer->width++;
  }
  footer->open = 1;
}

/* "# @n id value ...": one sample; '-' stands for no value. */
static void block_row(conceg_swc *swc, swc_footer *footer, const char *p, const char *end, uint32_t line) {
  swc_footer_row row;
  size_t i;
  const char *stop = word_end(p, end);
  int bad = swc_read_integer(p, stop, &row.id) != stop;
  if (!swc_reserve(swc, (void **)&footer->value, &footer->value_room, footer->value_count + footer->width,
                   sizeof(double)) ||
      !swc_reserve(swc, (void **)&footer->row, &footer->row_room, footer->row_count + 1, sizeof row))
    return;
  row.first_value = footer->value_count, row.line = line;
  for (i = 0; i < footer->width && !bad; i++) {
    double *const value = &footer->value[footer->value_count + i];
    p = skip_space(stop, end);
    *value = NAN;
    stop = p < end && *p == '-' && (p + 1 == end || is_space(p[1])) ? p + 1 : swc_read_double(p, end, value);
    bad = !stop || (stop < end && !is_space(*stop));
  }
  if (bad || skip_space(stop, end) != end) {
    swc_warn_strict(swc, line, "W_FOOTER", "expected an id and %zu values; the line is left out",
                    footer->width);
    return;
  }
  footer->value_count += footer->width;
  footer->row[footer->row_count++] = row;
}

static void keep_header(conceg_swc *swc, const char *p, const char *end) {
  const char *stop = word_end(p, end), *value;
  swc_header *header;
  if (p == stop ||
      !swc_reserve(swc, (void **)&swc->header, &swc->header_room, swc->header_count + 1, sizeof *header))
    return;
  value = skip_space(stop, end);
  header = &swc->header[swc->header_count];
  header->key = swc_copy(swc, p, (size_t)(stop - p));
  header->value = swc_copy(swc, value, (size_t)(end - value));
  swc->header_count++;
}

void swc_read_comment(conceg_swc *swc, swc_footer *footer, const char *text, const char *end, uint32_t line) {
  const char *p = skip_space(text, end), *const stop = word_end(p, end);
  if (footer->open && word_is(p, stop, "@n")) {
    block_row(swc, footer, skip_space(stop, end), end, line);
    return;
  }
  if (!is_utf8(text, end)) swc_remark(swc, SWC_NOTE_ENCODING, line);
  if (word_is(p, stop, "@begin"))
    begin_block(swc, footer, skip_space(stop, end), end, line);
  else if (word_is(p, stop, "@end"))
    footer->open = 0;
  else
    keep_header(swc, p, end);
}

void swc_free_footer(swc_footer *footer) {
  size_t i;
  for (i = 0; i < footer->width; i++)
    free(footer->name[i]);
  free(footer->name), free(footer->row), free(footer->value);
}

/* The exact value in place of the rounded one, when both tell the same. */
static void refine(conceg_swc *swc, const swc_footer_row *from, const char *name, double exact,
                   double *column) {
  if (isnan(exact)) return;
  if (isfinite(exact) && fabs(exact - *column) <= AGREEMENT_UM + 1e-15 * fabs(exact))
    *column = exact;
  else
    swc_warn(swc, from->line, "W_STALE",
             "exact %s of sample %lld is %.9g but its column says %.9g; the column is used", name,
             (long long)from->id, exact, *column);
}

/* Which of x, y, z, radius a column of the footer holds: 0 to 3, 4 = none of them. */
static int own_column(const char *name) {
  static const char *const own[4] = {"x", "y", "z", "radius"};
  int k = 0;
  while (k < 4 && strcmp(name, own[k]) != 0)
    k++;
  return k;
}

void swc_apply_footer(conceg_swc *swc, swc_footer *footer) {
  static const char *const own[4] = {"x", "y", "z", "radius"};
  const size_t first = swc->column_count;
  int holds[MOST_FOOTER_COLUMNS];
  swc_ids *ids;
  size_t i, c, missing = 0;
  if (!footer->width || swc->out_of_memory) return;
  for (c = 0; c < footer->width; c++) {
    double *value = swc_add_column(swc, footer->name[c], swc->row_count);
    if (!value) return;
    for (i = 0; i < swc->row_count; i++)
      value[i] = NAN;
    holds[c] = own_column(footer->name[c]);
  }
  ids = swc_ids_new(swc);
  if (!ids) return;
  for (i = 0; i < footer->row_count; i++) {
    const swc_footer_row *const from = &footer->row[i];
    const int64_t row = swc_ids_find(ids, from->id);
    if (row < 0) {
      if (!missing++)
        swc_warn(swc, from->line, "W_FOOTER", "no sample has the id %lld; the line is left out",
                 (long long)from->id);
      continue;
    }
    for (c = 0; c < footer->width; c++) {
      const double exact = footer->value[from->first_value + c];
      const int k = holds[c];
      swc->column[first + c].value[row] = exact;
      if (k < 4) refine(swc, from, own[k], exact, k < 3 ? &swc->row[row].position[k] : &swc->row[row].radius);
    }
  }
  swc_ids_free(ids);
}
