// SPDX-License-Identifier: BSD-3-Clause
#include "walls.hpp"

#include "distance_grid.hpp"
#include "tile.hpp"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <limits>
#include <map>

namespace conceg::simulate {

namespace {

constexpr double voxel_limit = 268435456.0; // 2^28
constexpr double fine_limit =
    33554432.0; // 2^25 voxels; above, distances are kept for them and not for finer ones
// A face reaches this far (um) beyond its edges, so that rounding opens no gap between two that share one.
constexpr double rim_um = 1e-7;
constexpr double finest_voxel_um = 0.3; // finer ones hold fewer faces each, but more in all
constexpr std::size_t chunk = 16384;

} // namespace

Walls::Walls(const conceg_box &box, const Membranes &membranes, double reach_um, Workers &workers,
             const Progress &progress)
    : box_(box), side_(side(box)), reach_(reach_um) {
  any_open_ = !(box.periodic[0] && box.periodic[1] && box.periodic[2]);
  vertex_ = membranes.vertex, code_ = membranes.code;
  choose_grid(membranes.face.size());
  list_images(membranes);
  sort_images(workers);
  fill_voxels(workers, progress);
}

// Whole voxels along periodic sides; on open axes they cover all surfaces and the reach around them. Coarser
// ones where there are so many faces that their lists would not fit.
void Walls::choose_grid(std::size_t faces) {
  glm::dvec3 lowest(0.0), highest = side_;
  for (int axis = 0; axis < 3; axis++)
    origin_[axis] = box_.lo[axis];
  for (const glm::dvec3 &v : vertex_)
    lowest = glm::min(lowest, v - origin_), highest = glm::max(highest, v - origin_);
  for (int axis = 0; axis < 3; axis++) {
    lowest[axis] = box_.periodic[axis] ? 0.0 : lowest[axis] - 2.0 * reach_;
    highest[axis] = box_.periodic[axis] ? side_[axis] : highest[axis] + 2.0 * reach_;
  }
  const glm::dvec3 extent = highest - lowest;
  const double crowd = std::cbrt(std::max(1.0, static_cast<double>(faces) / 8e6));
  const double width = std::max(
      {finest_voxel_um * crowd, reach_, std::cbrt(extent.x * extent.y * extent.z / (0.5 * voxel_limit))});
  double total = 1.0;
  for (int axis = 0; axis < 3; axis++) {
    const double voxels = std::ceil(extent[axis] / width);
    total *= voxels;
    if (!(total <= voxel_limit))
      fail(CONCEG_E_RANGE,
           "walls: expected a box, with its cells, that %g voxels of %g um cover, got %g x %g x %g um",
           voxel_limit, width, extent.x, extent.y, extent.z);
    count_[axis] = static_cast<int>(voxels);
    edge_[axis] = extent[axis] / voxels, scale_[axis] = voxels / extent[axis];
    low_[axis] = lowest[axis];
  }
  fine_factor_ = total <= fine_limit ? 2 : 1;
  if (fine_factor_ == 2) fine_shift_ = 0.25 * edge_;
  for (int axis = 0; axis < 3; axis++)
    blocks_[axis] = (static_cast<std::size_t>(count_[axis]) + 1) / 2,
    fine_count_[axis] = static_cast<std::size_t>(count_[axis]) * static_cast<std::size_t>(fine_factor_);
  bytes_ = ByteScale(0.5 * edge_ + reach_ + 4.0 * clearance_um);
  room_unit_um_ = 1.0001 * (0.5 * glm::length(edge_) + reach_), room_scale_ = Room::steps / room_unit_um_;
}

std::array<glm::dvec3, 3> Walls::corners(const Face &face) const {
  const glm::dvec3 shift = lift_[face.lift] - origin_;
  return {vertex_[face.corner.x] + shift, vertex_[face.corner.y] + shift, vertex_[face.corner.z] + shift};
}

// Every face at every lift at which a move from within the box can meet it.
void Walls::list_images(const Membranes &membranes) {
  std::map<std::array<int, 3>, std::uint32_t> known;
  const glm::dvec3 rim(reach_ + 2.0 * clearance_um);
  for (std::uint32_t f = 0; f < membranes.face.size(); f++) {
    const glm::uvec3 &corner = membranes.face[f];
    const glm::dvec3 &a = vertex_[corner.x], &b = vertex_[corner.y], &c = vertex_[corner.z];
    if (!(glm::length(glm::cross(b - a, c - a)) > 0.0)) continue; // no area: its neighbours share its edges
    for_each_lift(box_, glm::min(a, glm::min(b, c)) - rim, glm::max(a, glm::max(b, c)) + rim,
                  [&](const glm::ivec3 &at) {
                    const auto [found, added] =
                        known.insert({{at.x, at.y, at.z}, static_cast<std::uint32_t>(lift_.size())});
                    if (added) lift_.push_back(glm::dvec3(at) * side_);
                    faces_.push_back({corner, f, found->second});
                  });
  }
  if (faces_.size() >= Contact::none)
    fail(CONCEG_E_UNSUPPORTED, "walls: expected fewer than 2^32 faces in the box, got %zu", faces_.size());
}

// Bits of the fine voxels, of the voxel around `middle`, that a face between `low` and `high` (widened by at
// least the reach) may cross.
unsigned Walls::touched_parts(const Plane &plane, const glm::dvec3 &middle, const glm::dvec3 &low,
                              const glm::dvec3 &high) const {
  if (fine_factor_ == 1) return 1u;
  const glm::dvec3 quarter = 0.25 * edge_, narrowed = glm::dvec3(reach_) - quarter;
  const double across = 1.001 * glm::dot(glm::abs(plane.normal), quarter);
  unsigned touched = 0;
  for (unsigned part = 0; part < 8; part++) {
    const glm::dvec3 at = middle + quarter * glm::dvec3((part & 1u) ? 1.0 : -1.0, (part & 2u) ? 1.0 : -1.0,
                                                        (part & 4u) ? 1.0 : -1.0);
    const bool within = glm::all(glm::greaterThanEqual(at, low + narrowed)) &&
                        glm::all(glm::lessThanEqual(at, high - narrowed));
    if (within && std::fabs(glm::dot(plane.normal, at) - plane.offset) <= across) touched |= 1u << part;
  }
  return touched;
}

// The voxels from which faces begin .. end can be met.
std::vector<Walls::Entry> Walls::entries(std::size_t begin, std::size_t end) const {
  std::vector<Entry> found;
  const double around = 0.5 * glm::length(edge_) + reach_ + 2.0 * clearance_um;
  const glm::dvec3 rim(reach_ + 2.0 * clearance_um);
  const double half_diagonal = 0.5005 * glm::length(edge_);
  for (std::size_t f = begin; f < end; f++) {
    const Plane &plane = plane_[f];
    const std::array<glm::dvec3, 3> p = corners(faces_[f]);
    const glm::dvec3 low = glm::min(p[0], glm::min(p[1], p[2])) - rim,
                     high = glm::max(p[0], glm::max(p[1], p[2])) + rim;
    const double across = 0.5 * glm::dot(glm::abs(plane.normal), edge_) + reach_ + 2.0 * clearance_um;
    glm::ivec3 from, to;
    bool meets = true;
    for (int axis = 0; axis < 3; axis++) {
      meets = meets && high[axis] >= low_[axis] && low[axis] <= low_[axis] + count_[axis] * edge_[axis];
      from[axis] = index_on(axis, low[axis]), to[axis] = index_on(axis, high[axis]);
    }
    if (!meets) continue;
    for (int z = from.z; z <= to.z; z++)
      for (int y = from.y; y <= to.y; y++)
        for (int x = from.x; x <= to.x; x++) {
          const glm::dvec3 middle = voxel_centre({x, y, z});
          if (std::fabs(glm::dot(plane.normal, middle) - plane.offset) > across) continue;
          const double squared = squared_distance(middle, p[0], p[1], p[2]);
          if (squared > around * around) continue;
          const unsigned touched =
              squared <= half_diagonal * half_diagonal ? touched_parts(plane, middle, low, high) : 0u;
          found.push_back({static_cast<std::uint32_t>(voxel_index(x, y, z)), static_cast<std::uint32_t>(f),
                           static_cast<std::uint8_t>(touched)});
        }
  }
  return found;
}

// What is near in space comes to be near in memory: by the interleaved bits of its place. Then the planes.
void Walls::sort_images(Workers &workers) {
  const auto spread_bits = [](std::uint64_t x) {
    std::uint64_t out = 0;
    for (int bit = 0; bit < 21; bit++)
      out |= (x >> bit & 1) << (3 * bit);
    return out;
  };
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(faces_.size());
  const auto for_each_face = [&](const auto &work) {
    workers.loop((faces_.size() + chunk - 1) / chunk, 1, [&](std::size_t c, unsigned) {
      for (std::size_t f = c * chunk; f < std::min(faces_.size(), (c + 1) * chunk); f++)
        work(f);
    });
  };
  for_each_face([&](std::size_t f) {
    const glm::dvec3 p = corners(faces_[f])[0];
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; axis++)
      key |= spread_bits(static_cast<std::uint64_t>(
                 std::max(0.0, (p[axis] - low_[axis] + side_[axis]) * scale_[axis] * 8.0)))
             << axis;
    order[f] = {key, static_cast<std::uint32_t>(f)};
  });
  std::sort(order.begin(), order.end());
  HugeVector<Face> sorted(faces_.size());
  for (std::size_t f = 0; f < order.size(); f++)
    sorted[f] = faces_[order[f].second];
  faces_.swap(sorted);
  plane_.resize(faces_.size()), inner_.resize(faces_.size());
  for_each_face([&](std::size_t f) {
    const std::array<glm::dvec3, 3> p = corners(faces_[f]);
    const glm::dvec3 normal = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    plane_[f] = {normal, glm::dot(normal, p[0])};
    inner_[f] = inner_of(p, normal);
  });
}

void Walls::fill_voxels(Workers &workers, const Progress &progress) {
  const std::size_t voxels = 8 * blocks_[0] * blocks_[1] * blocks_[2];
  const std::size_t chunks = (faces_.size() + chunk - 1) / chunk;
  std::vector<std::vector<Entry>> found(chunks);
  workers.loop(chunks, 1, [&](std::size_t c, unsigned) {
    found[c] = entries(c * chunk, std::min(faces_.size(), (c + 1) * chunk));
  });
  report(progress, "sorting faces into voxels", 1, 3);

  std::vector<std::uint32_t> many(voxels, 0);
  std::vector<std::uint8_t> touched(fine_count_[0] * fine_count_[1] * fine_count_[2], 0);
  // Threads share the counters; which of them comes first decides only the order in a voxel's list, which is
  // sorted later.
  workers.loop(chunks, 1, [&](std::size_t c, unsigned) {
    for (const Entry &e : found[c]) {
      __atomic_fetch_add(&many[e.voxel], 1u, __ATOMIC_RELAXED);
      if (!e.touched) continue;
      const glm::ivec3 at = voxel_place(e.voxel);
      for (std::size_t bit = 0; bit < 8; bit++)
        if (e.touched >> bit & 1)
          __atomic_store_n(&touched[fine_row(at, bit)], std::uint8_t{1}, __ATOMIC_RELAXED);
    }
  });
  voxel_.resize(voxels + 1);
  std::uint64_t total = 0;
  std::uint32_t rooms = 0;
  for (std::size_t v = 0; v < voxels; v++) {
    voxel_[v].begin = static_cast<std::uint32_t>(total), voxel_[v].room = rooms;
    total += (many[v] + 7) / 8, rooms += many[v] > 0;
  }
  if (total >= Contact::none)
    fail(CONCEG_E_UNSUPPORTED, "walls: expected fewer than 2^35 faces in all voxels together, got %llu",
         static_cast<unsigned long long>(8 * total));
  voxel_[voxels].begin = static_cast<std::uint32_t>(total);
  for (HugeVector<Room> &side : room_)
    side.resize(rooms);
  list_.resize(total);
  workers.loop((total + chunk - 1) / chunk, 1, [&](std::size_t c, unsigned) {
    for (std::size_t i = c * chunk; i < std::min<std::size_t>(total, (c + 1) * chunk); i++)
      list_[i].clear();
  });
  std::fill(many.begin(), many.end(), 0u);
  workers.loop(chunks, 1, [&](std::size_t c, unsigned) {
    for (const Entry &e : found[c]) {
      const std::uint32_t k = __atomic_fetch_add(&many[e.voxel], 1u, __ATOMIC_RELAXED);
      list_[voxel_[e.voxel].begin + k / 8].face[k % 8] = e.face;
    }
    std::vector<Entry>().swap(found[c]);
  });
  report(progress, "sorting faces into voxels", 1, 3);
  measure_distance(touched, workers);
  report(progress, "sorting faces into voxels", 2, 3);
  fill_rooms(workers);
  report(progress, "sorting faces into voxels", 3, 3);
}

// Sorts the list of each voxel, and makes its boxes and rooms.
void Walls::fill_rooms(Workers &workers) {
  const double half_diagonal = 0.5 * glm::length(edge_);
  constexpr std::size_t batch = 1024;
  workers.loop((voxels() + batch - 1) / batch, 1, [&](std::size_t b, unsigned) {
    RoomBuilder builder(room_unit_um_, half_diagonal);
    std::vector<std::uint32_t> face;
    for (std::size_t v = b * batch; v < std::min(voxels(), (b + 1) * batch); v++) {
      if (voxel_[v].begin == voxel_[v + 1].begin) continue;
      const glm::dvec3 middle = voxel_centre(voxel_place(v));
      builder.clear(), face.clear();
      for (std::size_t i = voxel_[v].begin; i < voxel_[v + 1].begin; i++)
        face.insert(face.end(), list_[i].face, list_[i].face + 8);
      std::sort(face.begin(), face.end()); // Contact::none last
      for (std::size_t i = 0; i < face.size(); i++) {
        EightBoxes &eight = list_[voxel_[v].begin + i / 8];
        eight.face[i % 8] = face[i];
        if (face[i] == Contact::none) continue;
        std::array<glm::dvec3, 3> p = corners(faces_[face[i]]);
        for (glm::dvec3 &corner : p)
          corner -= middle;
        eight.set(static_cast<int>(i % 8), face[i], bytes_,
                  glm::min(p[0], glm::min(p[1], p[2])) - 2.0 * clearance_um,
                  glm::max(p[0], glm::max(p[1], p[2])) + 2.0 * clearance_um);
        builder.add(p, plane_[face[i]].normal);
      }
      builder.build(room_[0][voxel_[v].room], room_[1][voxel_[v].room]);
    }
  });
}

// Each point of a membrane lies in a touched fine voxel, so it is at most half a diagonal nearer than that
// voxel's centre.
void Walls::measure_distance(const std::vector<std::uint8_t> &touched, Workers &workers) {
  DistanceGrid grid;
  for (int axis = 0; axis < 3; axis++)
    grid.count[axis] = static_cast<int>(fine_count_[axis]), grid.edge[axis] = edge_[axis] / fine_factor_,
    grid.periodic[axis] = box_.periodic[axis] != 0;
  const double half_diagonal = 0.5005 * glm::length(edge_) / fine_factor_;
  const std::vector<float> between =
      distance_between_centres(grid, touched, farthest_um + half_diagonal, workers);
  const std::size_t parts = fine_factor_ == 2 ? 8 : 1;
  free_.assign(parts * voxels(), 0);
  constexpr std::size_t batch = 4096;
  workers.loop((voxels() + batch - 1) / batch, 1, [&](std::size_t b, unsigned) {
    for (std::size_t v = b * batch; v < std::min(voxels(), (b + 1) * batch); v++) {
      const glm::ivec3 at = voxel_place(v);
      if (at.x >= count_.x || at.y >= count_.y || at.z >= count_.z) continue; // it fills up a block
      for (std::size_t part = 0; part < parts; part++) {
        const double least = static_cast<double>(between[fine_row(at, part)]) - half_diagonal;
        free_[parts * v + part] =
            static_cast<std::uint8_t>(std::clamp(least * (1.0 - 1e-6) / free_unit_um, 0.0, 255.0));
      }
    }
  });
}

double Walls::outside_radius(const glm::dvec3 &place) const {
  double squared = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    const double over =
        std::max({0.0, low_[axis] - place[axis], place[axis] - (low_[axis] + count_[axis] * edge_[axis])});
    squared += over * over;
  }
  return reach_ + std::sqrt(squared);
}

// The coordinate of a corner falls from 1 to 0 on the way to the opposite edge.
Walls::Inner Walls::inner_of(const std::array<glm::dvec3, 3> &corner, const glm::dvec3 &normal) {
  Inner inner;
  const double twice_area = glm::dot(glm::cross(corner[1] - corner[0], corner[2] - corner[0]), normal);
  for (std::size_t k = 0; k < 2; k++) {
    const glm::dvec3 &from = corner[(k + 1) % 3], edge = corner[(k + 2) % 3] - from;
    inner.gradient[k] = glm::cross(normal, edge) / twice_area;
    inner.offset[k] = glm::dot(inner.gradient[k], from);
  }
  return inner;
}

// On the face, up to rim_um beyond its edges; the point lies in its plane.
[[gnu::always_inline]] inline bool Walls::inside(const Inner &face, const glm::dvec3 &point) {
  // A coordinate is the way to the edge over the height, which is 1 / |gradient|.
  const auto beyond = [](double coordinate, const glm::dvec3 &gradient) {
    const double square = rim_um * rim_um * glm::dot(gradient, gradient);
    return static_cast<unsigned>(coordinate < 0.0) & static_cast<unsigned>(coordinate * coordinate > square);
  };
  const double first = glm::dot(face.gradient[0], point) - face.offset[0],
               second = glm::dot(face.gradient[1], point) - face.offset[1];
  return (beyond(first, face.gradient[0]) | beyond(second, face.gradient[1]) |
          beyond(1.0 - first - second, face.gradient[0] + face.gradient[1])) == 0;
}

// Candidates are found, and those whose plane is crossed kept, without a branch on either: such branches
// cannot be foreseen, and a wrong guess costs more than the sums.
Contact Walls::first_contact(const Spot &spot, const glm::dvec3 &place, const glm::dvec3 &move) const {
  Contact contact;
  if (!spot.known) return contact;
  const ByteMove ends(bytes_, spot.from_centre, spot.from_centre + move);
  double crossing = 1.0;
  const EightBoxes *const last = list_.data() + voxel_[spot.voxel + 1].begin;
  for (const EightBoxes *eight = list_.data() + voxel_[spot.voxel].begin; eight < last; eight += 8) {
    std::uint64_t met = 0;
    const std::size_t many = std::min<std::size_t>(8, static_cast<std::size_t>(last - eight));
    for (std::size_t i = 0; i < many; i++)
      met |= std::uint64_t{eight[i].met(ends)} << (8 * i);
    struct {
      double over, towards;
      std::uint32_t face;
    } crossed[64];
    std::size_t count = 0;
    for (; met != 0; met &= met - 1) {
      const int bit = __builtin_ctzll(met);
      const std::uint32_t f = eight[bit >> 3].face[bit & 7];
      const Plane &plane = plane_[f];
      __builtin_prefetch(&inner_[f]); // should the plane be crossed
      const double height = glm::dot(plane.normal, place) - plane.offset,
                   speed = glm::dot(plane.normal, move), over = std::fabs(height), towards = std::fabs(speed);
      crossed[count] = {over, towards, f};
      count += static_cast<std::size_t>((height * speed < 0.0) & (over <= towards + clearance_um));
    }
    for (std::size_t i = 0; i < count; i++) {
      const auto [over, towards, f] = crossed[i];
      const double at = over / towards;
      // Of faces met at the same point the first in the list, which is in ascending order.
      if (contact.face != Contact::none && at >= crossing) continue;
      if (!inside(inner_[f], place + at * move)) continue;
      crossing = at;
      contact.face = f;
      contact.at = std::max(0.0, (over - clearance_um) / towards);
    }
  }
  if (contact.face != Contact::none) contact.normal = plane_[contact.face].normal;
  return contact;
}

std::uint8_t Walls::nearest_code(const glm::dvec3 &place) const {
  glm::ivec3 middle;
  for (int axis = 0; axis < 3; axis++)
    middle[axis] = index_on(axis, place[axis]);
  const double narrowest = std::min({edge_.x, edge_.y, edge_.z});
  double nearest = std::numeric_limits<double>::infinity();
  std::uint32_t best = Contact::none;
  std::uint8_t code = 0;
  for (int ring = 0; ring < std::max({count_.x, count_.y, count_.z}); ring++) {
    const double inner = (ring - 1) * narrowest; // no face that first appears in this ring is nearer
    if (inner > 0.0 && inner * inner > nearest) break;
    const glm::ivec3 from = glm::max(middle - ring, glm::ivec3(0)), to = glm::min(middle + ring, count_ - 1);
    for (int z = from.z; z <= to.z; z++)
      for (int y = from.y; y <= to.y; y++)
        for (int x = from.x; x <= to.x; x++) {
          if (std::max({std::abs(x - middle.x), std::abs(y - middle.y), std::abs(z - middle.z)}) != ring)
            continue;
          const std::size_t v = voxel_index(x, y, z);
          for (std::size_t i = 8 * std::size_t{voxel_[v].begin}; i < 8 * std::size_t{voxel_[v + 1].begin};
               i++) {
            const std::uint32_t f = list_[i / 8].face[i % 8];
            if (f == Contact::none) break;
            const std::array<glm::dvec3, 3> p = corners(faces_[f]);
            const double squared = squared_distance(place, p[0], p[1], p[2]);
            if (squared > nearest || (squared == nearest && f >= best)) continue;
            nearest = squared, best = f, code = code_[faces_[f].source];
          }
        }
  }
  return code;
}

std::uint64_t Walls::bytes() const {
  return vertex_.size() * sizeof vertex_[0] + faces_.size() * (sizeof(Face) + sizeof(Plane) + sizeof(Inner)) +
         list_.size() * sizeof list_[0] + voxel_.size() * sizeof voxel_[0] +
         2 * room_[0].size() * sizeof(Room) + free_.size();
}

} // namespace conceg::simulate
