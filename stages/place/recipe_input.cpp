// SPDX-License-Identifier: BSD-3-Clause
#include "recipe_input.hpp"

#include "guard.hpp"

#include <memory>

namespace conceg::place {
namespace {

struct FreeRecipe {
  void operator()(conceg_recipe *recipe) const { conceg_recipe_free(recipe); }
};

class Reader {
public:
  Reader(conceg_ctx *ctx, const conceg_node *root) : ctx_(ctx), root_(root) {}

  RecipeInput read() const {
    RecipeInput in;
    read_domain(in);
    in.dictionary = text(conceg_node_get(root_, "dictionary"), "default");
    in.density = number(conceg_node_get(root_, "density_per_um3"), kNotGiven);
    const conceg_node *profile = conceg_node_get(root_, "density_profile");
    for (std::uint32_t i = 0; i < conceg_node_count(profile); i++) {
      in.profile.z.push_back(number(conceg_node_get(conceg_node_at(profile, i), "z_um"), 0.0));
      in.profile.density.push_back(number(conceg_node_get(conceg_node_at(profile, i), "per_um3"), 0.0));
    }
    const conceg_node *layers = conceg_node_get(root_, "layers");
    for (std::uint32_t i = 0; i < conceg_node_count(layers); i++) {
      const conceg_node *layer = conceg_node_at(layers, i), *z = conceg_node_get(layer, "z_um");
      in.layers.push_back({text(conceg_node_get(layer, "name"), ""),
                           conceg_snap(number(conceg_node_at(z, 0), 0.0)),
                           conceg_snap(number(conceg_node_at(z, 1), 0.0)),
                           number(conceg_node_get(layer, "density_per_um3"), kNotGiven)});
    }
    const conceg_node *types = conceg_node_get(root_, "types");
    if (conceg_node_count(types) == 0)
      fail(CONCEG_E_MISSING, "recipe: key types is missing; list at least one cell type");
    for (std::uint32_t i = 0; i < conceg_node_count(types); i++)
      in.types.push_back(type(conceg_node_at(types, i), in.layers, i));
    in.perturb.neurons = number(conceg_node_get(root_, "perturb.neurons"), 1.0);
    in.perturb.dendrites = number(conceg_node_get(root_, "perturb.dendrites"), 1.0);
    in.perturb.glia = number(conceg_node_get(root_, "perturb.glia"), 1.0);
    return in;
  }

private:
  double number(const conceg_node *node, double fallback) const {
    double value = fallback;
    if (node) must(conceg_node_f64(ctx_, node, &value));
    return value;
  }
  static std::string text(const conceg_node *node, const char *fallback) {
    const char *value = conceg_node_text(node);
    return value ? value : fallback;
  }

  // A direction [x, y, z] as a unit vector; `fallback` where the key is absent.
  glm::dvec3 unit(const conceg_node *node, const glm::dvec3 &fallback) const {
    if (!node) return fallback;
    glm::dvec3 direction;
    for (std::uint32_t axis = 0; axis < 3; axis++)
      direction[static_cast<int>(axis)] = number(conceg_node_at(node, axis), 0.0);
    const double length =
        std::sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
    if (!(length > 1e-100 && length < 1e100)) // the squares of others are lost
      fail(CONCEG_E_RANGE, "recipe (line %u): expected a direction of a length near 1, got %g",
           conceg_node_line(node), length);
    return direction / length;
  }

  void read_domain(RecipeInput &in) const {
    const conceg_node *domain = conceg_node_get(root_, "domain");
    if (!domain) fail(CONCEG_E_MISSING, "recipe: key domain is missing; give domain.size_um");
    const conceg_node *size = conceg_node_get(domain, "size_um"), *lo = conceg_node_get(domain, "lo_um");
    const conceg_node *hi = conceg_node_get(domain, "hi_um"), *periodic = conceg_node_get(domain, "periodic");
    for (std::uint32_t axis = 0; axis < 3; axis++) {
      const double from = number(conceg_node_at(lo, axis), 0.0);
      const double to =
          size ? from + number(conceg_node_at(size, axis), 0.0) : number(conceg_node_at(hi, axis), 0.0);
      in.box.lo[axis] = conceg_snap(from), in.box.hi[axis] = conceg_snap(to);
      if (!(in.box.hi[axis] > in.box.lo[axis]) || !(std::fabs(from) < kLongest) ||
          !(std::fabs(to) < kLongest))
        fail(
            CONCEG_E_RANGE,
            "domain (line %u): expected sides of more than 2^-16 um within %g um, got %g to %g um on axis %u",
            conceg_node_line(domain), kLongest, from, to, axis);
      int on = 1;
      if (periodic) must(conceg_node_bool(ctx_, conceg_node_at(periodic, axis), &on));
      in.box.periodic[axis] = on != 0;
    }
    in.pia = unit(conceg_node_get(domain, "pia"), in.pia);
  }

  // The law of passing axons; what is not given is as in `defaults`.
  AxonLaw axons(const conceg_node *type, const AxonLaw &defaults) const {
    AxonLaw law = defaults;
    law.cable_density = number(conceg_node_get(type, "cable_density_per_um2"), law.cable_density);
    law.length = number(conceg_node_get(type, "length_um"), law.length);
    law.radius.mean = number(conceg_node_get(type, "radius_um.mean"), law.radius.mean);
    law.radius.sd = number(conceg_node_get(type, "radius_um.sd"), law.radius.sd);
    law.radius.minimum = number(conceg_node_get(type, "radius_um.minimum"), law.radius.minimum);
    law.direction.axis = unit(conceg_node_get(type, "direction.axis"), law.direction.axis);
    law.direction.kappa = number(conceg_node_get(type, "direction.kappa"), law.direction.kappa);
    return law;
  }

  TypeInput type(const conceg_node *node, const std::vector<Layer> &layers, std::uint32_t index) const {
    TypeInput out;
    out.share.name = text(conceg_node_get(node, "name"), "");
    out.share.fraction = number(conceg_node_get(node, "fraction"), kNotGiven);
    out.share.density = number(conceg_node_get(node, "density_per_um3"), kNotGiven);
    out.class_name = text(conceg_node_get(node, "class"), "other");
    out.layer = text(conceg_node_get(node, "layer"), "");
    out.entry = text(conceg_node_get(node, "entry"), "");
    out.radius_scale = number(conceg_node_get(node, "radius_scale"), 1.0);
    out.share.passing = out.class_name == "axon" && out.entry.empty();
    out.axons = axons(node, out.axons);
    for (std::size_t i = 0; i < layers.size(); i++)
      if (layers[i].name == out.layer) out.share.layer = static_cast<int>(i);
    if (out.share.layer < 0 && !out.layer.empty())
      fail(CONCEG_E_RANGE, "types[%u].layer (line %u): no layer is named %s", index, conceg_node_line(node),
           out.layer.c_str());
    return out;
  }

  static constexpr double kLongest = 1e6; // um
  conceg_ctx *ctx_;
  const conceg_node *root_;
};

} // namespace

RecipeInput read_recipe(conceg_ctx *ctx, conceg_doc *doc) {
  conceg_recipe *raw = nullptr;
  must(conceg_recipe_from_doc(ctx, doc, &raw));
  const std::unique_ptr<conceg_recipe, FreeRecipe> recipe(raw);
  return Reader(ctx, conceg_recipe_root(raw)).read();
}

} // namespace conceg::place
