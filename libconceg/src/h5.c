/* SPDX-License-Identifier: BSD-3-Clause
 * HDF5: the lock, messages, opening and closing. */
#define _POSIX_C_SOURCE 200809L
#include "h5_internal.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
/* The program's own way to print HDF5 errors, put back at each unlock. */
static H5E_auto2_t program_print;
static void *program_print_data;

/* After a damaged file HDF5 cannot tidy up when the process ends, and says so at length. All files are closed
 * here anyway. */
static void keep_quiet_at_exit(void) {
  H5dont_atexit();
}

void h5_lock(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, keep_quiet_at_exit);
  pthread_mutex_lock(&mutex);
  H5Eget_auto2(H5E_DEFAULT, &program_print, &program_print_data);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

void h5_unlock(void) {
  H5Eset_auto2(H5E_DEFAULT, program_print, program_print_data);
  pthread_mutex_unlock(&mutex);
}

/* Keeps the system's reason if HDF5 quotes one, else the innermost description. */
static herr_t take_reason(unsigned n, const H5E_error2_t *error, void *data) {
  char *reason = data;
  const char *quoted = error->desc ? strstr(error->desc, "error message = '") : NULL;
  if (quoted) {
    quoted += strlen("error message = '");
    snprintf(reason, 256, "%.*s", (int)strcspn(quoted, "'"), quoted);
  } else if (n == 0 && error->desc) {
    snprintf(reason, 256, "%s", error->desc);
  }
  return 0;
}

conceg_status h5_fail(conceg_ctx *ctx, conceg_status status, const char *name, const char *path,
                      const char *what) {
  char reason[256] = "";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_reason, reason);
  return conceg_ctx_fail(ctx, status, "%s: %s%s%s%s%s", name, path, *path ? ": " : "", what,
                         *reason ? ": " : "", reason);
}

hid_t h5_access(int writing) {
  const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
  if (list < 0) return list;
  if (writing) H5Pset_libver_bounds(list, H5F_LIBVER_V18, H5F_LIBVER_V18); /* what is read may be newer */
  H5Pset_fclose_degree(list, H5F_CLOSE_STRONG);
#if H5_VERSION_GE(1, 10, 7)
  H5Pset_file_locking(list, 0, 1); /* a reader never sees a file being written: writers rename */
#endif
  return list;
}

hid_t h5_memory_type(conceg_dtype dtype) {
  switch (dtype) {
  case CONCEG_U8:
    return H5T_STD_U8LE;
  case CONCEG_I8:
    return H5T_STD_I8LE;
  case CONCEG_U32:
    return H5T_STD_U32LE;
  case CONCEG_I32:
    return H5T_STD_I32LE;
  case CONCEG_U64:
    return H5T_STD_U64LE;
  case CONCEG_I64:
    return H5T_STD_I64LE;
  case CONCEG_F32:
    return H5T_IEEE_F32LE;
  case CONCEG_F64:
    return H5T_IEEE_F64LE;
  default:
    return H5I_INVALID_HID;
  }
}

hid_t h5_text_type(size_t width, H5T_cset_t cset) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  if (type < 0) return type;
  H5Tset_size(type, width);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, cset);
  return type;
}

herr_t h5_read_all(hid_t object, int attribute, hid_t type, void *buffer) {
  return attribute ? H5Aread(object, type, buffer)
                   : H5Dread(object, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
}

conceg_status h5_open(conceg_ctx *ctx, const char *path, const char *name, uint64_t length,
                      struct h5_file **out) {
  struct h5_file *file = calloc(1, sizeof *file);
  char *copy = strdup(name);
  if (!file || !copy) {
    free(file);
    free(copy);
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", name);
  }
  file->name = copy;
  file->length = length;
  h5_lock();
  const hid_t access = h5_access(0);
  file->id = H5Fopen(path, H5F_ACC_RDONLY, access);
  conceg_status status = CONCEG_OK;
  if (file->id < 0) status = h5_fail(ctx, CONCEG_E_FORMAT, name, "", "not a readable HDF5 file");
  H5Pclose(access);
  h5_unlock();
  if (status != CONCEG_OK) {
    free(copy);
    free(file);
    return status;
  }
  *out = file;
  return CONCEG_OK;
}

conceg_status h5_close(conceg_ctx *ctx, struct h5_file *file) {
  if (!file) return CONCEG_OK;
  conceg_status status = CONCEG_OK;
  h5_lock();
  if (H5Fclose(file->id) < 0) status = h5_fail(ctx, CONCEG_E_IO, file->name, "", "could not be closed");
  h5_unlock();
  free(file->name);
  free(file);
  return status;
}

const char *h5_name(const struct h5_file *file) {
  return file->name;
}
