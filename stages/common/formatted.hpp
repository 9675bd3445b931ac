// SPDX-License-Identifier: BSD-3-Clause
// "text %d" as a string.
#pragma once

#include "conceg/base.h"

#include <cstdarg>
#include <cstdio>
#include <string>

namespace conceg {

inline std::string formatted(const char *format, ...) CONCEG_PRINTF(1, 2);
inline std::string formatted(const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

} // namespace conceg
