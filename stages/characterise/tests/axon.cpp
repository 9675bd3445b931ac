// SPDX-License-Identifier: BSD-3-Clause
// A tree that was broken is made whole again; what is too far away stays loose.
#include "check.h"

#include "axon.hpp"
#include "barcode.hpp"

#include "conceg/rng.h"

#include <algorithm>

using namespace conceg::characterise;

namespace {

// A trunk along x, a sample every um, with a branch along y from every tenth one.
Tree comb() {
  Tree tree;
  tree.neurite = neurite_axon;
  const auto add = [&](double x, double y, std::int64_t parent) {
    tree.position.emplace_back(x, y, 1e-4 * static_cast<double>(tree.size()));
    tree.radius.push_back(0.1 + 0.001 * static_cast<double>(tree.size())), tree.parent.push_back(parent);
    return static_cast<std::int64_t>(tree.size()) - 1;
  };
  std::vector<std::int64_t> trunk;
  for (int x = 0; x < 60; x++)
    trunk.push_back(add(x, 0, x ? trunk.back() : -1));
  for (std::size_t x = 10; x < 60; x += 10) {
    std::int64_t up = trunk[x];
    for (int y = 1; y <= 15; y++)
      up = add(static_cast<double>(x), y, up);
  }
  return tree;
}

std::vector<double> sorted_radii(const Tree &tree) {
  std::vector<double> out(tree.radius);
  std::sort(out.begin(), out.end());
  return out;
}

// Cuts the links above the given nodes: the piece with node 0 first, the others after it.
std::vector<Tree> cut(const Tree &tree, const std::vector<std::size_t> &above) {
  std::vector<Tree> out;
  std::vector<std::size_t> piece(tree.size());
  std::vector<std::int64_t> place(tree.size());
  for (std::size_t i = 0; i < tree.size(); i++) {
    const bool starts = i == 0 || std::find(above.begin(), above.end(), i) != above.end();
    const auto up = static_cast<std::size_t>(std::max<std::int64_t>(0, tree.parent[i]));
    if (starts) out.emplace_back();
    piece[i] = starts ? out.size() - 1 : piece[up];
    Tree &t = out[piece[i]];
    place[i] = static_cast<std::int64_t>(t.size());
    t.parent.push_back(starts ? -1 : place[up]);
    t.position.push_back(tree.position[i]), t.radius.push_back(tree.radius[i]);
  }
  return out;
}

void check_turned() {
  const Tree tree = comb();
  const Children children(tree.parent);
  for (std::size_t end = 1; end < tree.size(); end++) {
    if (children.count(end)) continue;
    const Tree turned = turned_to(tree, end);
    CHECK(turned.position[0] == tree.position[end]);
    CHECK_EQUAL(turned.size(), tree.size());
    CHECK_NEAR(cable_length(turned), cable_length(tree), 1e-9);
    CHECK(sorted_radii(turned) == sorted_radii(tree));
    for (std::size_t i = 1; i < turned.size(); i++)
      CHECK(turned.parent[i] >= 0 && turned.parent[i] < static_cast<std::int64_t>(i));
  }
}

void check_joined() {
  const Tree whole = comb();
  conceg_rng rng = conceg_rng_stream(1, "test.axon", 0);
  for (int trial = 0; trial < 50; trial++) {
    std::vector<std::size_t> above;
    for (int k = 0; k < 6; k++)
      above.push_back(
          1 + static_cast<std::size_t>(conceg_rng_uniform(&rng) * static_cast<double>(whole.size() - 1)));
    std::vector<Tree> pieces = cut(whole, above);
    const std::size_t loose = pieces.size() - 1;
    Tree axon = pieces[0];
    pieces.erase(pieces.begin());
    for (Tree &piece : pieces) { // as a tracer may have begun at any end
      const Children children(piece.parent);
      std::size_t end = piece.size() - 1;
      while (children.count(end))
        end--;
      // A piece that begins at a fork has no end there once it is turned.
      if (children.count(0) < 2 && conceg_rng_uniform(&rng) < 0.5) piece = turned_to(piece, end);
    }
    std::reverse(pieces.begin(), pieces.end());
    std::vector<Tree> far = pieces;
    Tree alone = axon;
    CHECK_EQUAL(join_pieces(alone, far, 0.5).pieces, 0); // no two samples are that near
    CHECK_EQUAL(far.size(), loose);
    CHECK_EQUAL(alone.size(), axon.size());
    const Joined joined = join_pieces(axon, pieces, 2.0);
    CHECK_EQUAL(joined.pieces, loose);
    CHECK(pieces.empty());
    CHECK_EQUAL(axon.size(), whole.size());
    // Each link that was cut is bridged by one that is no longer.
    CHECK(cable_length(axon) <= cable_length(whole) + 1e-9 && cable_length(axon) > cable_length(whole) - 0.1);
    CHECK_NEAR(joined.bridged_um, static_cast<double>(loose), 0.7);
    CHECK(sorted_radii(axon) == sorted_radii(whole));
    for (std::size_t i = 1; i < axon.size(); i++)
      CHECK(axon.parent[i] >= 0 && axon.parent[i] < static_cast<std::int64_t>(i));
  }
}

// The nearest piece comes first, so that pieces of one cable find each other, and one beyond the gap stays.
void check_order() {
  const auto line = [](double from, double to) {
    Tree t;
    for (double x = from; x <= to; x += 1.0)
      t.position.emplace_back(x, 0, 0), t.radius.push_back(0.2),
          t.parent.push_back(static_cast<std::int64_t>(t.size()) - 2);
    return t;
  };
  Tree axon = line(0, 10);
  std::vector<Tree> pieces = {line(40, 50), line(18, 32), line(80, 90)};
  const Joined joined = join_pieces(axon, pieces, 10.0);
  CHECK_EQUAL(joined.pieces, 2);
  CHECK_NEAR(joined.bridged_um, 8.0 + 8.0, 1e-9);
  CHECK_EQUAL(pieces.size(), 1);
  CHECK_EQUAL(find_bars(axon).size(), 1); // one cable
  CHECK_NEAR(find_bars(axon)[0].death, 50.0, 1e-9);
}

} // namespace

int main() {
  check_turned();
  check_joined();
  check_order();
  return check_done();
}
