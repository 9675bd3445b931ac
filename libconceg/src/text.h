/* SPDX-License-Identifier: BSD-3-Clause
 * A growing string. A failed allocation is remembered, so that callers check once, at the end. */
#ifndef CONCEG_SRC_TEXT_H
#define CONCEG_SRC_TEXT_H

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct text {
  char *data; /* NUL-terminated once something was added */
  size_t length, capacity;
  int failed;
};

static inline void text_add(struct text *text, const char *bytes, size_t count) {
  if (text->failed) return;
  if (text->capacity - text->length <= count) {
    const size_t capacity = (text->capacity + count + 64) * 2;
    char *data = realloc(text->data, capacity);
    if (!data) {
      text->failed = 1;
      return;
    }
    text->data = data, text->capacity = capacity;
  }
  if (count) memcpy(text->data + text->length, bytes, count);
  text->length += count;
  text->data[text->length] = '\0';
}

static inline void text_put(struct text *text, const char *string) {
  text_add(text, string, strlen(string));
}

static inline void text_format(struct text *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static inline void text_format(struct text *text, const char *format, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  text_put(text, line);
}

static inline void text_free(struct text *text) {
  free(text->data);
  memset(text, 0, sizeof *text);
}

static inline char *text_copy(const char *string, size_t length) {
  char *copy = malloc(length + 1);
  if (!copy) return NULL;
  if (length) memcpy(copy, string, length);
  copy[length] = '\0';
  return copy;
}

#endif
