/* SPDX-License-Identifier: BSD-3-Clause
 * SWC-plus writer (spec/swc-plus.md): seven plain columns that every reader accepts, exact values in comment
 * lines. */
#define _GNU_SOURCE
#include "partial.h"
#include "swc_internal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LARGEST_UM 1e12
#define SMALLEST_RADIUS_UM 1e-6

typedef struct writer {
  FILE *file;
  int failed;
  char buffer[1 << 16];
  size_t used;
} writer;

static void flush(writer *w) {
  if (w->used && fwrite(w->buffer, 1, w->used, w->file) != w->used) w->failed = 1;
  w->used = 0;
}
static void put(writer *w, const char *text, size_t length) {
  if (length > sizeof w->buffer - w->used) flush(w);
  if (length > sizeof w->buffer) {
    if (fwrite(text, 1, length, w->file) != length) w->failed = 1;
    return;
  }
  memcpy(w->buffer + w->used, text, length), w->used += length;
}
static void put_text(writer *w, const char *text) {
  put(w, text, strlen(text));
}
static void put_integer(writer *w, int64_t value) {
  char digits[24];
  put(w, digits, (size_t)snprintf(digits, sizeof digits, "%lld", (long long)value));
}
static void put_fixed(writer *w, double value) {
  char digits[48];
  put(w, " ", 1), put(w, digits, swc_write_fixed6(digits, value));
}
static void put_hex(writer *w, double value) {
  char digits[48];
  if (isfinite(value))
    put(w, " ", 1), put(w, digits, swc_write_hex(digits, value));
  else
    put(w, " -", 2);
}

static int is_name(const char *name) {
  const char *p;
  for (p = name; *p; p++)
    if (!((*p >= 'a' && *p <= 'z') || (*p >= 'A' && *p <= 'Z') || (*p >= '0' && *p <= '9') ||
          strchr("_.-@", *p)))
      return 0;
  return p > name;
}

/* Comment lines of the caller: one line of ASCII each, none that the block of exact values uses. */
static conceg_status check_lines(conceg_ctx *ctx, const char *path, const char *what,
                                 const char *const *lines) {
  uint32_t i;
  for (i = 0; lines && lines[i]; i++) {
    const char *p;
    for (p = lines[i]; *p; p++)
      if ((unsigned char)*p < 32 || (unsigned char)*p > 126)
        return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: %s[%u]: expected one line of ASCII, got byte %u",
                               path, what, i, (unsigned char)*p);
    if (!strncmp(lines[i], "@n ", 3) || !strncmp(lines[i], "@begin", 6) || !strncmp(lines[i], "@end", 4))
      return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: %s[%u]: '%.12s' opens a footer line; use another key",
                             path, what, i, lines[i]);
  }
  return CONCEG_OK;
}

static const char *const *footer_of(const conceg_swc_cell *cell) {
  return cell->size < offsetof(conceg_swc_cell, footer) + sizeof cell->footer ? NULL : cell->footer;
}

static conceg_status check_text(conceg_ctx *ctx, const char *path, const conceg_swc_cell *cell) {
  static const char *const taken[] = {"x", "y", "z", "radius"};
  conceg_status status = check_lines(ctx, path, "header", cell->header);
  uint32_t i, k;
  if (status == CONCEG_OK) status = check_lines(ctx, path, "footer", footer_of(cell));
  if (status != CONCEG_OK) return status;
  for (i = 0; i < cell->column_count; i++) {
    if (!is_name(cell->column_name[i]))
      return conceg_ctx_fail(ctx, CONCEG_E_PARAM,
                             "%s: column_name[%u]: expected letters, digits, _ . - @, got '%.40s'", path, i,
                             cell->column_name[i]);
    for (k = 0; k < 4; k++)
      if (!strcmp(cell->column_name[i], taken[k]))
        return conceg_ctx_fail(ctx, CONCEG_E_PARAM,
                               "%s: column_name[%u]: '%s' is written by itself; use another name", path, i,
                               taken[k]);
  }
  return CONCEG_OK;
}

static int fits(const double position[3]) {
  return fabs(position[0]) < LARGEST_UM && fabs(position[1]) < LARGEST_UM && fabs(position[2]) < LARGEST_UM;
}

static conceg_status check_samples(conceg_ctx *ctx, const char *path, const conceg_swc_cell *cell) {
  uint64_t i;
  if (!(cell->soma_radius >= 0.0 && cell->soma_radius < LARGEST_UM) || !fits(cell->soma) ||
      (cell->soma_radius > 0.0 && cell->soma_radius < SMALLEST_RADIUS_UM))
    return conceg_ctx_fail(ctx, CONCEG_E_RANGE,
                           "%s: soma: expected a finite centre and a radius of 0 or %g um and more, got %g",
                           path, SMALLEST_RADIUS_UM, cell->soma_radius);
  if (!cell->count && cell->soma_radius == 0.0)
    return conceg_ctx_fail(ctx, CONCEG_E_FORMAT, "%s: expected a soma or samples, got neither", path);
  for (i = 0; i < cell->count; i++) {
    const unsigned long long at = (unsigned long long)i;
    if (!fits(cell->position + 3 * i))
      return conceg_ctx_fail(ctx, CONCEG_E_RANGE, "%s: position[%llu]: expected finite numbers below %g um",
                             path, at, LARGEST_UM);
    if (!(cell->radius[i] >= SMALLEST_RADIUS_UM && cell->radius[i] < LARGEST_UM))
      return conceg_ctx_fail(ctx, CONCEG_E_RANGE, "%s: radius[%llu]: expected %g um or more, got %g", path,
                             at, SMALLEST_RADIUS_UM, cell->radius[i]);
    if (cell->parent[i] < CONCEG_SWC_FLOATING || cell->parent[i] >= (int64_t)i)
      return conceg_ctx_fail(ctx, CONCEG_E_FORMAT,
                             "%s: parent[%llu]: expected -1 or an earlier sample, got %lld", path, at,
                             (long long)cell->parent[i]);
    if (cell->kind[i] == CONCEG_SWC_SOMA ||
        (cell->kind[i] > CONCEG_SWC_APICAL && cell->kind[i] != CONCEG_SWC_GLIA))
      return conceg_ctx_fail(ctx, CONCEG_E_RANGE, "%s: kind[%llu]: expected 0, 2, 3, 4 or 7, got %u", path,
                             at, (unsigned)cell->kind[i]);
  }
  return CONCEG_OK;
}

/* Samples in preorder; children keep their order. `order` and the scratch arrays have `count` places. */
static void make_preorder(const conceg_swc_cell *cell, uint64_t *order, int64_t *last_child, int64_t *older,
                          int64_t *stack) {
  const int64_t count = (int64_t)cell->count;
  int64_t i, root = SWC_NONE, depth = 0;
  uint64_t done = 0;
  for (i = 0; i < count; i++)
    last_child[i] = SWC_NONE;
  /* Lists from the last to the first; the stack turns each round again. */
  for (i = 0; i < count; i++) {
    const int64_t up = cell->parent[i];
    if (up < 0)
      older[i] = root, root = i;
    else
      older[i] = last_child[up], last_child[up] = i;
  }
  for (i = root; i >= 0; i = older[i])
    stack[depth++] = i;
  while (depth) {
    const int64_t node = stack[--depth];
    order[done++] = (uint64_t)node;
    for (i = last_child[node]; i >= 0; i = older[i])
      stack[depth++] = i;
  }
}

static void write_row(writer *w, int64_t id, int kind, const double position[3], double radius,
                      int64_t parent) {
  int axis;
  put_integer(w, id), put(w, " ", 1), put_integer(w, kind);
  for (axis = 0; axis < 3; axis++)
    put_fixed(w, position[axis]);
  put_fixed(w, radius);
  put(w, " ", 1), put_integer(w, parent), put(w, "\n", 1);
}

static void write_exact(writer *w, const conceg_swc_cell *cell, int64_t id, const double position[3],
                        double radius, int64_t sample) {
  uint32_t c;
  int axis;
  put_text(w, "# @n "), put_integer(w, id);
  for (axis = 0; axis < 3; axis++)
    put_hex(w, position[axis]);
  put_hex(w, radius);
  for (c = 0; c < cell->column_count; c++)
    put_hex(w, sample < 0 ? NAN : cell->column[c][sample]);
  put(w, "\n", 1);
}

static void write_cell(writer *w, const conceg_swc_cell *cell, const uint64_t *order, int64_t *id) {
  const int64_t soma = cell->soma_radius > 0.0;
  uint64_t i;
  uint32_t c;
  put_text(w, "# SWC-plus 1.0 (ConCeG)\n");
  for (c = 0; cell->header && cell->header[c]; c++)
    put_text(w, "# "), put_text(w, cell->header[c]), put(w, "\n", 1);
  put_text(w, "# id type x y z radius parent\n");
  if (soma) write_row(w, 1, CONCEG_SWC_SOMA, cell->soma, cell->soma_radius, -1);
  for (i = 0; i < cell->count; i++) {
    const uint64_t node = order[i];
    const int64_t up = cell->parent[node];
    id[node] = (int64_t)i + 1 + soma;
    write_row(w, id[node], cell->kind[node], cell->position + 3 * node, cell->radius[node],
              up >= 0                             ? id[up]
              : soma && up != CONCEG_SWC_FLOATING ? 1
                                                  : -1);
  }
  put_text(w, "# @begin nodes columns=x,y,z,radius");
  for (c = 0; c < cell->column_count; c++)
    put(w, ",", 1), put_text(w, cell->column_name[c]);
  put(w, "\n", 1);
  if (soma) write_exact(w, cell, 1, cell->soma, cell->soma_radius, -1);
  for (i = 0; i < cell->count; i++)
    write_exact(w, cell, id[order[i]], cell->position + 3 * order[i], cell->radius[order[i]],
                (int64_t)order[i]);
  put_text(w, "# @end nodes\n");
  for (c = 0; footer_of(cell) && footer_of(cell)[c]; c++)
    put_text(w, "# "), put_text(w, footer_of(cell)[c]), put(w, "\n", 1);
}

/* A new file beside `path`, renamed onto it once it is whole. */
static conceg_status write_file(conceg_ctx *ctx, const char *path, const conceg_swc_cell *cell,
                                const uint64_t *order, int64_t *id, writer *w) {
  char folder[PATH_MAX], temporary[PATH_MAX];
  int handle, reason = 0;
  partial_folder_of(path, folder);
  handle = partial_new(folder, temporary);
  w->file = handle < 0 ? NULL : fdopen(handle, "wb");
  if (!w->file) {
    reason = errno;
    if (handle >= 0) close(handle), unlink(temporary);
    return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be written: %s", path, strerror(reason));
  }
  errno = 0;
  write_cell(w, cell, order, id);
  flush(w);
  if (fflush(w->file) != 0) w->failed = 1;
  if (w->failed || rename(temporary, path) != 0) { /* the lock is held until the file has its name */
    reason = errno ? errno : EIO;
    unlink(temporary);
  }
  if (fclose(w->file) != 0 && !reason) reason = errno ? errno : EIO;
  return reason ? conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be written: %s", path, strerror(reason))
                : CONCEG_OK;
}

conceg_status conceg_swc_write(conceg_ctx *ctx, const char *path, const conceg_swc_cell *cell) {
  conceg_status status;
  uint64_t *order;
  int64_t *scratch;
  writer *w;
  if (cell->size < offsetof(conceg_swc_cell, footer))
    return conceg_ctx_fail(ctx, CONCEG_E_ABI, "conceg_swc_write: expected size %zu, got %u", sizeof *cell,
                           cell->size);
  status = check_text(ctx, path, cell);
  if (status == CONCEG_OK) status = check_samples(ctx, path, cell);
  if (status != CONCEG_OK) return status;
  if (cell->count > SIZE_MAX / (4 * sizeof(int64_t)))
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
  order = calloc((size_t)cell->count + 1, sizeof *order);
  scratch = calloc((size_t)cell->count + 1, 3 * sizeof *scratch);
  w = calloc(1, sizeof *w);
  if (order && scratch && w) {
    make_preorder(cell, order, scratch, scratch + cell->count, scratch + 2 * cell->count);
    status = write_file(ctx, path, cell, order, scratch, w);
  } else
    status = conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
  free(order), free(scratch), free(w);
  return status;
}
