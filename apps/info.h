/* SPDX-License-Identifier: BSD-3-Clause
 * Parts of conceg info. `json` is NULL when text is wanted. Each returns 0 or an exit code. */
#ifndef CONCEG_APPS_INFO_H
#define CONCEG_APPS_INFO_H

#include "array_text.h"
#include "json.h"

/* Every table of /statistics, its columns side by side. */
int print_statistics(struct cli *cli, conceg_doc *doc, struct json *json);

#endif
