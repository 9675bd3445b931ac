/* SPDX-License-Identifier: BSD-3-Clause
 * SWC reader: memory, problems, the two ways to read, and the accessors. */
#include "swc_internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *swc_alloc(conceg_swc *swc, size_t count, size_t size) {
  void *memory = swc->out_of_memory ? NULL : calloc(count ? count : 1, size);
  if (!memory) swc->out_of_memory = 1;
  return memory;
}

int swc_reserve(conceg_swc *swc, void **array, size_t *room, size_t need, size_t size) {
  size_t wanted = *room ? *room : 64;
  void *grown;
  if (need <= *room) return 1;
  while (wanted < need) {
    if (wanted > SIZE_MAX / 2) return swc->out_of_memory = 1, 0;
    wanted *= 2;
  }
  grown = swc->out_of_memory || wanted > SIZE_MAX / size ? NULL : realloc(*array, wanted * size);
  if (!grown) return swc->out_of_memory = 1, 0;
  *array = grown, *room = wanted;
  return 1;
}

char *swc_copy(conceg_swc *swc, const char *text, size_t length) {
  char *copy = swc_alloc(swc, length + 1, 1);
  if (copy) memcpy(copy, text, length), copy[length] = 0;
  return copy;
}

static void add_problem(conceg_swc *swc, uint32_t severity, uint32_t line, const char *code,
                        const char *format, va_list arguments) {
  char text[512];
  swc_problem *problem;
  char *copy;
  if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = 0;
  if (!swc_reserve(swc, (void **)&swc->problem, &swc->problem_room, swc->problem_count + 1, sizeof *problem))
    return;
  copy = swc_copy(swc, text, strlen(text));
  if (!copy) return;
  problem = &swc->problem[swc->problem_count];
  problem->severity = severity, problem->line = line, problem->order = (uint32_t)swc->problem_count;
  problem->code = code, problem->text = copy;
  swc->problem_count++;
}

void swc_error(conceg_swc *swc, uint32_t line, const char *code, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  swc->error_count++;
  add_problem(swc, 0, line, code, format, arguments);
  va_end(arguments);
}

void swc_warn(conceg_swc *swc, uint32_t line, const char *code, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  add_problem(swc, 1, line, code, format, arguments);
  va_end(arguments);
}

void swc_warn_strict(conceg_swc *swc, uint32_t line, const char *code, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  add_problem(swc, swc->flags & CONCEG_SWC_STRICT ? 0 : 1, line, code, format, arguments);
  va_end(arguments);
}

void swc_remark(conceg_swc *swc, swc_note note, uint32_t line) {
  if (!swc->note_count[note] || line < swc->note_line[note]) swc->note_line[note] = line;
  swc->note_count[note]++;
}

/* One problem per kind of remark, with the first line and the number of rows. */
static void report_remarks(conceg_swc *swc) {
  static const struct {
    const char *code, *text;
    int strict;
  } remark[SWC_NOTE_COUNT] = {
      {"W_EOL", "line ends are a bare CR; read as line ends", 0},
      {"W_PROSE", "text before the first row does not start with #; read as a comment", 1},
      {"W_DELIM", "columns are separated by commas; write single spaces", 1},
      {"W_TRAILING", "text after the columns starts with #; it is left out", 0},
      {"W_COLUMNS", "more than 7 columns; the extra ones are kept as column8, column9, ...", 0},
      {"W_COLUMNS", "an extra column is no number; left out", 0},
      {"W_FLOAT_ID", "id, type or parent is written as a decimal number; read as an integer", 1},
      {"W_ENCODING", "a comment holds bytes that are not UTF-8; kept as they are", 0},
      {"W_TYPE", "type is negative (read as 0) or 20 or more (kept)", 0},
      {"W_RADIUS", "radius is 0 or negative; kept, but a mesh needs a positive one", 0},
      {"W_CNIC", "type 5 at a fork or 6 at a tip inside a branch; read as the parent's type", 0},
      {"W_ZEROLEN", "sample lies on its parent: a segment of length 0; kept", 0},
  };
  int note;
  for (note = 0; note < SWC_NOTE_COUNT; note++) {
    const unsigned long long rows = swc->note_count[note];
    if (!rows) continue;
    (remark[note].strict ? swc_warn_strict : swc_warn)(swc, swc->note_line[note], remark[note].code,
                                                       "%s (%llu line%s)", remark[note].text, rows,
                                                       rows == 1 ? "" : "s");
  }
}

static int by_line(const void *a, const void *b) {
  const swc_problem *p = a, *q = b;
  if (p->line != q->line) return p->line < q->line ? -1 : 1;
  return p->order < q->order ? -1 : p->order > q->order;
}

/* Sorts the problems and turns them into the status of the call. */
static conceg_status conclude(conceg_swc *swc) {
  size_t i;
  report_remarks(swc);
  if (swc->out_of_memory)
    return conceg_ctx_fail(swc->ctx, CONCEG_E_NOMEM, "%s: out of memory", swc->name ? swc->name : "SWC");
  if (swc->problem_count) qsort(swc->problem, swc->problem_count, sizeof *swc->problem, by_line);
  for (i = 0; i < swc->problem_count; i++) {
    const swc_problem *p = &swc->problem[i];
    if (p->severity) continue;
    if (!p->line)
      return conceg_ctx_fail(swc->ctx, CONCEG_E_FORMAT, "%s: %s: %s", swc->name, p->code, p->text);
    return conceg_ctx_fail(swc->ctx, CONCEG_E_FORMAT, "%s:%u: %s: %s", swc->name, p->line, p->code, p->text);
  }
  return CONCEG_OK;
}

/* What only the making of the samples needed. */
static void free_rows(conceg_swc *swc) {
  free(swc->row), free(swc->parent), free(swc->merged), free(swc->is_soma), free(swc->row_cell);
  free(swc->first_child), free(swc->next_sibling), free(swc->sample_row);
  free(swc->soma_row), free(swc->soma_first);
  swc->row = NULL, swc->parent = NULL, swc->merged = swc->is_soma = NULL, swc->row_cell = NULL;
  swc->first_child = swc->next_sibling = swc->sample_row = swc->soma_row = NULL, swc->soma_first = NULL;
}

static conceg_status check_flags(conceg_ctx *ctx, uint32_t flags) {
  const uint32_t both = CONCEG_SWC_DROP_FLOATING | CONCEG_SWC_ATTACH_FLOATING;
  if (flags & ~(CONCEG_SWC_STRICT | CONCEG_SWC_SPLIT | both))
    return conceg_ctx_fail(ctx, CONCEG_E_PARAM, "reading SWC: expected flags of conceg/swc.h, got 0x%x",
                           flags);
  if ((flags & both) == both)
    return conceg_ctx_fail(ctx, CONCEG_E_PARAM,
                           "reading SWC: floating trees can be dropped or attached, not both");
  return CONCEG_OK;
}

static conceg_status begin(conceg_ctx *ctx, const char *name, uint32_t flags, swc_parser *parser) {
  const conceg_status status = check_flags(ctx, flags);
  conceg_swc *swc;
  memset(parser, 0, sizeof *parser);
  if (status != CONCEG_OK) return status;
  swc = calloc(1, sizeof *swc);
  if (!swc) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", name);
  swc->ctx = ctx, swc->flags = flags;
  swc->name = swc_copy(swc, name, strlen(name));
  parser->swc = swc;
  return CONCEG_OK;
}

static conceg_status end(swc_parser *parser, conceg_swc **out) {
  conceg_swc *const swc = parser->swc;
  conceg_status status;
  *out = swc;
  swc_parse_end(parser);
  if (!swc->out_of_memory && !swc->error_count) swc_build_tree(swc);
  status = conclude(swc);
  free_rows(swc);
  if (status != CONCEG_OK) swc->count = 0, swc->cell_count = 0;
  return status;
}

conceg_status conceg_swc_parse(conceg_ctx *ctx, const char *text, size_t length, const char *name,
                               uint32_t flags, conceg_swc **out) {
  swc_parser parser;
  conceg_status status;
  *out = NULL;
  if (length >= UINT32_MAX)
    return conceg_ctx_fail(ctx, CONCEG_E_RANGE, "%s: expected less than 4 GiB, got %zu bytes", name, length);
  status = begin(ctx, name, flags, &parser);
  if (status != CONCEG_OK) return status;
  swc_parse_piece(&parser, text, length, 1);
  return end(&parser, out);
}

conceg_status conceg_swc_read(conceg_ctx *ctx, const char *path, uint32_t flags, conceg_swc **out) {
  swc_parser parser;
  conceg_status status;
  *out = NULL;
  status = begin(ctx, path, flags, &parser);
  if (status != CONCEG_OK) return status;
  status = swc_parse_file(ctx, path, &parser);
  if (status == CONCEG_OK) return end(&parser, out);
  swc_free_footer(&parser.footer);
  conceg_swc_free(parser.swc);
  return status;
}

void conceg_swc_free(conceg_swc *swc) {
  size_t i;
  if (!swc) return;
  for (i = 0; i < swc->problem_count; i++)
    free(swc->problem[i].text);
  for (i = 0; i < swc->header_count; i++)
    free(swc->header[i].key), free(swc->header[i].value);
  for (i = 0; i < swc->column_count; i++)
    free(swc->column[i].name), free(swc->column[i].value);
  free_rows(swc);
  free(swc->name), free(swc->problem), free(swc->header), free(swc->column);
  free(swc->position), free(swc->radius), free(swc->kind), free(swc->sample_parent);
  free(swc->on_soma), free(swc->line), free(swc->cell_first), free(swc->soma);
  free(swc);
}

uint64_t conceg_swc_count(const conceg_swc *swc) {
  return swc->count;
}
const double *conceg_swc_position(const conceg_swc *swc) {
  return swc->position;
}
const double *conceg_swc_radius(const conceg_swc *swc) {
  return swc->radius;
}
const int32_t *conceg_swc_kind(const conceg_swc *swc) {
  return swc->kind;
}
const int64_t *conceg_swc_parent(const conceg_swc *swc) {
  return swc->sample_parent;
}
const uint8_t *conceg_swc_on_soma(const conceg_swc *swc) {
  return swc->on_soma;
}
const uint32_t *conceg_swc_line(const conceg_swc *swc) {
  return swc->line;
}

conceg_soma_form conceg_swc_soma(const conceg_swc *swc, double center[3], double *radius) {
  return conceg_swc_cell_soma(swc, 0, center, radius);
}

uint32_t conceg_swc_cell_count(const conceg_swc *swc) {
  return swc->cell_count;
}

uint64_t conceg_swc_cell_first(const conceg_swc *swc, uint32_t cell) {
  return cell < swc->cell_count ? swc->cell_first[cell] : swc->count;
}

conceg_soma_form conceg_swc_cell_soma(const conceg_swc *swc, uint32_t cell, double center[3],
                                      double *radius) {
  static const swc_sphere none = {CONCEG_SOMA_NONE, {0, 0, 0}, 0};
  const swc_sphere *const soma = cell < swc->cell_count ? &swc->soma[cell] : &none;
  if (center) memcpy(center, soma->center, sizeof soma->center);
  if (radius) *radius = soma->radius;
  return soma->form;
}

uint64_t conceg_swc_rows(const conceg_swc *swc, conceg_swc_use use) {
  return (uint32_t)use < SWC_USES ? swc->use[use] : 0;
}

int conceg_swc_problem(const conceg_swc *swc, uint32_t index, uint32_t *severity, uint32_t *line,
                       const char **code, const char **text) {
  const swc_problem *problem;
  if (index >= swc->problem_count) return 0;
  problem = &swc->problem[index];
  if (severity) *severity = problem->severity;
  if (line) *line = problem->line;
  if (code) *code = problem->code;
  if (text) *text = problem->text;
  return 1;
}

const char *conceg_swc_header(const conceg_swc *swc, const char *key) {
  size_t i;
  for (i = 0; i < swc->header_count; i++)
    if (!strcmp(swc->header[i].key, key)) return swc->header[i].value;
  return NULL;
}

const double *conceg_swc_column(const conceg_swc *swc, const char *name) {
  size_t i;
  if (swc->count)
    for (i = 0; i < swc->column_count; i++)
      if (!strcmp(swc->column[i].name, name)) return swc->column[i].value;
  return NULL;
}

int conceg_swc_header_at(const conceg_swc *swc, uint32_t index, const char **key, const char **value) {
  if (index >= swc->header_count) return 0;
  if (key) *key = swc->header[index].key;
  if (value) *value = swc->header[index].value;
  return 1;
}

const char *conceg_swc_column_at(const conceg_swc *swc, uint32_t index) {
  return index < swc->column_count ? swc->column[index].name : NULL;
}
