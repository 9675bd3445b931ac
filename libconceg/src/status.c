/* SPDX-License-Identifier: BSD-3-Clause
 * Names and texts of the status codes; the version of the library. */
#include "conceg/base.h"

const char *conceg_status_name(conceg_status status) {
  switch (status) {
#define NAME_CASE(name, value, text)                                                                         \
  case CONCEG_##name:                                                                                        \
    return #name;
    CONCEG_STATUS_MAP(NAME_CASE)
#undef NAME_CASE
  default:
    return "E_UNKNOWN";
  }
}

const char *conceg_status_text(conceg_status status) {
  switch (status) {
#define TEXT_CASE(name, value, text)                                                                         \
  case CONCEG_##name:                                                                                        \
    return text;
    CONCEG_STATUS_MAP(TEXT_CASE)
#undef TEXT_CASE
  default:
    return "unknown status";
  }
}

const char *conceg_version(void) {
  return CONCEG_VERSION_TEXT;
}
