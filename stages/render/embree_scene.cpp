// SPDX-License-Identifier: BSD-3-Clause
#include "embree_scene.hpp"
#include "raycast.hpp"

#include <embree3/rtcore.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstring>
#include <thread>

namespace conceg::rendering {
namespace {

// Geometry ids: three in a row for each body.
constexpr unsigned kinds = 3, surface_kind = 0, cone_kind = 1, sphere_kind = 2;
constexpr double edge_radius = 0.0008; // of the scene's diagonal

RTCRay float_ray(const glm::dvec3 &start, const glm::dvec3 &direction, double from, double to) {
  RTCRay ray;
  ray.org_x = static_cast<float>(start.x), ray.org_y = static_cast<float>(start.y),
  ray.org_z = static_cast<float>(start.z);
  ray.dir_x = static_cast<float>(direction.x), ray.dir_y = static_cast<float>(direction.y),
  ray.dir_z = static_cast<float>(direction.z);
  ray.tnear = static_cast<float>(from), ray.tfar = static_cast<float>(to);
  ray.time = 0.0f, ray.mask = ~0u, ray.id = 0, ray.flags = 0;
  return ray;
}

RTCRayHit first_hit(RTCScene scene, const RTCRay &ray) {
  RTCRayHit both;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  both.ray = ray;
  std::memset(&both.hit, 0, sizeof both.hit);
  both.hit.geomID = RTC_INVALID_GEOMETRY_ID, both.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene, &context, &both);
  return both;
}

// Fills a new buffer of a geometry; Embree owns it.
float *float_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t floats,
                    std::size_t count) {
  void *memory = rtcSetNewGeometryBuffer(geometry, type, 0, format, floats * sizeof(float), count);
  if (!memory) throw std::bad_alloc();
  return static_cast<float *>(memory);
}
std::uint32_t *index_buffer(RTCGeometry geometry, RTCFormat format, std::size_t numbers, std::size_t count) {
  void *memory = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, format,
                                         numbers * sizeof(std::uint32_t), count);
  if (!memory) throw std::bad_alloc();
  return static_cast<std::uint32_t *>(memory);
}

void attach(RTCScene scene, RTCGeometry geometry, unsigned id) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

void put_ball(float *&out, const glm::dvec3 &p, double radius) {
  for (int axis = 0; axis < 3; axis++)
    *out++ = static_cast<float>(p[axis]);
  *out++ = static_cast<float>(radius);
}

// Distance from a point of a triangle to its nearest edge: barycentric coordinate times height.
double rim_of(const Body &body, const glm::uvec3 &f, double u, double v) {
  const glm::dvec3 &a = body.vertex[f.x], &b = body.vertex[f.y], &c = body.vertex[f.z];
  const double twice_area = glm::length(glm::cross(b - a, c - a));
  return twice_area *
         std::min({(1 - u - v) / glm::length(c - b), u / glm::length(c - a), v / glm::length(b - a)});
}

} // namespace

RayScene::RayScene(const Scene &scene, unsigned threads)
    : scene_(scene), middle_(0.5 * (scene.lo + scene.hi)) {
  // A number of threads given to Embree limits TBB in the whole process, so it is given only when it is asked
  // for.
  const bool all = threads >= std::thread::hardware_concurrency();
  device_ = rtcNewDevice(all ? nullptr : ("threads=" + std::to_string(threads)).c_str());
  if (!device_)
    fail(CONCEG_E_UNSUPPORTED, "Embree gave no device (error %d)",
         static_cast<int>(rtcGetDeviceError(nullptr)));
  cells_ = rtcNewScene(device_), edges_ = rtcNewScene(device_);
  shapes_.resize(kinds * scene.bodies.size());
  for (std::uint32_t k = 0; k < scene.bodies.size(); k++) {
    if (!scene.bodies[k].face.empty()) add_surface(scene.bodies[k], k);
    if (!scene.bodies[k].cones.empty()) add_cones(scene.bodies[k], k);
  }
  add_edges();
  rtcCommitScene(cells_);
  rtcCommitScene(edges_);
  const RTCError error = rtcGetDeviceError(device_);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE)
    fail(CONCEG_E_INTERNAL, "Embree failed to build the scene (error %d)", static_cast<int>(error));
}

RayScene::~RayScene() {
  if (cells_) rtcReleaseScene(cells_);
  if (edges_) rtcReleaseScene(edges_);
  if (device_) rtcReleaseDevice(device_);
}

void RayScene::add_surface(const Body &body, std::uint32_t number) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  float *vertex = float_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 3, body.vertex.size());
  for (const glm::dvec3 &p : body.vertex)
    for (int axis = 0; axis < 3; axis++)
      *vertex++ = static_cast<float>(p[axis] - middle_[axis]);
  std::uint32_t *index = index_buffer(geometry, RTC_FORMAT_UINT3, 3, body.face.size());
  for (const glm::uvec3 &f : body.face)
    for (int k = 0; k < 3; k++)
      *index++ = f[k];
  attach(cells_, geometry, kinds * number + surface_kind);
}

void RayScene::add_cones(const Body &body, std::uint32_t number) {
  std::vector<const RoundCone *> cones, balls;
  for (const RoundCone &cone : body.cones) {
    (cone.a == cone.b ? balls : cones).push_back(&cone);
    shapes_[kinds * number + (cone.a == cone.b ? sphere_kind : cone_kind)].push_back(cone);
  }
  has_cones_ = true;
  if (!cones.empty()) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
    float *ends = float_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 4, 2 * cones.size());
    std::uint32_t *index = index_buffer(geometry, RTC_FORMAT_UINT, 1, cones.size());
    for (std::uint32_t k = 0; k < cones.size(); k++) {
      index[k] = 2 * k;
      put_ball(ends, cones[k]->a - middle_, cones[k]->ra);
      put_ball(ends, cones[k]->b - middle_, cones[k]->rb);
    }
    attach(cells_, geometry, kinds * number + cone_kind);
  }
  if (balls.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  float *centres = float_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 4, balls.size());
  for (const RoundCone *ball : balls)
    put_ball(centres, ball->a - middle_, ball->ra);
  attach(cells_, geometry, kinds * number + sphere_kind);
}

void RayScene::add_edges() {
  const glm::dvec3 corner[2] = {{scene_.box.lo[0], scene_.box.lo[1], scene_.box.lo[2]},
                                {scene_.box.hi[0], scene_.box.hi[1], scene_.box.hi[2]}};
  const double radius = edge_radius * glm::length(scene_.hi - scene_.lo);
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
  float *ends = float_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 4, 24);
  std::uint32_t *index = index_buffer(geometry, RTC_FORMAT_UINT, 1, 12);
  for (std::uint32_t k = 0; k < 12; k++)
    *index++ = 2 * k;
  for (int axis = 0; axis < 3; axis++)
    for (int k = 0; k < 4; k++)
      for (int end = 0; end < 2; end++) {
        glm::dvec3 p;
        p[axis] = corner[end][axis];
        p[(axis + 1) % 3] = corner[k % 2][(axis + 1) % 3], p[(axis + 2) % 3] = corner[k / 2][(axis + 2) % 3];
        put_ball(ends, p - middle_, radius);
      }
  attach(edges_, geometry, 0);
}

RayHit RayScene::first(const glm::dvec3 &start, const glm::dvec3 &direction, double from, double to) const {
  // The float ray begins where it enters, which keeps its numbers small.
  const RTCRayHit both =
      first_hit(cells_, float_ray(start + from * direction - middle_, direction, 0.0, to - from));
  RayHit hit;
  if (both.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  const std::uint32_t number = both.hit.geomID / kinds;
  const Body &body = scene_.bodies[number];
  const glm::dvec3 plain(both.hit.Ng_x, both.hit.Ng_y, both.hit.Ng_z);
  hit.body = static_cast<std::int32_t>(number);
  hit.distance = from + both.ray.tfar;
  hit.inside = glm::dot(plain, direction) > 0.0;
  hit.normal = plain;
  if (both.hit.geomID % kinds == surface_kind) {
    const glm::uvec3 &f = body.face[both.hit.primID];
    hit.normal = glm::dvec3((1.0f - both.hit.u - both.hit.v) * body.normal[f.x] +
                            both.hit.u * body.normal[f.y] + both.hit.v * body.normal[f.z]);
    if (glm::length(hit.normal) == 0.0) hit.normal = plain;
    if (scene_.wire) hit.rim = rim_of(body, f, both.hit.u, both.hit.v);
  }
  const double length = glm::length(hit.normal);
  hit.normal = length > 0.0 ? hit.normal / length : -direction;
  return hit;
}

namespace {

struct OwnerSearch {
  const std::vector<std::vector<RoundCone>> *shapes;
  glm::dvec3 point;
  std::int32_t owner;
};

bool find_owner(RTCPointQueryFunctionArguments *arguments) {
  auto *search = static_cast<OwnerSearch *>(arguments->userPtr);
  const std::vector<RoundCone> &shapes = (*search->shapes)[arguments->geomID];
  const auto body = static_cast<std::int32_t>(arguments->geomID / kinds);
  // Bodies do not overlap much; where they do, the lowest number wins in any order of the search.
  if (arguments->primID < shapes.size() && cone_distance(shapes[arguments->primID], search->point) < 0.0)
    search->owner = search->owner < 0 ? body : std::min(search->owner, body);
  return false;
}

} // namespace

std::int32_t RayScene::cone_owner(const glm::dvec3 &point) const {
  if (!has_cones_) return -1;
  OwnerSearch search = {&shapes_, point, -1};
  const glm::dvec3 near = point - middle_;
  RTCPointQuery query;
  query.x = static_cast<float>(near.x), query.y = static_cast<float>(near.y),
  query.z = static_cast<float>(near.z);
  query.time = 0.0f, query.radius = 1e-4f;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(cells_, &query, &context, find_owner, &search);
  return search.owner;
}

bool RayScene::blocked(const glm::dvec3 &start, const glm::dvec3 &direction, double to) const {
  RTCRay ray = float_ray(start - middle_, direction, 0.0, to);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(cells_, &context, &ray);
  return ray.tfar < 0.0f;
}

double RayScene::edge_distance(const glm::dvec3 &start, const glm::dvec3 &direction) const {
  // Edges may stick out before the plane that rays start from.
  const double before =
      4.0 * edge_radius * glm::length(scene_.hi - scene_.lo) + glm::length(side(scene_.box));
  const RTCRayHit both =
      first_hit(edges_, float_ray(start - before * direction - middle_, direction, 0.0, 1e9));
  return both.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INFINITY : both.ray.tfar - before;
}

bool clip_to_box(const Scene &scene, const glm::dvec3 &start, const glm::dvec3 &direction, double &from,
                 double &to) {
  if (!scene.clipped) return from <= to;
  for (int axis = 0; axis < 3; axis++) {
    if (!scene.box.periodic[axis]) continue;
    const double a = scene.box.lo[axis] - start[axis], b = scene.box.hi[axis] - start[axis];
    if (direction[axis] == 0.0) {
      if (a > 0.0 || b < 0.0) return false;
      continue;
    }
    from = std::max(from, std::min(a / direction[axis], b / direction[axis]));
    to = std::min(to, std::max(a / direction[axis], b / direction[axis]));
  }
  return from <= to;
}

glm::dvec3 box_normal(const Scene &scene, const glm::dvec3 &place) {
  glm::dvec3 normal(0, 0, 1);
  double nearest = INFINITY;
  for (int axis = 0; axis < 3; axis++) {
    if (!scene.box.periodic[axis]) continue;
    for (const int sign : {-1, 1}) {
      const double distance = std::fabs(place[axis] - (sign < 0 ? scene.box.lo[axis] : scene.box.hi[axis]));
      if (distance >= nearest) continue;
      nearest = distance, normal = glm::dvec3(0.0), normal[axis] = sign;
    }
  }
  return normal;
}

std::shared_ptr<const RayScene> make_ray_scene(const Scene &scene, unsigned threads) {
  return std::make_shared<const RayScene>(scene, threads);
}

} // namespace conceg::rendering
