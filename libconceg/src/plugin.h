/* SPDX-License-Identifier: BSD-3-Clause
 * Stages in shared libraries: finding their files and opening them. */
#ifndef CONCEG_SRC_PLUGIN_H
#define CONCEG_SRC_PLUGIN_H

#include "conceg/stage.h"

/* libconceg_stage_<kind>_<name>.so */
struct plugin {
  char *file, *kind, *name;
  const conceg_stage *stage; /* NULL until it was opened */
};

struct plugin_list {
  struct plugin *item;
  uint32_t count, capacity;
};

/* Lists the plugins of one folder by name, after what the list holds. A folder that is not there is no error.
 * E_NOMEM. */
conceg_status plugin_scan(conceg_ctx *ctx, const char *folder, struct plugin_list *list) CONCEG_NODISCARD;
/* Lists CONCEG_STAGE_PATH (an empty element = the install folder), then the install folder. */
conceg_status plugin_find_all(conceg_ctx *ctx, struct plugin_list *list) CONCEG_NODISCARD;
void plugin_list_free(struct plugin_list *list);

/* Opens the library and checks its stage. E_ABI names the file and the numbers. */
conceg_status plugin_open(conceg_ctx *ctx, struct plugin *plugin) CONCEG_NODISCARD;

/* Checks a descriptor: numbers, names, table. `from` is for messages. */
conceg_status stage_check(conceg_ctx *ctx, const conceg_stage *stage, const char *from) CONCEG_NODISCARD;

#endif
