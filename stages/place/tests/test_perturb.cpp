// SPDX-License-Identifier: BSD-3-Clause
// Controlled perturbation: a factor of 1 is the unperturbed document to the byte; every other factor changes
// what it names and leaves place, donor, rotation and bars of all other cells as they were.
#include "run_place.hpp"

#include "../perturb.hpp"
#include "conceg/swc.h"

#include <cstdio>
#include <set>

namespace {

struct Drawn { // of one cell
  std::uint32_t type, donor;
  std::vector<double> place;                       // soma, rotation, radius
  std::vector<std::vector<double>> bars;           // start, end, angle, radius, taper
  std::vector<std::array<double, 3>> to_attractor; // from the soma
  std::vector<std::uint8_t> neurite;
  bool operator==(const Drawn &o) const {
    return type == o.type && donor == o.donor && place == o.place && bars == o.bars &&
           to_attractor == o.to_attractor && neurite == o.neurite;
  }
};

using Cells = std::map<std::uint64_t, Drawn>; // by id

Cells cells_of(conceg_doc *doc) {
  Cells out;
  const auto id = view<std::uint64_t>(doc, "/cells/id"),
             offset = view<std::uint64_t>(doc, "/bars/cell_offset");
  const auto type = view<std::uint32_t>(doc, "/cells/type"), donor = view<std::uint32_t>(doc, "/cells/donor");
  const auto soma = view<double>(doc, "/cells/soma", 3), rotation = view<double>(doc, "/cells/rotation", 4),
             attractor = view<double>(doc, "/bars/attractor", 3);
  const auto radius = view<float>(doc, "/cells/radius");
  const auto neurite = view<std::uint8_t>(doc, "/bars/neurite");
  std::vector<View<double>> values;
  for (const char *name : {"asked_start", "asked_end", "angle", "radius", "taper"})
    values.push_back(view<double>(doc, (std::string("/bars/") + name).c_str()));
  for (std::size_t i = 0; i < id.rows(); i++) {
    Drawn cell = {type[i], donor[i], {}, {}, {}, {}};
    cell.place.assign(soma.row(i), soma.row(i) + 3);
    cell.place.insert(cell.place.end(), rotation.row(i), rotation.row(i) + 4);
    cell.place.push_back(static_cast<double>(radius[i]));
    for (std::uint64_t b = offset[i]; b < offset[i + 1]; b++) {
      std::vector<double> row;
      for (const View<double> &value : values)
        row.push_back(value[b]);
      cell.bars.push_back(row);
      cell.neurite.push_back(neurite[b]);
      cell.to_attractor.push_back({attractor.row(b)[0] - soma.row(i)[0], attractor.row(b)[1] - soma.row(i)[1],
                                   attractor.row(b)[2] - soma.row(i)[2]});
    }
    out[id[i]] = cell;
  }
  return out;
}

const std::string axons = "  - {name: x, class: axon, cable_density_per_um2: 0.05}\n";
constexpr std::uint64_t kTypes = 5, kGlia = 3, kAxon = 4;

Cells perturbed(std::vector<const char *> sets, const std::string &more = "") {
  conceg_doc *doc = run(recipe_text((axons + more).c_str()), std::move(sets));
  CHECK(doc != nullptr);
  if (!doc) {
    std::fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    return {};
  }
  CHECK_EQUAL(conceg_doc_validate(doc, nullptr, nullptr, nullptr), CONCEG_OK);
  Cells cells = cells_of(doc);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  return cells;
}

std::size_t count(const Cells &cells, bool neurons) {
  std::size_t n = 0;
  for (const auto &[id, cell] : cells)
    n += neurons ? cell.type < kGlia : cell.type == kGlia;
  return n;
}

// All of `some` are among `all`, with the same draws.
bool among(const Cells &some, const Cells &all) {
  for (const auto &[id, cell] : some)
    if (!all.count(id) || !(all.at(id) == cell)) return false;
  return !some.empty();
}

void test_one() {
  conceg_doc *doc = run(recipe_text(axons.c_str()));
  const std::string plain = digest(doc);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  doc = run(recipe_text((axons + "perturb: {neurons: 1, dendrites: 1.0, glia: 1, ecs: 1}\n").c_str()));
  CHECK(doc && plain == digest(doc));
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  doc = run(recipe_text(axons.c_str()), {"perturb.glia=1"});
  CHECK(doc && plain == digest(doc));
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  doc = run(recipe_text(axons.c_str()), {"perturb.ecs=0.9"}); // of relax: here the recipe alone says so
  CHECK(doc && plain != digest(doc));
  CHECK(perturbed({"perturb.ecs=0.9"}) == perturbed({}));
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

void test_neurons(const Cells &plain) {
  const Cells most = perturbed({"perturb.neurons=0.9"}), half = perturbed({"perturb.neurons=0.5"});
  CHECK_EQUAL(count(plain, true), 82);
  CHECK_EQUAL(count(most, true), 74); // 73.8
  CHECK_EQUAL(count(half, true), 41);
  CHECK(among(half, most) && among(most, plain));
  CHECK_EQUAL(plain.size() - half.size(), 41); // no glia and no axon is gone
  CHECK_EQUAL(count(perturbed({"perturb.neurons=0"}), true), 0);
  CHECK(!(perturbed({"perturb.neurons=0.5", "seed=4"}) == half));
}

void test_glia(const Cells &plain) {
  CHECK_EQUAL(count(plain, false), 20);
  const Cells half = perturbed({"perturb.glia=0.5"}), twice = perturbed({"perturb.glia=2"});
  CHECK_EQUAL(count(half, false), 10);
  CHECK(among(half, plain));
  CHECK_EQUAL(count(twice, false), 40);
  std::size_t redrawn = 0;
  for (const auto &[id, cell] : plain) {
    if (cell.type != kAxon) CHECK(twice.count(id) && twice.at(id) == cell);
    redrawn += cell.type == kAxon && !(twice.count(id) && twice.at(id) == cell); // began in a new soma
  }
  CHECK(redrawn <= 40);
  // New cells keep their distance to all others, images included.
  double least = 1e9;
  for (const auto &[a, p] : twice)
    for (const auto &[b, q] : twice) {
      if (a >= b || p.type == kAxon || q.type == kAxon) continue;
      double square = 0;
      for (int axis = 0; axis < 3; axis++) {
        const double d = p.place[axis] - q.place[axis];
        square += std::pow(d - 80 * std::round(d / 80), 2);
      }
      least = std::min(least, std::sqrt(square) - p.place[7] - q.place[7]);
    }
  CHECK(least >= 1.0 - 1e-4);
}

void test_dendrites(const Cells &plain) {
  const Cells shorter = perturbed({"perturb.dendrites=0.6", "place.axons=true"}),
              same = perturbed({"place.axons=true"});
  CHECK_EQUAL(shorter.size(), plain.size());
  std::size_t bars = 0, own_axons = 0;
  for (const auto &[id, cell] : same) {
    const Drawn &now = shorter.at(id);
    CHECK(now.donor == cell.donor && now.place == cell.place && now.neurite == cell.neurite);
    if (cell.type >= kGlia) CHECK(now == cell);
    if (cell.type >= kGlia) continue;
    for (std::size_t b = 0; b < cell.bars.size(); b++) {
      if (cell.neurite[b] == CONCEG_SWC_AXON) {
        own_axons++;
        CHECK(now.bars[b] == cell.bars[b] && now.to_attractor[b] == cell.to_attractor[b]);
        continue;
      }
      bars++;
      CHECK_NEAR(now.bars[b][0], 0.6 * cell.bars[b][0], 1e-9);
      CHECK_NEAR(now.bars[b][1], 0.6 * cell.bars[b][1], 1e-9);
      CHECK(now.bars[b][2] == cell.bars[b][2] && now.bars[b][3] == cell.bars[b][3]); // angle, mean radius
      // The radius at the end of the bar is what it was there.
      CHECK_NEAR(now.bars[b][4] * (now.bars[b][1] - now.bars[b][0]),
                 cell.bars[b][4] * (cell.bars[b][1] - cell.bars[b][0]), 1e-9);
      // The attractor lies in the same direction, its way from the soma's surface shortened.
      double before = 0, after = 0, dot = 0;
      for (int axis = 0; axis < 3; axis++) {
        before += std::pow(cell.to_attractor[b][axis], 2), after += std::pow(now.to_attractor[b][axis], 2);
        dot += cell.to_attractor[b][axis] * now.to_attractor[b][axis];
      }
      before = std::sqrt(before), after = std::sqrt(after);
      CHECK_NEAR(dot / (before * after), 1.0, 1e-9);
      const double soma = cell.place[7];
      CHECK_NEAR(after, before <= soma ? before : soma + 0.6 * (before - soma), 1e-4);
    }
  }
  CHECK(bars > 1000);
  CHECK(own_axons > 0);
}

// Ranks, not coins: exact counts, nested, and each id by itself.
void test_staying() {
  std::vector<std::uint64_t> ids;
  for (std::uint64_t i = 0; i < 1000; i++)
    ids.push_back(5 * i + 1);
  const auto most = conceg::place::staying(ids, 0.8, 7, "test"),
             few = conceg::place::staying(ids, 0.25, 7, "test");
  CHECK_EQUAL(std::count(most.begin(), most.end(), 1), 800);
  CHECK_EQUAL(std::count(few.begin(), few.end(), 1), 250);
  std::size_t early = 0;
  for (std::size_t i = 0; i < ids.size(); i++) {
    CHECK(!few[i] || most[i]);
    early += i < 500 && few[i];
  }
  CHECK(early > 95 && early < 155); // 125 +- 3 sd
  const auto other = conceg::place::staying(ids, 0.25, 8, "test");
  CHECK(other != few);
}

void refused(const char *set, const char *expected) {
  conceg_doc *doc = run(recipe_text(""), {set});
  CHECK(doc == nullptr);
  if (doc) CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  const std::string line = conceg_ctx_error(ctx);
  CHECK(line.find(expected) != std::string::npos);
  if (line.find(expected) == std::string::npos) std::fprintf(stderr, "%s: got: %s\n", set, line.c_str());
}

} // namespace

int main() {
  ctx = conceg_ctx_new();
  conceg_ctx_set_log(ctx, CONCEG_LOG_WARNING, nullptr, nullptr);
  const Cells plain = perturbed({});
  CHECK_EQUAL(plain.size() > 102, true);
  test_one();
  test_neurons(plain);
  test_glia(plain);
  test_dendrites(plain);
  test_staying();
  refused("perturb.neurons=1.1", "perturb.neurons: expected a factor from 0 to 1, got 1.1");
  refused("perturb.dendrites=0.05", "perturb.dendrites: expected a factor from 0.1 to 1, got 0.05");
  refused("perturb.glia=11", "perturb.glia: expected a factor from 0 to 10, got 11");
  refused("perturb.ecs=0", "perturb.ecs: expected a factor from 0.1 to 10, got 0");
  refused("perturb.glia=-1", "perturb.glia: expected a number, 0 or more, got -1");
  refused("perturb.neuron=0.5", "unknown key perturb.neuron; did you mean neurons?");
  conceg_ctx_free(ctx);
  return check_done();
}
