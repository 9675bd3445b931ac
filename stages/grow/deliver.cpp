// SPDX-License-Identifier: BSD-3-Clause
#include "deliver.hpp"

#include "calibre.hpp"
#include "straightness.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::grow {

namespace {

// Emits the points of one cell.
class Writer {
public:
  Writer(const State &state, std::uint32_t cell, Skeleton &skeleton)
      : state_(state), skeleton_(skeleton), first_bar_(state.input.bars.cell_offset[cell]),
        first_point_(skeleton.position.size()) {}

  void write() {
    const auto last_bar = state_.input.bars.cell_offset[state_.projections[first_bar_].cell + 1];
    for (std::uint64_t bar = first_bar_; bar < last_bar; bar++)
      if (state_.projections[bar].parent == none && state_.projections[bar].chain.size() > 1)
        write_tree(static_cast<std::uint32_t>(bar));
  }

private:
  struct Branch {
    std::uint32_t bar;
    std::int64_t from;       // point at which it starts
    std::uint32_t continues; // branch that it carries on, or none
  };

  void write_tree(std::uint32_t root) {
    const Projection &projection = state_.projections[root];
    emit(root, 0, projection.chain[0].position, projection.chain[0].path, projection.chain[1].radius, -1,
         branches_);
    std::vector<Branch> open = {{root, count() - 1, branches_++}};
    while (!open.empty()) {
      const Branch next = open.back();
      open.pop_back();
      write_projection(next, open);
    }
  }

  // A projection to its tip; its daughters are pushed so that the last fork comes next.
  void write_projection(const Branch &start, std::vector<Branch> &open) {
    const Projection &projection = state_.projections[start.bar];
    std::vector<Fork> forks;
    for (const Fork &fork : projection.forks)
      if (state_.projections[fork.bar].chain.size() > 1) forks.push_back(fork);
    std::sort(forks.begin(), forks.end(), [](const Fork &x, const Fork &y) {
      return x.path < y.path || (x.path == y.path && x.bar < y.bar);
    });
    // A bar that ended at its last fork leaves one daughter there to carry its branch on.
    const double tip = projection.chain.back().path;
    const bool carried_on = forks.size() > 0 && forks.back().path >= tip &&
                            (forks.size() < 2 || forks[forks.size() - 2].path < tip);
    std::uint32_t branch = start.continues != none ? start.continues : branches_++;
    std::int64_t parent = start.from;
    std::size_t next = 0;
    for (std::size_t i = 1; i < projection.chain.size(); i++) {
      const Vertex &vertex = projection.chain[i];
      bool after_fork = false;
      while (next < forks.size() && forks[next].path <= vertex.path) {
        const Fork &fork = forks[next++];
        // Forks at one place share their point.
        if (!(after_fork && fork.path == forks[next - 2].path)) {
          parent = emit(start.bar, fork.vertex, fork.position, fork.path, vertex.radius, parent, branch);
          if (fork.path < tip) branch = branches_++;
        }
        after_fork = true;
        open.push_back({fork.bar, parent, carried_on && fork.path >= tip ? branch : none});
        lower_radius(parent, state_.projections[fork.bar].chain[1].radius);
      }
      if (after_fork && forks[next - 1].path == vertex.path) {
        if (i + 1 < projection.chain.size()) lower_radius(parent, projection.chain[i + 1].radius);
        continue;
      }
      float radius = vertex.radius;
      if (i + 1 < projection.chain.size()) radius = std::min(radius, projection.chain[i + 1].radius);
      parent = emit(start.bar, i, vertex.position, vertex.path, radius, parent, branch);
    }
  }

  std::int64_t count() const { return static_cast<std::int64_t>(skeleton_.position.size() - first_point_); }

  void lower_radius(std::int64_t point, float radius) {
    const std::size_t row = first_point_ + static_cast<std::size_t>(point);
    skeleton_.radius[row] = std::min(skeleton_.radius[row], radius);
    set_status(row);
  }

  void set_status(std::size_t row) {
    // Radii follow the taper at path lengths that settling changes a little: 2 % is no constriction.
    const double wanted = std::max(state_.parameters.radius_fraction * skeleton_.target_radius[row],
                                   state_.parameters.r_min_um);
    skeleton_.status[row] = skeleton_.radius[row] < 0.98 * wanted;
  }

  // A point at `vertex` of the bar's line, or just before it.
  std::int64_t emit(std::uint32_t bar, std::size_t vertex, const glm::dvec3 &position, double path,
                    float radius, std::int64_t parent, std::uint32_t branch) {
    const Projection &projection = state_.projections[bar];
    skeleton_.position.push_back(position);
    if (vertex < projection.fixed) {
      skeleton_.radius.push_back(radius);
      skeleton_.target_radius.push_back(state_.input.earlier.target_radius[projection.fixed_row + vertex]);
    } else {
      skeleton_.radius.push_back(std::min(radius, static_cast<float>(wanted_radius(state_, bar, path))));
      skeleton_.target_radius.push_back(static_cast<float>(target_radius(state_, bar, path)));
    }
    skeleton_.parent.push_back(parent);
    skeleton_.kind.push_back(state_.input.bars.neurite[bar]);
    skeleton_.branch.push_back(branch);
    skeleton_.bar.push_back(static_cast<std::uint32_t>(bar - first_bar_));
    skeleton_.tree.push_back(projection.tree);
    skeleton_.status.push_back(0);
    set_status(skeleton_.status.size() - 1);
    return count() - 1;
  }

  const State &state_;
  Skeleton &skeleton_;
  std::uint64_t first_bar_;
  std::size_t first_point_;
  std::uint32_t branches_ = 0;
};

double cone_volume(double length, double r1, double r2) {
  return 3.14159265358979323846 / 3.0 * length * (r1 * r1 + r1 * r2 + r2 * r2);
}

} // namespace

Skeleton deliver_skeleton(const State &state) {
  Skeleton skeleton;
  const Bars &bars = state.input.bars;
  skeleton.cell_offset.push_back(0);
  for (std::uint32_t cell = 0; cell < state.input.cells.count; cell++) {
    if (bars.cell_offset[cell] < bars.cell_offset[cell + 1]) Writer(state, cell, skeleton).write();
    skeleton.cell_offset.push_back(skeleton.position.size());
  }
  return skeleton;
}

BarReport deliver_bars(const State &state) {
  BarReport report;
  const std::size_t count = state.projections.size();
  report.achieved_start.assign(count, 0.0), report.achieved_end.assign(count, 0.0);
  report.state.assign(count, bar_lost), report.handed_to.assign(count, -1);
  for (std::size_t bar = 0; bar < count; bar++) {
    const Projection &projection = state.projections[bar];
    if (projection.chain.size() < 2) continue;
    report.achieved_start[bar] = projection.chain.front().path;
    report.achieved_end[bar] = projection.chain.back().path;
    report.state[bar] = projection.phase == Phase::done ? bar_done : bar_short;
    if (projection.host == projection.parent) continue;
    report.state[bar] = bar_handed;
    report.handed_to[bar] =
        static_cast<std::int64_t>(projection.host - state.input.bars.cell_offset[projection.cell]);
  }
  return report;
}

Measures measure(const State &state, const Skeleton &skeleton) {
  Measures measures;
  const double sphere = 4.0 / 3.0 * 3.14159265358979323846;
  double sum = 0.0;
  std::uint64_t branches = 0;
  measures.of_type.resize(std::max<std::size_t>(1, state.input.types.name.size()));
  for (std::size_t cell = 0; cell + 1 < skeleton.cell_offset.size(); cell++) {
    const double r = state.input.cells.radius[cell];
    measures.volume_committed_um3 += sphere * r * r * r, measures.volume_target_um3 += sphere * r * r * r;
    const std::size_t first = skeleton.cell_offset[cell], last = skeleton.cell_offset[cell + 1];
    std::size_t start = first; // point before the branch
    double path = 0.0;
    ResampledPath line(glm::dvec3(0.0), resample_um);
    Straightness &type = measures.of_type[state.input.types.of_cell ? state.input.types.of_cell[cell] : 0];
    for (std::size_t i = first; i < last; i++) {
      if (skeleton.parent[i] < 0) continue;
      const std::size_t parent = first + static_cast<std::size_t>(skeleton.parent[i]);
      const double length = glm::distance(skeleton.position[i], skeleton.position[parent]);
      if (skeleton.parent[parent] < 0 || skeleton.branch[parent] != skeleton.branch[i])
        start = parent, path = 0.0, line = ResampledPath(skeleton.position[start], resample_um);
      line.add(skeleton.position[i]);
      path += length;
      measures.cable_um += length;
      measures.volume_committed_um3 += cone_volume(length, skeleton.radius[parent], skeleton.radius[i]);
      measures.volume_target_um3 +=
          cone_volume(length, skeleton.target_radius[parent], skeleton.target_radius[i]);
      const bool ends = i + 1 == last || skeleton.branch[i + 1] != skeleton.branch[i];
      if (!ends || path < shortest_branch_um) continue;
      type.sum += line.straightness(), type.branches++;
      sum += glm::distance(skeleton.position[i], skeleton.position[start]) / path;
      branches++;
    }
  }
  measures.straightness = branches ? sum / static_cast<double>(branches) : 0.0;
  return measures;
}

FreeCable measure_free_cable(const State &state, const BarReport &report) {
  FreeCable cable;
  const Bars &bars = state.input.bars;
  for (std::size_t cell = 0; cell < state.input.cells.count; cell++) {
    if (state.input.cells.radius[cell] > 0.0f) continue;
    cable.cells++;
    for (std::uint64_t bar = bars.cell_offset[cell]; bar < bars.cell_offset[cell + 1]; bar++) {
      cable.asked_um += bars.asked_end[bar] - bars.asked_start[bar];
      cable.grown_um += report.achieved_end[bar] - report.achieved_start[bar];
      cable.cut_short += report.state[bar] == bar_short;
      cable.lost += report.state[bar] == bar_lost;
    }
  }
  return cable;
}

} // namespace conceg::grow
