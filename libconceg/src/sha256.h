/* SPDX-License-Identifier: BSD-3-Clause
 * SHA-256 (FIPS 180-4). */
#ifndef CONCEG_SHA256_H
#define CONCEG_SHA256_H

#include <stddef.h>
#include <stdint.h>

struct sha256 {
  uint32_t state[8];
  uint64_t bytes;
  uint8_t pending[64];
};

void sha256_start(struct sha256 *hash);
void sha256_add(struct sha256 *hash, const void *bytes, size_t count);
void sha256_end(struct sha256 *hash, uint8_t digest[32]);
void sha256_hex(const uint8_t digest[32], char hex[65]);
/* Which code runs: 1 = the portable one alone (for tests). */
void sha256_force_portable(int on);

#endif
