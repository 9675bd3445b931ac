/* SPDX-License-Identifier: BSD-3-Clause
 * The soma of an SWC file as a sphere, whichever way it was drawn. */
#include "swc_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double distance(const double a[3], const double b[3]) {
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return sqrt(x * x + y * y + z * z);
}

static void set_sphere(conceg_swc *swc, conceg_soma_form form, const double center[3], double radius) {
  swc->soma_form = form;
  memcpy(swc->soma_center, center, sizeof swc->soma_center);
  swc->soma_radius = radius > 0.0 ? radius : 0.0;
}

/* NeuroMorpho's form: two children of the first sample, one radius away on opposite sides. */
static int is_three_point(const swc_row *a, const swc_row *b, const swc_row *c) {
  const double tolerance = 0.01 * a->radius + 0.01;
  double middle[3];
  int axis;
  for (axis = 0; axis < 3; axis++)
    middle[axis] = 0.5 * (b->position[axis] + c->position[axis]);
  return fabs(a->radius - b->radius) <= tolerance && fabs(a->radius - c->radius) <= tolerance &&
         distance(middle, a->position) <= tolerance &&
         fabs(distance(b->position, a->position) - a->radius) <= tolerance;
}

/* An outline traced as a chain: flat, of constant or no radius, and its ends near each other. */
static int is_contour(const conceg_swc *swc, const int64_t *member, size_t count, double center[3],
                      double *mean_distance) {
  double thickness[3][2], length = 0.0;
  size_t i;
  int axis, flat = 0;
  const swc_row *const first = &swc->row[member[0]];
  if (count < 5) return 0;
  memset(center, 0, 3 * sizeof *center);
  for (i = 0; i < count; i++) {
    const swc_row *const row = &swc->row[member[i]];
    if (fabs(row->radius - first->radius) > 1e-3) return 0;
    for (axis = 0; axis < 3; axis++) {
      const double x = row->position[axis];
      center[axis] += x / (double)count;
      if (i == 0 || x < thickness[axis][0]) thickness[axis][0] = x;
      if (i == 0 || x > thickness[axis][1]) thickness[axis][1] = x;
    }
    if (i) length += distance(row->position, swc->row[member[i - 1]].position);
  }
  for (*mean_distance = 0.0, i = 0; i < count; i++)
    *mean_distance += distance(swc->row[member[i]].position, center) / (double)count;
  for (axis = 0; axis < 3; axis++)
    flat |= thickness[axis][1] - thickness[axis][0] <= 0.2 * *mean_distance;
  return flat && length > 3.0 * *mean_distance &&
         distance(first->position, swc->row[member[count - 1]].position) <=
             1.5 * length / (double)(count - 1) + 0.1 * *mean_distance;
}

/* The largest sample when it holds all other centres, else the sphere with the area of the frusta. */
static void set_from_chain(conceg_swc *swc, const int64_t *member, size_t count, conceg_soma_form form) {
  const double pi = 3.14159265358979323846;
  const swc_row *largest = &swc->row[member[0]];
  double center[3] = {0, 0, 0}, area = 0.0;
  size_t i;
  int axis, inside = 1;
  for (i = 1; i < count; i++)
    if (swc->row[member[i]].radius > largest->radius) largest = &swc->row[member[i]];
  for (i = 0; i < count; i++)
    inside &= distance(swc->row[member[i]].position, largest->position) <= 1.1 * largest->radius;
  for (i = 0; i < count && !inside; i++) {
    const int64_t up = swc->parent[member[i]];
    const swc_row *const b = &swc->row[member[i]], *a;
    double h, lateral;
    if (up < 0) continue;
    a = &swc->row[up], h = distance(a->position, b->position);
    lateral = pi * (a->radius + b->radius) * sqrt((a->radius - b->radius) * (a->radius - b->radius) + h * h);
    area += lateral;
    for (axis = 0; axis < 3; axis++)
      center[axis] += 0.5 * lateral * (a->position[axis] + b->position[axis]);
  }
  if (inside || !(area > 0.0)) {
    set_sphere(swc, form, largest->position, largest->radius);
    return;
  }
  for (axis = 0; axis < 3; axis++)
    center[axis] /= area;
  set_sphere(swc, form, center, sqrt(area / (4.0 * pi)));
}

static int soma_children(const conceg_swc *swc, int64_t row) {
  int count = 0;
  int64_t child;
  for (child = swc->first_child[row]; child >= 0; child = swc->next_sibling[child])
    count += swc->is_soma[child];
  return count;
}

void swc_find_soma(conceg_swc *swc) {
  int64_t *member = swc_alloc(swc, swc->row_count, sizeof *member);
  double center[3], mean_distance = 0.0;
  size_t count = 0, i;
  int forked = 0;
  const swc_row *first;
  if (!member) return;
  for (i = 0; i < swc->row_count; i++)
    if (swc->is_soma[i]) member[count++] = (int64_t)i;
  if (!count) {
    free(member);
    return;
  }
  first = &swc->row[member[0]];
  for (i = 0; i < count; i++)
    forked |= soma_children(swc, member[i]) > (swc->parent[member[i]] < 0 ? 2 : 1);
  if (count == 1)
    set_sphere(swc, CONCEG_SOMA_POINT, first->position, first->radius);
  else if (count == 3 && swc->parent[member[1]] == member[0] && swc->parent[member[2]] == member[0]) {
    if (!is_three_point(first, &swc->row[member[1]], &swc->row[member[2]]))
      swc_warn(swc, first->line, "W_SOMA_FORM",
               "three-point soma whose 2nd and 3rd samples are not one radius away on opposite sides; read "
               "as the first sample's sphere");
    set_sphere(swc, CONCEG_SOMA_THREE_POINT, first->position, first->radius);
  } else if (forked) {
    set_from_chain(swc, member, count, CONCEG_SOMA_TREE);
    swc_warn(swc, first->line, "W_SOMA_FORM", "the soma forks; read as a sphere of radius %.3g um",
             swc->soma_radius);
  } else if (is_contour(swc, member, count, center, &mean_distance)) {
    set_sphere(swc, CONCEG_SOMA_CONTOUR, center, mean_distance);
    swc_warn(swc, first->line, "W_SOMA_FORM",
             "the soma is an outline of %zu points; read as a sphere of radius %.3g um", count,
             mean_distance);
  } else
    set_from_chain(swc, member, count, CONCEG_SOMA_CHAIN);
  free(member);
}
