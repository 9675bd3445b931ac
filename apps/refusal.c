/* SPDX-License-Identifier: BSD-3-Clause
 * From "FILE: /path: expected X, got Y (CGX-001)" to a rule, a path, what was expected and got. */
#define _POSIX_C_SOURCE 200809L
#include "refusal.h"

#include <stdio.h>
#include <string.h>

static void take(char *out, size_t size, const char *text, size_t length) {
  snprintf(out, size, "%.*s", (int)length, text);
}

conceg_problem refusal_problem(const char *line, const char *name, struct refusal *out) {
  const size_t skip = strlen(name);
  if (strncmp(line, name, skip) == 0) line += skip;
  line += strspn(line, ": ");
  const char *rule = strstr(line, "(CGX-"), *expected = strstr(line, "expected "),
             *got = expected ? strstr(expected, ", got ") : NULL;
  size_t length = rule ? (size_t)(rule - line) : strlen(line);
  while (length && line[length - 1] == ' ')
    length--;
  /* A file that HDF5 cannot read at all has no other rule. */
  take(out->rule, sizeof out->rule, rule ? rule + 1 : "CGX-001", 7);
  take(out->path, sizeof out->path, *line == '/' ? line : "/", *line == '/' ? strcspn(line, ": ") : 1);
  if (got && got < line + length) {
    take(out->expected, sizeof out->expected, expected + 9, (size_t)(got - expected) - 9);
    take(out->got, sizeof out->got, got + 6, (size_t)(line + length - got) - 6);
  } else {
    take(out->expected, sizeof out->expected, "a document that can be read", 64);
    take(out->got, sizeof out->got, line, length);
  }
  return (conceg_problem){.size = sizeof(conceg_problem),
                          .rule = out->rule,
                          .path = out->path,
                          .expected = out->expected,
                          .got = out->got};
}
