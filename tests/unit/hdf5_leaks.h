/* SPDX-License-Identifier: BSD-3-Clause
 * HDF5 itself loses memory when it gives up on a damaged file; only the address sanitizer asks for this. */
#ifndef CONCEG_TESTS_HDF5_LEAKS_H
#define CONCEG_TESTS_HDF5_LEAKS_H

const char *__lsan_default_suppressions(void);
__attribute__((visibility("default"))) const char *__lsan_default_suppressions(void) {
  return "leak:libhdf5";
}

#endif
