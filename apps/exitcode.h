/* SPDX-License-Identifier: BSD-3-Clause
 * Exit codes of every ConCeG program (spec/cli.md). */
#ifndef CONCEG_APPS_EXITCODE_H
#define CONCEG_APPS_EXITCODE_H

#include "conceg/base.h"

/* Name, number, meaning: the one table for programs, pages and spec/cli.md. */
#define CONCEG_EXIT_CODES(X)                                                                                 \
  X(EXIT_OK, 0, "done")                                                                                      \
  X(EXIT_STAGE, 1, "a stage failed, diff found differences, or a gate of check failed")                      \
  X(EXIT_USAGE, 2, "wrong command line, recipe key or value")                                                \
  X(EXIT_INPUT, 3, "the input document, or the recipe's YAML, is invalid; a group is missing")               \
  X(EXIT_IO, 4, "input or output failed: no such file, disk full, closed pipe")                              \
  X(EXIT_MISSING, 5, "a stage, plugin or library is missing or of another ABI")                              \
  X(EXIT_CANCELLED, 6, "cancelled")

enum {
#define CONCEG_EXIT_ROW(name, number, meaning) name = number,
  CONCEG_EXIT_CODES(CONCEG_EXIT_ROW)
#undef CONCEG_EXIT_ROW
};

static inline int exit_code(conceg_status status) {
  switch (status) {
  case CONCEG_OK:
    return EXIT_OK;
  case CONCEG_E_USAGE:
  case CONCEG_E_PARAM:
    return EXIT_USAGE;
  case CONCEG_E_FORMAT:
  case CONCEG_E_VERSION:
  case CONCEG_E_MISSING:
  case CONCEG_E_RANGE:
    return EXIT_INPUT;
  case CONCEG_E_IO:
    return EXIT_IO;
  case CONCEG_E_ABI:
  case CONCEG_E_UNSUPPORTED:
    return EXIT_MISSING;
  case CONCEG_E_CANCELLED:
    return EXIT_CANCELLED;
  default:
    return EXIT_STAGE;
  }
}

#endif
