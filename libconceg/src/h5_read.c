/* SPDX-License-Identifier: BSD-3-Clause
 * HDF5: walking through a file and reading values. Nothing that a file claims is believed before it is
 * compared with the file's length. */
#define _POSIX_C_SOURCE 200809L
#include "h5_type.h"
#include "texts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAXIMUM_OBJECTS = 1000000, NAME_BYTES = 512 };
/* A compressed array may claim this many times the length of its file. */
static const uint64_t maximum_inflation = 256;
/* What the tree may take: this many times the length of the file, and this much besides (CGX-016). */
static const uint64_t tree_factor = 64, tree_extra = (uint64_t)16 << 20;
/* Strings of variable length in one attribute: HDF5 reads them at once, each as long as the file may be. */
enum { MAXIMUM_ATTRIBUTE_STRINGS = 64 };

struct scan {
  struct h5_file *file;
  struct budget *budget;
  const struct schema *schema;
  struct entry *entry; /* the group, or the dataset whose attributes are read */
  hid_t object;
  uint64_t *objects, *tree_bytes; /* so far, in the whole file */
  int depth;
  conceg_status status;
};

static conceg_status fail(const struct scan *scan, conceg_status status, const char *name, const char *what) {
  return conceg_ctx_fail(scan->budget->ctx, status, "%s: %s%s: %s", scan->file->name, scan->entry->path, name,
                         what);
}

static conceg_status out_of_memory(const struct scan *scan, const char *name) {
  return fail(scan, CONCEG_E_NOMEM, name, "out of memory");
}

/* Memory for strings of variable length: many of them may refer to the same bytes of the file. */
struct string_room {
  uint64_t left;
};

static void *take_string(size_t bytes, void *user) {
  struct string_room *room = user;
  if (bytes > room->left) return NULL;
  room->left -= bytes;
  return malloc(bytes);
}

static void free_string(void *memory, void *user) {
  (void)user;
  free(memory);
}

static uint64_t at_most(uint64_t length, uint64_t factor, uint64_t extra) {
  return length <= (UINT64_MAX - extra) / factor ? length * factor + extra : UINT64_MAX;
}

/* Reads into a zeroed block. What was read of strings before a failure is given back by the caller. */
static herr_t read_strings(hid_t object, int attribute, hid_t memory, uint64_t most, void *block) {
  if (attribute) return H5Aread(object, memory, block);
  struct string_room room = {most};
  const hid_t list = H5Pcreate(H5P_DATASET_XFER);
  herr_t result = H5Pset_vlen_mem_manager(list, take_string, &room, free_string, NULL);
  if (result >= 0) result = H5Dread(object, memory, H5S_ALL, H5S_ALL, list, block);
  H5Pclose(list);
  return result;
}

/* Reads all strings of an open attribute or dataset. */
static conceg_status read_texts(struct budget *budget, struct h5_file *file, const char *path, hid_t object,
                                int attribute, hid_t type, hid_t space, const struct h5_form *form,
                                struct store *out) {
  conceg_ctx *ctx = budget->ctx;
  if (form->variable_text) {
    const conceg_status damaged = h5_check_heaps(ctx, file, path);
    if (damaged != CONCEG_OK) return damaged;
  }
  uint64_t count = 1;
  for (uint32_t axis = 0; axis < form->rank; axis++)
    count *= form->shape[axis];
  const size_t width = form->variable_text ? sizeof(char *) : form->width;
  char *block = calloc(count ? count : 1, width ? width : 1);
  if (!block) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
  const hid_t memory = h5_text_type(form->variable_text ? H5T_VARIABLE : width, H5Tget_cset(type));
  conceg_status status = CONCEG_OK;
  if (count &&
      read_strings(object, attribute, memory, at_most(file->length, maximum_inflation, 0), block) < 0)
    status =
        h5_fail(ctx, CONCEG_E_FORMAT, file->name, path,
                form->variable_text ? "cannot be read, or its strings are above 256 times the file (CGX-016)"
                                    : "cannot be read");
  else if (form->variable_text) {
    char **strings = (char **)(void *)block;
    for (uint64_t i = 0; i < count; i++)
      if (!strings[i] && !(strings[i] = calloc(1, 1)))
        status = conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
    if (status == CONCEG_OK) status = texts_copy(budget, path, (const char *const *)strings, count, out);
  } else {
    status =
        texts_from_fixed(budget, path, block, width, count, H5Tget_strpad(type) == H5T_STR_SPACEPAD, out);
  }
  if (form->variable_text && count) H5Dvlen_reclaim(memory, space, H5P_DEFAULT, block);
  H5Tclose(memory);
  free(block);
  return status;
}

static void set_form(struct entry *entry, const struct h5_form *form) {
  entry->dtype = form->dtype;
  entry->rank = form->rank;
  memcpy(entry->shape, form->shape, sizeof entry->shape);
}

/* Makes an entry and hands it to its parent, unsorted. NULL when out of memory. */
static struct entry *add_entry(struct scan *scan, enum entry_kind kind, const char *name, int attribute) {
  struct entry *entry = entry_new(kind, scan->entry, name, attribute, scan->schema);
  if (entry && entry_append(entry)) return entry;
  entry_free(scan->budget, entry);
  return NULL;
}

/* One object may have many names, and so make more of a tree than its file has bytes. */
static conceg_status count_bytes(const struct scan *scan, const char *name, uint64_t bytes) {
  const uint64_t limit = at_most(scan->file->length, tree_factor, tree_extra);
  *scan->tree_bytes += bytes;
  if (*scan->tree_bytes <= limit) return CONCEG_OK;
  return conceg_ctx_fail(scan->budget->ctx, CONCEG_E_FORMAT,
                         "%s: %.200s%s: names and attributes take more than %llu bytes, too many for a file "
                         "of %llu bytes (CGX-016)",
                         scan->file->name, scan->entry->path, name, (unsigned long long)limit,
                         (unsigned long long)scan->file->length);
}

static conceg_status count_object(const struct scan *scan, const char *name) {
  if (++*scan->objects > MAXIMUM_OBJECTS)
    return fail(scan, CONCEG_E_FORMAT, name, "expected at most 1000000 objects in a file (CGX-005)");
  return count_bytes(scan, name, sizeof(struct entry) + strlen(scan->entry->path) + 2 * strlen(name));
}

static conceg_status scan_attribute(const struct scan *scan, struct entry *entry, hid_t attribute) {
  const hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
  struct h5_form form;
  const char *why = h5_classify(type, space, &form);
  conceg_status status = CONCEG_OK;
  if (why) {
    entry->kind = ENTRY_OPAQUE;
    entry->why = strdup(why);
    if (!entry->why) status = out_of_memory(scan, entry->name);
  } else if (form.bytes > scan->file->length) {
    status = conceg_ctx_fail(
        scan->budget->ctx, CONCEG_E_FORMAT,
        "%s: %s: expected at most the %llu bytes of the file, got an attribute of %llu (CGX-006)",
        scan->file->name, entry->path, (unsigned long long)scan->file->length,
        (unsigned long long)form.bytes);
  } else {
    set_form(entry, &form);
    if (form.variable_text && entry_count(entry) > MAXIMUM_ATTRIBUTE_STRINGS)
      status = conceg_ctx_fail(
          scan->budget->ctx, CONCEG_E_FORMAT,
          "%s: %s: expected at most %d strings of variable length in an attribute, got %llu (CGX-016)",
          scan->file->name, entry->path, MAXIMUM_ATTRIBUTE_STRINGS, (unsigned long long)entry_count(entry));
    else if (form.dtype == CONCEG_TEXT)
      status =
          read_texts(scan->budget, scan->file, entry->path, attribute, 1, type, space, &form, &entry->store);
    else if ((status = store_new(scan->budget, entry->path, form.bytes, &entry->store)) == CONCEG_OK &&
             form.bytes && h5_read_all(attribute, 1, h5_memory_type(form.dtype), entry->store.data) < 0)
      status = h5_fail(scan->budget->ctx, CONCEG_E_FORMAT, scan->file->name, entry->path, "cannot be read");
  }
  if (status == CONCEG_OK) status = count_bytes(scan, entry->name, entry->store.bytes);
  H5Tclose(type);
  H5Sclose(space);
  return status;
}

static herr_t visit_attribute(hid_t object, const char *name, const H5A_info_t *info, void *user) {
  (void)info;
  struct scan *scan = user;
  scan->status = count_object(scan, name);
  if (scan->status != CONCEG_OK) return 1;
  if (strlen(name) >= NAME_BYTES)
    return scan->status = fail(scan, CONCEG_E_FORMAT, "", "a name of 512 bytes or more (CGX-007)"), 1;
  struct entry *entry = add_entry(scan, ENTRY_ARRAY, name, 1);
  if (!entry) return scan->status = out_of_memory(scan, name), 1;
  const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
  if (attribute < 0)
    scan->status =
        h5_fail(scan->budget->ctx, CONCEG_E_FORMAT, scan->file->name, entry->path, "cannot be opened");
  else {
    scan->status = scan_attribute(scan, entry, attribute);
    H5Aclose(attribute);
  }
  return scan->status != CONCEG_OK;
}

static conceg_status scan_attributes(struct scan *scan) {
  hsize_t index = 0;
  if (H5Aiterate2(scan->object, H5_INDEX_NAME, H5_ITER_NATIVE, &index, visit_attribute, scan) < 0 &&
      scan->status == CONCEG_OK)
    scan->status = h5_fail(scan->budget->ctx, CONCEG_E_FORMAT, scan->file->name, scan->entry->path,
                           "attributes cannot be listed");
  entry_sort(scan->budget, scan->entry, 1);
  return scan->status;
}

/* The filters of ConCeG's files: each can tell, or is bounded by, the size of what it makes; HDF5's others
 * take it from the file. */
static int is_known_pipeline(hid_t list) {
  const int count = H5Pget_nfilters(list);
  unsigned seen = 0;
  for (int i = 0; i < count; i++) {
    unsigned flags, configuration;
    size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(list, (unsigned)i, &flags, &values, NULL, 0, NULL, &configuration);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
      return 0;
    if (seen & 1u << filter) return 0;
    seen |= 1u << filter;
  }
  return count >= 0;
}

/* HDF5 takes memory for one whole chunk, however little of it is used. */
static uint64_t chunk_bytes(hid_t list, const struct h5_form *form) {
  hsize_t extent[4] = {0};
  uint64_t bytes = form->width;
  const int rank = H5Pget_chunk(list, 4, extent);
  for (int axis = 0; axis < rank && axis < 4; axis++)
    if (__builtin_mul_overflow(bytes, (uint64_t)extent[axis], &bytes)) return UINT64_MAX;
  return bytes;
}

/* Compares what a dataset claims with what the file can hold. */
static conceg_status check_storage(const struct scan *scan, const char *name, hid_t dataset,
                                   const struct h5_form *form) {
  const hid_t list = H5Dget_create_plist(dataset);
  const H5D_layout_t layout = H5Pget_layout(list);
  const int external = H5Pget_external_count(list);
  const int known = layout != H5D_CHUNKED || is_known_pipeline(list);
  const uint64_t chunk = layout == H5D_CHUNKED ? chunk_bytes(list, form) : 0;
  H5Pclose(list);
  const uint64_t length = scan->file->length;
  if (external > 0 || layout == H5D_VIRTUAL)
    return fail(scan, CONCEG_E_FORMAT, name,
                "expected values inside the file, got a reference to another file (CGX-005)");
  if (!known)
    return fail(
        scan, CONCEG_E_FORMAT, name,
        "expected no filter but deflate, shuffle and fletcher32, each once; repack the file (CGX-016)");
  const uint64_t limit = layout == H5D_CHUNKED ? at_most(length, maximum_inflation, 0) : length;
  if (chunk > at_most(length, maximum_inflation, tree_extra))
    return conceg_ctx_fail(scan->budget->ctx, CONCEG_E_FORMAT,
                           "%s: %s%s: a chunk claims %llu bytes, too many for a file of %llu bytes (CGX-016)",
                           scan->file->name, scan->entry->path, name, (unsigned long long)chunk,
                           (unsigned long long)length);
  const haddr_t offset = layout == H5D_CONTIGUOUS ? H5Dget_offset(dataset) : HADDR_UNDEF;
  const int beyond = offset != HADDR_UNDEF && (offset > length || form->bytes > length - offset);
  if (form->bytes > limit || beyond)
    return conceg_ctx_fail(
        scan->budget->ctx, CONCEG_E_FORMAT,
        "%s: %s%s: the array claims %llu bytes, more than a file of %llu bytes can hold (CGX-006)",
        scan->file->name, scan->entry->path, name, (unsigned long long)form->bytes,
        (unsigned long long)length);
  return CONCEG_OK;
}

static conceg_status scan_dataset(struct scan *scan, const char *name, hid_t dataset) {
  const hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
  struct h5_form form;
  const char *why = h5_classify(type, space, &form);
  H5Tclose(type);
  H5Sclose(space);
  if (!why) {
    const conceg_status status = check_storage(scan, name, dataset, &form);
    if (status != CONCEG_OK) return status;
  }
  struct entry *entry = add_entry(scan, why ? ENTRY_OPAQUE : ENTRY_ARRAY, name, 0);
  if (!entry) return out_of_memory(scan, name);
  entry->in_file = 1;
  if (why) {
    entry->why = strdup(why);
    return entry->why ? CONCEG_OK : out_of_memory(scan, name);
  }
  set_form(entry, &form);
  struct scan inner = *scan;
  inner.entry = entry;
  inner.object = dataset;
  return scan_attributes(&inner);
}

static conceg_status scan_group(struct scan *scan);

static conceg_status scan_object(struct scan *scan, const char *name, hid_t object) {
  if (H5Iget_type(object) == H5I_DATASET) return scan_dataset(scan, name, object);
  const int group = H5Iget_type(object) == H5I_GROUP;
  struct entry *entry = add_entry(scan, group ? ENTRY_GROUP : ENTRY_OPAQUE, name, 0);
  if (!entry) return out_of_memory(scan, name);
  if (!group) {
    entry->why = strdup("a named type");
    return entry->why ? CONCEG_OK : out_of_memory(scan, name);
  }
  if (scan->depth >= PATH_DEPTH)
    return fail(scan, CONCEG_E_FORMAT, name, "groups are nested more than 16 deep, or form a loop (CGX-005)");
  struct scan inner = *scan;
  inner.entry = entry;
  inner.object = object;
  inner.depth++;
  return scan_group(&inner);
}

static herr_t visit_link(hid_t group, const char *name, const H5L_info_t *info, void *user) {
  struct scan *scan = user;
  scan->status = count_object(scan, name);
  if (scan->status != CONCEG_OK) return 1;
  if (strlen(name) >= NAME_BYTES)
    return scan->status = fail(scan, CONCEG_E_FORMAT, "", "a name of 512 bytes or more (CGX-007)"), 1;
  if (info->type != H5L_TYPE_HARD)
    return scan->status = fail(scan, CONCEG_E_FORMAT, name,
                               "expected a group or dataset, got a soft or external link (CGX-005)"),
           1;
  const hid_t object = H5Oopen(group, name, H5P_DEFAULT);
  if (object < 0) {
    char path[PATH_BYTES + NAME_BYTES];
    snprintf(path, sizeof path, "%.1000s%s", scan->entry->path, name);
    scan->status = h5_fail(scan->budget->ctx, CONCEG_E_FORMAT, scan->file->name, path, "cannot be opened");
    return 1;
  }
  scan->status = scan_object(scan, name, object);
  H5Oclose(object);
  return scan->status != CONCEG_OK;
}

static conceg_status scan_group(struct scan *scan) {
  hsize_t index =
      0; /* the tree sorts; HDF5's own sorting frees wild pointers when a group's index is damaged */
  if (scan_attributes(scan) != CONCEG_OK) return scan->status;
  if (H5Literate(scan->object, H5_INDEX_NAME, H5_ITER_NATIVE, &index, visit_link, scan) < 0 &&
      scan->status == CONCEG_OK)
    scan->status =
        h5_fail(scan->budget->ctx, CONCEG_E_FORMAT, scan->file->name, scan->entry->path, "cannot be listed");
  entry_sort(scan->budget, scan->entry, 0);
  return scan->status;
}

conceg_status h5_scan(struct h5_file *file, struct budget *budget, const struct schema *schema,
                      struct entry *root) {
  uint64_t objects = 0, tree_bytes = 0;
  h5_lock();
  struct scan scan = {.file = file,
                      .budget = budget,
                      .schema = schema,
                      .entry = root,
                      .objects = &objects,
                      .tree_bytes = &tree_bytes,
                      .depth = 1};
  scan.object = H5Gopen2(file->id, "/", H5P_DEFAULT);
  conceg_status status;
  if (scan.object < 0)
    status = h5_fail(budget->ctx, CONCEG_E_FORMAT, file->name, "/", "cannot be opened");
  else {
    status = scan_group(&scan);
    H5Gclose(scan.object);
  }
  h5_unlock();
  return status;
}

/* Reads through open ids; negative when HDF5 failed. */
static herr_t read_rows(hid_t dataset, const struct entry *entry, uint64_t first, uint64_t count,
                        void *buffer) {
  const hid_t type = h5_memory_type(entry->dtype);
  if (!entry->rank || (first == 0 && count == entry->shape[0])) return h5_read_all(dataset, 0, type, buffer);
  hsize_t start[4] = {first}, extent[4] = {count};
  for (uint32_t axis = 1; axis < entry->rank; axis++)
    extent[axis] = entry->shape[axis];
  const hid_t space = H5Dget_space(dataset), memory = H5Screate_simple((int)entry->rank, extent, NULL);
  herr_t result = -1;
  if (space >= 0 && memory >= 0 && H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, extent, NULL) >= 0)
    result = H5Dread(dataset, type, memory, space, H5P_DEFAULT, buffer);
  H5Sclose(memory);
  H5Sclose(space);
  return result;
}

conceg_status h5_read_rows(conceg_ctx *ctx, struct h5_file *file, const struct entry *entry, uint64_t first,
                           uint64_t count, void *buffer) {
  if (!entry_count(entry)) return CONCEG_OK;
  conceg_status status = CONCEG_OK;
  h5_lock();
  const hid_t dataset = H5Dopen2(file->id, entry->path, H5P_DEFAULT);
  if (dataset < 0 || read_rows(dataset, entry, first, count, buffer) < 0)
    status = h5_fail(ctx, CONCEG_E_FORMAT, file->name, entry->path, "cannot be read");
  if (dataset >= 0) H5Dclose(dataset);
  h5_unlock();
  return status;
}

conceg_status h5_read_texts(struct budget *budget, struct h5_file *file, const struct entry *entry,
                            struct store *out) {
  conceg_status status = CONCEG_OK;
  h5_lock();
  const hid_t dataset = H5Dopen2(file->id, entry->path, H5P_DEFAULT);
  if (dataset < 0)
    status = h5_fail(budget->ctx, CONCEG_E_FORMAT, file->name, entry->path, "cannot be opened");
  else {
    const hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
    struct h5_form form;
    h5_classify(type, space, &form);
    status = read_texts(budget, file, entry->path, dataset, 0, type, space, &form, out);
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(dataset);
  }
  h5_unlock();
  return status;
}
