// SPDX-License-Identifier: BSD-3-Clause
// What the stage writes.
#pragma once

#include "final_check.hpp"
#include "finish.hpp"

#include "conceg/doc.h"

namespace conceg::mesh {

// Geometry and face labels of /meshes: what the final check then reads.
void write_surfaces(conceg_doc *doc, const Scene &scene, const Index &index, const Finished &done,
                    Workers &workers);

// What was measured on the surfaces and found by the final check. Returns their volume, um3.
double write_measures(conceg_doc *doc, const conceg_box &box, const Scene &scene, const FinalCheck &check,
                      const std::vector<Pieces> &pieces, double gap, Workers &workers);

} // namespace conceg::mesh
