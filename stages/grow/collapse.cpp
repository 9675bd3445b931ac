// SPDX-License-Identifier: BSD-3-Clause
#include "collapse.hpp"

#include "smooth.hpp"

#include <algorithm>

namespace conceg::grow {

namespace {
constexpr double progress_um = 1.0; // beyond the old maximum: the projection has got past its trap
constexpr std::size_t banned_nodes = 3;
} // namespace

std::uint32_t least_kept(const Projection &projection) {
  // A root keeps its first edge too, so that it does not lose its place on the soma.
  std::uint32_t least = std::max(projection.host == none ? 2u : 1u, projection.fixed);
  for (const Fork &fork : projection.forks)
    least = std::max(least, fork.vertex + 1);
  return least;
}

void propose_collapse(const State &state, std::uint32_t bar, Edit &edit) {
  const Projection &projection = state.projections[bar];
  if (projection.collapses >= state.parameters.retries) {
    edit.kind = Edit::Kind::end;
    std::uint32_t offset = 0;
    std::vector<Vertex> line = open_line(projection, offset);
    const std::size_t settled = settle_line(state, bar, line, projection.settled - offset, true,
                                            state.input.bars.asked_end[bar], edit.finished);
    edit_from_line(state, line, offset, static_cast<std::uint32_t>(settled) + offset, edit);
    return;
  }
  edit.kind = Edit::Kind::collapse;
  const std::vector<Vertex> &chain = projection.chain;
  const double back_to = chain.back().path - (projection.collapses + 1) * state.parameters.collapse_um;
  const std::uint32_t least = least_kept(projection);
  auto keep = static_cast<std::uint32_t>(chain.size());
  while (keep > least && chain[keep - 1].path > back_to)
    keep--;
  for (std::size_t i = chain.size(); i > least && edit.banned.size() < banned_nodes; i--)
    edit.banned.push_back(chain[i - 1].node);
  edit_cut(state, keep, edit);
}

void note_collapse(Projection &projection, const Edit &edit, double trapped_at) {
  projection.collapses++;
  projection.best_path = std::max(projection.best_path, trapped_at);
  projection.banned.insert(projection.banned.end(), edit.banned.begin(), edit.banned.end());
}

void note_progress(Projection &projection) {
  const double path = projection.chain.back().path;
  if (projection.collapses > 0 && path > projection.best_path + progress_um) {
    projection.collapses = 0;
    projection.banned.clear();
  }
}

} // namespace conceg::grow
