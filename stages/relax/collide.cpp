// SPDX-License-Identifier: BSD-3-Clause
#include "collide.hpp"

#include "handover.hpp"
#include "sort.hpp"

#include <embree3/rtcore.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <tuple>

namespace conceg::relax {

namespace {

constexpr double most_images = 1e4; // of one chunk around the box; more mean a broken coordinate or radius

struct Bounds {
  glm::dvec3 lo, hi;
};

bool overlap(const Bounds &x, const Bounds &y) {
  return x.lo.x <= y.hi.x && y.lo.x <= x.hi.x && x.lo.y <= y.hi.y && y.lo.y <= x.hi.y && x.lo.z <= y.hi.z &&
         y.lo.z <= x.hi.z;
}

// A chunk in the box (its middle lies there), or a ghost of it lifted by `lift` more sides.
struct Placed {
  std::uint32_t chunk;
  std::int32_t lift[3];
  Bounds bounds;
};

struct Candidate {
  std::uint32_t first, second; // indices of placed chunks
};

bool operator<(const Candidate &x, const Candidate &y) {
  return std::tie(x.first, x.second) < std::tie(y.first, y.second);
}
bool operator==(const Candidate &x, const Candidate &y) {
  return x.first == y.first && x.second == y.second;
}

bool positive(const std::int32_t lift[3]) {
  for (int a = 0; a < 3; a++)
    if (lift[a]) return lift[a] > 0;
  return false;
}

bool pair_before(const Pair &x, const Pair &y) {
  return std::tie(x.e, x.f, x.lift[0], x.lift[1], x.lift[2]) <
         std::tie(y.e, y.f, y.lift[0], y.lift[1], y.lift[2]);
}

Bounds bounds_of(const Bodies &bodies, const std::vector<double> &radius, const Chunk &chunk, double margin) {
  Bounds out = {glm::dvec3(std::numeric_limits<double>::max()),
                glm::dvec3(std::numeric_limits<double>::lowest())};
  for (std::uint32_t e = chunk.first; e < chunk.first + chunk.count; e++) {
    const RoundCone cone = cone_of(bodies, e, radius);
    const double thick = std::max(cone.radius_a, cone.radius_b);
    out.lo = glm::min(out.lo, glm::min(cone.a, cone.b) - thick);
    out.hi = glm::max(out.hi, glm::max(cone.a, cone.b) + thick);
  }
  out.lo -= margin, out.hi += margin;
  return out;
}

std::vector<Placed> place_chunks(const Bodies &bodies, const std::vector<double> &radius,
                                 const conceg_box &box, double margin, Workers &workers) {
  std::vector<Placed> placed(bodies.chunks.size());
  const glm::dvec3 sides = side(box);
  workers.loop(placed.size(), 256, [&](std::size_t i, unsigned) {
    Placed &out = placed[i];
    out.chunk = static_cast<std::uint32_t>(i);
    out.bounds = bounds_of(bodies, radius, bodies.chunks[i], margin);
    const glm::ivec3 number = lift(box, 0.5 * (out.bounds.lo + out.bounds.hi));
    for (int a = 0; a < 3; a++)
      out.lift[a] = -number[a];
    out.bounds.lo -= sides * glm::dvec3(number), out.bounds.hi -= sides * glm::dvec3(number);
  });
  return placed;
}

// Images of chunks that can meet a chunk in the box.
std::vector<Placed> place_ghosts(const std::vector<Placed> &core, const conceg_box &box) {
  Bounds all = {glm::dvec3(std::numeric_limits<double>::max()),
                glm::dvec3(std::numeric_limits<double>::lowest())};
  for (const Placed &p : core)
    all.lo = glm::min(all.lo, p.bounds.lo), all.hi = glm::max(all.hi, p.bounds.hi);
  const glm::dvec3 sides = side(box);
  std::vector<Placed> ghosts;
  for (const Placed &p : core) {
    double first[3] = {0, 0, 0}, last[3] = {0, 0, 0}, count = 1;
    for (int a = 0; a < 3; a++) {
      if (!box.periodic[a]) continue;
      first[a] = std::ceil((all.lo[a] - p.bounds.hi[a]) / sides[a]);
      last[a] = std::floor((all.hi[a] - p.bounds.lo[a]) / sides[a]);
      count *= last[a] - first[a] + 1;
    }
    if (!(count <= most_images))
      fail(
          CONCEG_E_RANGE,
          "/skeleton: a piece of a cell meets %g images of another one: expected segments and somas of about "
          "the size of the box, or smaller",
          count);
    for (int x = static_cast<int>(first[0]); x <= static_cast<int>(last[0]); x++)
      for (int y = static_cast<int>(first[1]); y <= static_cast<int>(last[1]); y++)
        for (int z = static_cast<int>(first[2]); z <= static_cast<int>(last[2]); z++) {
          if (x == 0 && y == 0 && z == 0) continue;
          const glm::dvec3 shift = sides * glm::dvec3(x, y, z);
          Placed ghost = {p.chunk,
                          {p.lift[0] + x, p.lift[1] + y, p.lift[2] + z},
                          {p.bounds.lo + shift, p.bounds.hi + shift}};
          ghosts.push_back(ghost);
        }
  }
  return ghosts;
}

// What Embree sees: bounds in single precision, rounded outward, from the corner of the box.
struct Primitives {
  const std::vector<Placed> *placed;
  glm::dvec3 origin;
  mutable Handover threads = {};
};

float round_down(double x) {
  return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}
float round_up(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

void give_bounds(const RTCBoundsFunctionArguments *arguments) {
  const auto *primitives = static_cast<const Primitives *>(arguments->geometryUserPtr);
  primitives->threads.take();
  const Bounds &bounds = (*primitives->placed)[arguments->primID].bounds;
  const glm::dvec3 lo = bounds.lo - primitives->origin, hi = bounds.hi - primitives->origin;
  RTCBounds &out = *arguments->bounds_o;
  out.lower_x = round_down(lo.x), out.lower_y = round_down(lo.y), out.lower_z = round_down(lo.z);
  out.upper_x = round_up(hi.x), out.upper_y = round_up(hi.y), out.upper_z = round_up(hi.z);
  primitives->threads.give();
}

void check_device(RTCDevice device, const char *what) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE)
    fail(CONCEG_E_STAGE, "Embree: %s failed with error %d", what, static_cast<int>(error));
}

class Scene {
public:
  Scene(RTCDevice device, const Primitives &primitives) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    check_device(device, "rtcNewGeometry");
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(primitives.placed->size()));
    rtcSetGeometryUserData(geometry, const_cast<Primitives *>(&primitives));
    rtcSetGeometryBoundsFunction(geometry, give_bounds, nullptr);
    rtcCommitGeometry(geometry);
    scene_ = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    primitives.threads.give();
    rtcCommitScene(scene_);
    primitives.threads.take();
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    rtcReleaseScene(scene_);
    fail(CONCEG_E_STAGE, "Embree: building the collision tree failed with error %d", static_cast<int>(error));
  }
  ~Scene() { rtcReleaseScene(scene_); }
  Scene(const Scene &) = delete;
  Scene &operator=(const Scene &) = delete;
  RTCScene get() const { return scene_; }

private:
  RTCScene scene_ = nullptr;
};

struct Buffers {
  tbb::enumerable_thread_specific<std::vector<Candidate>> lists;
  Handover threads;
};

// Called from Embree's threads in no fixed order; candidates are sorted afterwards.
void keep_candidates(void *user, RTCCollision *collisions, unsigned count) {
  Buffers &buffers = *static_cast<Buffers *>(user);
  buffers.threads.take();
  std::vector<Candidate> &mine = buffers.lists.local();
  for (unsigned i = 0; i < count; i++)
    mine.push_back({collisions[i].primID0, collisions[i].primID1});
  buffers.threads.give();
}

// Candidates of two scenes, sorted, each unordered pair of placed chunks once.
template <class Keep>
std::vector<Candidate> collide_scenes(RTCDevice device, const Scene &first, const Scene &second,
                                      tbb::task_arena &arena, Workers &workers, Keep keep) {
  Buffers buffers;
  buffers.threads.give();
  arena.execute([&] { rtcCollide(first.get(), second.get(), keep_candidates, &buffers); });
  buffers.threads.take();
  check_device(device, "rtcCollide");
  std::vector<Candidate> all;
  for (const std::vector<Candidate> &buffer : buffers.lists)
    std::copy_if(buffer.begin(), buffer.end(), std::back_inserter(all), keep);
  sort(all, std::less<>(), workers);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// Puts e before f, or the lift of an own image upwards.
Pair canonical(std::uint32_t e, std::uint32_t f, const std::int32_t up[3]) {
  if (e < f || (e == f && positive(up))) return {e, f, {up[0], up[1], up[2]}};
  return {f, e, {-up[0], -up[1], -up[2]}};
}

// A ball around each element, to leave most pairs of two chunks out cheaply.
struct Ball {
  glm::dvec3 center;
  double radius;
};

std::vector<Ball> balls_of(const Bodies &bodies, const std::vector<double> &radius, Workers &workers) {
  std::vector<Ball> balls(bodies.elements.size());
  workers.loop(balls.size(), 2048, [&](std::size_t e, unsigned) {
    const RoundCone cone = cone_of(bodies, static_cast<std::uint32_t>(e), radius);
    balls[e] = {0.5 * (cone.a + cone.b),
                0.5 * glm::distance(cone.a, cone.b) + std::max(cone.radius_a, cone.radius_b) + 1e-6};
  });
  return balls;
}

bool is_close(const Bodies &bodies, const std::vector<double> &radius, const glm::dvec3 &sides,
              const Pair &pair, double reach) {
  RoundCone first, second;
  cones_of(bodies, pair, radius, sides, first, second);
  const double thick = std::max(first.radius_a, first.radius_b) + std::max(second.radius_a, second.radius_b);
  first.radius_a = first.radius_b = second.radius_a = second.radius_b = 0;
  if (closest_axes(first, second).gap - thick >= reach) return false;
  const bool one_body = same_copy(pair) && bodies.elements[pair.e].cell == bodies.elements[pair.f].cell;
  return !one_body || !near_in_tree(bodies, pair.e, pair.f);
}

// The pairs of elements of two chunks, the second lifted by `up`.
void narrow(const Bodies &bodies, const std::vector<double> &radius, const std::vector<Ball> &balls,
            const glm::dvec3 &sides, double reach, const Chunk &first, const Chunk &second,
            const std::int32_t up[3], std::vector<Pair> &out) {
  const bool lifted = up[0] || up[1] || up[2];
  const glm::dvec3 shift = sides * glm::dvec3(up[0], up[1], up[2]);
  for (std::uint32_t e = first.first; e < first.first + first.count; e++)
    for (std::uint32_t f = second.first; f < second.first + second.count; f++) {
      if (!lifted && e >= f) continue; // within one chunk
      const glm::dvec3 apart = balls[f].center + shift - balls[e].center;
      const double most = std::max(0.0, balls[e].radius + balls[f].radius + reach);
      if (glm::dot(apart, apart) >= most * most) continue;
      const Pair pair = canonical(e, f, up);
      if (is_close(bodies, radius, sides, pair, reach)) out.push_back(pair);
    }
}

std::vector<ChunkPair> chunk_pairs_of(const std::vector<Placed> &core, const std::vector<Placed> &ghosts,
                                      const std::vector<Candidate> &inside,
                                      const std::vector<Candidate> &across) {
  std::vector<ChunkPair> out;
  out.reserve(inside.size() + across.size() + core.size());
  const auto add = [&](const Placed &first, const Placed &second) {
    ChunkPair pair = {first.chunk, second.chunk, {0, 0, 0}};
    for (int a = 0; a < 3; a++)
      pair.up[a] = second.lift[a] - first.lift[a];
    if (pair.i != pair.j || positive(pair.up)) out.push_back(pair);
  };
  for (const Candidate &c : inside)
    add(core[c.first], core[c.second]);
  for (const Candidate &c : across)
    add(core[c.first], ghosts[c.second]);
  for (std::uint32_t i = 0; i < core.size(); i++)
    out.push_back({i, i, {0, 0, 0}});
  return out;
}

// For each chunk the chunk that holds its first element's parent, or none (= number of chunks).
std::vector<std::uint32_t> parent_chunks(const Bodies &bodies) {
  std::vector<std::uint32_t> holder(bodies.elements.size()), out(bodies.chunks.size());
  for (std::uint32_t c = 0; c < bodies.chunks.size(); c++)
    for (std::uint32_t e = 0; e < bodies.chunks[c].count; e++)
      holder[bodies.chunks[c].first + e] = c;
  for (std::uint32_t c = 0; c < bodies.chunks.size(); c++) {
    const std::uint32_t first = bodies.chunks[c].first;
    const bool has_parent = first < bodies.points && bodies.parent[first] >= 0;
    out[c] = has_parent ? holder[static_cast<std::size_t>(bodies.parent[first])]
                        : static_cast<std::uint32_t>(bodies.chunks.size());
  }
  return out;
}

// Chunks that share a point must have been found; this shows at every run that the search works, faces
// included.
void check_joined(const Bodies &bodies, ChunkSearch &search) {
  const std::vector<std::uint32_t> parent = parent_chunks(bodies);
  std::uint64_t found = 0;
  for (const std::uint32_t p : parent)
    search.joined += p < bodies.chunks.size();
  for (const ChunkPair &p : search.pairs)
    found += p.i < p.j && !p.up[0] && !p.up[1] && !p.up[2] && parent[p.j] == p.i;
  if (found != search.joined)
    fail(CONCEG_E_STAGE,
         "collision search: expected %llu pairs of joined chunks among the candidates, got %llu",
         static_cast<unsigned long long>(search.joined), static_cast<unsigned long long>(found));
}

} // namespace

struct Collider::Device {
  RTCDevice handle = nullptr;
  tbb::task_arena arena;
  explicit Device(unsigned threads) : arena(static_cast<int>(threads)) {}
};

Collider::Collider(unsigned threads) : device_(std::make_unique<Device>(threads)) {
  device_->handle = rtcNewDevice(nullptr);
  if (!device_->handle)
    fail(CONCEG_E_STAGE, "Embree: rtcNewDevice failed with error %d",
         static_cast<int>(rtcGetDeviceError(nullptr)));
}

Collider::~Collider() {
  if (device_->handle) rtcReleaseDevice(device_->handle);
}

ChunkSearch Collider::find_chunks(const Bodies &bodies, const std::vector<double> &radius,
                                  const conceg_box &box, double reach, Workers &workers) {
  ChunkSearch search;
  if (bodies.chunks.empty()) return search;
  // Half of the reach on each side, and a little more than the rounding of lifted coordinates.
  const std::vector<Placed> core =
      place_chunks(bodies, radius, box, std::max(0.0, 0.5 * reach) + 1e-6, workers);
  const std::vector<Placed> ghosts = place_ghosts(core, box);
  const glm::dvec3 origin(box.lo[0], box.lo[1], box.lo[2]);
  const Primitives core_primitives = {&core, origin}, ghost_primitives = {&ghosts, origin};
  RTCDevice device = device_->handle;

  std::vector<Candidate> inside, across;
  {
    const Scene core_scene(device, core_primitives);
    // Embree reports each pair of one scene twice.
    inside = collide_scenes(device, core_scene, core_scene, device_->arena, workers, [&](const Candidate &c) {
      return c.first < c.second && overlap(core[c.first].bounds, core[c.second].bounds);
    });
    if (!ghosts.empty()) {
      const Scene ghost_scene(device, ghost_primitives);
      // (i, image of j) is also found as (j, image of i).
      across =
          collide_scenes(device, core_scene, ghost_scene, device_->arena, workers, [&](const Candidate &c) {
            return c.first <= ghosts[c.second].chunk &&
                   overlap(core[c.first].bounds, ghosts[c.second].bounds);
          });
    }
  }
  search.candidates = inside.size() + across.size();
  search.pairs = chunk_pairs_of(core, ghosts, inside, across);
  for (const Placed &p : core)
    search.lift.push_back({p.lift[0], p.lift[1], p.lift[2]});
  check_joined(bodies, search);
  return search;
}

Search Collider::find(const Bodies &bodies, const std::vector<double> &radius, const conceg_box &box,
                      double reach, Workers &workers) {
  Search search;
  const ChunkSearch chunks = find_chunks(bodies, radius, box, reach, workers);
  const std::vector<ChunkPair> &jobs = chunks.pairs;
  search.chunk_pairs = chunks.candidates;
  // A block of jobs fills one list, so that the result does not depend on who did it.
  const std::size_t block = 256, blocks = (jobs.size() + block - 1) / block;
  const glm::dvec3 sides = side(box);
  const std::vector<Ball> balls = balls_of(bodies, radius, workers);
  std::vector<std::vector<Pair>> found(blocks);
  workers.loop(blocks, 1, [&](std::size_t b, unsigned) {
    for (std::size_t k = b * block; k < std::min(jobs.size(), (b + 1) * block); k++)
      narrow(bodies, radius, balls, sides, reach, bodies.chunks[jobs[k].i], bodies.chunks[jobs[k].j],
             jobs[k].up, found[b]);
  });
  for (const ChunkPair &job : jobs) {
    const std::uint64_t first = bodies.chunks[job.i].count, second = bodies.chunks[job.j].count;
    search.visited += job.i == job.j && !positive(job.up) ? first * (first - 1) / 2 : first * second;
  }
  for (const std::vector<Pair> &list : found)
    search.pairs.insert(search.pairs.end(), list.begin(), list.end());
  sort(search.pairs, pair_before, workers);
  return search;
}

} // namespace conceg::relax
