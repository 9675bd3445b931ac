/* SPDX-License-Identifier: BSD-3-Clause
 * Loaded before HDF5: a call that reads the document crashes, as it may on a damaged file. */
#include <signal.h>
#include <stdlib.h>

int H5Literate(void);
int H5Literate(void) {
  const char *number = getenv("CRASH_SIGNAL");
  raise(number ? atoi(number) : SIGSEGV);
  return -1;
}
