// SPDX-License-Identifier: BSD-3-Clause
// What the stage writes.
#pragma once

#include "final_check.hpp"
#include "finish.hpp"
#include "levels.hpp"

#include "conceg/doc.h"

namespace conceg::mesh {

// Geometry and face labels of /meshes: what the final check then reads. Coarser levels come behind.
void write_surfaces(conceg_doc *doc, const Scene &scene, const Index &index, const Finished &done,
                    const std::vector<Level> &levels, Workers &workers);

// What was measured on the surfaces and found by the final check. Gaps of coarser levels are not measured: 0.
// Returns the volume of the finest level, um3.
double write_measures(conceg_doc *doc, const conceg_box &box, const Scene &scene, const FinalCheck &check,
                      const std::vector<Pieces> &pieces, const std::vector<Level> &levels, double gap,
                      Workers &workers);

} // namespace conceg::mesh
