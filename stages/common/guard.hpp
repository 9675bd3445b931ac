// SPDX-License-Identifier: BSD-3-Clause
// Where C++ exceptions stop: a stage's C entry points run their body inside guard(), which turns them into a
// status.
#pragma once

#include "conceg/ctx.h"

#include <cstdarg>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <utility>

namespace conceg {

// A failure with its status and its one line "what: path[index]: expected, got".
// An empty line means that the library has already set the context's error.
class Error : public std::exception {
public:
  Error(conceg_status status, std::string line) : status_(status), line_(std::move(line)) {}
  conceg_status status() const { return status_; }
  const char *what() const noexcept override { return line_.c_str(); }

private:
  conceg_status status_;
  std::string line_;
};

[[noreturn]] inline void fail(conceg_status status, const char *format, ...) CONCEG_PRINTF(2, 3);
[[noreturn]] inline void fail(conceg_status status, const char *format, ...) {
  char line[1024];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  throw Error(status, line);
}

// Throws when a C call failed; the context already holds the line.
inline void must(conceg_status status) {
  if (status != CONCEG_OK) throw Error(status, "");
}

template <class Body> conceg_status guard(conceg_ctx *ctx, const char *stage, Body &&body) noexcept {
  try {
    body();
    return CONCEG_OK;
  } catch (const Error &error) {
    if (!*error.what()) return error.status();
    return conceg_ctx_fail(ctx, error.status(), "%s: %s", stage, error.what());
  } catch (const std::bad_alloc &) {
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", stage);
  } catch (const std::exception &error) {
    return conceg_ctx_fail(ctx, CONCEG_E_STAGE, "%s: %s", stage, error.what());
  } catch (...) {
    return conceg_ctx_fail(ctx, CONCEG_E_STAGE, "%s: an exception of unknown type", stage);
  }
}

} // namespace conceg
