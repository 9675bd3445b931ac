/* SPDX-License-Identifier: BSD-3-Clause
 * conceg validate --expect: the documents of a manifest, each with the verdict that it must get. */
#ifndef CONCEG_APPS_EXPECT_H
#define CONCEG_APPS_EXPECT_H

#include "cli.h"

/* Runs every row of the manifest (spec/conformance/README.md says what a row is). Returns an exit code: 1
 * when a row got another verdict. */
int expect_manifest(struct cli *cli, const char *path);

#endif
