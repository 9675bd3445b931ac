// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes.hpp"

#include "conceg/rng.h"
#include "lattice.hpp"
#include "wrap.hpp"

#include <algorithm>
#include <array>
#include <atomic>

namespace conceg::triangulate {
namespace {

constexpr double kNodeLimit = 4294967295.0; // ids are u32
constexpr double kSmallestSide = 0.0625;    // um; many lattice steps
constexpr double kHaloUniform = 3.8; // of density^(-1/3): twice the largest empty sphere seen, and a tenth
constexpr double kHaloMargin = 1e-4; // um; above the certificate's own safety
constexpr std::size_t kBlock = 4096; // nodes made between two progress reports of a worker

// A node with its place on the curve; `draw` names the random draw that made it.
struct Node {
  std::uint64_t curve;
  glm::dvec3 position;
  std::uint64_t draw;
};

bool same_place(const Node &a, const Node &b) {
  return a.position == b.position;
}

bool before(const Node &a, const Node &b) {
  if (a.curve != b.curve) return a.curve < b.curve;
  for (int axis = 0; axis < 3; axis++)
    if (a.position[axis] != b.position[axis]) return a.position[axis] < b.position[axis];
  return a.draw < b.draw;
}

// Spreads the low 21 bits of x over every third bit.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  return (x | x << 2) & 0x1249249249249249ull;
}

// Position on the Morton curve through blocks of one node spacing.
std::uint64_t curve_of(const conceg_box &box, const glm::dvec3 &position, double spacing) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; axis++)
    code |= spread(static_cast<std::uint64_t>((position[axis] - box.lo[axis]) / spacing)) << axis;
  return code;
}

std::uint64_t lattice_steps(double length) {
  return static_cast<std::uint64_t>(length / CONCEG_LATTICE_STEP_UM + 0.5);
}

// A lattice coordinate strictly between the faces `lo` and `lo + side`.
double between(double lo, double side, conceg_rng &rng) {
  return lo +
         static_cast<double>(1 + conceg_rng_below(&rng, lattice_steps(side) - 1)) * CONCEG_LATTICE_STEP_UM;
}

// The draw-th uniform node; `attempt` > 0 replaces a node that fell on another one.
glm::dvec3 uniform_node(const conceg_box &box, std::uint64_t seed, std::uint64_t draw, std::uint64_t attempt,
                        bool inside) {
  conceg_rng rng = conceg_rng_stream(seed, "triangulate.uniform", draw);
  rng.counter = 3 * attempt;
  glm::dvec3 position;
  for (int axis = 0; axis < 3; axis++) {
    const double side = conceg_box_side(&box, axis);
    position[axis] = inside
                         ? between(box.lo[axis], side, rng)
                         : box.lo[axis] + static_cast<double>(conceg_rng_below(&rng, lattice_steps(side))) *
                                              CONCEG_LATTICE_STEP_UM;
  }
  return position;
}

// Nodes on the faces, edges and corners of the box, at the density of the network's cross-section: one set
// per pair of opposing faces on a periodic axis, one set per face on an open one.
void add_face_nodes(const conceg_box &box, const NodeOptions &options, std::vector<glm::dvec3> &out) {
  const double line = conceg_pow(options.density_per_um3, 1.0 / 3.0);
  for (unsigned on = 1; on < 8; on++) { // bit a: the node lies on a face of axis a
    double expected = 1.0;
    for (int axis = 0; axis < 3; axis++)
      if (!(on >> axis & 1)) expected *= line * conceg_box_side(&box, axis);
    const auto count = static_cast<std::uint64_t>(expected + 0.5);
    for (unsigned upper = 0; upper < 8; upper++) { // bit a: on the upper face of open axis a
      bool wanted = (upper & ~on) == 0;
      for (int axis = 0; axis < 3; axis++)
        wanted = wanted && !((upper >> axis & 1) && box.periodic[axis]);
      for (std::uint64_t i = 0; wanted && i < count; i++) {
        conceg_rng rng = conceg_rng_stream(options.seed, "triangulate.face", (i << 6) | (upper << 3) | on);
        glm::dvec3 position;
        for (int axis = 0; axis < 3; axis++) {
          const double side = conceg_box_side(&box, axis);
          if (on >> axis & 1)
            position[axis] = (upper >> axis & 1) ? box.hi[axis] : box.lo[axis];
          else
            position[axis] = between(box.lo[axis], side, rng);
        }
        out.push_back(position);
      }
    }
  }
}

// Sorts along the curve and gives every second node of one place a new draw inside the box, until no place is
// taken twice.
void order_without_doubles(const conceg_box &box, const NodeOptions &options, double spacing,
                           std::vector<Node> &nodes) {
  for (std::uint64_t attempt = 1;; attempt++) {
    std::sort(nodes.begin(), nodes.end(), before);
    bool doubled = false;
    for (std::size_t i = 1; i < nodes.size(); i++)
      if (same_place(nodes[i - 1], nodes[i])) {
        doubled = true;
        nodes[i].position = uniform_node(box, options.seed, nodes[i].draw, attempt, options.mirrored_faces);
        nodes[i].curve = curve_of(box, nodes[i].position, spacing);
      }
    if (!doubled) return;
    if (attempt == 1000)
      fail(CONCEG_E_RANGE,
           "density_per_um3: expected fewer nodes than lattice points, got %g; ask for a lower density",
           options.density_per_um3);
  }
}

void check_box(const conceg_box &box) {
  for (int axis = 0; axis < 3; axis++)
    if (!(conceg_box_side(&box, axis) >= kSmallestSide))
      fail(CONCEG_E_RANGE, "/domain: expected a side of at least %g um on axis %d, got %g um", kSmallestSide,
           axis, conceg_box_side(&box, axis));
}

void check_count(double expected, const char *remedy) {
  if (!(expected < kNodeLimit))
    fail(CONCEG_E_RANGE, "density_per_um3: expected fewer than 2^32 nodes in the box, got %.3g; ask for %s",
         expected, remedy);
}

} // namespace

void check_nodes(const conceg_box &box, const NodeOptions &options) {
  check_box(box);
  check_count(options.density_per_um3 * volume(box), "a lower density or a smaller box");
}

double first_halo_um(const conceg_box &box, const NodeOptions &options) {
  if (options.set == NodeSet::uniform) return kHaloUniform * conceg_pow(options.density_per_um3, -1.0 / 3.0);
  // A node's cells have circumspheres without a node inside, which reach twice the radius at most.
  const Lattice lattice = lattice_of(box, options.density_per_um3);
  return 2.0 * empty_radius_um(lattice, options.jitter, !options.levels.empty()) + kHaloMargin;
}

std::vector<glm::dvec3> make_nodes(const conceg_box &box, const NodeOptions &options, Workers &workers,
                                   const Progress &progress) {
  check_nodes(box, options);
  const double expected = options.density_per_um3 * volume(box);
  const bool bcc = options.set == NodeSet::bcc;
  const CellNodes cell_nodes(lattice_of(box, options.density_per_um3), options.levels);
  const std::uint64_t count = bcc ? cell_nodes.count() : static_cast<std::uint64_t>(expected + 0.5);
  check_count(static_cast<double>(count), "a lower density, fewer grade_levels or a smaller box");
  if (count == 0)
    fail(CONCEG_E_RANGE,
         "density_per_um3: expected at least one node in the box, got %g um^-3 x %g um3; ask for a higher "
         "density",
         options.density_per_um3, volume(box));
  std::vector<glm::dvec3> faces;
  if (options.mirrored_faces) add_face_nodes(box, options, faces);

  const double spacing = cell_side(options.density_per_um3);
  std::vector<Node> nodes(count + faces.size());
  std::atomic<std::uint64_t> made{0};
  workers.loop((nodes.size() + kBlock - 1) / kBlock, 1, [&](std::size_t block, unsigned) {
    const std::size_t end = std::min(nodes.size(), (block + 1) * kBlock);
    std::uint64_t cell = bcc ? cell_nodes.cell_of(block * kBlock) : 0;
    for (std::size_t i = block * kBlock; i < end; i++) {
      Node &node = nodes[i];
      node.draw = i;
      if (i >= count) {
        node.position = faces[i - count];
      } else if (bcc) {
        cell = cell_nodes.cell_of(i, cell);
        node.position = cell_nodes.node(i, cell, options.jitter, options.seed);
      } else {
        node.position = uniform_node(box, options.seed, i, 0, options.mirrored_faces);
      }
      node.curve = curve_of(box, node.position, spacing);
    }
    report(progress, "nodes", made += end - block * kBlock, nodes.size());
  });
  order_without_doubles(box, options, spacing, nodes);

  std::vector<glm::dvec3> positions(nodes.size());
  std::transform(nodes.begin(), nodes.end(), positions.begin(),
                 [](const Node &node) { return node.position; });
  return positions;
}

} // namespace conceg::triangulate
