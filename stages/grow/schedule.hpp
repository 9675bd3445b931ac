// SPDX-License-Identifier: BSD-3-Clause
// Which steps a round takes: tips by rota, not too near to each other, then those whose proposals do not
// meet. Depends on the state and the round's number alone, never on the number of threads.
#pragma once

#include "edit.hpp"
#include "state.hpp"

#include <utility>

namespace conceg::grow {

class Schedule {
public:
  explicit Schedule(const State &state);

  // Bars that grow or start enter, and leave when they end or wait.
  void enter(std::uint32_t bar);
  void leave(std::uint32_t bar);
  // The bar's tip is elsewhere now.
  void moved(std::uint32_t bar);
  std::size_t cells_done() const { return tips_of_.size() - working_.size(); }

  // The tips of this round by a priority drawn for it; none left = empty.
  const std::vector<std::uint32_t> &choose(std::uint64_t round);
  // Lists the grid cells of a proposal's regions; may run beside others.
  void plan(Edit &edit) const { list_cells(plan_, edit); }
  // Deterministic reservations: in the order of the tips, a step is accepted when it writes nothing that an
  // accepted one reads or writes, and reads nothing that an accepted one writes. Rows of the tips, ascending.
  const std::vector<std::size_t> &reserve(const std::vector<Edit> &edits, std::uint64_t round);
  std::uint64_t deferred() const { return deferred_; }

private:
  // Tips that stand in one grid cell of the side of their least distance; of a cube's corners there are 8.
  struct Stand {
    std::uint32_t round = 0, count = 0;
    glm::vec3 tip[8];
  };
  struct Offer {
    std::uint64_t priority;
    std::uint32_t bar;
  };
  void offer(std::uint32_t cell, std::uint32_t bar, std::uint64_t round);
  void offer_by_rota(std::uint64_t round);
  bool stands_alone(const glm::vec3 &place, std::uint32_t round);

  const State &state_;
  std::vector<glm::vec3> place_;                    // by bar, of its tip
  std::vector<std::vector<std::uint32_t>> tips_of_; // by cell
  std::vector<std::size_t> next_tip_;
  std::vector<std::uint32_t> working_; // cells that have tips, ascending
  std::uint32_t next_cell_ = 0;        // where the next round begins
  std::size_t most_tips_;
  Grid plan_, stand_;
  std::vector<Stand> stood_;
  std::vector<std::uint32_t> written_, read_; // by cell of the plan: the round that last did
  std::vector<Offer> offers_;
  std::vector<std::uint32_t> tips_;
  std::vector<std::size_t> accepted_;
  std::uint64_t deferred_ = 0;
};

} // namespace conceg::grow
