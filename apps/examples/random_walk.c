/* SPDX-License-Identifier: BSD-3-Clause
 * A random walk of water in a meshed document, through libconceg and libconceg_query alone.
 *
 *   random_walk FILE [WALKERS [STEPS]]
 *
 * Seeds WALKERS in the cells and as many in the extracellular space, lets each make STEPS steps that the
 * surfaces reflect, and prints for each compartment the mean squared displacement, the apparent diffusivity,
 * and the leaks: walkers that end in another cell than they began in. Surfaces are impermeable, so that a
 * leak is a fault of the mesh or of the walk. Exit code: 0 without leaks, 1 with some, 2 on errors. */
#include <conceg/conceg.h>
#include <conceg/query.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIFFUSIVITY 2.0 /* um2/ms, free water in tissue at body temperature is about this */
#define STEP_MS 0.04
/* A walker never comes nearer to a face than this (um), measured across the face. It is large against the
 * rounding of the hits (1e-12 um) and small against a step (0.7 um). */
#define CLEARANCE 1e-6
#define MOST_BOUNCES                                                                                         \
  200 /* in one step; what is left of the step is given up, which corners alone make happen */

typedef struct walkers {
  uint64_t count;
  double *start, *now; /* [count][3], um, never wrapped: the queries take any image */
  int64_t *cell;       /* [count], where they began; -1 = extracellular */
  uint8_t *compartment;
  conceg_rng *rng; /* [count], each its own stream, so that the walk does not depend on the order */
} walkers;

/* One batch of rays: the walkers that have still some way to go in this step. */
typedef struct batch {
  uint64_t count;
  uint64_t *walker;
  double *origin, *direction, *length, *asked; /* `asked`: the length and a little beyond */
  conceg_hit *hit;
} batch;

static int fail(const char *what, conceg_status status) {
  fprintf(stderr, "random_walk: %s: %s\n", what, conceg_status_text(status));
  exit(2);
}

static void *allocate(uint64_t count, size_t size) {
  void *memory = calloc(count ? count : 1, size);
  if (!memory) fail("allocating", CONCEG_E_NOMEM);
  return memory;
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Draws points in the box until both groups are full: the cells' walkers first, then those outside. Returns
 * how many points were drawn, and how many of them lay in cells. */
static uint64_t seed(const conceg_substrate *substrate, const conceg_query *query, walkers *all,
                     uint64_t each, uint64_t *inside) {
  double lo[3], hi[3], point[3];
  uint8_t periodic[3], compartment;
  int64_t cell;
  uint64_t drawn = 0, in_cells = 0, outside = 0;
  conceg_rng rng = conceg_rng_stream(1, "random_walk.seed", 0);
  conceg_substrate_box(substrate, lo, hi, periodic);
  for (int axis = 0; axis < 3; axis++)
    if (!periodic[axis])
      fprintf(stderr, "random_walk: axis %d is open: walkers may leave the box along it\n", axis);
  for (*inside = 0; in_cells < each || outside < each; drawn++) {
    if (drawn > 10000 * (each + 100))
      fail("seeding: the tissue is all cells, or all extracellular", CONCEG_E_RANGE);
    for (int axis = 0; axis < 3; axis++)
      point[axis] = lo[axis] + (hi[axis] - lo[axis]) * conceg_rng_uniform(&rng);
    const conceg_status status = conceg_query_locate(query, 1, point, &cell, &compartment);
    if (status != CONCEG_OK) fail("locate", status);
    *inside += cell >= 0;
    const uint64_t i = cell >= 0 ? in_cells : each + outside;
    if (cell >= 0 ? in_cells == each : outside == each) continue;
    *(cell >= 0 ? &in_cells : &outside) += 1;
    memcpy(all->start + 3 * i, point, sizeof point);
    memcpy(all->now + 3 * i, point, sizeof point);
    all->cell[i] = cell, all->compartment[i] = compartment;
    all->rng[i] = conceg_rng_stream(1, "random_walk.steps", i);
  }
  return drawn;
}

/* Gives every walker a step of one length in a random direction. */
static void start_step(walkers *all, batch *rays, double step) {
  rays->count = all->count;
  for (uint64_t i = 0; i < all->count; i++) {
    double *d = rays->direction + 3 * i, sine, cosine;
    const double z = 2 * conceg_rng_uniform(&all->rng[i]) - 1, across = sqrt(1 - z * z);
    conceg_sincos(6.283185307179586 * conceg_rng_uniform(&all->rng[i]), &sine, &cosine);
    d[0] = across * cosine, d[1] = across * sine, d[2] = z;
    rays->walker[i] = i;
    rays->length[i] = step;
    memcpy(rays->origin + 3 * i, all->now + 3 * i, 3 * sizeof(double));
  }
}

/* Moves the walker of ray `from` to the hit or to the end of its step. A walker that was reflected goes on as
 * ray `to` with what is left; returns 1 then, else 0. */
static int move(walkers *all, batch *rays, uint64_t from, uint64_t to) {
  const conceg_hit *hit = &rays->hit[from];
  const double *origin = rays->origin + 3 * from;
  double d[3], length = rays->length[from], go = length, across = 0;
  memcpy(d, rays->direction + 3 * from, sizeof d);
  int reflected = 0;
  if (hit->cell >= 0) {
    /* Stop short of the face by the clearance; if the step ends before that, the face does not matter. */
    across = dot(hit->normal, d);
    const double stop = hit->distance - CLEARANCE / fmax(fabs(across), 1e-3);
    if (stop < length) reflected = 1, go = fmax(stop, 0);
  }
  double *now = all->now + 3 * rays->walker[from];
  for (int axis = 0; axis < 3; axis++)
    now[axis] = origin[axis] + go * d[axis];
  if (!reflected || go >= length) return 0;
  for (int axis = 0; axis < 3; axis++) {
    rays->direction[3 * to + (uint64_t)axis] = d[axis] - 2 * across * hit->normal[axis];
    rays->origin[3 * to + (uint64_t)axis] = now[axis];
  }
  const double norm = sqrt(dot(rays->direction + 3 * to, rays->direction + 3 * to));
  for (int axis = 0; axis < 3; axis++)
    rays->direction[3 * to + (uint64_t)axis] /= norm;
  rays->length[to] = length - go;
  rays->walker[to] = rays->walker[from];
  return 1;
}

/* One step of all walkers: a batch of rays, then a batch of those that were reflected, until none is left. */
static void step_all(const conceg_query *query, walkers *all, batch *rays, double step) {
  start_step(all, rays, step);
  for (int bounce = 0; rays->count && bounce < MOST_BOUNCES; bounce++) {
    uint64_t left = 0;
    /* Look beyond the step, so that a walker does not end too near to a face that it does not hit. */
    for (uint64_t i = 0; i < rays->count; i++)
      rays->asked[i] = rays->length[i] + 1000 * CLEARANCE;
    const conceg_status status =
        conceg_query_intersect(query, rays->count, rays->origin, rays->direction, rays->asked, rays->hit);
    if (status != CONCEG_OK) fail("intersect", status);
    for (uint64_t i = 0; i < rays->count; i++)
      left += (uint64_t)move(all, rays, i, left);
    rays->count = left;
  }
}

/* A line for the walkers that began in one compartment; returns their leaks. */
static uint64_t report(const walkers *all, const int64_t *end, uint32_t compartment, double time) {
  double sum = 0;
  uint64_t count = 0, leaks = 0;
  for (uint64_t i = 0; i < all->count; i++) {
    if (all->compartment[i] != compartment) continue;
    for (int axis = 0; axis < 3; axis++) {
      const double moved = all->now[3 * i + (uint64_t)axis] - all->start[3 * i + (uint64_t)axis];
      sum += moved * moved;
    }
    count++, leaks += end[i] != all->cell[i];
  }
  if (!count) return 0;
  const char *name = conceg_compartment_name(compartment);
  printf("%s: walkers %llu, msd %.3f um2, diffusivity %.4f um2/ms, leaks %llu\n", name ? name : "other",
         (unsigned long long)count, sum / (double)count, sum / (double)count / (6 * time),
         (unsigned long long)leaks);
  return leaks;
}

int main(int argc, char **argv) {
  if (argc < 2 || argc > 4) {
    fprintf(stderr, "usage: random_walk FILE [WALKERS [STEPS]]\n");
    return 2;
  }
  const uint64_t each = argc > 2 ? strtoull(argv[2], NULL, 10) : 1000,
                 steps = argc > 3 ? strtoull(argv[3], NULL, 10) : 250;
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_substrate *substrate = NULL;
  conceg_query *query = NULL;
  conceg_status status = ctx ? conceg_substrate_open_file(ctx, argv[1], &substrate) : CONCEG_E_NOMEM;
  if (status == CONCEG_OK) status = conceg_query_new(ctx, substrate, &query);
  if (status != CONCEG_OK) fail(ctx ? conceg_ctx_error(ctx) : "starting", status);

  const uint64_t count = 2 * each;
  walkers all = {count,
                 allocate(3 * count, sizeof(double)),
                 allocate(3 * count, sizeof(double)),
                 allocate(count, sizeof(int64_t)),
                 allocate(count, 1),
                 allocate(count, sizeof(conceg_rng))};
  batch rays = {0,
                allocate(count, sizeof(uint64_t)),
                allocate(3 * count, sizeof(double)),
                allocate(3 * count, sizeof(double)),
                allocate(count, sizeof(double)),
                allocate(count, sizeof(double)),
                allocate(count, sizeof(conceg_hit))};
  uint64_t inside = 0;
  const uint64_t drawn = seed(substrate, query, &all, each, &inside);
  const double fraction = (double)inside / (double)drawn;
  printf("seeds: %llu drawn, intracellular fraction %.4f +- %.4f\n", (unsigned long long)drawn, fraction,
         sqrt(fraction * (1 - fraction) / (double)drawn));

  const double time = (double)steps * STEP_MS;
  for (uint64_t i = 0; i < steps; i++)
    step_all(query, &all, &rays, sqrt(6 * DIFFUSIVITY * STEP_MS));

  int64_t *end = allocate(count, sizeof *end);
  status = conceg_query_locate(query, count, all.now, end, NULL);
  if (status != CONCEG_OK) fail("locate", status);
  printf("walk: %llu steps, %g ms, free diffusivity %g um2/ms\n", (unsigned long long)steps, time,
         DIFFUSIVITY);
  uint64_t leaks = 0;
  for (uint32_t compartment = 0; compartment < 256; compartment++)
    leaks += report(&all, end, compartment, time);
  printf("leaks %llu of %llu\n", (unsigned long long)leaks, (unsigned long long)count);

  void *const arrays[] = {all.start,   all.now,        all.cell,    all.compartment, all.rng,  rays.walker,
                          rays.origin, rays.direction, rays.length, rays.asked,      rays.hit, end};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
    free(arrays[i]);
  conceg_query_free(query); /* before the substrate, which it borrows */
  conceg_substrate_free(substrate);
  conceg_ctx_free(ctx);
  return leaks ? 1 : 0;
}
