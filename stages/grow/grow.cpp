// SPDX-License-Identifier: BSD-3-Clause
#include "grow.hpp"

#include "branch.hpp"
#include "calibre.hpp"
#include "collapse.hpp"
#include "course.hpp"
#include "edit.hpp"
#include "occupancy.hpp"
#include "restore.hpp"
#include "roots.hpp"
#include "schedule.hpp"
#include "step.hpp"
#include "team.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::grow {

namespace {

double volume_of(const Segment &segment) {
  const double pi = 3.14159265358979323846, r = segment.radius;
  return segment.bar == none ? 4.0 / 3.0 * pi * r * r * r : pi * r * r * 2.0 * segment.half_length;
}

class Growth {
public:
  Growth(State &state, unsigned threads, Phases &phases, const Watch &watch)
      : state_(state), phases_(phases), watch_(watch), team_(threads), schedule_(state), steering_(state) {
    summary_.steps_by_worker.assign(team_.size(), 0);
    orphans_.resize(state.input.cells.count);
  }

  Summary run(const Progress &progress) {
    go_on();
    start_roots(true);
    phases_.end("roots");
    bool all_started = false; // cells without a soma fill what room the others leave
    double asked = 0.0;
    for (std::size_t bar = 0; bar < state_.input.bars.count; bar++)
      asked += state_.input.bars.asked_end[bar] - state_.input.bars.asked_start[bar];
    for (;;) {
      summary_.rounds++;
      const std::vector<std::uint32_t> &tips = schedule_.choose(summary_.rounds);
      if (tips.empty() && all_started) break;
      if (tips.empty()) {
        start_roots(false);
        all_started = true;
        phases_.end("roots");
        continue;
      }
      phases_.end("choose");
      if (summary_.rounds % 64 == 0)
        report(progress, "grow", static_cast<std::uint64_t>(grown_), static_cast<std::uint64_t>(asked));
      tell_tenth(asked);
      round(tips);
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
    standing.cable_um = grown_, standing.asked_um = asked;
    standing.cells = state_.input.cells.count, standing.cells_done = schedule_.cells_done();
    for (const Segment &segment : state_.space.segments)
      if (segment.alive) standing.occupied_um3 += volume_of(segment);
    watch_.tenth(standing);
  }

  // Second growth: bars that are not done go on, those that found no room look for a host.
  void go_on() {
    if (!state_.input.earlier.rows) return;
    for (std::uint32_t bar = 0; bar < state_.projections.size(); bar++) {
      const Projection &projection = state_.projections[bar];
      if (projection.phase == Phase::growing) schedule_.enter(bar);
      if (!projection.chain.empty())
        grown_ += projection.chain.back().path - projection.start_path;
      else if (projection.parent != none)
        make_orphan(bar);
    }
    for (std::uint32_t cell = 0; cell < state_.input.cells.count; cell++)
      retry_orphans(cell);
    phases_.end("restore");
  }

  // Roots of the cells with a soma, or of those without.
  void start_roots(bool with_soma) {
    Edit edit;
    for (std::uint32_t bar = 0; bar < state_.projections.size(); bar++) {
      if (state_.projections[bar].parent != none || !state_.projections[bar].chain.empty()) continue;
      if ((state_.input.cells.radius[state_.projections[bar].cell] > 0.0f) != with_soma) continue;
      if (!propose_root(state_, bar, edit)) {
        state_.projections[bar].phase = Phase::lost;
        orphan_waiting(bar);
        continue;
      }
      number_segments(state_.space, edit);
      commit(state_, edit);
      adopt_children(state_, bar);
      schedule_.enter(bar);
    }
  }

  void round(const std::vector<std::uint32_t> &tips) {
    if (edits_.size() < tips.size()) edits_.resize(tips.size());
    team_.loop(tips.size(), [&](std::size_t i, unsigned) {
      propose(state_, tips[i], edits_[i]);
      schedule_.plan(edits_[i]);
    });
    phases_.end("propose");
    const std::vector<std::size_t> &accepted = schedule_.reserve(edits_, summary_.rounds);
    if (watch_.before) watch_.before(state_, bars_of(accepted));
    for (const std::size_t i : accepted)
      number_segments(state_.space, edits_[i]);
    phases_.end("reserve");
    team_.loop(accepted.size(), [&](std::size_t i, unsigned worker) {
      commit(state_, edits_[accepted[i]]);
      summary_.steps_by_worker[worker]++;
    });
    phases_.end("commit");
    for (const std::size_t i : accepted)
      return_segments(state_.space, edits_[i]);
    if (watch_.after) watch_.after(state_);
    for (const std::size_t i : accepted)
      follow(edits_[i]);
    steering_.steer();
    phases_.end("follow");
  }

  std::vector<std::uint32_t> bars_of(const std::vector<std::size_t> &accepted) const {
    std::vector<std::uint32_t> bars;
    for (const std::size_t i : accepted)
      bars.push_back(edits_[i].bar);
    return bars;
  }

  // What follows from a committed edit, in the order of the tips.
  void follow(const Edit &edit) {
    Projection &projection = state_.projections[edit.bar];
    if (!projection.chain.empty()) grown_ += projection.chain.back().path - edit.tip_before;
    if (!projection.chain.empty()) schedule_.moved(edit.bar);
    summary_.steps++;
    switch (edit.kind) {
    case Edit::Kind::collapse:
      summary_.collapses++;
      note_collapse(projection, edit, edit.tip_before);
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
    fire_forks(edit.bar, edit.settled_before);
    if (edit.finished)
      end(edit.bar, Phase::done);
    else if (edit.kind == Edit::Kind::end)
      end(edit.bar, Phase::cut_short);
  }

  void fire_forks(std::uint32_t host, std::uint32_t settled_before) {
    for (const std::uint32_t bar : due_bars(state_, host, settled_before)) {
      steering_.touch(host);
      if (open_fork(state_, bar))
        schedule_.enter(bar);
      else
        end(bar, Phase::lost);
    }
  }

  // A postponed fork waits for the next place on its host, which is there already when that is done.
  void wait_again(std::uint32_t bar) {
    schedule_.leave(bar);
    Projection &host = state_.projections[state_.projections[bar].host];
    host.waiting.push_back(bar);
    if (host.phase == Phase::done)
      fire_forks(state_.projections[bar].host, host.settled);
    else if (host.phase != Phase::growing && host.phase != Phase::starting)
      orphan_waiting(state_.projections[bar].host);
    retry_orphans(state_.projections[bar].cell);
  }

  void end(std::uint32_t bar, Phase phase) {
    schedule_.leave(bar);
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
    summary_.busy_s = team_.busy_s(), summary_.deferred = schedule_.deferred();
    summary_.angle_error = number ? sum / static_cast<double>(number) : 0.0;
    return summary_;
  }

  State &state_;
  Phases &phases_;
  const Watch &watch_;
  Team team_;
  Schedule schedule_;
  Steering steering_;
  Summary summary_;
  double grown_ = 0.0;
  int tenths_told_ = 0;
  Grid plan_, stand_;
  std::vector<std::vector<std::uint32_t>> orphans_;
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

Summary grow(State &state, unsigned threads, const Progress &progress, Phases &phases, const Watch &watch) {
  make_projections(state);
  for (std::uint32_t bar = 0; bar < state.projections.size(); bar++)
    if (state.projections[bar].parent == none) draw_calibre(state, bar);
  make_space(state);
  phases.end("space");
  restore(state);
  return Growth(state, threads, phases, watch).run(progress);
}

} // namespace conceg::grow
