// SPDX-License-Identifier: BSD-3-Clause
#include "march.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace conceg::mesh {
namespace {

// An edge of the split runs from a lower node along (dx, dy, dz) in {0, 1}^3. In a cube: lower corner and
// direction, as bits.
struct CubeEdge {
  int corner, direction;
};
using CubeFace = std::array<CubeEdge, 3>;

// The triangles of a cube for each pattern of inside corners (bit = corner, x + 2 y + 4 z).
class CubeTable {
public:
  CubeTable() {
    int axes[3] = {0, 1, 2};
    do {
      const bool even = axes[1] == (axes[0] + 1) % 3;
      const std::array<int, 4> corner = {0, 1 << axes[0], (1 << axes[0]) | (1 << axes[1]), 7};
      for (int inside = 0; inside < 256; inside++)
        add_tetrahedron(inside, corner, even);
    } while (std::next_permutation(axes, axes + 3));
  }
  const std::vector<CubeFace> &operator[](int inside) const {
    return faces_[static_cast<std::size_t>(inside)];
  }

private:
  void add_tetrahedron(int inside, const std::array<int, 4> &corner, bool even) {
    int in[4], out[4], ins = 0, outs = 0;
    for (int i = 0; i < 4; i++)
      (inside >> corner[i] & 1 ? in[ins++] : out[outs++]) = i;
    if (ins == 1) add_corner(inside, corner, in[0], even);
    if (ins == 3) add_corner(inside, corner, out[0], !even);
    if (ins == 2) {
      const bool turned = parity({in[0], in[1], out[0], out[1]}) ^ !even;
      const CubeEdge a = edge(corner, in[0], out[0]), b = edge(corner, in[0], out[1]),
                     c = edge(corner, in[1], out[1]), d = edge(corner, in[1], out[0]);
      add(inside, {a, b, c}, turned);
      add(inside, {a, c, d}, turned);
    }
  }
  // The triangle that cuts off one corner, facing away from it where the tetrahedron is positive.
  void add_corner(int inside, const std::array<int, 4> &corner, int lone, bool positive) {
    static constexpr int others[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    add(inside,
        {edge(corner, lone, others[lone][0]), edge(corner, lone, others[lone][1]),
         edge(corner, lone, others[lone][2])},
        !positive);
  }
  void add(int inside, CubeFace face, bool turned) {
    if (turned) std::swap(face[1], face[2]);
    faces_[static_cast<std::size_t>(inside)].push_back(face);
  }
  static CubeEdge edge(const std::array<int, 4> &corner, int i, int j) {
    return {corner[std::min(i, j)], corner[i] ^ corner[j]};
  }
  static bool parity(const std::array<int, 4> &order) {
    bool odd = false;
    for (int i = 0; i < 4; i++)
      for (int j = i + 1; j < 4; j++)
        odd ^= order[i] > order[j];
    return odd;
  }
  std::array<std::vector<CubeFace>, 256> faces_;
};

constexpr int kStar = 14; // edges at a node: 7 upwards, 7 downwards

constexpr int node_number(int x, int y, int z) {
  return (z * kRow + y) * kRow + x;
}

// The star of a node: its neighbours in the split, and which sets of them bound a disk. Two crossings on
// edges at a node are joined by an edge of the surface exactly when the edges' far ends are neighbours, so
// the crossings near a node are one patch without holes when their far ends are one on the sphere of
// neighbours.
class Star {
public:
  Star() {
    for (int d = 1; d < 8; d++) {
      const glm::ivec3 step(d & 1, d >> 1 & 1, d >> 2);
      step_[d - 1] = step, step_[d + 6] = -step;
      shift_[d - 1] = node_number(step.x, step.y, step.z), shift_[d + 6] = -shift_[d - 1];
    }
    disk_.resize(1 << kStar);
    for (unsigned mask = 1; mask < disk_.size(); mask++)
      disk_[mask] = is_disk(mask);
  }
  int shift(int i) const { return shift_[i]; }
  const glm::ivec3 &step(int i) const { return step_[i]; }
  bool disk(unsigned mask) const { return disk_[mask] != 0; }

private:
  bool neighbours(int i, int j) const {
    const glm::ivec3 d = step_[i] - step_[j];
    const int low = std::min({d.x, d.y, d.z}), high = std::max({d.x, d.y, d.z});
    return d != glm::ivec3(0) && ((low >= 0 && high == 1) || (low == -1 && high <= 0));
  }
  // One piece, and as many vertices less edges plus triangles as a disk has.
  bool is_disk(unsigned mask) const {
    int euler = 0;
    unsigned reached = mask & -mask;
    for (int i = 0; i < kStar; i++) {
      if (!(mask >> i & 1)) continue;
      euler++;
      for (int j = i + 1; j < kStar; j++) {
        if (!(mask >> j & 1) || !neighbours(i, j)) continue;
        euler--;
        for (int k = j + 1; k < kStar; k++)
          if ((mask >> k & 1) && neighbours(i, k) && neighbours(j, k)) euler++;
      }
    }
    for (unsigned before = 0; before != reached;) {
      before = reached;
      for (int i = 0; i < kStar; i++)
        for (int j = 0; j < kStar; j++)
          if ((reached >> i & 1) && (mask >> j & 1) && neighbours(i, j)) reached |= 1u << j;
    }
    return euler == 1 && reached == mask;
  }
  std::array<glm::ivec3, kStar> step_;
  std::array<int, kStar> shift_;
  std::vector<std::uint8_t> disk_;
};

const Star &star() {
  static const Star instance;
  return instance;
}
const CubeTable &table() {
  static const CubeTable instance;
  return instance;
}

constexpr std::uint32_t kNone = 0xffffffffu, kApart = 0xfffffffeu;

} // namespace

Marcher::Marcher() : slot_(std::size_t(kNodes) * 8, kNone) {}

bool Marcher::run(const BlockField &field, std::size_t label, const glm::ivec3 &size, bool cluster,
                  const KeepsApart &apart, Chunk &out) {
  field_ = &field, label_ = label, value_ = field.of(label), cluster_ = cluster, apart_ = &apart;
  out.lift = field.label[label].lift;
  out.first = field.first - out.lift * size;
  out.vertex.clear(), out.face.clear();
  sign_rows(field.cubes);
  for (int z = 0; z < field.cubes.z; z++)
    for (int y = 0; y < field.cubes.y; y++)
      march_row(y + kHalo, z + kHalo, field.cubes.x, out);
  for (const std::uint32_t slot : used_)
    slot_[slot] = kNone;
  used_.clear();
  return !out.vertex.empty();
}

void Marcher::sign_rows(const glm::ivec3 &cubes) {
  for (int z = kHalo; z <= cubes.z + kHalo; z++)
    for (int y = kHalo; y <= cubes.y + kHalo; y++) {
      const float *row = value_ + node_number(0, y, z);
      std::uint32_t bits = 0;
      for (int x = 0; x < kRow; x++)
        bits |= static_cast<std::uint32_t>(row[x] < 0) << x;
      sign_[z][y] = bits;
    }
}

void Marcher::march_row(int y, int z, int width, Chunk &out) {
  const std::uint32_t a = sign_[z][y], b = sign_[z][y + 1], c = sign_[z + 1][y], d = sign_[z + 1][y + 1];
  const std::uint32_t any = a | b | c | d, all = a & b & c & d;
  const std::uint32_t mixed = (any | any >> 1) & ~(all & all >> 1) & (((1u << width) - 1) << kHalo);
  for (std::uint32_t rest = mixed; rest; rest &= rest - 1) {
    const int x = __builtin_ctz(rest);
    const auto pair = [x](std::uint32_t bits) { return static_cast<int>(bits >> x & 3); };
    const int inside = pair(a) | pair(b) << 2 | pair(c) << 4 | pair(d) << 6;
    for (const CubeFace &face : table()[inside]) {
      ChunkFace f;
      for (int i = 0; i < 3; i++)
        f.corner[i] = static_cast<std::uint16_t>(vertex(x, y, z, face[static_cast<std::size_t>(i)].corner,
                                                        face[static_cast<std::size_t>(i)].direction, out));
      if (f.corner[0] != f.corner[1] && f.corner[1] != f.corner[2] && f.corner[2] != f.corner[0])
        out.face.push_back(f);
    }
  }
}

Marcher::Crossing Marcher::crossing(int low, int high) const {
  const float a = value_[low], b = value_[high], part = a / (a - b);
  const float ra = room_at(low), rb = room_at(high);
  return {part, ra + part * (rb - ra)};
}

std::uint32_t Marcher::vertex(int x, int y, int z, int corner, int direction, Chunk &out) {
  x += corner & 1, y += corner >> 1 & 1, z += corner >> 2;
  const glm::ivec3 step(direction & 1, direction >> 1 & 1, direction >> 2);
  const int node = node_number(x, y, z);
  const auto slot = static_cast<std::uint32_t>(node * 8 + direction);
  if (slot_[slot] != kNone) return slot_[slot];
  const int far = node + node_number(step.x, step.y, step.z);
  const Crossing c = crossing(node, far);
  std::uint32_t number = kApart;
  if (cluster_)
    number =
        c.part < 0.5f ? cluster_at(node, {x, y, z}, out) : cluster_at(far, glm::ivec3(x, y, z) + step, out);
  if (number == kApart) number = add(node, direction, c.part * glm::vec3(step), c.room, out);
  slot_[slot] = number;
  used_.push_back(slot);
  return number;
}

// The vertex of the crossings nearest to a node; kApart when they do not form a disk, or must stay apart.
std::uint32_t Marcher::cluster_at(int node, const glm::ivec3 &at, Chunk &out) {
  const auto slot = static_cast<std::uint32_t>(node * 8);
  if (slot_[slot] != kNone) return slot_[slot];
  unsigned mask = 0;
  int count = 0;
  glm::vec3 sum(0);
  float room = kRoomMost;
  const bool inside = value_[node] < 0;
  for (int i = 0; i < kStar; i++) {
    const int far = node + star().shift(i);
    if ((value_[far] < 0) == inside) continue;
    const Crossing c = i < 7 ? crossing(node, far) : crossing(far, node);
    if ((c.part < 0.5f) != (i < 7)) continue; // nearest to the other end
    mask |= 1u << i;
    sum += (i < 7 ? c.part : 1.0f - c.part) * glm::vec3(star().step(i));
    room = std::min(room, c.room);
    count++;
  }
  std::uint32_t number = kApart;
  if (star().disk(mask) && !(*apart_ && (*apart_)(out.first + at)))
    number = add(node, 0, sum / static_cast<float>(count), room, out);
  slot_[slot] = number;
  used_.push_back(slot);
  return number;
}

std::uint32_t Marcher::add(int node, int direction, const glm::vec3 &offset, float room, Chunk &out) {
  const auto fixed = [](float v) { return static_cast<std::int16_t>(std::floor(v * kOffset + 0.5f)); };
  out.vertex.push_back({static_cast<std::uint16_t>(node * 8 + direction),
                        {fixed(offset.x), fixed(offset.y), fixed(offset.z)},
                        static_cast<std::uint16_t>(std::max(0.0f, room) * kRoomUnit)});
  return static_cast<std::uint32_t>(out.vertex.size() - 1);
}

} // namespace conceg::mesh
