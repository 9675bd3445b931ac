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

static void set_sphere(swc_sphere *soma, conceg_soma_form form, const double center[3], double radius) {
  soma->form = form;
  memcpy(soma->center, center, sizeof soma->center);
  soma->radius = radius > 0.0 ? radius : 0.0;
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

/* The centroid, the mean distance from it, and the vector area of the polygon (half the sum of its corners'
 * cross products). */
static double measure_outline(const conceg_swc *swc, const swc_index *member, size_t count, double center[3],
                              double area[3]) {
  double mean = 0.0;
  size_t i;
  int axis;
  memset(center, 0, 3 * sizeof *center), memset(area, 0, 3 * sizeof *area);
  for (i = 0; i < count; i++)
    for (axis = 0; axis < 3; axis++)
      center[axis] += swc->row[member[i]].position[axis] / (double)count;
  for (i = 0; i < count; i++) {
    const double *const p = swc->row[member[i]].position, *const q =
                                                              swc->row[member[(i + 1) % count]].position;
    for (axis = 0; axis < 3; axis++) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      area[axis] += 0.5 * ((p[u] - center[u]) * (q[v] - center[v]) - (p[v] - center[v]) * (q[u] - center[u]));
    }
    mean += distance(p, center) / (double)count;
  }
  return mean;
}

/* All samples within a tenth of the mean distance of one plane, which the outline encloses area of. */
static int is_flat(const conceg_swc *swc, const swc_index *member, size_t count, const double center[3],
                   const double area[3], double mean) {
  const double zero[3] = {0, 0, 0}, size = distance(area, zero);
  size_t i;
  if (!(size > 0.5 * mean * mean)) return 0;
  for (i = 0; i < count; i++) {
    const double *const p = swc->row[member[i]].position;
    const double height =
        ((p[0] - center[0]) * area[0] + (p[1] - center[1]) * area[1] + (p[2] - center[2]) * area[2]) / size;
    if (fabs(height) > 0.1 * mean) return 0;
  }
  return 1;
}

/* An outline: samples without a radius, or a flat chain of one radius whose ends are near each other. */
static int is_contour(const conceg_swc *swc, const swc_index *member, size_t count, int forked,
                      double center[3], double *mean_distance) {
  const swc_row *const first = &swc->row[member[0]];
  double area[3], length = 0.0;
  size_t i;
  int thin = 1;
  if (count < 3) return 0;
  for (i = 0; i < count; i++) {
    const swc_row *const row = &swc->row[member[i]];
    thin &= row->radius < 1e-6;
    if (fabs(row->radius - first->radius) > 1e-3) return 0;
    if (i) length += distance(row->position, swc->row[member[i - 1]].position);
  }
  *mean_distance = measure_outline(swc, member, count, center, area);
  if (thin) return 1;
  return count >= 5 && !forked && is_flat(swc, member, count, center, area, *mean_distance) &&
         distance(first->position, swc->row[member[count - 1]].position) <=
             1.5 * length / (double)(count - 1) + 0.1 * *mean_distance;
}

/* The largest sample when it holds all other centres, else the sphere with the area of the frusta. */
static void set_from_chain(const conceg_swc *swc, const swc_index *member, size_t count,
                           conceg_soma_form form, swc_sphere *soma) {
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
    const swc_index up = swc->parent[member[i]];
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
    set_sphere(soma, form, largest->position, largest->radius);
    return;
  }
  for (axis = 0; axis < 3; axis++)
    center[axis] /= area;
  set_sphere(soma, form, center, sqrt(area / (4.0 * pi)));
}

static int soma_children(const conceg_swc *swc, swc_index row) {
  int count = 0;
  swc_index child;
  for (child = swc->first_child[row]; child >= 0; child = swc->next_sibling[child])
    count += swc->is_soma[child];
  return count;
}

static void find_soma(conceg_swc *swc, const swc_index *member, size_t count, swc_sphere *soma) {
  const swc_row *const first = &swc->row[member[0]];
  double center[3], mean_distance = 0.0;
  size_t i;
  int forked = 0;
  for (i = 0; i < count; i++)
    forked |= soma_children(swc, member[i]) > (swc->parent[member[i]] < 0 ? 2 : 1);
  if (count == 1)
    set_sphere(soma, CONCEG_SOMA_POINT, first->position, first->radius);
  else if (is_contour(swc, member, count, forked, center, &mean_distance)) {
    set_sphere(soma, CONCEG_SOMA_CONTOUR, center, mean_distance);
    swc_warn(swc, first->line, "W_SOMA_FORM",
             "the soma is an outline of %zu points; read as a sphere of radius %.3g um", count,
             mean_distance);
  } else if (count == 3 && swc->parent[member[1]] == member[0] && swc->parent[member[2]] == member[0]) {
    if (!is_three_point(first, &swc->row[member[1]], &swc->row[member[2]]))
      swc_warn(swc, first->line, "W_SOMA_FORM",
               "three-point soma whose 2nd and 3rd samples are not one radius away on opposite sides; read "
               "as the first sample's sphere");
    set_sphere(soma, CONCEG_SOMA_THREE_POINT, first->position, first->radius);
  } else if (forked) {
    set_from_chain(swc, member, count, CONCEG_SOMA_TREE, soma);
    swc_warn(swc, first->line, "W_SOMA_FORM", "the soma forks; read as a sphere of radius %.3g um",
             soma->radius);
  } else
    set_from_chain(swc, member, count, CONCEG_SOMA_CHAIN, soma);
}

void swc_find_somas(conceg_swc *swc) {
  uint32_t k;
  swc->soma = swc_alloc(swc, swc->cell_count, sizeof *swc->soma);
  for (k = 0; k < swc->soma_count && swc->soma; k++)
    find_soma(swc, swc->soma_row + swc->soma_first[k], (size_t)(swc->soma_first[k + 1] - swc->soma_first[k]),
              &swc->soma[k]);
}
