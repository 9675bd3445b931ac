/* SPDX-License-Identifier: BSD-3-Clause
 * The substrate handle: what a simulator needs, as plain memory. Read-only after opening: no file is touched
 * and HDF5 is not called later, and every function may be called from any number of threads. Lengths in um,
 * areas in um2, volumes in um3. Views are borrowed: valid until the substrate is freed.
 *
 * Each view begins with `size`, which the caller sets to sizeof the view. A library that knows less fills
 * what it knows and clears the rest; one that knows more fills `size` bytes. Members are only ever added at
 * the end. E_USAGE for a NULL argument or a size that was not set. */
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

/* English name of a compartment code, such as "basal dendrite"; NULL for a code that is none. Static. */
CONCEG_API const char *conceg_compartment_name(uint32_t code);

typedef struct conceg_substrate conceg_substrate;

/* Copies what is there of /domain, /types, /cells, /skeleton, /meshes and /volumes into memory. Everything
 * that is used as an index or a size is checked: a document that breaks a rule is refused, not trusted. The
 * document may be closed afterwards. /skeleton, /meshes or /volumes made from groups that have changed since
 * (CGX-070) are logged as warnings. Memory: the bytes of these groups once, 16 more for each cell, and one
 * block of the file; arrays that the document has in memory stay there until it is closed. Errors: E_MISSING
 * (no /domain, or a part of a group), E_FORMAT (names path[index]), E_IO, E_NOMEM. One thread, like all that
 * uses the document. */
CONCEG_API conceg_status conceg_substrate_open(conceg_doc *doc, conceg_substrate **out) CONCEG_NODISCARD;

/* The same from a file in one call; "-" is standard input. Errors as of conceg_doc_open and
 * conceg_substrate_open. The context is not used afterwards. */
CONCEG_API conceg_status conceg_substrate_open_file(conceg_ctx *ctx, const char *path,
                                                    conceg_substrate **out) CONCEG_NODISCARD;

/* Ends all views; NULL is allowed. Free the queries that borrow the substrate first. */
CONCEG_API void conceg_substrate_free(conceg_substrate *substrate);

/* The box. Positions below are unwrapped: along a periodic axis x and x + k (hi - lo) are the same place. */
CONCEG_API void conceg_substrate_box(const conceg_substrate *substrate, double lo[3], double hi[3],
                                     uint8_t periodic[3]);

typedef struct conceg_type_view {
  uint32_t size, reserved;
  const char *name, *class_name; /* "L2/3 pyramidal", "pyramidal" */
} conceg_type_view;
/* Number of cell types. */
CONCEG_API uint64_t conceg_substrate_types(const conceg_substrate *substrate);
/* E_RANGE for an index past the end, here and below. */
CONCEG_API conceg_status conceg_substrate_type(const conceg_substrate *substrate, uint64_t type,
                                               conceg_type_view *out) CONCEG_NODISCARD;

typedef struct conceg_cell_view {
  uint32_t size;
  uint32_t type; /* index into /types */
  uint64_t id;
  const char *type_name, *class_name;
  double soma[3]; /* in the box */
  double soma_radius;
} conceg_cell_view;
/* Number of cells. */
CONCEG_API uint64_t conceg_substrate_cells(const conceg_substrate *substrate);
/* Cell number `cell`, borrowed from the substrate; out->size must be set. Errors: E_RANGE, E_USAGE. */
CONCEG_API conceg_status conceg_substrate_cell(const conceg_substrate *substrate, uint64_t cell,
                                               conceg_cell_view *out) CONCEG_NODISCARD;
/* Index of the cell with this id; E_MISSING when there is none. */
CONCEG_API conceg_status conceg_substrate_find_cell(const conceg_substrate *substrate, uint64_t id,
                                                    uint64_t *cell) CONCEG_NODISCARD;

typedef struct conceg_skeleton_view {
  uint32_t size, reserved;
  uint64_t count;             /* 0 = the cell has no skeleton; all pointers are NULL then */
  const double *position;     /* [count][3], unwrapped */
  const float *radius;        /* [count] */
  const int64_t *parent;      /* [count], an earlier row, -1 = soma */
  const uint8_t *kind;        /* [count], SWC code */
  const float *target_radius; /* [count] */
  const uint32_t *branch;     /* [count], run between forks; NULL when the document has none */
} conceg_skeleton_view;
/* The skeleton of cell number `cell`, borrowed; out->size must be set. Errors: E_RANGE, E_USAGE. */
CONCEG_API conceg_status conceg_substrate_skeleton(const conceg_substrate *substrate, uint64_t cell,
                                                   conceg_skeleton_view *out) CONCEG_NODISCARD;

typedef struct conceg_mesh_view {
  uint32_t size;
  uint32_t cell; /* index of the cell */
  uint64_t vertex_count, face_count;
  const double *vertex;       /* [vertex_count][3], unwrapped */
  const uint32_t *face;       /* [face_count][3], anticlockwise seen from outside */
  const uint8_t *compartment; /* [face_count] */
  double volume, area;        /* 0 when the document does not state it, like min_gap and genus */
  uint64_t first_face;        /* index of face 0 among all faces of the substrate, as in conceg_hit.face */
  const uint32_t
      *component; /* [face_count], connected piece of the surface; NULL when the document has none */
  const uint32_t
      *section;     /* [face_count], skeleton branch nearest to the face, 4294967295 on the soma; or NULL */
  const char *form; /* "closed", "open" or "capped"; NULL when the document does not state it */
  double origin[3]; /* vertices are this plus a float32 */
  double min_gap;   /* um to the nearest other surface, cut at twice the gap that was asked for */
  int64_t genus;
  uint32_t closed; /* 1 = its maker found it closed; 0 = not, or not stated */
  uint32_t reserved;
} conceg_mesh_view;
/* Number of surfaces of level 0; coarser ones are not opened. */
CONCEG_API uint64_t conceg_substrate_meshes(const conceg_substrate *substrate);
/* Surface number `mesh`, borrowed; out->size must be set. Errors: E_RANGE, E_USAGE. */
CONCEG_API conceg_status conceg_substrate_mesh(const conceg_substrate *substrate, uint64_t mesh,
                                               conceg_mesh_view *out) CONCEG_NODISCARD;

/* Labelled voxels, in leaves of 8 x 8 x 8 (x slowest); voxels in no leaf are extracellular. */
typedef struct conceg_volumes_view {
  uint32_t size, reserved;
  uint64_t leaf_count;
  const int32_t *leaf_origin; /* [leaf_count][3], voxel indices of the leaf's first voxel */
  const uint32_t *label;      /* [leaf_count][512], cell index + 1, 0 = ECS; or NULL */
  const float *distance;      /* [leaf_count][512], um to the nearest membrane, negative inside; or NULL */
  double origin[3];           /* centre of voxel (0, 0, 0) */
  double spacing[3];          /* um; 0 when the document does not state it, like shape */
  uint64_t shape[3];          /* voxels of the box along each axis */
} conceg_volumes_view;
/* E_MISSING when the document had no /volumes. */
CONCEG_API conceg_status conceg_substrate_volumes(const conceg_substrate *substrate,
                                                  conceg_volumes_view *out) CONCEG_NODISCARD;

CONCEG_END_C
#endif
