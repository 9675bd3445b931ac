/* SPDX-License-Identifier: BSD-3-Clause
 * One stage as a program, for stage_main.c and for the umbrella. */
#ifndef CONCEG_APPS_STAGE_PROGRAM_H
#define CONCEG_APPS_STAGE_PROGRAM_H

/* Runs conceg-<kind>; returns the exit code. `name` is how it calls itself in messages. */
int stage_program(const char *kind, const char *name, int argc, char **argv);

#endif
