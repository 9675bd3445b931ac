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
constexpr double finest_voxel_um = 0.25; // finer ones hold fewer faces each, but more in all
constexpr std::size_t chunk = 16384;

typedef float Four __attribute__((vector_size(16)));
typedef std::int32_t Mask __attribute__((vector_size(16)));
#if defined(__clang__)
#define LANES(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define LANES(a, b, i, j, k, l) __builtin_shuffle(a, b, Mask{i, j, k, l})
#endif
// Rows of four floats, turned to columns.
inline void columns(const float *p, const float *q, const float *r, const float *s, Four &x, Four &y, Four &z,
                    Four &w) {
  Four a, b, c, d;
  __builtin_memcpy(&a, p, 16), __builtin_memcpy(&b, q, 16), __builtin_memcpy(&c, r, 16),
      __builtin_memcpy(&d, s, 16);
  const Four ab_low = LANES(a, b, 0, 4, 1, 5), ab_high = LANES(a, b, 2, 6, 3, 7);
  const Four cd_low = LANES(c, d, 0, 4, 1, 5), cd_high = LANES(c, d, 2, 6, 3, 7);
  x = LANES(ab_low, cd_low, 0, 1, 4, 5), y = LANES(ab_low, cd_low, 2, 3, 6, 7);
  z = LANES(ab_high, cd_high, 0, 1, 4, 5), w = LANES(ab_high, cd_high, 2, 3, 6, 7);
}
inline bool any(const Mask &mask) {
  std::uint64_t halves[2];
  __builtin_memcpy(halves, &mask, sizeof halves);
  return (halves[0] | halves[1]) != 0;
}

} // namespace

Walls::Walls(const conceg_box &box, const Membranes &membranes, double reach_um, Workers &workers,
             const Progress &progress)
    : box_(box), side_(side(box)), reach_(reach_um) {
  any_open_ = !(box.periodic[0] && box.periodic[1] && box.periodic[2]);
  vertex_ = membranes.vertex, code_ = membranes.code;
  choose_grid(membranes.face.size());
  list_images(membranes);
  sort_images();
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
    const glm::dvec3 product = glm::cross(b - a, c - a);
    const double twice_area = glm::length(product);
    if (!(twice_area > 0.0)) continue; // no area: its neighbours share its edges
    const glm::dvec3 normal = product / twice_area;
    for_each_lift(box_, glm::min(a, glm::min(b, c)) - rim, glm::max(a, glm::max(b, c)) + rim,
                  [&](const glm::ivec3 &at) {
                    const auto [found, added] =
                        known.insert({{at.x, at.y, at.z}, static_cast<std::uint32_t>(lift_.size())});
                    if (added) lift_.push_back(glm::dvec3(at) * side_);
                    Face face{normal, 0.0, corner, f, found->second};
                    face.offset = glm::dot(normal, corners(face)[0]);
                    faces_.push_back(face);
                  });
  }
  if (faces_.size() >= Contact::none)
    fail(CONCEG_E_UNSUPPORTED, "walls: expected fewer than 2^32 faces in the box, got %zu", faces_.size());
}

// Bits of the fine voxels, of the voxel around `middle`, that a face between `low` and `high` (widened by at
// least the reach) may cross.
unsigned Walls::touched_parts(const Face &face, const glm::dvec3 &middle, const glm::dvec3 &low,
                              const glm::dvec3 &high) const {
  if (fine_factor_ == 1) return 1u;
  const glm::dvec3 quarter = 0.25 * edge_, narrowed = glm::dvec3(reach_) - quarter;
  const double across = 1.001 * glm::dot(glm::abs(face.normal), quarter);
  unsigned touched = 0;
  for (unsigned part = 0; part < 8; part++) {
    const glm::dvec3 at = middle + quarter * glm::dvec3((part & 1u) ? 1.0 : -1.0, (part & 2u) ? 1.0 : -1.0,
                                                        (part & 4u) ? 1.0 : -1.0);
    const bool within = glm::all(glm::greaterThanEqual(at, low + narrowed)) &&
                        glm::all(glm::lessThanEqual(at, high - narrowed));
    if (within && std::fabs(glm::dot(face.normal, at) - face.offset) <= across) touched |= 1u << part;
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
    const Face &face = faces_[f];
    const std::array<glm::dvec3, 3> p = corners(face);
    const glm::dvec3 low = glm::min(p[0], glm::min(p[1], p[2])) - rim,
                     high = glm::max(p[0], glm::max(p[1], p[2])) + rim;
    const double plane = 0.5 * glm::dot(glm::abs(face.normal), edge_) + reach_ + 2.0 * clearance_um;
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
          if (std::fabs(glm::dot(face.normal, middle) - face.offset) > plane) continue;
          const double squared = squared_distance(middle, p[0], p[1], p[2]);
          if (squared > around * around) continue;
          const unsigned touched =
              squared <= half_diagonal * half_diagonal ? touched_parts(face, middle, low, high) : 0u;
          found.push_back({static_cast<std::uint32_t>(voxel_index(x, y, z)), static_cast<std::uint32_t>(f),
                           static_cast<std::uint8_t>(touched)});
        }
  }
  return found;
}

// What is near in space comes to be near in memory: by the interleaved bits of its place. Then the float
// copies.
void Walls::sort_images() {
  const auto spread_bits = [](std::uint64_t x) {
    std::uint64_t out = 0;
    for (int bit = 0; bit < 21; bit++)
      out |= (x >> bit & 1) << (3 * bit);
    return out;
  };
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(faces_.size());
  for (std::size_t f = 0; f < faces_.size(); f++) {
    const glm::dvec3 p = corners(faces_[f])[0];
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; axis++)
      key |= spread_bits(static_cast<std::uint64_t>(index_on(axis, p[axis]))) << axis;
    order[f] = {key, static_cast<std::uint32_t>(f)};
  }
  std::sort(order.begin(), order.end());
  HugeVector<Face> sorted(faces_.size());
  for (std::size_t f = 0; f < order.size(); f++)
    sorted[f] = faces_[order[f].second];
  faces_.swap(sorted);

  double largest = reach_;
  for (int axis = 0; axis < 3; axis++)
    largest = std::max({largest, std::fabs(low_[axis]), std::fabs(low_[axis] + count_[axis] * edge_[axis])});
  margin_um_ = static_cast<float>(16.0 * largest * 0x1p-23);
  disc_.assign(faces_.size() + 1, Disc());
  for (std::size_t f = 0; f < faces_.size(); f++) {
    const Face &face = faces_[f];
    const std::array<glm::dvec3, 3> p = corners(face);
    const glm::dvec3 middle = (p[0] + p[1] + p[2]) / 3.0;
    const double radius =
        std::max({glm::length(p[0] - middle), glm::length(p[1] - middle), glm::length(p[2] - middle)});
    Disc &d = disc_[f];
    for (int axis = 0; axis < 3; axis++)
      d.normal[axis] = static_cast<float>(face.normal[axis]),
      d.centre[axis] = static_cast<float>(middle[axis]);
    d.offset = static_cast<float>(face.offset),
    d.radius = static_cast<float>(radius + 2.0 * clearance_um) + margin_um_;
  }
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
  for (const std::vector<Entry> &part : found)
    for (const Entry &e : part) {
      many[e.voxel]++;
      if (!e.touched) continue;
      const glm::ivec3 at = voxel_place(e.voxel);
      for (std::size_t bit = 0; bit < 8; bit++)
        if (e.touched >> bit & 1) touched[fine_row(at, bit)] = 1;
    }
  voxel_.resize(voxels + 1);
  std::uint64_t total = 0;
  std::uint32_t rooms = 0;
  for (std::size_t v = 0; v < voxels; v++) {
    voxel_[v].begin = static_cast<std::uint32_t>(total), voxel_[v].room = rooms;
    total += (many[v] + 3) / 4, rooms += many[v] > 0;
  }
  if (total >= Contact::none)
    fail(CONCEG_E_UNSUPPORTED, "walls: expected fewer than 2^34 faces in all voxels together, got %llu",
         static_cast<unsigned long long>(4 * total));
  voxel_[voxels].begin = static_cast<std::uint32_t>(total);
  for (HugeVector<Room> &side : room_)
    side.resize(rooms);
  list_.assign(4 * total, static_cast<std::uint32_t>(faces_.size()));
  std::fill(many.begin(), many.end(), 0u);
  for (std::vector<Entry> &part : found) {
    for (const Entry &e : part)
      list_[4 * std::size_t{voxel_[e.voxel].begin} + many[e.voxel]++] = e.face;
    std::vector<Entry>().swap(part);
  }
  report(progress, "sorting faces into voxels", 1, 3);
  measure_distance(touched, workers);
  report(progress, "sorting faces into voxels", 2, 3);
  fill_rooms(workers);
  report(progress, "sorting faces into voxels", 3, 3);
}

void Walls::fill_rooms(Workers &workers) {
  const double half_diagonal = 0.5 * glm::length(edge_);
  constexpr std::size_t batch = 1024;
  workers.loop((voxels() + batch - 1) / batch, 1, [&](std::size_t b, unsigned) {
    RoomBuilder builder(room_unit_um_, half_diagonal);
    for (std::size_t v = b * batch; v < std::min(voxels(), (b + 1) * batch); v++) {
      if (voxel_[v].begin == voxel_[v + 1].begin) continue;
      const glm::dvec3 middle = voxel_centre(voxel_place(v));
      builder.clear();
      for (std::size_t i = 4 * std::size_t{voxel_[v].begin}; i < 4 * std::size_t{voxel_[v + 1].begin}; i++) {
        if (list_[i] == faces_.size()) continue;
        const Face &face = faces_[list_[i]];
        const std::array<glm::dvec3, 3> p = corners(face);
        builder.add({p[0] - middle, p[1] - middle, p[2] - middle}, face.normal);
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

// On the face, up to rim_um beyond its edges; the point lies in its plane.
bool Walls::inside(const Face &face, const glm::dvec3 &point) const {
  const std::array<glm::dvec3, 3> p = corners(face);
  for (std::size_t k = 0; k < 3; k++) {
    const glm::dvec3 edge = p[(k + 1) % 3] - p[k];
    const double height = glm::dot(glm::cross(edge, point - p[k]), face.normal);
    if (height < 0.0 && height * height > rim_um * rim_um * glm::dot(edge, edge)) return false;
  }
  return true;
}

Contact Walls::first_contact(const Spot &spot, const glm::dvec3 &place, const glm::dvec3 &move) const {
  Contact contact;
  if (!spot.known) return contact;
  const auto spread = [](double x) {
    const float f = static_cast<float>(x);
    return Four{f, f, f, f};
  };
  const Four px = spread(place.x), py = spread(place.y), pz = spread(place.z);
  const Four mx = spread(move.x), my = spread(move.y), mz = spread(move.z);
  const Four hx = spread(place.x + 0.5 * move.x), hy = spread(place.y + 0.5 * move.y),
             hz = spread(place.z + 0.5 * move.z);
  const Four half = spread(0.5 * glm::length(move) + 2.0 * static_cast<double>(margin_um_));
  const Four margin = spread(static_cast<double>(margin_um_)), minus_margin = -margin;
  // Whether a move that is not along the plane crosses it outside the ball. A height is off by at most the
  // margin, so that the point is off by margin / |along| of the move: less than the slack.
  const glm::vec3 from(place), way(move);
  const float least = 100.0f * margin_um_, slack = 0.02f * glm::length(way) + 2.0f * margin_um_;
  const auto misses = [&](const Disc &d, float before, float along) {
    if (std::fabs(along) < least) return false;
    const glm::vec3 off = from - (before / along) * way - glm::vec3(d.centre[0], d.centre[1], d.centre[2]);
    return glm::dot(off, off) > (d.radius + slack) * (d.radius + slack);
  };
  double crossing = 1.0;
  const std::uint32_t *const end = list_.data() + 4 * std::size_t{voxel_[spot.voxel + 1].begin};
  for (const std::uint32_t *four = list_.data() + 4 * std::size_t{voxel_[spot.voxel].begin}; four != end;
       four += 4) {
    Four x, y, z, w;
    // Balls around the faces that the ball around the move meets.
    columns(disc_[four[0]].centre, disc_[four[1]].centre, disc_[four[2]].centre, disc_[four[3]].centre, x, y,
            z, w);
    x -= hx, y -= hy, z -= hz, w += half;
    const Mask near = x * x + y * y + z * z <= w * w;
    // Planes that the move crosses, or touches within the margin: not both ends above or both below.
    columns(disc_[four[0]].normal, disc_[four[1]].normal, disc_[four[2]].normal, disc_[four[3]].normal, x, y,
            z, w);
    const Four before = x * px + y * py + z * pz - w, along = x * mx + y * my + z * mz,
               after = before + along;
    const Mask met =
        near & ~(((before > margin) & (after > margin)) | ((before < minus_margin) & (after < minus_margin)));
    if (!any(met)) continue;
    for (int lane = 0; lane < 4; lane++) {
      if (!met[lane] || misses(disc_[four[lane]], before[lane], along[lane])) continue;
      const Face &face = faces_[four[lane]];
      const double height = glm::dot(face.normal, place) - face.offset, speed = glm::dot(face.normal, move);
      if (height * speed >= 0.0) continue; // it moves away
      const double over = std::fabs(height), towards = std::fabs(speed);
      if (over > crossing * towards + (contact.face == Contact::none ? clearance_um : 0.0)) continue;
      const double at = over / towards;
      // Of faces met at the same point the first in the list, which is in ascending order.
      if (contact.face != Contact::none && at >= crossing) continue;
      if (!inside(face, place + at * move)) continue;
      crossing = at;
      contact.face = four[lane];
      contact.at = std::max(0.0, (over - clearance_um) / towards);
      contact.normal = face.normal;
    }
  }
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
          for (std::size_t i = 4 * std::size_t{voxel_[v].begin}; i < 4 * std::size_t{voxel_[v + 1].begin};
               i++) {
            const std::uint32_t f = list_[i];
            if (f == faces_.size()) continue;
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
  return vertex_.size() * sizeof vertex_[0] + faces_.size() * sizeof faces_[0] +
         disc_.size() * sizeof disc_[0] + list_.size() * sizeof list_[0] + voxel_.size() * sizeof voxel_[0] +
         2 * room_[0].size() * sizeof(Room) + free_.size();
}

} // namespace conceg::simulate
