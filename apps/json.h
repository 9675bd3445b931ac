/* SPDX-License-Identifier: BSD-3-Clause
 * JSON text on standard output: commas and quotes are its business. */
#ifndef CONCEG_APPS_JSON_H
#define CONCEG_APPS_JSON_H

#include <stdint.h>

#define JSON_DEPTH 16

struct json {
  int depth;
  int filled[JSON_DEPTH]; /* 1 = a comma is due before the next entry */
};

/* `key` is NULL inside a list. */
void json_open(struct json *json, const char *key, char bracket);
void json_close(struct json *json, char bracket);
void json_text(struct json *json, const char *key, const char *value);
void json_number(struct json *json, const char *key, double value); /* null when not finite */
void json_whole(struct json *json, const char *key, uint64_t value);
void json_flag(struct json *json, const char *key, int value);

#endif
