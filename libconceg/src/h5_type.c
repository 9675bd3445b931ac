/* SPDX-License-Identifier: BSD-3-Clause
 * HDF5: which type and shape of a file becomes which array. */
#define _POSIX_C_SOURCE 200809L
#include "h5_type.h"

#include <string.h>

static conceg_dtype integer_type(hid_t type) {
  const int is_signed = H5Tget_sign(type) != H5T_SGN_NONE;
  switch (H5Tget_size(type)) {
  case 1:
    return is_signed ? CONCEG_I8 : CONCEG_U8;
  case 4:
    return is_signed ? CONCEG_I32 : CONCEG_U32;
  case 8:
    return is_signed ? CONCEG_I64 : CONCEG_U64;
  default:
    return 0;
  }
}

static conceg_dtype float_type(hid_t type) {
  if (H5Tequal(type, H5T_IEEE_F32LE) > 0 || H5Tequal(type, H5T_IEEE_F32BE) > 0) return CONCEG_F32;
  if (H5Tequal(type, H5T_IEEE_F64LE) > 0 || H5Tequal(type, H5T_IEEE_F64BE) > 0) return CONCEG_F64;
  return 0;
}

static const char *why_not(H5T_class_t class) {
  switch (class) {
  case H5T_INTEGER:
    return "an integer of other than 1, 4 or 8 bytes";
  case H5T_FLOAT:
    return "a floating-point number of other than 4 or 8 bytes";
  case H5T_ENUM:
    return "an enumeration (or boolean)";
  case H5T_COMPOUND:
    return "a compound";
  case H5T_REFERENCE:
    return "a reference";
  case H5T_VLEN:
    return "a list of variable length";
  case H5T_ARRAY:
    return "an array type";
  case H5T_OPAQUE:
    return "an opaque type";
  case H5T_BITFIELD:
    return "a bit field";
  default:
    return "a type that HDF5 does not name";
  }
}

const char *h5_classify(hid_t type, hid_t space, struct h5_form *form) {
  *form = (struct h5_form){0};
  const H5S_class_t space_class = H5Sget_simple_extent_type(space);
  if (space_class != H5S_SCALAR && space_class != H5S_SIMPLE) return "an array without extents";
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || rank > 4) return "an array of rank above 4";
  hsize_t shape[4] = {0};
  if (rank) H5Sget_simple_extent_dims(space, shape, NULL);
  form->rank = (uint32_t)rank;
  uint64_t count = 1;
  for (int axis = 0; axis < rank; axis++) {
    form->shape[axis] = shape[axis];
    if (__builtin_mul_overflow(count, (uint64_t)shape[axis], &count))
      return "an array of more values than 64 bits can count";
  }
  const H5T_class_t class = H5Tget_class(type);
  form->variable_text = class == H5T_STRING && H5Tis_variable_str(type) > 0;
  form->width = H5Tget_size(type);
  if (class == H5T_INTEGER)
    form->dtype = integer_type(type);
  else if (class == H5T_FLOAT)
    form->dtype = float_type(type);
  else if (class == H5T_STRING && rank <= 1)
    form->dtype = CONCEG_TEXT;
  else if (class == H5T_STRING)
    return "a text of rank above 1";
  if (!form->dtype) return why_not(class);
  if (__builtin_mul_overflow(count, (uint64_t)form->width, &form->bytes))
    return "an array of more bytes than 64 bits can count";
  return NULL;
}
