/* SPDX-License-Identifier: BSD-3-Clause
 * The one main() of every conceg-<stage>. CONCEG_STAGE_KIND is set by the build. */
#include "stage_program.h"

int main(int argc, char **argv) {
  return stage_program(CONCEG_STAGE_KIND, "conceg " CONCEG_STAGE_KIND, argc, argv);
}
