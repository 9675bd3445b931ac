/* SPDX-License-Identifier: BSD-3-Clause
 * The words of the umbrella that are not stages. Each takes argv from its own word on and returns an exit
 * code. */
#ifndef CONCEG_APPS_TOOLS_H
#define CONCEG_APPS_TOOLS_H

int tool_run(int argc, char **argv);
int tool_info(int argc, char **argv);
int tool_validate(int argc, char **argv);
int tool_check(int argc, char **argv);
int tool_dump(int argc, char **argv);
int tool_diff(int argc, char **argv);
int tool_strip(int argc, char **argv);
int tool_clean(int argc, char **argv);
int tool_stages(int argc, char **argv);
int tool_params(int argc, char **argv);
int tool_swc(int argc, char **argv);
int tool_bench(int argc, char **argv);

#endif
