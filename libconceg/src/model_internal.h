/* SPDX-License-Identifier: BSD-3-Clause
 * What is behind a substrate handle: plain arrays, checked while they were copied (model_open.c), that the
 * views of model.c show. */
#ifndef CONCEG_MODEL_INTERNAL_H
#define CONCEG_MODEL_INTERNAL_H

#include "conceg/model.h"

/* The row of a cell by its id; sorted by id. */
struct cell_id {
  uint64_t id, row;
};

struct conceg_substrate {
  conceg_ctx *ctx; /* used while opening only */
  double lo[3], hi[3];
  uint8_t periodic[3];

  uint64_t types, classes, cells, meshes; /* types = classes once open */
  char **type_name, **class_name;
  uint64_t *id;
  struct cell_id *by_id;
  uint32_t *type;
  double *soma;
  float *soma_radius;

  uint64_t *cell_offset; /* NULL without skeletons */
  double *position;
  float *radius, *target_radius;
  int64_t *parent;
  uint8_t *kind;
  uint32_t *branch; /* NULL when the document has none, like component, section, form, label, distance */

  uint32_t *mesh_cell;
  uint64_t *vertex_offset, *face_offset, forms;
  double *vertex, *origin, *volume, *area, *min_gap;
  uint32_t *face, *component, *section;
  uint8_t *compartment, *closed;
  int64_t *genus;
  char **form;

  int has_volumes;
  uint64_t leaves, volume_shape[3];
  double volume_origin[3], volume_spacing[3];
  int32_t *leaf_origin;
  uint32_t *label;
  float *distance;
};

#endif
