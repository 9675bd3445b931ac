/* SPDX-License-Identifier: BSD-3-Clause
 * Arrays of strings in one block: the pointers, then the characters. */
#define _POSIX_C_SOURCE 200809L
#include "texts.h"

#include <string.h>

conceg_status texts_copy(struct budget *budget, const char *path, const char *const *strings, uint64_t count,
                         struct store *out) {
  uint64_t bytes = count * sizeof(char *);
  for (uint64_t i = 0; i < count; i++)
    bytes += strlen(strings[i]) + 1;
  const conceg_status status = store_new(budget, path, bytes, out);
  if (status != CONCEG_OK) return status;
  char **pointers = out->data;
  char *at = (char *)out->data + count * sizeof(char *);
  for (uint64_t i = 0; i < count; i++) {
    const size_t length = strlen(strings[i]) + 1;
    memcpy(at, strings[i], length);
    pointers[i] = at;
    at += length;
  }
  return CONCEG_OK;
}

static size_t fixed_length(const char *text, size_t width, int trim) {
  size_t length = strnlen(text, width);
  while (trim && length && text[length - 1] == ' ')
    length--;
  return length;
}

conceg_status texts_from_fixed(struct budget *budget, const char *path, const char *block, size_t width,
                               uint64_t count, int trim, struct store *out) {
  uint64_t bytes = count * sizeof(char *);
  for (uint64_t i = 0; i < count; i++)
    bytes += fixed_length(block + i * width, width, trim) + 1;
  const conceg_status status = store_new(budget, path, bytes, out);
  if (status != CONCEG_OK) return status;
  char **pointers = out->data;
  char *at = (char *)out->data + count * sizeof(char *);
  for (uint64_t i = 0; i < count; i++) {
    const size_t length = fixed_length(block + i * width, width, trim);
    memcpy(at, block + i * width, length); /* the store is zeroed, so the NUL is there */
    pointers[i] = at;
    at += length + 1;
  }
  return CONCEG_OK;
}

/* Length of the UTF-8 sequence at `p`; 0 when it is malformed. */
static int sequence_length(const unsigned char *p) {
  if (p[0] < 0x80) return 1;
  if (p[0] < 0xc2 || p[0] > 0xf4) return 0;
  const int length = p[0] < 0xe0 ? 2 : p[0] < 0xf0 ? 3 : 4;
  for (int i = 1; i < length; i++)
    if ((p[i] & 0xc0) != 0x80) return 0;
  if (p[0] == 0xe0 && p[1] < 0xa0) return 0;
  if (p[0] == 0xed && p[1] > 0x9f) return 0; /* surrogates */
  if (p[0] == 0xf0 && p[1] < 0x90) return 0;
  if (p[0] == 0xf4 && p[1] > 0x8f) return 0;
  return length;
}

int text_is_utf8(const char *text) {
  const unsigned char *p = (const unsigned char *)text;
  while (*p) {
    const int length = sequence_length(p);
    if (!length) return 0;
    p += length;
  }
  return 1;
}
