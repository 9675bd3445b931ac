/* SPDX-License-Identifier: BSD-3-Clause
 * The substrate handle: what a simulator needs, as plain memory. Read-only after opening: no file is touched
 * later, and every function may be called from any number of threads. Lengths in um, volumes in um3. */
#ifndef CONCEG_MODEL_H
#define CONCEG_MODEL_H

#include "conceg/doc.h"

CONCEG_BEGIN_C

/* Compartment codes; append only. */
typedef enum conceg_compartment {
  CONCEG_ECS = 0,
  CONCEG_SOMA = 1,
  CONCEG_AXON = 2,
  CONCEG_BASAL_DENDRITE = 3,
  CONCEG_APICAL_DENDRITE = 4,
  CONCEG_GLIAL_PROCESS = 7,
  CONCEG_SPINE_NECK = 16,
  CONCEG_SPINE_HEAD = 17,
  CONCEG_BOUTON = 18,
  CONCEG_NUCLEUS = 19,
  CONCEG_MYELIN = 20,
  CONCEG_VESSEL = 21,
  CONCEG_COMPARTMENT_MAXIMUM = 0x7fffffff
} conceg_compartment;

typedef struct conceg_substrate conceg_substrate;

/* Copies what is there of /domain, /types, /cells, /skeleton and /meshes into memory. The document may be
 * closed afterwards. Errors: E_MISSING (no /domain), E_FORMAT, E_NOMEM. */
CONCEG_API conceg_status conceg_substrate_open(conceg_doc *doc, conceg_substrate **out) CONCEG_NODISCARD;
CONCEG_API void conceg_substrate_free(conceg_substrate *substrate);

CONCEG_API void conceg_substrate_box(const conceg_substrate *substrate, double lo[3], double hi[3],
                                     uint8_t periodic[3]);
CONCEG_API uint64_t conceg_substrate_cells(const conceg_substrate *substrate);

typedef struct conceg_cell_view {
  uint32_t size; /* set by the caller */
  uint32_t type; /* index into /types */
  uint64_t id;
  const char *type_name, *class_name;
  double soma[3]; /* in the box */
  double soma_radius;
} conceg_cell_view;
/* E_RANGE for an index past the end. */
CONCEG_API conceg_status conceg_substrate_cell(const conceg_substrate *substrate, uint64_t cell,
                                               conceg_cell_view *out) CONCEG_NODISCARD;

typedef struct conceg_skeleton_view {
  uint32_t size, reserved;
  uint64_t count;
  const double *position; /* [count][3], unwrapped */
  const float *radius;    /* [count] */
  const int64_t *parent;  /* [count], -1 = soma */
  const uint8_t *kind;    /* [count], SWC code */
} conceg_skeleton_view;
CONCEG_API conceg_status conceg_substrate_skeleton(const conceg_substrate *substrate, uint64_t cell,
                                                   conceg_skeleton_view *out) CONCEG_NODISCARD;

CONCEG_API uint64_t conceg_substrate_meshes(const conceg_substrate *substrate);
typedef struct conceg_mesh_view {
  uint32_t size;
  uint32_t cell; /* index of the cell */
  uint64_t vertex_count, face_count;
  const double *vertex;       /* [vertex_count][3], unwrapped */
  const uint32_t *face;       /* [face_count][3], outward */
  const uint8_t *compartment; /* [face_count] */
  double volume, area;
} conceg_mesh_view;
CONCEG_API conceg_status conceg_substrate_mesh(const conceg_substrate *substrate, uint64_t mesh,
                                               conceg_mesh_view *out) CONCEG_NODISCARD;

CONCEG_END_C
#endif
