/* SPDX-License-Identifier: BSD-3-Clause
 * HDF5: the one canonical writer. Same tree, same bytes: a fresh file, siblings in the tree's order, fixed
 * creation lists, no times, every array contiguous, allocated at once and written by the same code wherever
 * its values came from. */
#define _GNU_SOURCE
#include "h5_internal.h"
#include "texts.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const uint64_t block_bytes = (uint64_t)4 << 20;

struct writer {
  conceg_ctx *ctx;
  const char *name;
  hid_t file, group_list, dataset_list;
  struct h5_file *source;
  uint64_t done, total;
};

static conceg_status fail(const struct writer *writer, const struct entry *entry, const char *what) {
  return h5_fail(writer->ctx, CONCEG_E_IO, writer->name, entry->path, what);
}

static hid_t make_space(const struct entry *entry) {
  if (!entry->rank) return H5Screate(H5S_SCALAR);
  hsize_t shape[4];
  for (uint32_t axis = 0; axis < entry->rank; axis++)
    shape[axis] = entry->shape[axis];
  return H5Screate_simple((int)entry->rank, shape, NULL);
}

/* Strings as one block of equal width, padded with NUL. */
static char *pad_texts(const char *const *strings, uint64_t count, size_t *width) {
  *width = 1;
  for (uint64_t i = 0; i < count; i++) {
    const size_t length = strlen(strings[i]);
    if (length > *width) *width = length;
  }
  char *block = calloc(count ? count : 1, *width);
  for (uint64_t i = 0; block && i < count; i++)
    memcpy(block + i * *width, strings[i], strlen(strings[i]));
  return block;
}

static conceg_status write_attribute(const struct writer *writer, hid_t owner, const struct entry *entry) {
  size_t width = 0;
  char *block = NULL;
  const int is_text = entry->dtype == CONCEG_TEXT;
  if (is_text && !(block = pad_texts(entry->store.data, entry_count(entry), &width)))
    return conceg_ctx_fail(writer->ctx, CONCEG_E_NOMEM, "%s: %s: out of memory", writer->name, entry->path);
  const hid_t type = is_text ? h5_text_type(width, H5T_CSET_UTF8) : H5Tcopy(h5_memory_type(entry->dtype));
  const hid_t space = make_space(entry);
  const hid_t attribute = H5Acreate2(owner, entry->name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  conceg_status status = CONCEG_OK;
  if (attribute < 0 ||
      (entry_count(entry) && H5Awrite(attribute, type, is_text ? block : entry->store.data) < 0))
    status = fail(writer, entry, "cannot be written");
  if (attribute >= 0) H5Aclose(attribute);
  H5Sclose(space);
  H5Tclose(type);
  free(block);
  return status;
}

/* An attribute of a type that conceg_array cannot hold: its bytes are copied as they are. */
static conceg_status carry_attribute(const struct writer *writer, hid_t owner, const struct entry *entry) {
  const hid_t from =
      H5Aopen_by_name(writer->source->id, entry->parent->path, entry->name, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t type = H5Aget_type(from), space = H5Aget_space(from);
  conceg_status status = CONCEG_OK;
  if (H5Tdetect_class(type, H5T_VLEN) > 0 || H5Tdetect_class(type, H5T_REFERENCE) > 0 ||
      H5Tis_variable_str(type) > 0) {
    conceg_ctx_log(writer->ctx, CONCEG_LOG_WARNING, "%s: %s is left out: %s cannot be carried through",
                   writer->name, entry->path, entry->why);
  } else {
    const hsize_t size = H5Aget_storage_size(from);
    void *bytes = calloc(size ? size : 1, 1);
    const hid_t to = H5Acreate2(owner, entry->name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (!bytes || to < 0 || (size && (H5Aread(from, type, bytes) < 0 || H5Awrite(to, type, bytes) < 0)))
      status = fail(writer, entry, "cannot be carried through");
    if (to >= 0) H5Aclose(to);
    free(bytes);
  }
  H5Tclose(type);
  H5Sclose(space);
  H5Aclose(from);
  return status;
}

static conceg_status write_attributes(const struct writer *writer, hid_t owner, const struct entry *entry) {
  conceg_status status = CONCEG_OK;
  for (size_t i = 0; i < entry->attrs && status == CONCEG_OK; i++)
    status = entry->attr[i]->kind == ENTRY_OPAQUE ? carry_attribute(writer, owner, entry->attr[i])
                                                  : write_attribute(writer, owner, entry->attr[i]);
  return status;
}

/* Reports between datasets; the lock is given back so that the callback may use other documents. */
static conceg_status report(struct writer *writer, uint64_t bytes) {
  const uint64_t before = writer->done / (16 * block_bytes);
  writer->done += bytes;
  if (writer->done / (16 * block_bytes) == before) return CONCEG_OK;
  h5_unlock();
  const conceg_status status = conceg_ctx_progress(writer->ctx, "write", writer->done, writer->total);
  h5_lock();
  return status;
}

static herr_t write_rows(hid_t dataset, const struct entry *entry, uint64_t first, uint64_t rows,
                         const void *values) {
  const hid_t type = h5_memory_type(entry->dtype);
  if (!entry->rank) return H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  hsize_t start[4] = {first}, extent[4] = {rows};
  for (uint32_t axis = 1; axis < entry->rank; axis++)
    extent[axis] = entry->shape[axis];
  const hid_t space = H5Dget_space(dataset), memory = H5Screate_simple((int)entry->rank, extent, NULL);
  herr_t result = -1;
  if (space >= 0 && memory >= 0 && H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, extent, NULL) >= 0)
    result = H5Dwrite(dataset, type, memory, space, H5P_DEFAULT, values);
  H5Sclose(memory);
  H5Sclose(space);
  return result;
}

static conceg_status write_values(struct writer *writer, hid_t dataset, const struct entry *entry) {
  if (!entry_count(entry)) return CONCEG_OK;
  const uint64_t rows = entry->rank ? entry->shape[0] : 1, row_bytes = entry_bytes(entry) / rows;
  const uint64_t rows_per_block = row_bytes < block_bytes ? block_bytes / row_bytes : 1;
  void *buffer = NULL;
  if (!entry->store.data && !(buffer = malloc((rows < rows_per_block ? rows : rows_per_block) * row_bytes)))
    return conceg_ctx_fail(writer->ctx, CONCEG_E_NOMEM, "%s: %s: out of memory", writer->name, entry->path);
  conceg_status status = CONCEG_OK;
  for (uint64_t first = 0; first < rows && status == CONCEG_OK; first += rows_per_block) {
    const uint64_t count = rows - first < rows_per_block ? rows - first : rows_per_block;
    const void *values = buffer;
    if (entry->store.data)
      values = (const char *)entry->store.data + first * row_bytes;
    else {
      h5_unlock();
      status = h5_read_rows(writer->ctx, writer->source, entry, first, count, buffer);
      h5_lock();
    }
    if (status == CONCEG_OK && write_rows(dataset, entry, first, count, values) < 0)
      status = fail(writer, entry, "cannot be written");
    if (status == CONCEG_OK) status = report(writer, count * row_bytes);
  }
  free(buffer);
  return status;
}

/* Text: the strings as one padded block, from memory or from the source. */
static conceg_status padded_texts(struct writer *writer, const struct entry *entry, char **block,
                                  size_t *width) {
  struct store loaded = {0};
  struct budget apart = {.ctx = writer->ctx};
  conceg_status status = CONCEG_OK;
  if (!entry->store.data) {
    h5_unlock();
    status = h5_read_texts(&apart, writer->source, entry, &loaded);
    h5_lock();
  }
  if (status != CONCEG_OK) return status;
  *block = pad_texts(entry->store.data ? entry->store.data : loaded.data, entry_count(entry), width);
  store_free(&apart, &loaded);
  if (!*block)
    return conceg_ctx_fail(writer->ctx, CONCEG_E_NOMEM, "%s: %s: out of memory", writer->name, entry->path);
  return CONCEG_OK;
}

static conceg_status write_dataset(struct writer *writer, hid_t group, const struct entry *entry) {
  size_t width = 0;
  char *block = NULL;
  const int is_text = entry->dtype == CONCEG_TEXT;
  if (is_text) {
    const conceg_status status = padded_texts(writer, entry, &block, &width);
    if (status != CONCEG_OK) return status;
  }
  const hid_t type = is_text ? h5_text_type(width, H5T_CSET_UTF8) : H5Tcopy(h5_memory_type(entry->dtype));
  const hid_t space = make_space(entry);
  const hid_t dataset =
      H5Dcreate2(group, entry->name, type, space, H5P_DEFAULT, writer->dataset_list, H5P_DEFAULT);
  conceg_status status = CONCEG_OK;
  if (dataset < 0)
    status = fail(writer, entry, "cannot be written");
  else {
    status = write_attributes(writer, dataset, entry);
    if (status == CONCEG_OK && !is_text) status = write_values(writer, dataset, entry);
    if (status == CONCEG_OK && is_text && entry_count(entry) &&
        H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, block) < 0)
      status = fail(writer, entry, "cannot be written");
    if (H5Dclose(dataset) < 0 && status == CONCEG_OK) status = fail(writer, entry, "cannot be written");
  }
  H5Sclose(space);
  H5Tclose(type);
  free(block);
  return status;
}

static conceg_status write_children(struct writer *writer, hid_t group, const struct entry *entry);

static conceg_status write_group(struct writer *writer, hid_t parent, const struct entry *entry) {
  const hid_t group = H5Gcreate2(parent, entry->name, H5P_DEFAULT, writer->group_list, H5P_DEFAULT);
  if (group < 0) return fail(writer, entry, "cannot be written");
  conceg_status status = write_attributes(writer, group, entry);
  if (status == CONCEG_OK) status = write_children(writer, group, entry);
  if (H5Gclose(group) < 0 && status == CONCEG_OK) status = fail(writer, entry, "cannot be written");
  return status;
}

static conceg_status write_children(struct writer *writer, hid_t group, const struct entry *entry) {
  conceg_status status = CONCEG_OK;
  for (size_t i = 0; i < entry->children && status == CONCEG_OK; i++) {
    const struct entry *child = entry->child[i];
    if (child->kind == ENTRY_GROUP)
      status = write_group(writer, group, child);
    else if (child->kind == ENTRY_ARRAY)
      status = write_dataset(writer, group, child);
    else if (H5Ocopy(writer->source->id, child->path, group, child->name, H5P_DEFAULT, H5P_DEFAULT) < 0)
      status = fail(writer, child, "cannot be carried through");
  }
  return status;
}

static uint64_t tree_bytes(const struct entry *entry, uint64_t *objects) {
  uint64_t bytes = entry->kind == ENTRY_ARRAY
                       ? entry_bytes(entry) + entry->store.bytes * (entry->dtype == CONCEG_TEXT)
                       : 0;
  *objects += 1 + entry->attrs;
  for (size_t i = 0; i < entry->children; i++)
    bytes += tree_bytes(entry->child[i], objects);
  return bytes;
}

/* HDF5 cannot recover from a disk that fills up while it writes, so the space is reserved first. */
static conceg_status reserve(const struct writer *writer, int fd, uint64_t bytes) {
  if (fallocate(fd, FALLOC_FL_KEEP_SIZE, 0, (off_t)bytes) == 0 || errno != ENOSPC) return CONCEG_OK;
  return conceg_ctx_fail(writer->ctx, CONCEG_E_IO, "%s: cannot be written: %s: expected room for %llu MiB",
                         writer->name, strerror(ENOSPC), (unsigned long long)((bytes >> 20) + 1));
}

/* Frees what was reserved beyond the end. */
static void trim(int fd) {
  struct stat info;
  if (fstat(fd, &info) == 0 && ftruncate(fd, info.st_size) != 0) errno = 0; /* only room is lost */
}

static hid_t create_file(const char *path) {
  const hid_t access = h5_access(1), creation = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_obj_track_times(creation, 0);
  const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, creation, access);
  H5Pclose(access);
  H5Pclose(creation);
  return file;
}

static void make_lists(struct writer *writer) {
  writer->group_list = H5Pcreate(H5P_GROUP_CREATE);
  H5Pset_obj_track_times(writer->group_list, 0);
  writer->dataset_list = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(writer->dataset_list, 0);
  H5Pset_layout(writer->dataset_list, H5D_CONTIGUOUS);
  H5Pset_alloc_time(writer->dataset_list, H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(writer->dataset_list, H5D_FILL_TIME_NEVER);
}

static conceg_status write_file(struct writer *writer, const struct entry *root) {
  make_lists(writer);
  const hid_t group = H5Gopen2(writer->file, "/", H5P_DEFAULT);
  conceg_status status = write_attributes(writer, group, root);
  if (status == CONCEG_OK) status = write_children(writer, group, root);
  H5Gclose(group);
  H5Pclose(writer->group_list);
  H5Pclose(writer->dataset_list);
  return status;
}

/* Fills the empty file at `path`, which `fd` has open too; leaves its name to the caller unless `anonymous`.
 */
static conceg_status fill_file(struct writer *writer, const char *path, const struct entry *root,
                               int anonymous, int fd) {
  uint64_t objects = 0;
  writer->total = tree_bytes(root, &objects);
  const uint64_t room = writer->total + objects * 1024 + 4096;
  conceg_status status = reserve(writer, fd, room);
  if (status != CONCEG_OK) return status;
  writer->file = create_file(path); /* which gives the room back */
  if (writer->file < 0) return h5_fail(writer->ctx, CONCEG_E_IO, writer->name, "", "cannot be written");
  if (anonymous) unlink(path);
  status = reserve(writer, fd, room);
  if (status == CONCEG_OK) status = write_file(writer, root);
  if (H5Fclose(writer->file) < 0 && status == CONCEG_OK)
    status = h5_fail(writer->ctx, CONCEG_E_IO, writer->name, "", "cannot be written");
  return status;
}

conceg_status h5_write(conceg_ctx *ctx, const char *path, const char *name, const struct entry *root,
                       struct h5_file *source, int anonymous, int *fd) {
  struct writer writer = {.ctx = ctx, .name = name, .source = source};
  h5_lock();
  const conceg_status status = fill_file(&writer, path, root, anonymous, *fd);
  h5_unlock();
  if (status == CONCEG_OK) {
    trim(*fd);
    return CONCEG_OK;
  }
  unlink(path); /* gone already when anonymous, unless the file could not even be started */
  close(*fd);
  *fd = -1;
  return status;
}
