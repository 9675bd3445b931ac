// SPDX-License-Identifier: BSD-3-Clause
// Smoothing in growth, a few vertices behind the tip: the delivered line, on which path length is counted.
#pragma once

#include "state.hpp"

namespace conceg::grow {

constexpr std::uint32_t smoothing_lag = 3; // vertices kept open behind the tip

// Copy of a chain's end with what smoothing needs before the first open vertex; `offset` = index of its first
// vertex.
std::vector<Vertex> open_line(const Projection &projection, std::uint32_t &offset);

// Settles vertex `index` of the line: moves it towards the binomial mean of its neighbours when both segments
// stay free, and recomputes the path lengths after it.
void settle(const State &state, std::uint32_t bar, std::vector<Vertex> &line, std::size_t index);

// Path length at the end of the line if everything from `open` on were settled now.
double settled_length(const State &state, std::uint32_t bar, const std::vector<Vertex> &line,
                      std::size_t open);

// If the line reaches `end` at its settled vertex `index`, cuts it there exactly and drops the rest.
bool cut_at(std::vector<Vertex> &line, std::size_t index, double end);

// Settles what may be settled: all that is more than the lag behind the tip, or everything with `flush`.
// Returns the number of settled vertices of the line; `finished` tells that `end` was reached and the line
// was cut.
std::size_t settle_line(const State &state, std::uint32_t bar, std::vector<Vertex> &line, std::size_t open,
                        bool flush, double end, bool &finished);

} // namespace conceg::grow
