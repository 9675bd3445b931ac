// SPDX-License-Identifier: BSD-3-Clause
#include "schedule.hpp"

#include "occupancy.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::grow {

namespace {

constexpr std::size_t least_tips = 16; // a round offers at least so many steps while there are as many tips
constexpr double least_room_um3 = 1000.0; // box per step of a round: nearer ones would mostly be put off
constexpr double stand_apart_um = 6.0;    // tips of one round; nearer ones would mostly be put off
constexpr double plan_step_um = 2.0;      // grid on which steps keep out of each other's way

} // namespace

Schedule::Schedule(const State &state) : state_(state) {
  const conceg_box &box = state.input.box;
  tips_of_.resize(state.input.cells.count);
  place_.resize(state.projections.size());
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
  const std::uint32_t cell = state_.projections[bar].cell;
  if (tips_of_[cell].empty()) working_.insert(std::lower_bound(working_.begin(), working_.end(), cell), cell);
  tips_of_[cell].push_back(bar);
  moved(bar);
}

void Schedule::moved(std::uint32_t bar) {
  place_[bar] = glm::vec3(state_.projections[bar].chain.back().position);
}

void Schedule::leave(std::uint32_t bar) {
  const std::uint32_t cell = state_.projections[bar].cell;
  std::vector<std::uint32_t> &tips = tips_of_[cell];
  const auto found = std::find(tips.begin(), tips.end(), bar);
  if (found == tips.end()) return;
  const auto place = static_cast<std::size_t>(found - tips.begin());
  tips.erase(found);
  if (tips.empty()) working_.erase(std::lower_bound(working_.begin(), working_.end(), cell));
  if (next_tip_[cell] > place) next_tip_[cell]--;
  if (next_tip_[cell] >= tips.size()) next_tip_[cell] = 0;
}

void Schedule::offer(std::uint32_t cell, std::uint32_t bar, std::uint64_t round) {
  const std::uint64_t key =
      conceg_rng_mix(state_.input.seed ^ conceg_rng_mix(round ^ conceg_rng_mix(state_.input.cells.id[cell])));
  offers_.push_back({conceg_rng_mix(key ^ bar), bar});
}

// One tip of each working cell by its own rota; several when few cells work, and not all cells when so many
// work that they would stand in each other's way.
void Schedule::offer_by_rota(std::uint64_t round) {
  offers_.clear();
  const std::size_t working = working_.size();
  if (working == 0) return;
  const std::size_t share = (least_tips + working - 1) / working;
  const std::size_t cells = std::min(working, most_tips_);
  auto at = std::lower_bound(working_.begin(), working_.end(), next_cell_);
  for (std::size_t chosen = 0; chosen < cells; chosen++, at++) {
    if (at == working_.end()) at = working_.begin();
    const std::uint32_t cell = *at;
    const std::vector<std::uint32_t> &tips = tips_of_[cell];
    const std::size_t number = std::min(share, tips.size());
    for (std::size_t i = 0; i < number; i++)
      offer(cell, tips[(next_tip_[cell] + i) % tips.size()], round);
    next_tip_[cell] = (next_tip_[cell] + number) % tips.size();
  }
  next_cell_ = cells == working || at == working_.end() ? 0 : *at;
}

const std::vector<std::uint32_t> &Schedule::choose(std::uint64_t round) {
  offer_by_rota(round);
  std::sort(offers_.begin(), offers_.end(), [](const Offer &x, const Offer &y) {
    return x.priority < y.priority || (x.priority == y.priority && x.bar < y.bar);
  });
  tips_.clear();
  for (const Offer &offer : offers_)
    if (stands_alone(place_[offer.bar], static_cast<std::uint32_t>(round))) tips_.push_back(offer.bar);
  return tips_;
}

// Whether no tip of this round stands within `stand_apart_um`; if so this one is noted.
bool Schedule::stands_alone(const glm::vec3 &place, std::uint32_t round) {
  const glm::dvec3 tip(place);
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
