/* SPDX-License-Identifier: BSD-3-Clause
 * A library that is no plugin: it has no conceg_stage_entry. */
int conceg_test_nothing(void);
int conceg_test_nothing(void) {
  return 0;
}
