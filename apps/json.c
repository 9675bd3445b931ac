/* SPDX-License-Identifier: BSD-3-Clause
 * JSON text on standard output. */
#include "json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void put_text(const char *text) {
  putchar('"');
  for (; *text; text++) {
    const unsigned char c = (unsigned char)*text;
    if (c == '"' || c == '\\')
      printf("\\%c", c);
    else if (c < 0x20)
      printf("\\u%04x", c);
    else
      putchar(c);
  }
  putchar('"');
}

static void begin(struct json *json, const char *key) {
  if (json->filled[json->depth]) putchar(',');
  json->filled[json->depth] = 1;
  if (!key) return;
  put_text(key);
  putchar(':');
}

void json_open(struct json *json, const char *key, char bracket) {
  begin(json, key);
  putchar(bracket);
  if (json->depth + 1 == JSON_DEPTH) abort(); /* the programs nest a few levels, by hand */
  json->filled[++json->depth] = 0;
}

void json_close(struct json *json, char bracket) {
  putchar(bracket);
  if (--json->depth == 0) putchar('\n');
}

void json_text(struct json *json, const char *key, const char *value) {
  begin(json, key);
  put_text(value);
}

void json_number(struct json *json, const char *key, double value) {
  begin(json, key);
  if (isfinite(value))
    printf("%.17g", value);
  else
    fputs("null", stdout);
}

void json_whole(struct json *json, const char *key, uint64_t value) {
  begin(json, key);
  printf("%llu", (unsigned long long)value);
}

void json_flag(struct json *json, const char *key, int value) {
  begin(json, key);
  fputs(value ? "true" : "false", stdout);
}
