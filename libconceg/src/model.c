/* SPDX-License-Identifier: BSD-3-Clause
 * The views of an open substrate. All was checked while it was copied, so that only the index is checked
 * here. */
#include "model_internal.h"

#include <stdlib.h>
#include <string.h>

const char *conceg_compartment_name(uint32_t code) {
  switch (code) {
  case CONCEG_ECS:
    return "extracellular";
  case CONCEG_SOMA:
    return "soma";
  case CONCEG_AXON:
    return "axon";
  case CONCEG_BASAL_DENDRITE:
    return "basal dendrite";
  case CONCEG_APICAL_DENDRITE:
    return "apical dendrite";
  case CONCEG_GLIAL_PROCESS:
    return "glial process";
  case CONCEG_SPINE_NECK:
    return "spine neck";
  case CONCEG_SPINE_HEAD:
    return "spine head";
  case CONCEG_BOUTON:
    return "bouton";
  case CONCEG_NUCLEUS:
    return "nucleus";
  case CONCEG_MYELIN:
    return "myelin";
  case CONCEG_VESSEL:
    return "vessel";
  default:
    return NULL;
  }
}

/* Gives a view of `bytes` bytes to a caller whose view, of the size in its first word, may be shorter or
 * longer. */
static conceg_status give(void *out, void *view, uint32_t bytes) {
  uint32_t size;
  memcpy(&size, out, sizeof size);
  memcpy(view, &size, sizeof size);
  memset(out, 0, size);
  memcpy(out, view, size < bytes ? size : bytes);
  return CONCEG_OK;
}

/* A view holds more than its own size; nothing that was not cleared by mistake is this large. */
static int is_set(uint32_t size) {
  return size >= 8 && size <= 4096;
}

void conceg_substrate_box(const conceg_substrate *s, double lo[3], double hi[3], uint8_t periodic[3]) {
  memcpy(lo, s->lo, sizeof s->lo);
  memcpy(hi, s->hi, sizeof s->hi);
  memcpy(periodic, s->periodic, sizeof s->periodic);
}

uint64_t conceg_substrate_types(const conceg_substrate *s) {
  return s->types;
}
uint64_t conceg_substrate_cells(const conceg_substrate *s) {
  return s->cells;
}
uint64_t conceg_substrate_meshes(const conceg_substrate *s) {
  return s->meshes;
}

conceg_status conceg_substrate_type(const conceg_substrate *s, uint64_t type, conceg_type_view *out) {
  if (!s || !out || !is_set(out->size)) return CONCEG_E_USAGE;
  if (type >= s->types) return CONCEG_E_RANGE;
  conceg_type_view view = {.name = s->type_name[type], .class_name = s->class_name[type]};
  return give(out, &view, sizeof view);
}

conceg_status conceg_substrate_cell(const conceg_substrate *s, uint64_t cell, conceg_cell_view *out) {
  if (!s || !out || !is_set(out->size)) return CONCEG_E_USAGE;
  if (cell >= s->cells) return CONCEG_E_RANGE;
  const uint32_t type = s->type[cell];
  conceg_cell_view view = {.type = type,
                           .id = s->id[cell],
                           .type_name = s->type_name[type],
                           .class_name = s->class_name[type],
                           .soma_radius = (double)s->soma_radius[cell]};
  memcpy(view.soma, s->soma + 3 * cell, sizeof view.soma);
  return give(out, &view, sizeof view);
}

conceg_status conceg_substrate_find_cell(const conceg_substrate *s, uint64_t id, uint64_t *cell) {
  if (!s || !cell) return CONCEG_E_USAGE;
  uint64_t low = 0, high = s->cells;
  while (low < high) {
    const uint64_t middle = low + (high - low) / 2;
    if (s->by_id[middle].id < id)
      low = middle + 1;
    else
      high = middle;
  }
  if (low == s->cells || s->by_id[low].id != id) return CONCEG_E_MISSING;
  *cell = s->by_id[low].row;
  return CONCEG_OK;
}

conceg_status conceg_substrate_skeleton(const conceg_substrate *s, uint64_t cell, conceg_skeleton_view *out) {
  if (!s || !out || !is_set(out->size)) return CONCEG_E_USAGE;
  if (cell >= s->cells) return CONCEG_E_RANGE;
  conceg_skeleton_view view = {0};
  const uint64_t start = s->cell_offset ? s->cell_offset[cell] : 0;
  view.count = s->cell_offset ? s->cell_offset[cell + 1] - start : 0;
  if (view.count) {
    view.position = s->position + 3 * start;
    view.radius = s->radius + start;
    view.parent = s->parent + start;
    view.kind = s->kind + start;
    view.target_radius = s->target_radius + start;
    view.branch = s->branch ? s->branch + start : NULL;
  }
  return give(out, &view, sizeof view);
}

conceg_status conceg_substrate_mesh(const conceg_substrate *s, uint64_t mesh, conceg_mesh_view *out) {
  if (!s || !out || !is_set(out->size)) return CONCEG_E_USAGE;
  if (mesh >= s->meshes) return CONCEG_E_RANGE;
  const uint64_t vertex = s->vertex_offset[mesh], face = s->face_offset[mesh];
  conceg_mesh_view view = {.cell = s->mesh_cell[mesh],
                           .vertex_count = s->vertex_offset[mesh + 1] - vertex,
                           .face_count = s->face_offset[mesh + 1] - face,
                           .vertex = s->vertex + 3 * vertex,
                           .face = s->face + 3 * face,
                           .compartment = s->compartment + face,
                           .volume = s->volume[mesh],
                           .area = s->area[mesh],
                           .first_face = face,
                           .component = s->component ? s->component + face : NULL,
                           .section = s->section ? s->section + face : NULL,
                           .form = s->form ? s->form[mesh] : NULL,
                           .min_gap = s->min_gap[mesh],
                           .genus = s->genus[mesh],
                           .closed = s->closed[mesh]};
  memcpy(view.origin, s->origin + 3 * mesh, sizeof view.origin);
  return give(out, &view, sizeof view);
}

conceg_status conceg_substrate_volumes(const conceg_substrate *s, conceg_volumes_view *out) {
  if (!s || !out || !is_set(out->size)) return CONCEG_E_USAGE;
  if (!s->has_volumes) return CONCEG_E_MISSING;
  conceg_volumes_view view = {
      .leaf_count = s->leaves, .leaf_origin = s->leaf_origin, .label = s->label, .distance = s->distance};
  memcpy(view.origin, s->volume_origin, sizeof view.origin);
  memcpy(view.spacing, s->volume_spacing, sizeof view.spacing);
  memcpy(view.shape, s->volume_shape, sizeof view.shape);
  return give(out, &view, sizeof view);
}
