// SPDX-License-Identifier: BSD-3-Clause
// The place stage: descriptor, and glue between recipe, document and the algorithm files.
#include "axons.hpp"
#include "composition.hpp"
#include "dictionary_io.hpp"
#include "donors.hpp"
#include "perturb.hpp"
#include "recipe_input.hpp"
#include "somas.hpp"

#include "conceg/stage.h"
#include "conceg/swc.h"
#include "wrap.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstring>

namespace {

using namespace conceg;
using namespace conceg::place;

constexpr std::uint32_t kNoDonor = 4294967295u; // spec/schema.yaml, /cells/donor

struct Cell {
  std::uint64_t id;
  std::uint32_t type, donor;
  glm::dquat rotation;
  double radius; // of the soma, 0 = none
  std::size_t demand;
  glm::dvec3 soma;
  const Axon *axon; // of a passing axon, which has no donor
};

// Looks up the entries of the types and keeps only those of the dictionary. `entry_of_type` has no use for
// passing axons.
Dictionary dictionary_for(conceg_ctx *ctx, const RecipeInput &recipe,
                          std::vector<std::size_t> &entry_of_type) {
  const Dictionary whole = load_dictionary(ctx, recipe.dictionary);
  std::vector<std::size_t> kept;
  entry_of_type.assign(recipe.types.size(), 0);
  for (std::size_t t = 0; t < recipe.types.size(); t++) {
    if (recipe.types[t].share.passing) continue;
    const std::int64_t found = whole.find(recipe.types[t].entry);
    if (found < 0) {
      std::string names;
      for (const std::string &name : whole.entry.name)
        names += (names.empty() ? "" : " ") + name;
      fail(CONCEG_E_MISSING, "types[%zu].entry: dictionary %s has no entry \"%s\"; it has: %s", t,
           recipe.dictionary.c_str(), recipe.types[t].entry.c_str(), names.c_str());
    }
    const auto entry = static_cast<std::size_t>(found);
    if (whole.entry.donor_offset[entry] == whole.entry.donor_offset[entry + 1])
      fail(CONCEG_E_RANGE, "types[%zu].entry: expected donors in dictionary entry %s, got none", t,
           recipe.types[t].entry.c_str());
    const auto known = std::find(kept.begin(), kept.end(), entry);
    entry_of_type[t] = static_cast<std::size_t>(known - kept.begin());
    if (known == kept.end()) kept.push_back(entry);
  }
  return subset(whole, kept);
}

// The k-th cell of type t has the id k * types + t: a changed count of one type leaves the other cells as
// they were. `made` counts the cells of each type so far.
std::vector<Cell> draw_cells(const std::vector<Demand> &demands, const Dictionary &dictionary,
                             const std::vector<Pool> &pool_of_type, const DonorOptions &options,
                             std::vector<std::uint64_t> &made) {
  const std::size_t types = made.size();
  std::vector<std::pair<std::uint64_t, std::size_t>> rows; // id, demand
  for (std::size_t d = 0; d < demands.size(); d++)
    for (std::uint64_t i = 0; i < demands[d].count; i++)
      rows.emplace_back(made[demands[d].type]++ * types + demands[d].type, d);
  std::sort(rows.begin(), rows.end());
  std::vector<Cell> cells;
  for (const auto &[id, d] : rows) {
    const std::size_t type = demands[d].type, donor = draw_donor(pool_of_type[type], id, options.seed);
    const auto radius = static_cast<float>(dictionary.donor.soma_radius[donor]);
    cells.push_back({id, static_cast<std::uint32_t>(type), static_cast<std::uint32_t>(donor),
                     draw_rotation(dictionary, donor, id, options), static_cast<double>(radius), d,
                     glm::dvec3(0.0), nullptr});
  }
  return cells;
}

Somas somas_of(const std::vector<Cell> &cells) {
  Somas somas;
  for (const Cell &cell : cells)
    somas.center.push_back(cell.soma), somas.radius.push_back(cell.radius);
  return somas;
}

void place_cells(const RecipeInput &recipe, const std::vector<Demand> &demands, double gap_um,
                 std::uint64_t seed, const Progress &progress, const Somas &standing,
                 std::vector<Cell> &cells) {
  std::vector<SomaRequest> requests;
  for (const Cell &cell : cells) {
    const Demand &demand = demands[cell.demand];
    requests.push_back(
        {cell.id, cell.radius, demand.z_lo, demand.z_hi, demand.by_profile ? &recipe.profile : nullptr});
  }
  const std::vector<glm::dvec3> somas = place_somas(recipe.box, requests, gap_um, seed, progress, standing);
  for (std::size_t i = 0; i < cells.size(); i++)
    cells[i].soma = somas[i];
}

void tell_axons(conceg_ctx *ctx, const RecipeInput &recipe, const TypeInput &type,
                const std::vector<Axon> &axons) {
  double cable = 0.0, radius = 0.0, along = 0.0;
  for (const Axon &axon : axons) {
    const double cosine = glm::dot(axon.direction, type.axons.direction.axis);
    cable += axon.length, radius += axon.length * axon.radius, along += axon.length * cosine * cosine;
  }
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "place: %s: %zu passing axons, %.3f mm, %.4f um of cable per um3; radius %.3f um, mean "
                 "square cosine to the axis %.3f",
                 type.share.name.c_str(), axons.size(), cable * 1e-3, cable / volume(recipe.box),
                 cable > 0.0 ? radius / cable : 0.0, cable > 0.0 ? along / cable : 0.0);
}

void check_cable(const RecipeInput &recipe) {
  double asked = 0.0;
  for (const TypeInput &type : recipe.types)
    if (type.share.passing) asked += type.axons.cable_density;
  if (asked > kMostCable)
    fail(CONCEG_E_RANGE,
         "types: expected passing axons of at most %g um of cable per um3 in all, got %g, for which there is "
         "no room beside cells; lower cable_density_per_um2",
         kMostCable, asked);
}

// The passing axons of each type, outside the somas.
std::vector<std::vector<Axon>> draw_all_axons(conceg_ctx *ctx, const RecipeInput &recipe,
                                              const std::vector<Cell> &cells, std::uint64_t seed) {
  const Somas somas = somas_of(cells);
  std::vector<std::vector<Axon>> axons(recipe.types.size());
  for (std::size_t t = 0; t < recipe.types.size(); t++) {
    const TypeInput &type = recipe.types[t];
    if (!type.share.passing) continue;
    const std::string name = "types[" + std::to_string(t) + "]";
    axons[t] = draw_axons(recipe.box, type.axons, somas, t, recipe.types.size(), seed, name.c_str(),
                          progress_of(ctx));
    tell_axons(ctx, recipe, type, axons[t]);
  }
  return axons;
}

// The cells of the unperturbed recipe, each in its place, and behind them the glia that come on top: these
// find room around the others and move none.
std::vector<Cell> place_all(conceg_ctx *ctx, const RecipeInput &recipe, const std::vector<Demand> &demands,
                            double gap_um, const Dictionary &dictionary, const std::vector<Pool> &pools,
                            const DonorOptions &options) {
  std::vector<std::uint64_t> made(recipe.types.size());
  std::vector<Cell> cells = draw_cells(demands, dictionary, pools, options, made);
  place_cells(recipe, demands, gap_um, options.seed, progress_of(ctx), {}, cells);
  if (!(recipe.perturb.glia > 1.0)) return cells;
  std::vector<std::uint8_t> grows;
  for (const TypeInput &type : recipe.types)
    grows.push_back(is_glia(type.class_name));
  const std::vector<Demand> more = additional(demands, grows, recipe.perturb.glia);
  std::vector<Cell> added = draw_cells(more, dictionary, pools, options, made);
  place_cells(recipe, more, gap_um, options.seed, progress_of(ctx), somas_of(cells), added);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "place: perturb.glia: %zu cells on top", added.size());
  cells.insert(cells.end(), added.begin(), added.end());
  return cells;
}

// Takes out those that the perturbation loses, after all places and draws are settled.
void lose_cells(conceg_ctx *ctx, const RecipeInput &recipe, const char *factor, double share,
                bool (*concerned)(const std::string &), std::uint64_t seed, std::vector<Cell> &cells) {
  if (!(share < 1.0)) return;
  const auto is_concerned = [&](const Cell &cell) { return concerned(recipe.types[cell.type].class_name); };
  std::vector<std::uint64_t> ids;
  for (const Cell &cell : cells)
    if (is_concerned(cell)) ids.push_back(cell.id);
  const std::vector<std::uint8_t> stays =
      staying(ids, share, seed, (std::string("place.perturb.") + factor).c_str());
  std::size_t next = 0, before = cells.size();
  cells.erase(std::remove_if(cells.begin(), cells.end(),
                             [&](const Cell &cell) { return is_concerned(cell) && !stays[next++]; }),
              cells.end());
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "place: perturb.%s: %zu of %zu cells are lost", factor,
                 before - cells.size(), ids.size());
  if (cells.empty())
    fail(CONCEG_E_RANGE, "perturb.%s: expected a cell to be left, all %zu are lost; raise the factor", factor,
         before);
}

// Puts the axons among the cells, in the order of the ids.
void add_axons(const std::vector<std::vector<Axon>> &axons, std::vector<Cell> &cells) {
  for (std::size_t t = 0; t < axons.size(); t++)
    for (const Axon &axon : axons[t])
      cells.push_back({axon.id, static_cast<std::uint32_t>(t), kNoDonor, glm::dquat(1, 0, 0, 0), 0.0, 0,
                       axon.start, &axon});
  std::sort(cells.begin(), cells.end(), [](const Cell &a, const Cell &b) { return a.id < b.id; });
}

// Many donors have no axon that was traced to its ends: their cells have none either, which must not go
// unseen.
void tell_own_axons(conceg_ctx *ctx, const std::vector<Cell> &cells, const Bars &bars) {
  std::size_t neurons = 0, with_axon = 0;
  for (std::size_t i = 0; i < cells.size(); i++) {
    if (cells[i].axon) continue;
    neurons++;
    const auto first = bars.neurite.begin() + static_cast<std::ptrdiff_t>(bars.cell_offset[i]),
               last = bars.neurite.begin() + static_cast<std::ptrdiff_t>(bars.cell_offset[i + 1]);
    with_axon += std::find(first, last, CONCEG_SWC_AXON) != last;
  }
  conceg_ctx_log(
      ctx, CONCEG_LOG_INFO,
      "place.axons: %zu of %zu cells have an axon of their own; the donors of the others have none "
      "in the dictionary",
      with_axon, neurons);
}

void write_domain(conceg_doc *doc, const RecipeInput &recipe, const std::vector<Demand> &demands) {
  put(doc, "/domain@lo", recipe.box.lo, 3);
  put(doc, "/domain@hi", recipe.box.hi, 3);
  put(doc, "/domain@periodic", recipe.box.periodic, 3);
  put(doc, "/domain@pia", &recipe.pia.x, 3);
  put_scalar<double>(doc, "/domain@lattice_step", CONCEG_LATTICE_STEP_UM);
  if (!recipe.layers.empty()) {
    const glm::dvec3 size = side(recipe.box);
    std::vector<std::string> name;
    std::vector<double> lo, hi, density;
    for (std::size_t i = 0; i < recipe.layers.size(); i++) {
      double expected =
          0.0; // of the types that take a fraction, and of those with a density in this layer alone
      for (const Demand &demand : demands)
        if (demand.layer == static_cast<int>(i)) expected += demand.expected;
      name.push_back(recipe.layers[i].name);
      lo.push_back(recipe.layers[i].z_lo);
      hi.push_back(recipe.layers[i].z_hi);
      density.push_back(expected / (size.x * size.y * (hi.back() - lo.back())));
    }
    put_texts(doc, "/domain/layer_name", name);
    put(doc, "/domain/layer_lo", lo);
    put(doc, "/domain/layer_hi", hi);
    put(doc, "/domain/layer_density", density);
  }
  if (!recipe.profile.z.empty()) {
    put(doc, "/domain/profile_z", recipe.profile.z);
    put(doc, "/domain/profile_density", recipe.profile.density);
  }
}

void write_types(conceg_doc *doc, const RecipeInput &recipe, const std::vector<Demand> &demands,
                 const std::vector<Cell> &cells) {
  const std::size_t types = recipe.types.size();
  std::vector<std::string> name, class_name, layer, entry;
  std::vector<double> fraction(types), radius_scale;
  std::vector<std::uint64_t> asked(types), placed(types); // by the densities; after the perturbation
  double total = 0.0;
  for (const Demand &demand : demands) {
    fraction[demand.type] += demand.expected;
    asked[demand.type] += demand.count;
    total += demand.expected;
  }
  for (double &share : fraction)
    share = total > 0.0 ? share / total : 0.0;
  for (const Cell &cell : cells) {
    placed[cell.type]++;
    if (cell.axon) asked[cell.type]++; // their number follows from the cable that was asked for
  }
  for (const TypeInput &type : recipe.types) {
    name.push_back(type.share.name);
    class_name.push_back(type.class_name);
    layer.push_back(type.layer);
    entry.push_back(type.entry);
    radius_scale.push_back(type.radius_scale);
  }
  put_texts(doc, "/types/name", name);
  put_texts(doc, "/types/class", class_name);
  put(doc, "/types/fraction", fraction);
  put_texts(doc, "/types/layer", layer);
  put_texts(doc, "/types/entry", entry);
  put(doc, "/types/radius_scale", radius_scale);
  put(doc, "/types/asked", asked);
  put(doc, "/types/placed", placed);
}

void write_cells(conceg_doc *doc, const std::vector<Cell> &cells) {
  std::vector<std::uint64_t> id;
  std::vector<std::uint32_t> type, donor;
  std::vector<double> rotation;
  std::vector<glm::dvec3> soma;
  std::vector<float> radius;
  for (const Cell &cell : cells) {
    const glm::dquat &q = cell.rotation;
    id.push_back(cell.id), type.push_back(cell.type), donor.push_back(cell.donor);
    rotation.insert(rotation.end(), {q.w, q.x, q.y, q.z});
    soma.push_back(cell.soma), radius.push_back(static_cast<float>(cell.radius));
  }
  put(doc, "/cells/id", id);
  put(doc, "/cells/type", type);
  put(doc, "/cells/donor", donor);
  put(doc, "/cells/rotation", rotation, 4);
  put3(doc, "/cells/soma", soma);
  put(doc, "/cells/radius", radius);
}

void write_bars(conceg_doc *doc, const Bars &bars) {
  const std::size_t count = bars.tree.size();
  put(doc, "/bars/cell_offset", bars.cell_offset);
  put(doc, "/bars/tree", bars.tree);
  put(doc, "/bars/parent", bars.parent);
  put(doc, "/bars/neurite", bars.neurite);
  put(doc, "/bars/asked_start", bars.start);
  put(doc, "/bars/asked_end", bars.end);
  put(doc, "/bars/achieved_start", std::vector<double>(count));
  put(doc, "/bars/achieved_end", std::vector<double>(count));
  put3(doc, "/bars/attractor", bars.attractor);
  put(doc, "/bars/angle", bars.angle);
  put(doc, "/bars/radius", bars.radius);
  put(doc, "/bars/taper", bars.taper);
  put(doc, "/bars/radius_floor", bars.radius_floor);
  put(doc, "/bars/state", std::vector<std::uint8_t>(count));
  put(doc, "/bars/handed_to", std::vector<std::int64_t>(count, -1));
}

DonorOptions read_options(conceg_ctx *ctx, const RecipeInput &recipe, const conceg_params *params) {
  DonorOptions options;
  options.pia = recipe.pia;
  options.axons = conceg_params_bool(params, "axons") != 0;
  options.independent_trees = std::strcmp(conceg_params_text(params, "trees"), "independent") == 0;
  options.drawn_angles = std::strcmp(conceg_params_text(params, "angles"), "drawn") == 0;
  options.min_radius_um = conceg_params_f64(params, "min_radius_um");
  options.seed = conceg_ctx_seed(ctx);
  return options;
}

std::vector<Demand> count_cells(const RecipeInput &recipe) {
  std::vector<TypeShare> shares;
  for (const TypeInput &type : recipe.types)
    shares.push_back(type.share);
  const glm::dvec3 size = side(recipe.box);
  return compose({size.x * size.y, recipe.box.lo[2], recipe.box.hi[2]}, recipe.layers, shares, recipe.density,
                 recipe.profile);
}

// Marks the donors that are held back, and gives what each type may draw from: nothing for passing axons.
std::vector<Pool> pools_for(conceg_ctx *ctx, const RecipeInput &recipe, std::int64_t fold,
                            const std::vector<std::size_t> &entry_of_type, Dictionary &dictionary) {
  for (const std::string &entry : hold_back(dictionary, fold))
    conceg_ctx_log(
        ctx, CONCEG_LOG_WARNING,
        "place.validation_fold: dictionary entry %s has no donor of fold %lld, so none is held back",
        entry.c_str(), static_cast<long long>(fold));
  std::vector<Pool> pools;
  for (std::size_t t = 0; t < recipe.types.size(); t++)
    pools.push_back(recipe.types[t].share.passing ? Pool() : pool_of(dictionary, entry_of_type[t]));
  return pools;
}

Bars ask_bars(conceg_ctx *ctx, const RecipeInput &recipe, const Dictionary &dictionary,
              const std::vector<Pool> &pool_of_type, const std::vector<Cell> &cells,
              const DonorOptions &options) {
  Bars bars;
  for (std::size_t i = 0; i < cells.size(); i++) {
    const Cell &cell = cells[i];
    if (cell.axon)
      append_axon(*cell.axon, options.min_radius_um, bars);
    else
      append_cell(dictionary, pool_of_type[cell.type],
                  {cell.id, cell.donor, cell.rotation, cell.soma, recipe.types[cell.type].radius_scale,
                   is_neuron(recipe.types[cell.type].class_name) ? recipe.perturb.dendrites : 1.0},
                  options, bars);
    must(conceg_ctx_progress(ctx, "barcodes", i + 1, cells.size()));
  }
  return bars;
}

void place_document(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const RecipeInput recipe = read_recipe(ctx, doc);
  check_cable(recipe);
  const DonorOptions options = read_options(ctx, recipe, params);
  std::vector<std::size_t> entry_of_type;
  Dictionary dictionary = dictionary_for(ctx, recipe, entry_of_type);
  const std::vector<Pool> pools =
      pools_for(ctx, recipe, conceg_params_i64(params, "validation_fold"), entry_of_type, dictionary);
  const std::vector<Demand> demands = count_cells(recipe);
  std::vector<Cell> cells =
      place_all(ctx, recipe, demands, conceg_params_f64(params, "soma_gap_um"), dictionary, pools, options);
  // Around lost cells too: the axons of a pair are the same.
  const std::vector<std::vector<Axon>> axons = draw_all_axons(ctx, recipe, cells, options.seed);
  lose_cells(ctx, recipe, "neurons", recipe.perturb.neurons, is_neuron, options.seed, cells);
  lose_cells(ctx, recipe, "glia", recipe.perturb.glia, is_glia, options.seed, cells);
  add_axons(axons, cells);
  const Bars bars = ask_bars(ctx, recipe, dictionary, pools, cells, options);
  if (options.axons) tell_own_axons(ctx, cells, bars);
  write_domain(doc, recipe, demands);
  write_types(doc, recipe, demands, cells);
  write_dictionary(doc, dictionary);
  write_cells(doc, cells);
  write_bars(doc, bars);
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "place", [&] { place_document(ctx, doc, params); });
}

const conceg_param kParams[] = {
    {"soma_gap_um", "um", "smallest distance between the surfaces of two somas, images included", "1",
     nullptr, CONCEG_PARAM_F64, 0, 0, 1000},
    {"axons", "", "also grow the axon trees that the dictionary has for a donor", "false", nullptr,
     CONCEG_PARAM_BOOL, 0, 0, 0},
    {"trees", "",
     "trees of a cell: all from its one donor, or each drawn independently from all donors of the entry",
     "donor", "donor|independent", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"validation_fold", "1", "fold of donors that no cell draws, kept for comparisons (-1 = none)", "-1",
     nullptr, CONCEG_PARAM_I64, 0, -1, 4},
    {"angles", "",
     "angle at a fork: the donor's own, or drawn from the distribution of its entry as in the paper", "donor",
     "donor|drawn", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"min_radius_um", "um", "smallest target radius of a process", "0.15", nullptr, CONCEG_PARAM_F64, 0, 0.01,
     10},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0},
};
const char *const kReads[] = {nullptr};
const char *const kWrites[] = {"domain", "types", "dictionary", "cells", "bars", nullptr};
const char *const kDrops[] = {nullptr};

} // namespace

extern "C" {
extern CONCEG_EXPORT const conceg_stage conceg_stage_place;
const conceg_stage conceg_stage_place = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "place",
    "random",
    "1.0.0",
    "puts somas into the box by density and composition, and asks for each cell the barcode of a donor",
    "conceg place -p apps/recipes/cube.yaml > cells.cgx",
    kParams,
    kReads,
    kWrites,
    kDrops,
    CONCEG_STAGE_SOURCE | CONCEG_STAGE_RECIPE,
    nullptr,
    run,
};
}
