// SPDX-License-Identifier: BSD-3-Clause
// WIDE functions use wider registers where the machine has them; the same bits, as nothing is contracted.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&     \
    !defined(__SANITIZE_THREAD__)
#define WIDE __attribute__((target_clones("avx2", "default")))
#else
#define WIDE
#endif
