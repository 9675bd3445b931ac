/* SPDX-License-Identifier: BSD-3-Clause
 * SWC text to rows. Every line that is not understood becomes a problem with its number. */
#include "swc_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define COLUMNS 7
#define MOST_COLUMNS 32
#define MOST_LINE_ERRORS 100

typedef struct field {
  const char *text, *end;
} field;

typedef struct fields {
  field field[MOST_COLUMNS];
  int count;
  int commas, blanks; /* separators of each kind */
  int empty;          /* two commas in a row, or one at the start */
  int overflow;       /* more fields than MOST_COLUMNS */
  int trailing;       /* stopped at '#' */
} fields;

static int is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
static int is_digit(char c) {
  return c >= '0' && c <= '9';
}

static void split(const char *p, const char *end, fields *out) {
  memset(out, 0, sizeof *out);
  while (p < end && *p != '#') {
    int comma = 0, blank = 0;
    const char *start = p;
    while (p < end && !is_blank(*p) && *p != ',' && *p != '#')
      p++;
    if (p == start) out->empty = 1;
    if (out->count < MOST_COLUMNS)
      out->field[out->count].text = start, out->field[out->count].end = p, out->count++;
    else
      out->overflow = 1;
    for (; p < end && (is_blank(*p) || (*p == ',' && !comma)); p++) {
      if (*p == ',')
        comma = 1;
      else
        blank = 1;
    }
    if (comma)
      out->commas++;
    else if (blank && p < end && *p != '#')
      out->blanks++;
  }
  out->trailing = p < end;
}

/* Text of a field for a message: at most 24 bytes, unprintable ones as '?'. */
static const char *shown(const field *f, char buffer[28]) {
  size_t length = (size_t)(f->end - f->text), i;
  const int cut = length > 24;
  if (cut) length = 24;
  for (i = 0; i < length; i++)
    buffer[i] = f->text[i] >= 32 && f->text[i] < 127 ? f->text[i] : '?';
  memcpy(buffer + length, cut ? "..." : "", cut ? 4 : 1);
  return buffer;
}

static int read_real(conceg_swc *swc, const field *f, const char *what, uint32_t line, double *out) {
  char buffer[28];
  const char *p = f->text;
  const int read = swc_read_double(f->text, f->end, out) == f->end;
  if (read && isfinite(*out)) return 1;
  if (p < f->end && (*p == '+' || *p == '-')) p++;
  if (read || (p < f->end && (*p == 'n' || *p == 'N' || *p == 'i' || *p == 'I')))
    swc_error(swc, line, "E_NONFINITE", "%s: expected a finite number, got %s", what, shown(f, buffer));
  else
    swc_error(swc, line, "E_NUMBER", "%s: expected a number, got '%s'", what, shown(f, buffer));
  return 0;
}

static int read_whole(conceg_swc *swc, const field *f, const char *what, uint32_t line, int64_t *out) {
  char buffer[28];
  double real;
  if (swc_read_integer(f->text, f->end, out) == f->end) return 1;
  if (swc_read_double(f->text, f->end, &real) == f->end && real == floor(real) && fabs(real) <= 0x1p53) {
    *out = (int64_t)real;
    swc_remark(swc, SWC_NOTE_FLOAT_ID, line);
    return 1;
  }
  swc_error(swc, line, "E_ID", "%s: expected an integer below 2^63, got '%s'", what, shown(f, buffer));
  return 0;
}

/* Numbers beyond the seventh column become columns "column8", ... of this row. */
static void keep_extras(conceg_swc *swc, const fields *f, uint32_t line) {
  int i;
  swc_remark(swc, SWC_NOTE_COLUMNS, line);
  for (i = COLUMNS; i < f->count && !swc->out_of_memory; i++) {
    const size_t index = (size_t)(i - COLUMNS);
    double value;
    if (index >= swc->column_count) {
      char name[24];
      size_t row;
      double *column;
      snprintf(name, sizeof name, "column%d", i + 1);
      column = swc_add_column(swc, name, swc->row_room);
      if (!column) return;
      for (row = 0; row < swc->row_room; row++)
        column[row] = NAN;
    }
    if (swc_read_double(f->field[i].text, f->field[i].end, &value) == f->field[i].end)
      swc->column[index].value[swc->row_count - 1] = value;
    else
      swc_remark(swc, SWC_NOTE_COLUMN_TEXT, line);
  }
}

/* Room for one more row; the extra columns grow with the rows. */
static int add_row(conceg_swc *swc, const swc_row *row) {
  const size_t room = swc->row_room;
  size_t c, i;
  if (!swc_reserve(swc, (void **)&swc->row, &swc->row_room, swc->row_count + 1, sizeof *row)) return 0;
  for (c = 0; c < swc->column_count && swc->row_room > room; c++) {
    size_t column_room = room;
    if (!swc_reserve(swc, (void **)&swc->column[c].value, &column_room, swc->row_room, sizeof(double)))
      return 0;
    for (i = room; i < swc->row_room; i++)
      swc->column[c].value[i] = NAN;
  }
  swc->unsorted |= swc->row_count && swc->row[swc->row_count - 1].id > row->id;
  swc->row[swc->row_count++] = *row;
  return 1;
}

static void check_row(conceg_swc *swc, swc_row *row, int64_t kind, uint32_t line) {
  if (row->id < 0)
    swc_error(swc, line, "E_ID", "id: expected 0 or more, got %lld; renumber the samples",
              (long long)row->id);
  if (row->parent_id < -1) {
    swc_warn_strict(swc, line, "W_PARENT", "parent: expected -1 or an id, got %lld; read as a root",
                    (long long)row->parent_id);
    row->parent_id = -1;
  }
  if (kind > INT32_MAX)
    swc_error(swc, line, "E_ID", "type: expected at most 2147483647, got %lld", (long long)kind);
  else if (kind < 0 || kind >= 20)
    swc_remark(swc, SWC_NOTE_TYPE, line);
  row->kind = kind < 0 ? 0 : (int32_t)(kind & INT32_MAX);
  if (row->radius <= 0.0) swc_remark(swc, SWC_NOTE_RADIUS, line);
}

static void read_row(conceg_swc *swc, const char *text, const char *end, uint32_t line) {
  static const char *const axis_name[3] = {"x", "y", "z"};
  fields f;
  swc_row row;
  int64_t kind;
  int axis;
  split(text, end, &f);
  if (f.commas && (f.blanks || f.empty)) {
    swc_error(swc, line, "E_DELIM",
              "commas and blanks both separate columns, or a comma is a decimal point; "
              "write 7 columns with single spaces and decimal points");
    return;
  }
  if (f.commas && f.count > COLUMNS) {
    swc_error(swc, line, "E_DELIM",
              "more than 7 columns apart by commas: a comma may be a decimal point; "
              "write columns with single spaces and decimal points");
    return;
  }
  if (f.count < COLUMNS) {
    swc_error(swc, line, "E_COLUMNS", "expected 7 columns (id type x y z radius parent), got %d", f.count);
    return;
  }
  if (f.commas) swc_remark(swc, SWC_NOTE_DELIMITER, line);
  if (f.trailing) swc_remark(swc, SWC_NOTE_TRAILING, line);
  row.line = line;
  if (!read_whole(swc, &f.field[0], "id", line, &row.id) ||
      !read_whole(swc, &f.field[1], "type", line, &kind))
    return;
  for (axis = 0; axis < 3; axis++)
    if (!read_real(swc, &f.field[2 + axis], axis_name[axis], line, &row.position[axis])) return;
  if (!read_real(swc, &f.field[5], "radius", line, &row.radius)) return;
  if (!read_whole(swc, &f.field[6], "parent", line, &row.parent_id)) return;
  check_row(swc, &row, kind, line);
  if (!add_row(swc, &row)) return;
  if (f.count > COLUMNS) keep_extras(swc, &f, line);
  if (f.overflow)
    swc_warn(swc, line, "W_COLUMNS", "more than %d columns; those after are left out", MOST_COLUMNS);
}

static const char *skip_blanks(const char *p, const char *end) {
  while (p < end && is_blank(*p))
    p++;
  return p;
}

/* One field of the common row and the blanks after it; NULL when the careful way must look at it. */
static const char *plain_integer(const char *p, const char *end, int64_t *out) {
  const char *const next = swc_read_integer(p, end, out);
  return next && next < end && is_blank(*next) ? skip_blanks(next + 1, end) : NULL;
}
static const char *plain_double(const char *p, const char *end, double *out) {
  const char *const next = swc_read_double(p, end, out);
  return next && next < end && is_blank(*next) ? skip_blanks(next + 1, end) : NULL;
}

/* The common row, read without a look for the end of its line: seven fields apart by blanks and LF or CR LF.
 * Returns the start of the next line, or NULL when the careful way must look at it. */
static const char *read_plain_row(conceg_swc *swc, const char *p, const char *end, uint32_t line) {
  swc_row row;
  int64_t kind = 0;
  row.line = line;
  if (!(p = plain_integer(p, end, &row.id)) || !(p = plain_integer(p, end, &kind)) ||
      !(p = plain_double(p, end, &row.position[0])) || !(p = plain_double(p, end, &row.position[1])) ||
      !(p = plain_double(p, end, &row.position[2])) || !(p = plain_double(p, end, &row.radius)) ||
      !(p = swc_read_integer(p, end, &row.parent_id)))
    return NULL;
  p = skip_blanks(p, end);
  if (p < end && *p == '\r') p++;
  if (p == end || *p != '\n' || !isfinite(row.position[0] + row.position[1] + row.position[2] + row.radius))
    return NULL;
  check_row(swc, &row, kind, line);
  add_row(swc, &row);
  return p + 1;
}

static int starts_row(char c) {
  return is_digit(c) || c == '-' || c == '+' || c == '.' || c == ',';
}

static void read_line(conceg_swc *swc, swc_footer *footer, const char *text, const char *end, uint32_t line) {
  text = skip_blanks(text, end);
  while (text < end && is_blank(end[-1]))
    end--;
  if (text == end) return;
  if (*text == '#')
    swc_read_comment(swc, footer, text + 1, end, line);
  else if (starts_row(*text))
    read_row(swc, text, end, line);
  else if (swc->row_count)
    swc_error(swc, line, "E_PROSE", "expected a row of numbers, got text; start comments with #");
  else {
    swc_remark(swc, SWC_NOTE_PROSE, line);
    if (*text != '@') swc_read_comment(swc, footer, text, end, line);
  }
}

/* The end of a line: LF, CR LF or CR. NULL when the piece ends before it is known. */
static const char *line_end(const char *p, const char *end, int is_last) {
  const size_t length = (size_t)(end - p);
  const char *const feed = memchr(p, '\n', length), *const back =
                                                        memchr(p, '\r', feed ? (size_t)(feed - p) : length);
  p = back ? back : feed ? feed : end;
  return p < end - (p < end && *p == '\r') || is_last ? p : NULL;
}

static const char *read_any_line(swc_parser *parser, const char *p, const char *end, int is_last) {
  const char *const stop = line_end(p, end, is_last);
  if (!stop) return NULL;
  read_line(parser->swc, &parser->footer, p, stop, parser->line);
  if (stop == end) return end;
  if (*stop == '\n') return stop + 1;
  if (stop + 1 < end && stop[1] == '\n') return stop + 2;
  swc_remark(parser->swc, SWC_NOTE_EOL, parser->line);
  return stop + 1;
}

/* UTF-16 is refused, a byte order mark skipped. Returns the first byte to read. */
static const char *read_start(swc_parser *parser, const char *text, size_t length) {
  parser->started = 1;
  if (length >= 2 && (!memcmp(text, "\xff\xfe", 2) || !memcmp(text, "\xfe\xff", 2))) {
    swc_error(parser->swc, 1, "E_ENCODING", "the file is UTF-16; save it as UTF-8 or ASCII");
    parser->stopped = 1;
  }
  if (length < 3 || memcmp(text, "\xef\xbb\xbf", 3) != 0) return text;
  swc_warn(parser->swc, 1, "W_BOM", "the file starts with a UTF-8 byte order mark; skipped");
  return text + 3;
}

size_t swc_parse_piece(swc_parser *parser, const char *text, size_t length, int is_last) {
  conceg_swc *const swc = parser->swc;
  const char *const end = text + length, *p = text;
  if (!parser->started && length) p = read_start(parser, text, length);
  while (p < end && !swc->out_of_memory && !parser->stopped) {
    const char *const first = skip_blanks(p, end), *next = NULL;
    parser->line++;
    if (first < end && starts_row(*first)) next = read_plain_row(swc, first, end, parser->line);
    if (!next) next = read_any_line(parser, p, end, is_last);
    if (!next) {
      parser->line--;
      break;
    }
    p = next;
    if (swc->error_count >= MOST_LINE_ERRORS) {
      swc_error(swc, parser->line, "E_STOP", "reading stopped after %d errors", MOST_LINE_ERRORS);
      parser->stopped = 1;
    }
  }
  return (size_t)(p - text);
}

void swc_parse_end(swc_parser *parser) {
  conceg_swc *const swc = parser->swc;
  if (!swc->row_count && !swc->error_count)
    swc_error(swc, 0, "E_EMPTY", "the file has no samples (rows of 7 numbers)");
  if (!swc->error_count) swc_sort_rows(swc);
  if (!swc->error_count && !swc->out_of_memory) swc_apply_footer(swc, &parser->footer);
  swc_free_footer(&parser->footer);
}
