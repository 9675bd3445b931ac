/* SPDX-License-Identifier: BSD-3-Clause
 * What a run will take, foretold from what place asked for: seconds of each stage, and room on disk. */
#ifndef CONCEG_APPS_OUTLOOK_H
#define CONCEG_APPS_OUTLOOK_H

#include "conceg/conceg.h"

/* Of the tissue that the document asks for. */
struct outlook {
  double volume_um3; /* of the box */
  double cable_um;   /* asked in all bars */
  double area_um2;   /* of their membrane and of the somas */
};

/* Of one stage. Bytes. */
struct stage_cost {
  double seconds;   /* on two idle cores */
  double document;  /* what it adds to the document */
  double temporary; /* other files in TMPDIR */
  double part;      /* its unfinished work beside checkpoints */
  double faces;     /* of meshes, at most; 0 for other stages */
};

/* 1 and the figures, or 0 for a document without box and bars. */
int outlook_of(conceg_doc *doc, struct outlook *out);

/* `params` are those of the stage, NULL for one that is no stage of ours. `in_part`: unfinished work is kept
 * beside the checkpoints. Measured on a cube of 100 um with axons and on the column (growth.json, relax.json,
 * mesh.json of tests/bench/results); a stage unknown here takes a second and no room. */
struct stage_cost outlook_cost(const struct outlook *outlook, const char *kind, const conceg_params *params,
                               int in_part);

/* "4.2 GB", "40 s", "25 min": for lines. */
void outlook_size_text(char *out, size_t size, double bytes);
void outlook_time_text(char *out, size_t size, double seconds);

#endif
