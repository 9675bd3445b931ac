/* SPDX-License-Identifier: BSD-3-Clause
 * The validator: types, ranks and extents. */
#define _POSIX_C_SOURCE 200809L
#include "validate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct extent *find(const struct validator *validator, const struct schema_group *group,
                           const char *name) {
  const int shared = schema_is_global(validator->doc->schema, name);
  for (size_t i = 0; i < validator->extents; i++) {
    struct extent *extent = &validator->extent[i];
    if (strcmp(extent->name, name) == 0 &&
        (shared ? !extent->group : extent->group && strcmp(extent->group, group->name) == 0))
      return extent;
  }
  return NULL;
}

int find_extent(const struct validator *validator, const struct schema_group *group, const char *name,
                uint64_t *value) {
  const struct extent *extent = find(validator, group, name);
  if (extent) *value = extent->value;
  return extent != NULL;
}

static conceg_status add_extent(struct validator *validator, const struct schema_group *group,
                                const char *name, const char *path, uint64_t value) {
  if (validator->extents == validator->extent_room) {
    const size_t room = validator->extent_room ? 2 * validator->extent_room : 32;
    struct extent *grown = realloc(validator->extent, room * sizeof *grown);
    if (!grown) return conceg_ctx_fail(validator->ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
    validator->extent = grown;
    validator->extent_room = room;
  }
  validator->extent[validator->extents++] =
      (struct extent){.group = schema_is_global(validator->doc->schema, name) ? NULL : group->name,
                      .name = name,
                      .path = path,
                      .value = value};
  return CONCEG_OK;
}

static conceg_status check_extent(struct validator *validator, const struct schema_group *group,
                                  const struct schema_extent *want, const struct entry *entry,
                                  uint32_t axis) {
  char expected[PATH_BYTES + 128], got[64];
  const uint64_t length = entry->shape[axis];
  snprintf(got, sizeof got, "%llu", (unsigned long long)length);
  if (!want->name) {
    snprintf(expected, sizeof expected, "extent %llu along axis %u", (unsigned long long)want->fixed, axis);
    if (length != want->fixed) report(validator, "CGX-022", MUST, entry->path, expected, got);
    return CONCEG_OK;
  }
  if (want->plus_one && !length) {
    report(validator, "CGX-040", MUST, entry->path, "offsets with at least one value", "none");
    return CONCEG_OK;
  }
  const uint64_t value = length - (want->plus_one ? 1 : 0);
  const struct extent *known = find(validator, group, want->name);
  if (!known) return add_extent(validator, group, want->name, entry->path, value);
  if (known->value == value) return CONCEG_OK;
  snprintf(expected, sizeof expected, "extent %s%s along axis %u with %s = %llu as in %s", want->name,
           want->plus_one ? " + 1" : "", axis, want->name, (unsigned long long)known->value, known->path);
  report(validator, known->group ? "CGX-023" : "CGX-024", MUST, entry->path, expected, got);
  return CONCEG_OK;
}

conceg_status check_form(struct validator *validator, const struct schema_group *group,
                         const struct schema_item *item, const struct entry *entry) {
  char expected[64], got[64];
  if (entry->dtype != item->dtype) {
    snprintf(expected, sizeof expected, "type %s", conceg_dtype_name(item->dtype));
    report(validator, "CGX-021", MUST, entry->path, expected, conceg_dtype_name(entry->dtype));
  }
  if (entry->rank != item->rank) {
    snprintf(expected, sizeof expected, "rank %u", item->rank);
    snprintf(got, sizeof got, "rank %u", entry->rank);
    report(validator, "CGX-022", MUST, entry->path, expected, got);
    return CONCEG_OK;
  }
  conceg_status status = CONCEG_OK;
  for (uint32_t axis = 0; axis < item->rank && status == CONCEG_OK; axis++)
    status = check_extent(validator, group, &item->extent[axis], entry, axis);
  return status;
}
