/* SPDX-License-Identifier: BSD-3-Clause
 * Arrays of strings in one block: the pointers, then the characters. */
#ifndef CONCEG_TEXTS_H
#define CONCEG_TEXTS_H

#include "store.h"

/* Copies `count` NUL-terminated strings. */
conceg_status texts_copy(struct budget *budget, const char *path, const char *const *strings, uint64_t count,
                         struct store *out);
/* Copies `count` strings of `width` bytes each, which end at their first NUL; with `trim` trailing spaces go
 * too. */
conceg_status texts_from_fixed(struct budget *budget, const char *path, const char *block, size_t width,
                               uint64_t count, int trim, struct store *out);
/* 1 if the bytes are well-formed UTF-8. */
int text_is_utf8(const char *text);

#endif
