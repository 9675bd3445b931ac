/* SPDX-License-Identifier: BSD-3-Clause
 * A document that could not be opened, told like any other broken rule. */
#ifndef CONCEG_APPS_REFUSAL_H
#define CONCEG_APPS_REFUSAL_H

#include "conceg/doc.h"

struct refusal {
  char rule[8];
  char path[1024], expected[1024], got[1024];
};

/* Takes the error line of conceg_doc_open apart; `name` is the file's name as the line begins with it. The
 * problem borrows from `out`. */
conceg_problem refusal_problem(const char *line, const char *name, struct refusal *out);

#endif
