// SPDX-License-Identifier: BSD-3-Clause
// In a tetrahedron each label's inside is a half-space's part, and the insides are disjoint. What they leave
// is an intersection of half-spaces, so it is convex: one piece, or nothing when all four nodes lie in one
// label. The same holds in a face: two tetrahedra are joined through it unless its three nodes lie in one
// label. So pieces are found from the nodes' labels alone, without rounding.
#include "space.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <unordered_map>

namespace conceg::mesh {
namespace {

// The six tetrahedra of a cube, by corners (x + 2 y + 4 z), each along the diagonal 0 -> 7.
constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7},
                                   {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};

// Share of a tetrahedron in which a linear function with these values at its nodes is negative.
double negative_share(const std::array<float, 4> &value) {
  double in[4], out[4];
  int ins = 0, outs = 0;
  for (const float v : value)
    (v < 0 ? in[ins++] : out[outs++]) = v;
  const auto cut = [](double low, double high) { return low / (low - high); };
  if (ins == 0) return 0;
  if (ins == 4) return 1;
  if (ins == 1) return cut(in[0], out[0]) * cut(in[0], out[1]) * cut(in[0], out[2]);
  if (ins == 3) return 1 - cut(out[0], in[0]) * cut(out[0], in[1]) * cut(out[0], in[2]);
  // Two and two: a wedge.
  const double ac = cut(in[0], out[0]), ad = cut(in[0], out[1]), bc = cut(in[1], out[0]),
               bd = cut(in[1], out[1]);
  return ac * ad * (1 - bd) + ac * bd * (1 - bc) + bc * bd;
}

class Sets {
public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i)
      i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t i, std::uint32_t j) {
    i = root(i), j = root(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

private:
  std::vector<std::uint32_t> parent_;
};

int corner_node(int corner) {
  return ((corner >> 2) * kRow + (corner >> 1 & 1)) * kRow + (corner & 1);
}

// The space in one tetrahedron of the cube at node `base`, and which of its faces lie in one label.
void measure(const BlockField &field, const std::array<std::int32_t, kNodes> &holder, int base,
             const int *corner, float &space, std::uint8_t &closed) {
  std::array<int, 4> node;
  std::array<std::int32_t, 4> in;
  for (std::size_t c = 0; c < 4; c++)
    node[c] = base + corner_node(corner[c]), in[c] = holder[static_cast<std::size_t>(node[c])];
  double share = 1;
  for (std::size_t first = 0; first < 4; first++) {
    if (in[first] < 0 || std::find(in.begin(), in.begin() + first, in[first]) != in.begin() + first) continue;
    std::array<float, 4> value;
    int inside = 0;
    for (std::size_t c = 0; c < 4; c++) {
      value[c] = field.of(static_cast<std::size_t>(in[first]))[node[c]];
      inside |= (value[c] < 0) << c;
    }
    share -= negative_share(value);
    for (int c = 0; c < 4; c++)
      if ((inside | 1 << c) == 15) closed |= static_cast<std::uint8_t>(1 << c);
  }
  space = closed == 15 ? 0 : static_cast<float>(std::max(0.0, share));
}

} // namespace

Space extracellular_space(const Scene &scene, const Index &index, Workers &workers,
                          const Progress &progress) {
  const Grid &grid = scene.grid;
  for (int a = 0; a < 3; a++)
    if (!grid.periodic[a])
      fail(CONCEG_E_UNSUPPORTED, "space: expected a box that is periodic on all axes, axis %d is open", a);
  const std::size_t cubes = static_cast<std::size_t>(grid.size.x) * static_cast<std::size_t>(grid.size.y) *
                            static_cast<std::size_t>(grid.size.z);
  if (cubes * 6 >= 0xffffffffu)
    fail(CONCEG_E_RANGE, "space: %zu cubes are more than can be joined; use a larger h_um", cubes);
  std::vector<float> space(cubes * 6, 1); // per tetrahedron, the share that no cell holds
  std::vector<std::uint8_t> closed(cubes * 6,
                                   0); // bit c: the face that leaves corner c out lies in one label
  std::atomic<std::uint64_t> done{0};
  const auto cube_number = [&](const glm::ivec3 &at) {
    glm::ivec3 n;
    for (int a = 0; a < 3; a++)
      n[a] = ((at[a] % grid.size[a]) + grid.size[a]) % grid.size[a];
    return (static_cast<std::size_t>(n.z) * static_cast<std::size_t>(grid.size.y) +
            static_cast<std::size_t>(n.y)) *
               static_cast<std::size_t>(grid.size.x) +
           static_cast<std::size_t>(n.x);
  };
  workers.loop(index.block.size(), 1, [&](std::size_t row, unsigned) {
    static thread_local BlockField field;
    evaluate_block(scene, index, row, field);
    // A node lies in one label at most.
    std::array<std::int32_t, kNodes> holder;
    holder.fill(-1);
    for (std::size_t l = 0; l < field.label.size(); l++)
      for (int node = 0; node < kNodes; node++)
        if (field.of(l)[node] < 0) holder[static_cast<std::size_t>(node)] = static_cast<std::int32_t>(l);
    for (int z = 0; z < field.cubes.z; z++)
      for (int y = 0; y < field.cubes.y; y++)
        for (int x = 0; x < field.cubes.x; x++) {
          const std::size_t cube = cube_number(field.first + glm::ivec3(x, y, z));
          const int base = (z * kRow + y) * kRow + x;
          for (std::size_t t = 0; t < 6; t++)
            measure(field, holder, base, kTetrahedra[t], space[cube * 6 + t], closed[cube * 6 + t]);
        }
    const std::uint64_t count = ++done;
    if (count % 64 == 0) report(progress, "mesh: space", count, index.block.size());
  });

  // Join across the faces of each tetrahedron; a face is found again by its three nodes, in the cube itself
  // or the next one.
  Sets sets(cubes * 6);
  const auto tetrahedron = [](const glm::ivec3 &a,
                              const glm::ivec3 &b) { // of a cube, by corners 1 and 2 of its path
    const int first = a.x | a.y << 1 | a.z << 2, second = b.x | b.y << 1 | b.z << 2;
    for (int t = 0; t < 6; t++)
      if (kTetrahedra[t][1] == first && kTetrahedra[t][2] == second) return static_cast<std::size_t>(t);
    return std::size_t{6};
  };
  const auto corner = [](int c) { return glm::ivec3(c & 1, c >> 1 & 1, c >> 2); };
  const auto open = [&](std::size_t tet, int face) { return !(closed[tet] >> face & 1); };
  for (int z = 0; z < grid.size.z; z++)
    for (int y = 0; y < grid.size.y; y++)
      for (int x = 0; x < grid.size.x; x++) {
        const std::size_t cube = cube_number({x, y, z});
        for (int t = 0; t < 6; t++) {
          const std::size_t here = cube * 6 + static_cast<std::size_t>(t);
          const glm::ivec3 one = corner(kTetrahedra[t][1]), two = corner(kTetrahedra[t][2]);
          // Faces 1 and 2 hold the diagonal: joined to the path of the same cube that goes round the other
          // way.
          if (open(here, 1))
            sets.join(static_cast<std::uint32_t>(here),
                      static_cast<std::uint32_t>(cube * 6 + tetrahedron(two - one, two)));
          if (open(here, 2))
            sets.join(static_cast<std::uint32_t>(here),
                      static_cast<std::uint32_t>(cube * 6 + tetrahedron(one, one + glm::ivec3(1) - two)));
          // Face 0 (one, two, 7) lies on the far side along the first step; there it is 0, two - one, 1 -
          // one.
          if (open(here, 0)) {
            const std::size_t next = cube_number(glm::ivec3(x, y, z) + one);
            sets.join(static_cast<std::uint32_t>(here),
                      static_cast<std::uint32_t>(next * 6 + tetrahedron(two - one, glm::ivec3(1) - one)));
          }
        }
      }
  std::unordered_map<std::uint32_t, double> pieces;
  Space out;
  for (std::size_t t = 0; t < cubes * 6; t++)
    if (closed[t] != 15) pieces[sets.root(static_cast<std::uint32_t>(t))] += static_cast<double>(space[t]);
  // Sums in the order of the tetrahedra: the same for any number of threads.
  double total = 0, largest = 0;
  for (const auto &piece : pieces)
    largest = std::max(largest, piece.second);
  for (std::size_t t = 0; t < cubes * 6; t++)
    total += static_cast<double>(space[t]);
  out.pieces = pieces.size();
  out.volume = total / static_cast<double>(cubes * 6);
  out.largest = total > 0 ? largest / total : 1;
  return out;
}

} // namespace conceg::mesh
