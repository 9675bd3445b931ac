// SPDX-License-Identifier: BSD-3-Clause
#include "schedule.hpp"

#include "occupancy.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::grow {

namespace {

constexpr std::size_t least_tips = 16; // a round offers at least so many steps while there are as many tips
constexpr double least_room_um3 = 1000.0;    // box per step of a round: nearer ones would mostly be put off
constexpr double stand_apart_um = 6.0;       // tips of one round; nearer ones would mostly be put off
constexpr std::size_t fewest_to_share = 300; // fewer offers are filled before a worker has woken
constexpr double plan_step_um = 2.0;         // grid on which steps keep out of each other's way

} // namespace

Schedule::Schedule(const State &state, Team &team) : state_(state), team_(team) {
  const conceg_box &box = state.input.box;
  tips_of_.resize(state.input.cells.count);
  next_tip_.assign(state.input.cells.count, 0);
  double room = 1.0 / least_room_um3;
  for (int axis = 0; axis < 3; axis++)
    room *= conceg_box_side(&box, axis);
  most_tips_ = std::max(static_cast<std::size_t>(room), least_tips);
  plan_ = make_grid(box, plan_step_um);
  written_.assign(plan_.cells(), 0), read_.assign(plan_.cells(), 0);
  stand_ = make_grid(box, stand_apart_um);
  stood_.resize(stand_.cells());
}

void Schedule::enter(std::uint32_t bar) {
  tips_of_[state_.projections[bar].cell].push_back(bar);
}

void Schedule::leave(std::uint32_t bar) {
  const std::uint32_t cell = state_.projections[bar].cell;
  std::vector<std::uint32_t> &tips = tips_of_[cell];
  const auto found = std::find(tips.begin(), tips.end(), bar);
  if (found == tips.end()) return;
  const auto place = static_cast<std::size_t>(found - tips.begin());
  tips.erase(found);
  if (next_tip_[cell] > place) next_tip_[cell]--;
  if (next_tip_[cell] >= tips.size()) next_tip_[cell] = 0;
}

std::size_t Schedule::cells_done() const {
  return static_cast<std::size_t>(
      std::count_if(tips_of_.begin(), tips_of_.end(), [](const auto &tips) { return tips.empty(); }));
}

// One tip of each working cell by its own rota; several when few cells work, and not all cells when so many
// work that they would stand in each other's way.
void Schedule::offer_by_rota() {
  offers_.clear();
  const std::size_t working = tips_of_.size() - cells_done();
  if (working == 0) return;
  const std::size_t share = (least_tips + working - 1) / working;
  const std::size_t cells = std::min(working, most_tips_);
  for (std::size_t chosen = 0; chosen < cells; next_cell_ = (next_cell_ + 1) % tips_of_.size()) {
    const std::size_t cell = next_cell_;
    const std::vector<std::uint32_t> &tips = tips_of_[cell];
    if (tips.empty()) continue;
    chosen++;
    const std::size_t number = std::min(share, tips.size());
    for (std::size_t i = 0; i < number; i++)
      offers_.push_back({0, tips[(next_tip_[cell] + i) % tips.size()], {}});
    next_tip_[cell] = (next_tip_[cell] + number) % tips.size();
  }
  if (cells == working) next_cell_ = 0;
}

const std::vector<std::uint32_t> &Schedule::choose(std::uint64_t round) {
  offer_by_rota();
  const auto fill = [&](Offer &offer) {
    const Projection &projection = state_.projections[offer.bar];
    const std::uint64_t key = conceg_rng_mix(
        state_.input.seed ^ conceg_rng_mix(round ^ conceg_rng_mix(state_.input.cells.id[projection.cell])));
    offer.priority = conceg_rng_mix(key ^ offer.bar);
    offer.tip = projection.chain.back().position;
  };
  if (offers_.size() < fewest_to_share)
    std::for_each(offers_.begin(), offers_.end(), fill);
  else
    team_.loop(offers_.size(), [&](std::size_t i, unsigned) { fill(offers_[i]); });
  std::sort(offers_.begin(), offers_.end(), [](const Offer &x, const Offer &y) {
    return x.priority < y.priority || (x.priority == y.priority && x.bar < y.bar);
  });
  tips_.clear();
  for (const Offer &offer : offers_)
    if (stands_alone(offer.tip, static_cast<std::uint32_t>(round))) tips_.push_back(offer.bar);
  return tips_;
}

// Whether no tip of this round stands within `stand_apart_um`; if so this one is noted.
bool Schedule::stands_alone(const glm::dvec3 &tip, std::uint32_t round) {
  const glm::vec3 place(tip);
  bool alone = true;
  std::size_t home = 0;
  for_grid_cells(stand_, {tip, tip}, [&](std::size_t cell) { home = cell; });
  for_grid_cells(stand_, {tip - stand_apart_um, tip + stand_apart_um}, [&](std::size_t cell) {
    const Stand &stand = stood_[cell];
    if (!alone || stand.round != round) return;
    for (std::uint32_t i = 0; i < stand.count; i++) {
      glm::dvec3 d(stand.tip[i] - place);
      for (int a = 0; a < 3; a++)
        d[a] = conceg_box_nearest(&state_.input.box, a, d[a]);
      alone &= glm::dot(d, d) > stand_apart_um * stand_apart_um;
    }
  });
  Stand &stand = stood_[home];
  if (stand.round != round) stand.round = round, stand.count = 0;
  if (!alone || stand.count == std::size(stand.tip)) return false;
  stand.tip[stand.count++] = place;
  return true;
}

const std::vector<std::size_t> &Schedule::reserve(const std::vector<Edit> &edits, std::uint64_t round) {
  accepted_.clear();
  const auto stamp = static_cast<std::uint32_t>(round);
  const auto written = [&](std::uint32_t cell) { return written_[cell] == stamp; };
  const auto touched = [&](std::uint32_t cell) { return written_[cell] == stamp || read_[cell] == stamp; };
  for (std::size_t i = 0; i < tips_.size(); i++) {
    const Edit &edit = edits[i];
    if (std::any_of(edit.write_cells.begin(), edit.write_cells.end(), touched) ||
        std::any_of(edit.read_cells.begin(), edit.read_cells.end(), written)) {
      deferred_++;
      continue;
    }
    for (const std::uint32_t cell : edit.write_cells)
      written_[cell] = stamp;
    for (const std::uint32_t cell : edit.read_cells)
      read_[cell] = stamp;
    accepted_.push_back(i);
  }
  return accepted_;
}

} // namespace conceg::grow
