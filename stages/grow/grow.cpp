// SPDX-License-Identifier: BSD-3-Clause
#include "grow.hpp"

#include "branch.hpp"
#include "calibre.hpp"
#include "collapse.hpp"
#include "course.hpp"
#include "edit.hpp"
#include "occupancy.hpp"
#include "roots.hpp"
#include "step.hpp"
#include "team.hpp"

#include <algorithm>

namespace conceg::grow {

namespace {

constexpr std::size_t least_tips = 16; // a round offers at least so many steps while there are as many tips
constexpr double least_room_um3 = 1000.0; // box per step of a round: nearer ones would mostly be put off

double volume_of(const Segment &segment) {
  const double pi = 3.14159265358979323846, r = segment.radius;
  return segment.bar == none ? 4.0 / 3.0 * pi * r * r * r : pi * r * r * 2.0 * segment.half_length;
}

class Growth {
public:
  Growth(State &state, unsigned threads, const Watch &watch)
      : state_(state), watch_(watch), team_(threads), steering_(state) {
    summary_.steps_by_worker.assign(team_.size(), 0);
    written_.assign(state.space.grid.cells(), 0);
    read_.assign(state.space.grid.cells(), 0);
    tips_of_.resize(state.input.cells.count);
    next_tip_.assign(state.input.cells.count, 0);
    orphans_.resize(state.input.cells.count);
  }

  Summary run(const Progress &progress) {
    start_roots(true);
    bool all_started = false; // cells without a soma fill what room the others leave
    double asked = 0.0;
    for (std::size_t bar = 0; bar < state_.input.bars.count; bar++)
      asked += state_.input.bars.asked_end[bar] - state_.input.bars.asked_start[bar];
    for (;;) {
      choose_tips();
      if (tips_.empty() && !all_started) {
        start_roots(false);
        all_started = true;
        choose_tips();
      }
      if (tips_.empty()) break;
      if (summary_.rounds % 64 == 0)
        report(progress, "grow", static_cast<std::uint64_t>(grown_), static_cast<std::uint64_t>(asked));
      tell_tenth(asked);
      summary_.rounds++;
      round();
    }
    lose_the_rest();
    report(progress, "grow", static_cast<std::uint64_t>(asked), static_cast<std::uint64_t>(asked));
    return finish();
  }

private:
  void tell_tenth(double asked) {
    if (!watch_.tenth || 10.0 * grown_ < (tenths_told_ + 1) * asked) return;
    tenths_told_ = static_cast<int>(10.0 * grown_ / asked);
    Standing standing;
    standing.cable_um = grown_, standing.asked_um = asked, standing.cells = tips_of_.size();
    for (const auto &tips : tips_of_)
      standing.cells_done += tips.empty();
    for (const Segment &segment : state_.space.segments)
      if (segment.alive) standing.occupied_um3 += volume_of(segment);
    watch_.tenth(standing);
  }

  // Roots of the cells with a soma, or of those without.
  void start_roots(bool with_soma) {
    Edit edit;
    for (std::uint32_t bar = 0; bar < state_.projections.size(); bar++) {
      if (state_.projections[bar].parent != none) continue;
      if ((state_.input.cells.radius[state_.projections[bar].cell] > 0.0f) != with_soma) continue;
      if (!propose_root(state_, bar, edit)) {
        state_.projections[bar].phase = Phase::lost;
        orphan_waiting(bar);
        continue;
      }
      number_segments(state_.space, edit);
      commit(state_, edit);
      mark_tail(state_, edit);
      adopt_children(state_, bar);
      tips_of_[state_.projections[bar].cell].push_back(bar);
    }
  }

  // One tip of each working cell by its own rota; several when few cells work, and not all cells when so many
  // work that they would stand in each other's way. Depends on the state only.
  void choose_tips() {
    tips_.clear();
    std::size_t working = 0;
    for (const auto &tips : tips_of_)
      working += !tips.empty();
    if (working == 0) return;
    const std::size_t share = (least_tips + working - 1) / working;
    double room = 1.0 / least_room_um3;
    for (int axis = 0; axis < 3; axis++)
      room *= conceg_box_side(&state_.input.box, axis);
    const std::size_t cells = std::min(working, std::max(static_cast<std::size_t>(room), least_tips));
    for (std::size_t chosen = 0; chosen < cells; next_cell_ = (next_cell_ + 1) % tips_of_.size()) {
      const std::size_t cell = next_cell_;
      const std::vector<std::uint32_t> &tips = tips_of_[cell];
      if (tips.empty()) continue;
      chosen++;
      const std::size_t number = std::min(share, tips.size());
      for (std::size_t i = 0; i < number; i++)
        tips_.push_back(tips[(next_tip_[cell] + i) % tips.size()]);
      next_tip_[cell] = (next_tip_[cell] + number) % tips.size();
    }
    if (cells == working) next_cell_ = 0;
  }

  void round() {
    if (edits_.size() < tips_.size()) edits_.resize(tips_.size());
    team_.loop(tips_.size(), [&](std::size_t i, unsigned) {
      propose(state_, tips_[i], edits_[i]);
      list_cells(state_.space.grid, edits_[i]);
    });
    reserve();
    if (watch_.before) watch_.before(state_, accepted_by_priority());
    for (const std::size_t i : accepted_) {
      unmark_tail(state_, edits_[i]);
      number_segments(state_.space, edits_[i]);
      tip_before_.push_back(state_.projections[edits_[i].bar].chain.back().path);
      settled_before_.push_back(state_.projections[edits_[i].bar].settled);
    }
    team_.loop(accepted_.size(), [&](std::size_t i, unsigned worker) {
      commit(state_, edits_[accepted_[i]]);
      summary_.steps_by_worker[worker]++;
    });
    for (const std::size_t i : accepted_) {
      mark_tail(state_, edits_[i]);
      return_segments(state_.space, edits_[i]);
    }
    if (watch_.after) watch_.after(state_);
    for (std::size_t i = 0; i < accepted_.size(); i++)
      follow(edits_[accepted_[i]], tip_before_[i], settled_before_[i]);
    tip_before_.clear(), settled_before_.clear();
    steering_.steer();
  }

  // Deterministic reservations: in the order of a priority drawn for this round, a step is accepted when it
  // writes nothing that an accepted one reads or writes, and reads nothing that an accepted one writes.
  void reserve() {
    order_.resize(tips_.size());
    for (std::size_t i = 0; i < tips_.size(); i++) {
      const std::uint64_t cell = state_.input.cells.id[state_.projections[tips_[i]].cell];
      const std::uint64_t key =
          conceg_rng_mix(state_.input.seed ^ conceg_rng_mix(summary_.rounds ^ conceg_rng_mix(cell)));
      order_[i] = {conceg_rng_mix(key ^ tips_[i]), i};
    }
    std::sort(order_.begin(), order_.end());
    accepted_.clear();
    const auto stamp = static_cast<std::uint32_t>(summary_.rounds);
    const auto written = [&](std::uint32_t cell) { return written_[cell] == stamp; };
    const auto touched = [&](std::uint32_t cell) { return written_[cell] == stamp || read_[cell] == stamp; };
    for (const auto &[priority, i] : order_) {
      const Edit &edit = edits_[i];
      if (std::any_of(edit.write_cells.begin(), edit.write_cells.end(), touched) ||
          std::any_of(edit.read_cells.begin(), edit.read_cells.end(), written)) {
        summary_.deferred++;
        continue;
      }
      for (const std::uint32_t cell : edit.write_cells)
        written_[cell] = stamp;
      for (const std::uint32_t cell : edit.read_cells)
        read_[cell] = stamp;
      accepted_.push_back(i);
    }
    std::sort(accepted_.begin(), accepted_.end());
  }

  std::vector<std::uint32_t> accepted_by_priority() const {
    std::vector<std::uint32_t> bars;
    for (const auto &[priority, i] : order_)
      if (std::binary_search(accepted_.begin(), accepted_.end(), i)) bars.push_back(tips_[i]);
    return bars;
  }

  // What follows from a committed edit, in the order of the tips.
  void follow(Edit &edit, double tip_before, std::uint32_t settled_before) {
    Projection &projection = state_.projections[edit.bar];
    if (!projection.chain.empty()) grown_ += projection.chain.back().path - tip_before;
    summary_.steps++;
    switch (edit.kind) {
    case Edit::Kind::collapse:
      summary_.collapses++;
      note_collapse(projection, edit, tip_before);
      // Back at its fork, a projection chooses its first edge anew.
      if (projection.chain.size() == 1) projection.phase = Phase::starting;
      return;
    case Edit::Kind::start_failed:
      steering_.touch(projection.host);
      if (!postpone_fork(state_, edit.bar))
        end(edit.bar, Phase::lost);
      else
        wait_again(edit.bar);
      return;
    case Edit::Kind::start:
      projection.angle_error = edit.angle_error;
      adopt_children(state_, edit.bar);
      retry_orphans(projection.cell);
      break;
    case Edit::Kind::step:
    case Edit::Kind::end:
      break;
    }
    note_progress(projection);
    fire_forks(edit.bar, settled_before);
    if (edit.finished)
      end(edit.bar, Phase::done);
    else if (edit.kind == Edit::Kind::end)
      end(edit.bar, Phase::cut_short);
  }

  void fire_forks(std::uint32_t host, std::uint32_t settled_before) {
    for (const std::uint32_t bar : due_bars(state_, host, settled_before)) {
      steering_.touch(host);
      if (open_fork(state_, bar))
        tips_of_[state_.projections[bar].cell].push_back(bar);
      else
        end(bar, Phase::lost);
    }
  }

  // A postponed fork waits for the next place on its host, which is there already when that is done.
  void wait_again(std::uint32_t bar) {
    leave_rota(bar);
    Projection &host = state_.projections[state_.projections[bar].host];
    host.waiting.push_back(bar);
    if (host.phase == Phase::done)
      fire_forks(state_.projections[bar].host, host.settled);
    else if (host.phase != Phase::growing && host.phase != Phase::starting)
      orphan_waiting(state_.projections[bar].host);
    retry_orphans(state_.projections[bar].cell);
  }

  void leave_rota(std::uint32_t bar) {
    const std::uint32_t cell = state_.projections[bar].cell;
    std::vector<std::uint32_t> &tips = tips_of_[cell];
    const auto found = std::find(tips.begin(), tips.end(), bar);
    if (found == tips.end()) return;
    const auto place = static_cast<std::size_t>(found - tips.begin());
    tips.erase(found);
    if (next_tip_[cell] > place) next_tip_[cell]--;
    if (next_tip_[cell] >= tips.size()) next_tip_[cell] = 0;
  }

  void end(std::uint32_t bar, Phase phase) {
    leave_rota(bar);
    state_.projections[bar].phase = phase;
    steering_.touch(bar);
    orphan_waiting(bar);
    retry_orphans(state_.projections[bar].cell);
  }

  void make_orphan(std::uint32_t bar) {
    state_.projections[bar].phase = Phase::orphan;
    state_.projections[bar].host = none;
    orphans_[state_.projections[bar].cell].push_back(bar);
  }

  // Bars that waited on an ended projection, or were to be born on it, look for another host.
  void orphan_waiting(std::uint32_t bar) {
    std::vector<std::uint32_t> waiting;
    waiting.swap(state_.projections[bar].waiting);
    for (const std::uint32_t child : state_.children[bar])
      if (state_.projections[child].phase == Phase::waiting && state_.projections[child].host == none)
        waiting.push_back(child);
    for (const std::uint32_t child : waiting)
      make_orphan(child);
  }

  // Gives each orphan of a cell to a host, keeps it while one may still come, or declares it lost.
  void retry_orphans(std::uint32_t cell) {
    for (bool again = true; again;) {
      again = false;
      std::vector<std::uint32_t> orphans;
      orphans.swap(orphans_[cell]);
      for (const std::uint32_t bar : orphans) {
        const std::uint32_t host = find_host(state_, bar);
        if (host != none) {
          give_to_host(state_, bar, host);
          if (state_.projections[host].phase == Phase::done)
            fire_forks(host, state_.projections[host].settled);
        } else if (may_find_host(state_, bar)) {
          orphans_[cell].push_back(bar);
        } else {
          state_.projections[bar].phase = Phase::lost;
          orphan_waiting(bar);
          again = true;
        }
      }
    }
  }

  void lose_the_rest() {
    for (Projection &projection : state_.projections)
      if (projection.phase == Phase::waiting || projection.phase == Phase::orphan ||
          projection.phase == Phase::starting)
        projection.phase = Phase::lost;
  }

  Summary finish() {
    double sum = 0.0;
    std::uint64_t number = 0;
    for (const Projection &projection : state_.projections) {
      const bool handed =
          projection.host != none && projection.host != projection.parent && projection.chain.size() > 1;
      summary_.handed += handed;
      summary_.done += !handed && projection.phase == Phase::done;
      summary_.cut_short += !handed && projection.phase == Phase::cut_short;
      summary_.lost += projection.phase == Phase::lost;
      if (projection.angle_error >= 0.0f) sum += projection.angle_error, number++;
    }
    summary_.angle_error = number ? sum / static_cast<double>(number) : 0.0;
    return summary_;
  }

  State &state_;
  const Watch &watch_;
  Team team_;
  Steering steering_;
  Summary summary_;
  double grown_ = 0.0;
  int tenths_told_ = 0;
  std::vector<std::vector<std::uint32_t>> tips_of_; // by cell: bars that grow or start
  std::vector<std::size_t> next_tip_;
  std::size_t next_cell_ = 0; // where the next round begins
  std::vector<std::vector<std::uint32_t>> orphans_;
  std::vector<std::uint32_t> tips_, written_, read_;
  std::vector<std::pair<std::uint64_t, std::size_t>> order_;
  std::vector<std::size_t> accepted_;
  std::vector<double> tip_before_;
  std::vector<std::uint32_t> settled_before_;
  std::vector<Edit> edits_;
};

void make_projections(State &state) {
  const Input &input = state.input;
  const Bars &bars = input.bars;
  state.projections.assign(bars.count, {});
  state.children.assign(bars.count, {});
  for (std::uint32_t cell = 0; cell < input.cells.count; cell++) {
    const std::uint64_t first = bars.cell_offset[cell];
    for (std::uint64_t row = first; row < bars.cell_offset[cell + 1]; row++) {
      Projection &projection = state.projections[row];
      projection.cell = cell, projection.tree = bars.tree[row];
      projection.attractor = {bars.attractor[3 * row], bars.attractor[3 * row + 1],
                              bars.attractor[3 * row + 2]};
      projection.chance =
          conceg_rng_stream(input.seed, "grow.fork", conceg_rng_mix(input.cells.id[cell]) + (row - first));
      if (bars.parent[row] < 0) continue;
      projection.parent = static_cast<std::uint32_t>(first + static_cast<std::uint64_t>(bars.parent[row]));
      state.children[projection.parent].push_back(static_cast<std::uint32_t>(row));
    }
  }
}

} // namespace

Summary grow(State &state, unsigned threads, const Progress &progress, const Watch &watch) {
  make_projections(state);
  for (std::uint32_t bar = 0; bar < state.projections.size(); bar++)
    if (state.projections[bar].parent == none) draw_calibre(state, bar);
  make_space(state);
  return Growth(state, threads, watch).run(progress);
}

} // namespace conceg::grow
