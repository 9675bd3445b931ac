// SPDX-License-Identifier: BSD-3-Clause
// The node network of the growth as two plain tables, a format of our own: ConFiG's files are not public, its
// network of nodes with the largest radius at each is (Callaghan et al., NeuroImage 2020).
//   nodes.txt   "# box_um x0 y0 z0 x1 y1 z1 periodic px py pz", rows "id x y z rmax"
//   edges.txt   rows "i j", or "i j sx sy sz": j's image moved by whole box sides; each edge once
#include "scene.hpp"
#include "view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace conceg::importing {
namespace {

struct Network {
  std::vector<glm::dvec3> position;
  std::vector<float> radius;
  std::unordered_map<std::uint64_t, std::uint32_t> row_of_id;
  std::array<std::uint8_t, 3> periodic = {0, 0, 0};
  Scene box;
};
struct Edge {
  std::uint32_t from, to;
  std::array<std::int8_t, 3> shift;
  bool operator<(const Edge &o) const { return std::tie(from, to, shift) < std::tie(o.from, o.to, o.shift); }
  bool operator==(const Edge &o) const { return !(*this < o) && !(o < *this); }
};

void read_box(const TextFile &text, const std::vector<std::string_view> &words, Network &network) {
  if (words.size() != 12 || words[8] != "periodic")
    text.refuse("expected # box_um x0 y0 z0 x1 y1 z1 periodic px py pz");
  for (std::size_t axis = 0; axis < 3; axis++) {
    network.box.lo[static_cast<int>(axis)] = text.coordinate(words[2 + axis], "a corner of the box");
    network.box.hi[static_cast<int>(axis)] = text.coordinate(words[5 + axis], "a corner of the box");
    if (words[9 + axis] != "0" && words[9 + axis] != "1") text.refuse("periodic: expected 0 or 1");
    network.periodic[axis] = words[9 + axis] == "1";
  }
  const glm::dvec3 side = network.box.hi - network.box.lo;
  if (!(side.x > 0.0 && side.y > 0.0 && side.z > 0.0))
    text.refuse("expected a box whose upper corner lies above the lower one");
  network.box.has_box = true;
}

void read_nodes(TextFile text, Network &network) {
  std::string_view line;
  while (text.line(line)) {
    const auto words = words_of(line);
    if (words.size() > 1 && words[0] == "#" && words[1] == "box_um") read_box(text, words, network);
    if (words.empty() || words[0][0] == '#') continue;
    if (words.size() != 5) text.refuse("expected id x y z rmax, got %zu values", words.size());
    const std::uint64_t id = text.count(words[0], "the id of a node");
    if (!network.row_of_id.emplace(id, static_cast<std::uint32_t>(network.position.size())).second)
      text.refuse("node %llu comes twice", static_cast<unsigned long long>(id));
    network.position.emplace_back(text.coordinate(words[1], "x"), text.coordinate(words[2], "y"),
                                  text.coordinate(words[3], "z"));
    network.radius.push_back(static_cast<float>(text.radius(words[4], "rmax")));
  }
  if (network.position.empty()) text.refuse("expected rows id x y z rmax, got none");
}

std::vector<Edge> read_edges(TextFile text, const Network &network) {
  std::vector<Edge> edges;
  std::string_view line;
  while (text.line(line)) {
    const auto words = words_of(line);
    if (words.empty() || words[0][0] == '#') continue;
    if (words.size() != 2 && words.size() != 5)
      text.refuse("expected i j, or i j sx sy sz, got %zu values", words.size());
    Edge edge = {};
    for (std::size_t k = 0; k < 2; k++) {
      const auto found = network.row_of_id.find(text.count(words[k], "the id of a node"));
      if (found == network.row_of_id.end()) text.refuse("there is no node %s", shown(words[k]).c_str());
      (k ? edge.to : edge.from) = found->second;
    }
    for (std::size_t axis = 0; words.size() == 5 && axis < 3; axis++) {
      const double shift = text.number(words[2 + axis], "a shift");
      if (shift != std::floor(shift) || std::fabs(shift) > 1.0 || (shift != 0.0 && !network.periodic[axis]))
        text.refuse("shift: expected -1, 0 or 1, and 0 along an open axis, got %s",
                    shown(words[2 + axis]).c_str());
      edge.shift[axis] = static_cast<std::int8_t>(shift);
    }
    if (edge.from == edge.to && edge.shift == std::array<std::int8_t, 3>{0, 0, 0})
      text.refuse("an edge from node %s to itself", shown(words[0]).c_str());
    edges.push_back(edge);
    edges.push_back({edge.to,
                     edge.from,
                     {static_cast<std::int8_t>(-edge.shift[0]), static_cast<std::int8_t>(-edge.shift[1]),
                      static_cast<std::int8_t>(-edge.shift[2])}});
  }
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) text.refuse("an edge comes twice");
  return edges;
}

} // namespace

void import_network(const Request &request, conceg_doc *doc) {
  if (request.names.size() != 2)
    fail(CONCEG_E_USAGE, "expected two files, the nodes and the edges, got %zu", request.names.size());
  Network network;
  read_nodes(TextFile::open(request.ctx, request.names[0]), network);
  const std::vector<Edge> edges = read_edges(TextFile::open(request.ctx, request.names[1]), network);
  SceneCell nodes; // so that a box is put around them
  for (std::size_t i = 0; i < network.position.size(); i++)
    nodes.follow(network.position[i], network.radius[i], CONCEG_SWC_AXON);
  nodes.soma = nodes.position[0];
  network.box.cells.push_back(std::move(nodes));
  write_domain(doc, network.box, request.margin_um, network.periodic.data());
  std::vector<std::uint64_t> offset(network.position.size() + 1, 0);
  std::vector<std::uint32_t> to;
  std::vector<std::int8_t> shift;
  for (const Edge &edge : edges) {
    offset[edge.from + 1]++;
    to.push_back(edge.to), shift.insert(shift.end(), edge.shift.begin(), edge.shift.end());
  }
  for (std::size_t i = 1; i < offset.size(); i++)
    offset[i] += offset[i - 1];
  put3(doc, "/network/position", network.position), put(doc, "/network/radius", network.radius);
  put(doc, "/network/edge_offset", offset), put(doc, "/network/edge", to),
      put(doc, "/network/edge_shift", shift, 3);
  conceg_ctx_log(request.ctx, CONCEG_LOG_INFO, "import: %zu nodes, %zu edges", network.position.size(),
                 edges.size() / 2);
}

} // namespace conceg::importing
