/* SPDX-License-Identifier: BSD-3-Clause
 * Version, export macros and status codes: what every other ConCeG header includes. */
#ifndef CONCEG_BASE_H
#define CONCEG_BASE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define CONCEG_BEGIN_C extern "C" {
#define CONCEG_END_C }
#else
#define CONCEG_BEGIN_C
#define CONCEG_END_C
#endif

#define CONCEG_API __attribute__((visibility("default")))
#define CONCEG_EXPORT CONCEG_API
#define CONCEG_NODISCARD __attribute__((warn_unused_result))
#define CONCEG_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))

#define CONCEG_VERSION_MAJOR 0
#define CONCEG_VERSION_MINOR 1
#define CONCEG_VERSION_PATCH 0
#define CONCEG_VERSION_TEXT "0.1.0"

/* Version of the CGX interchange that this library writes (spec/cgx.md). */
#define CONCEG_CGX_MAJOR 1u
#define CONCEG_CGX_MINOR 0u

/* Every status: name, value, text. Append only; a value is never reused. Negative = error. */
#define CONCEG_STATUS_MAP(X)                                                                                 \
  X(OK, 0, "ok")                                                                                             \
  X(E_USAGE, -1, "wrong use of a function or a program")                                                     \
  X(E_NOMEM, -2, "out of memory")                                                                            \
  X(E_IO, -3, "input or output failed")                                                                      \
  X(E_FORMAT, -4, "the data breaks a rule of its format")                                                    \
  X(E_VERSION, -5, "the file has a version that this library cannot read")                                   \
  X(E_MISSING, -6, "a group or dataset that is needed is missing")                                           \
  X(E_RANGE, -7, "a value lies outside its range")                                                           \
  X(E_PARAM, -8, "unknown or malformed parameter")                                                           \
  X(E_STAGE, -9, "a stage failed")                                                                           \
  X(E_ABI, -10, "a plugin was built for another stage ABI")                                                  \
  X(E_UNSUPPORTED, -11, "not supported by this build")                                                       \
  X(E_CANCELLED, -12, "cancelled")                                                                           \
  X(E_INTERNAL, -13, "internal error")

typedef enum conceg_status {
#define CONCEG_STATUS_ENUM(name, value, text) CONCEG_##name = value,
  CONCEG_STATUS_MAP(CONCEG_STATUS_ENUM)
#undef CONCEG_STATUS_ENUM
      CONCEG_STATUS_MINIMUM = -0x7fffffff - 1,
  CONCEG_STATUS_MAXIMUM = 0x7fffffff
} conceg_status;

CONCEG_BEGIN_C

/* Name of a status, such as "E_RANGE". Static; "E_UNKNOWN" for a number that is no status. Any thread. */
CONCEG_API const char *conceg_status_name(conceg_status status);

/* One-line English text of a status. Static. Any thread. */
CONCEG_API const char *conceg_status_text(conceg_status status);

/* Version of the library in use, "major.minor.patch". Static. Any thread. */
CONCEG_API const char *conceg_version(void);

CONCEG_END_C
#endif
