// SPDX-License-Identifier: BSD-3-Clause
// A test tissue as a document, and the stage run on it.
#pragma once

#include "conceg/conceg.h"
#include "scenes.hpp"
#include "view.hpp"

extern "C" const conceg_stage conceg_stage_mesh;

namespace scenes {

inline conceg_doc *document_of(conceg_ctx *ctx, const Tissue &tissue) {
  using namespace conceg;
  conceg_doc *doc = nullptr;
  must(conceg_doc_new(ctx, &doc));
  const double pia[3] = {0, 0, 1};
  put(doc, "/domain@lo", tissue.box.lo, 3);
  put(doc, "/domain@hi", tissue.box.hi, 3);
  put(doc, "/domain@periodic", tissue.box.periodic, 3);
  put(doc, "/domain@pia", pia, 3);
  put_scalar(doc, "/domain@lattice_step", CONCEG_LATTICE_STEP_UM);
  put_texts(doc, "/types/name", {"ball"});
  put_texts(doc, "/types/class", {"other"});
  std::vector<std::uint64_t> id;
  for (std::uint64_t i = 0; i < tissue.cells(); i++)
    id.push_back(i + 1);
  put(doc, "/cells/id", id);
  put(doc, "/cells/type", std::vector<std::uint32_t>(tissue.cells()));
  put3(doc, "/cells/soma", tissue.soma);
  put(doc, "/cells/radius", tissue.soma_radius);
  put(doc, "/skeleton/cell_offset", tissue.offset);
  put3(doc, "/skeleton/position", tissue.point);
  put(doc, "/skeleton/radius", tissue.radius);
  put(doc, "/skeleton/target_radius", tissue.radius);
  put(doc, "/skeleton/parent", tissue.parent);
  put(doc, "/skeleton/kind", tissue.kind);
  return doc;
}

inline conceg_status run_stage(conceg_ctx *ctx, conceg_doc *doc, std::vector<const char *> sets) {
  sets.push_back(nullptr);
  conceg_params *params = nullptr;
  conceg::must(conceg_params_new(ctx, &conceg_stage_mesh, doc, nullptr, sets.data(), nullptr, &params));
  const conceg_status status = conceg_stage_run(ctx, &conceg_stage_mesh, doc, params);
  conceg_params_free(params);
  return status;
}

} // namespace scenes
