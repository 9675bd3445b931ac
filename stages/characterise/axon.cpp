// SPDX-License-Identifier: BSD-3-Clause
#include "axon.hpp"

#include <limits>
#include <utility>

namespace conceg::characterise {
namespace {

// A piece with the shortest way from one of its ends to the axon so far.
struct Loose {
  Tree tree;
  std::vector<std::size_t> ends;
  double gap = std::numeric_limits<double>::infinity();
  std::size_t end = 0, to = 0;
};

Loose loose(Tree tree) {
  Loose out;
  const Children children(tree.parent);
  for (std::size_t i = 0; i < tree.size(); i++)
    if (i == 0 || !children.count(i)) out.ends.push_back(i);
  out.tree = std::move(tree);
  return out;
}

// Nodes first .. of the axon are new: some may be nearer.
void look_again(Loose &piece, const Tree &axon, std::size_t first) {
  for (const std::size_t end : piece.ends)
    for (std::size_t to = first; to < axon.size(); to++) {
      const double gap = glm::length(axon.position[to] - piece.tree.position[end]);
      if (gap < piece.gap) piece.gap = gap, piece.end = end, piece.to = to;
    }
}

void append(Tree &axon, const Tree &piece, std::size_t to) {
  const auto shift = static_cast<std::int64_t>(axon.size());
  axon.position.insert(axon.position.end(), piece.position.begin(), piece.position.end());
  axon.radius.insert(axon.radius.end(), piece.radius.begin(), piece.radius.end());
  for (const std::int64_t up : piece.parent)
    axon.parent.push_back(up < 0 ? static_cast<std::int64_t>(to) : up + shift);
}

} // namespace

Tree turned_to(const Tree &tree, std::size_t end) {
  const Children children(tree.parent);
  Tree out;
  out.neurite = tree.neurite;
  struct Step {
    std::size_t node, from;
    std::int64_t parent;
  };
  std::vector<Step> stack{{end, end, -1}};
  while (!stack.empty()) {
    const Step step = stack.back();
    stack.pop_back();
    const auto place = static_cast<std::int64_t>(out.size());
    out.position.push_back(tree.position[step.node]), out.radius.push_back(tree.radius[step.node]);
    out.parent.push_back(step.parent);
    for (const std::size_t *child = children.end(step.node); child-- != children.begin(step.node);)
      if (*child != step.from) stack.push_back({*child, step.node, place});
    const std::int64_t up = tree.parent[step.node];
    if (up >= 0 && static_cast<std::size_t>(up) != step.from)
      stack.push_back({static_cast<std::size_t>(up), step.node, place});
  }
  return out;
}

Joined join_pieces(Tree &axon, std::vector<Tree> &pieces, double gap_um) {
  Joined out;
  std::vector<Loose> left;
  for (Tree &piece : pieces)
    left.push_back(loose(std::move(piece)));
  pieces.clear();
  for (std::size_t first = 0;;) {
    std::size_t best = left.size();
    for (std::size_t i = 0; i < left.size(); i++) {
      look_again(left[i], axon, first);
      if (left[i].gap <= gap_um && (best == left.size() || left[i].gap < left[best].gap)) best = i;
    }
    if (best == left.size()) break;
    first = axon.size();
    const Loose &piece = left[best];
    append(axon, turned_to(piece.tree, piece.end), piece.to);
    out.pieces++, out.bridged_um += piece.gap;
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  for (Loose &piece : left)
    pieces.push_back(std::move(piece.tree));
  return out;
}

} // namespace conceg::characterise
