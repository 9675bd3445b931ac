/* SPDX-License-Identifier: BSD-3-Clause
 * Exit codes of every ConCeG program (spec/cli.md). */
#ifndef CONCEG_APPS_EXITCODE_H
#define CONCEG_APPS_EXITCODE_H

#include "conceg/base.h"

enum {
  EXIT_OK = 0,
  EXIT_STAGE = 1, /* a stage failed, or a check found a difference */
  EXIT_USAGE = 2, /* command line or recipe */
  EXIT_INPUT = 3, /* the input document or file is invalid */
  EXIT_IO = 4,
  EXIT_MISSING = 5, /* a stage, plugin or library is not there */
  EXIT_CANCELLED = 6
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
