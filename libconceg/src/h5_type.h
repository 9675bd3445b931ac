/* SPDX-License-Identifier: BSD-3-Clause
 * HDF5: which type and shape of a file becomes which array. */
#ifndef CONCEG_H5_TYPE_H
#define CONCEG_H5_TYPE_H

#include "h5_internal.h"

struct h5_form {
  conceg_dtype dtype;
  uint32_t rank;
  uint64_t shape[4];
  uint64_t bytes; /* in the file, before any compression; a text of variable length counts its pointers */
  size_t width;   /* bytes of one element in the file */
  int variable_text;
};

/* Fills the form; returns NULL, or what the thing is that conceg_array cannot hold ("a compound"). */
const char *h5_classify(hid_t type, hid_t space, struct h5_form *form);

#endif
