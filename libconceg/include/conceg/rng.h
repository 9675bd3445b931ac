/* SPDX-License-Identifier: BSD-3-Clause
 * Counter-based random numbers (Philox4x32-10, Salmon et al., SC 2011): draw = f(seed, stage, id, counter).
 * No state is shared, so results do not depend on threads, on order, or on a neighbour's draws. Header-only;
 * any thread. */
#ifndef CONCEG_RNG_H
#define CONCEG_RNG_H

#include "conceg/portable.h"

#include <stdint.h>

typedef struct conceg_rng {
  uint32_t key[2];
  uint32_t id[2];
  uint64_t counter; /* next draw; may be set to jump */
} conceg_rng;

/* A one-to-one scrambling of 64 bits. */
static inline uint64_t conceg_rng_mix(uint64_t x) {
  /* SplitMix64 finaliser: spreads small seeds and stage numbers over the key. */
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/* FNV-1a of a name, to turn "grow" into a stage number. */
static inline uint64_t conceg_rng_name(const char *name) {
  uint64_t hash = 0xcbf29ce484222325ull;
  for (; *name; name++)
    hash = (hash ^ (uint8_t)*name) * 0x100000001b3ull;
  return hash;
}

/* A stream: `stage` separates uses ("grow", "place.soma"), `id` is a stable cell, block or bar number. */
static inline conceg_rng conceg_rng_stream(uint64_t seed, const char *stage, uint64_t id) {
  const uint64_t key = conceg_rng_mix(seed ^ conceg_rng_mix(conceg_rng_name(stage)));
  conceg_rng rng;
  rng.key[0] = (uint32_t)key, rng.key[1] = (uint32_t)(key >> 32);
  rng.id[0] = (uint32_t)id, rng.id[1] = (uint32_t)(id >> 32);
  rng.counter = 0;
  return rng;
}

/* The next 64 random bits; counts one draw. */
static inline uint64_t conceg_rng_u64(conceg_rng *rng) {
  uint32_t c0 = (uint32_t)rng->counter, c1 = (uint32_t)(rng->counter >> 32), c2 = rng->id[0], c3 = rng->id[1];
  uint32_t k0 = rng->key[0], k1 = rng->key[1];
  int round;
  rng->counter++;
  for (round = 0; round < 10; round++) {
    const uint64_t p0 = (uint64_t)0xD2511F53u * c0, p1 = (uint64_t)0xCD9E8D57u * c2;
    c0 = (uint32_t)(p1 >> 32) ^ c1 ^ k0;
    c1 = (uint32_t)p1;
    c2 = (uint32_t)(p0 >> 32) ^ c3 ^ k1;
    c3 = (uint32_t)p0;
    k0 += 0x9E3779B9u, k1 += 0xBB67AE85u;
  }
  return ((uint64_t)c1 << 32) | c0;
}

/* Uniform in [0, 1), 53 bits. */
static inline double conceg_rng_uniform(conceg_rng *rng) {
  return (double)(conceg_rng_u64(rng) >> 11) * 0x1p-53;
}

/* Uniform integer in [0, n), n > 0, without bias that matters (64-bit multiply). */
static inline uint64_t conceg_rng_below(conceg_rng *rng, uint64_t n) {
  __extension__ typedef unsigned __int128 wide;
  return (uint64_t)(((wide)conceg_rng_u64(rng) * n) >> 64);
}

/* Standard normal (Box-Muller, two draws). */
static inline double conceg_rng_normal(conceg_rng *rng) {
  const double u = 1.0 - conceg_rng_uniform(rng), v = conceg_rng_uniform(rng);
  return __builtin_sqrt(-2.0 * conceg_log(u)) * conceg_cos(6.283185307179586476925 * v);
}

/* Exponential with mean 1. */
static inline double conceg_rng_exponential(conceg_rng *rng) {
  return -conceg_log(1.0 - conceg_rng_uniform(rng));
}

#endif
