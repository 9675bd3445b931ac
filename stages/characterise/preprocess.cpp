// SPDX-License-Identifier: BSD-3-Clause
#include "preprocess.hpp"

#include "axon.hpp"
#include "sections.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::characterise {
namespace {

// The nodes that are kept, as a tree; node 0 must be kept, and with a node its parent.
Tree keep_nodes(const Tree &tree, const std::vector<char> &keep) {
  Tree out;
  out.neurite = tree.neurite;
  std::vector<std::int64_t> place(tree.size(), -1);
  for (std::size_t i = 0; i < tree.size(); i++) {
    if (!keep[i]) continue;
    place[i] = static_cast<std::int64_t>(out.size());
    out.position.push_back(tree.position[i]);
    out.radius.push_back(tree.radius[i]);
    out.parent.push_back(tree.parent[i] < 0 ? -1 : place[static_cast<std::size_t>(tree.parent[i])]);
  }
  return out;
}

double mean_radius(const Tree &tree, const Section &section) {
  double sum = 0.0, length = 0.0;
  for (std::size_t i = 1; i < section.nodes.size(); i++) {
    const double d = glm::length(tree.position[section.nodes[i]] - tree.position[section.nodes[i - 1]]);
    sum += d * tree.radius[section.nodes[i]], length += d;
  }
  return length > 0.0 ? sum / length : tree.radius[section.nodes.back()];
}

struct Piece {
  Tree tree;
  bool axon = false, joined = false; // joined: to the soma, or an axon to a dendrite
  double basal = 0.0, apical = 0.0;  // cable of each code
};

// Runs of samples that are all axon or all not; each becomes a tree of its own.
std::vector<Piece> split_pieces(const Samples &samples) {
  std::vector<Piece> pieces;
  std::vector<std::size_t> piece(samples.size());
  std::vector<std::int64_t> place(samples.size());
  for (std::size_t i = 0; i < samples.size(); i++) {
    const bool axon = samples.kind[i] == neurite_axon;
    const std::int64_t up = samples.parent[i];
    const bool starts = up < 0 || pieces[piece[static_cast<std::size_t>(up)]].axon != axon;
    if (starts) {
      Piece fresh;
      fresh.axon = axon;
      fresh.joined = up < 0 ? samples.on_soma[i] : axon;
      piece[i] = pieces.size();
      pieces.push_back(std::move(fresh));
    } else
      piece[i] = piece[static_cast<std::size_t>(up)];
    Piece &p = pieces[piece[i]];
    if (!starts) {
      const double d = glm::length(samples.position[i] - samples.position[static_cast<std::size_t>(up)]);
      (samples.kind[i] == neurite_apical ? p.apical : p.basal) += d;
    }
    place[i] = static_cast<std::int64_t>(p.tree.size());
    p.tree.position.push_back(samples.position[i]);
    p.tree.radius.push_back(samples.radius[i]);
    p.tree.parent.push_back(starts ? -1 : place[static_cast<std::size_t>(up)]);
  }
  return pieces;
}

} // namespace

Cleaned &Cleaned::operator+=(const Cleaned &other) {
  twigs += other.twigs, floating += other.floating, axon_pieces += other.axon_pieces;
  short_trees += other.short_trees, raised_radii += other.raised_radii;
  joined_pieces += other.joined_pieces, bridged_um += other.bridged_um;
  return *this;
}

std::size_t remove_twigs(Tree &tree, double length_um, double radius_um) {
  const std::vector<Section> sections = find_sections(tree);
  std::vector<char> inner(sections.size(), 0), twig(sections.size(), 0), keep(tree.size(), 1);
  std::vector<std::size_t> kept_daughters(sections.size(), 0);
  std::vector<std::int64_t> longest(sections.size(), -1);
  for (const Section &s : sections)
    if (s.parent >= 0) inner[static_cast<std::size_t>(s.parent)] = 1;
  for (std::size_t i = 0; i < sections.size(); i++) {
    const Section &s = sections[i];
    if (s.parent < 0) continue;
    const auto up = static_cast<std::size_t>(s.parent);
    twig[i] = !inner[i] && s.length < length_um && mean_radius(tree, s) < radius_um;
    kept_daughters[up] += !twig[i];
    if (longest[up] < 0 || s.length > sections[static_cast<std::size_t>(longest[up])].length)
      longest[up] = static_cast<std::int64_t>(i);
  }
  std::size_t removed = 0;
  for (std::size_t i = 0; i < sections.size(); i++) {
    if (!twig[i]) continue;
    const auto up = static_cast<std::size_t>(sections[i].parent);
    if (!kept_daughters[up] && longest[up] == static_cast<std::int64_t>(i)) continue;
    for (std::size_t k = 1; k < sections[i].nodes.size(); k++)
      keep[sections[i].nodes[k]] = 0;
    removed++;
  }
  if (removed) tree = keep_nodes(tree, keep);
  return removed;
}

std::vector<Tree> clip_at_sphere(const Tree &tree, const glm::dvec3 &center, double radius_um) {
  std::vector<Tree> out;
  std::vector<std::int64_t> piece(tree.size(), -1), place(tree.size(), -1);
  for (std::size_t i = 0; i < tree.size(); i++) {
    const glm::dvec3 here = tree.position[i] - center;
    const std::int64_t up = tree.parent[i];
    if (up >= 0 &&
        piece[static_cast<std::size_t>(up)] >= 0) // a tree that comes back into the sphere stays whole
      piece[i] = piece[static_cast<std::size_t>(up)];
    else if (glm::length(here) >= radius_um) {
      piece[i] = static_cast<std::int64_t>(out.size());
      out.emplace_back();
      out.back().neurite = tree.neurite;
      if (up >= 0) { // where the segment leaves the sphere
        const glm::dvec3 from = tree.position[static_cast<std::size_t>(up)] - center, step = here - from;
        const double a = glm::dot(step, step), b = glm::dot(from, step),
                     c = glm::dot(from, from) - radius_um * radius_um;
        const double share =
            a > 0.0 ? std::clamp((-b + std::sqrt(std::max(0.0, b * b - a * c))) / a, 0.0, 1.0) : 1.0;
        if (share < 1.0) {
          out.back().position.push_back(center + from + step * share);
          out.back().radius.push_back(tree.radius[i]);
          out.back().parent.push_back(-1);
        }
      }
    } else
      continue;
    Tree &t = out[static_cast<std::size_t>(piece[i])];
    const bool joined = up >= 0 && piece[static_cast<std::size_t>(up)] == piece[i];
    place[i] = static_cast<std::int64_t>(t.size());
    t.parent.push_back(joined ? place[static_cast<std::size_t>(up)]
                              : static_cast<std::int64_t>(t.size()) - 1);
    t.position.push_back(tree.position[i]);
    t.radius.push_back(tree.radius[i]);
  }
  return out;
}

std::vector<Tree> clean_trees(const Samples &samples, const glm::dvec3 &soma, double soma_radius,
                              const Cleaning &rules, Cleaned &count) {
  std::vector<Piece> pieces = split_pieces(samples);
  std::vector<Tree> trees;
  Piece *axon = nullptr;
  for (Piece &p : pieces) {
    for (double &r : p.tree.radius)
      if (r < rules.lowest_radius_um) r = rules.lowest_radius_um, count.raised_radii++;
    p.tree.neurite = rules.glia           ? neurite_glia
                     : p.axon             ? neurite_axon
                     : p.apical > p.basal ? neurite_apical
                                          : neurite_basal;
    if (p.axon) {
      count.axon_pieces++;
      if (p.joined && (!axon || cable_length(p.tree) > cable_length(axon->tree))) axon = &p;
    } else if (!p.joined)
      count.floating++;
  }
  if (axon && rules.axons) {
    std::vector<Tree> loose;
    for (const Piece &p : pieces)
      if (p.axon && !p.joined) loose.push_back(p.tree);
    const Joined joined =
        rules.axon_gap_um > 0.0 ? join_pieces(axon->tree, loose, rules.axon_gap_um) : Joined{};
    count.joined_pieces = joined.pieces, count.bridged_um = joined.bridged_um;
    count.axon_pieces -= 1 + joined.pieces;
  }
  for (const Piece &p : pieces) {
    if (p.axon ? !rules.axons || &p != axon : !p.joined) continue;
    for (Tree &t :
         rules.clip_at_soma ? clip_at_sphere(p.tree, soma, soma_radius) : std::vector<Tree>{p.tree}) {
      if (rules.twig_length_um > 0.0 && !p.axon)
        count.twigs += remove_twigs(t, rules.twig_length_um, rules.twig_radius_um);
      if (cable_length(t) < rules.tree_length_um)
        count.short_trees++;
      else
        trees.push_back(std::move(t));
    }
  }
  return trees;
}

} // namespace conceg::characterise
