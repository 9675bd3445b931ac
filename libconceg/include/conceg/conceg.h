/* SPDX-License-Identifier: BSD-3-Clause
 * Umbrella header of libconceg. conceg/query.h belongs to libconceg_query and is apart. */
#ifndef CONCEG_H
#define CONCEG_H

#include "conceg/array.h"
#include "conceg/base.h"
#include "conceg/ctx.h"
#include "conceg/doc.h"
#include "conceg/geom.h"
#include "conceg/model.h"
#include "conceg/params.h"
#include "conceg/portable.h"
#include "conceg/rng.h"
#include "conceg/run.h"
#include "conceg/stage.h"
#include "conceg/swc.h"

#endif
