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

  void read_domain(RecipeInput &in) const {
    const conceg_node *domain = conceg_node_get(root_, "domain");
    if (!domain) fail(CONCEG_E_MISSING, "recipe: key domain is missing; give domain.size_um");
    const conceg_node *size = conceg_node_get(domain, "size_um"), *lo = conceg_node_get(domain, "lo_um");
    const conceg_node *hi = conceg_node_get(domain, "hi_um"), *periodic = conceg_node_get(domain, "periodic");
    const conceg_node *pia = conceg_node_get(domain, "pia");
    glm::dvec3 direction(0, 0, 1);
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
      if (pia) direction[static_cast<int>(axis)] = number(conceg_node_at(pia, axis), 0.0);
    }
    const double length =
        std::sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
    if (!(length > 0.0))
      fail(CONCEG_E_RANGE, "domain.pia (line %u): expected a direction, got [0, 0, 0]",
           conceg_node_line(pia));
    in.pia = direction / length;
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
