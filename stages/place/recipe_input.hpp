// SPDX-License-Identifier: BSD-3-Clause
// What place needs of a recipe, as plain values: box, densities, layers, types, laws of passing axons.
// Lengths in um.
#pragma once

#include "axons.hpp"
#include "composition.hpp"
#include "perturb.hpp"

#include "conceg/geom.h"
#include "conceg/params.h"

#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace conceg::place {

struct TypeInput {
  TypeShare share;
  std::string class_name, layer, entry;
  double radius_scale = 1.0;
  AxonLaw axons; // of passing axons (share.passing)
};

struct RecipeInput {
  conceg_box box = {}; // on the lattice
  glm::dvec3 pia = {0, 0, 1};
  std::string dictionary = "default";
  double density = kNotGiven;
  Profile profile;
  std::vector<Layer> layers;
  std::vector<TypeInput> types;
  Perturbation perturb;
};

// The recipe that travels in the document; errors name key and line.
RecipeInput read_recipe(conceg_ctx *ctx, conceg_doc *doc);

} // namespace conceg::place
