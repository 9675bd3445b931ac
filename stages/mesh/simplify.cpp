// SPDX-License-Identifier: BSD-3-Clause
#include "simplify.hpp"
#include "distance.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>

namespace conceg::mesh {
namespace {

constexpr int kBuckets = 64; // of the error, on a square-root scale up to the tolerance
constexpr double kMean =
    1.0; // root-mean-square distance to the planes that is tried at most, over the tolerance
constexpr double kPull =
    3e-3; // weight of the edge's midpoint against the planes: settles flat and tube-like places
constexpr double kFan = 0.5;  // least cosine between the normals of the faces around a vertex and their sum
constexpr double kTurn = 0.5; // least cosine between a face's normals before and after
constexpr double kShape =
    0.12; // least quality of a new face (1 = equilateral), unless the old ones were worse
constexpr std::size_t kStretch = 1 << 12; // faces whose edges are queued together
constexpr std::size_t kValence = 24;      // most faces around a vertex

// Area-weighted sum of squared distances to planes: x'Ax + 2b'x + c. The trace of A is the sum of the
// weights.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, bx = 0, by = 0, bz = 0, c = 0;
  void add(const Quadric &q) {
    xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
    bx += q.bx, by += q.by, bz += q.bz, c += q.c;
  }
  double weight() const { return xx + yy + zz; }
  double at(const glm::dvec3 &p) const {
    return p.x * (xx * p.x + 2 * (xy * p.y + xz * p.z + bx)) + p.y * (yy * p.y + 2 * (yz * p.z + by)) +
           p.z * (zz * p.z + 2 * bz) + c;
  }
};

Quadric plane_quadric(const glm::dvec3 &n, double d, double weight) {
  Quadric q;
  q.xx = weight * n.x * n.x, q.xy = weight * n.x * n.y, q.xz = weight * n.x * n.z;
  q.yy = weight * n.y * n.y, q.yz = weight * n.y * n.z, q.zz = weight * n.z * n.z;
  q.bx = weight * d * n.x, q.by = weight * d * n.y, q.bz = weight * d * n.z, q.c = weight * d * d;
  return q;
}

struct Candidate {
  std::uint32_t a, b, version; // version: sum of the ends' versions when it was queued
};

// First in, first out within a bucket, lowest bucket first.
class Queue {
public:
  void push(int bucket, const Candidate &candidate) {
    const auto i = static_cast<std::size_t>(bucket);
    lane_[i].push_back(candidate);
    lowest_ = std::min(lowest_, i);
  }
  bool pop(Candidate &out) {
    for (; lowest_ < kBuckets; lowest_++) {
      auto &lane = lane_[lowest_];
      std::size_t &head = head_[lowest_];
      if (head < lane.size()) {
        out = lane[head++];
        return true;
      }
      lane.clear(), head = 0;
    }
    return false;
  }

private:
  std::array<std::vector<Candidate>, kBuckets> lane_;
  std::array<std::size_t, kBuckets> head_{};
  std::size_t lowest_ = kBuckets;
};

class Simplifier {
public:
  Simplifier(const Surface &base, const std::vector<float> &tolerance) : base_(base), face_(base.face) {
    for (const float t : tolerance)
      limit_.push_back(static_cast<float>(kMean * kMean * t * t)), tolerance2_.push_back(t * t);
    origin_ = base.vertex.empty() ? glm::dvec3(0) : glm::dvec3(base.vertex[0]);
    for (const glm::vec3 &v : base.vertex)
      position_.push_back(glm::dvec3(v) - origin_);
    version_.resize(position_.size());
    mark_.resize(position_.size());
    build_rings();
    build_quadrics();
    build_points();
  }

  // Stretch after stretch of the faces, which lie near one another, so that what is at work fits into the
  // cache.
  Surface run(const std::function<bool()> &keep_going) {
    for (std::size_t first = 0; first < face_.size(); first += kStretch) {
      if (keep_going && !keep_going()) break;
      queue_edges(first, std::min(face_.size(), first + kStretch));
      Candidate candidate;
      while (queue_.pop(candidate))
        if (version_[candidate.a] + version_[candidate.b] == candidate.version && !gone(candidate.a) &&
            !gone(candidate.b))
          try_collapse(candidate.a, candidate.b);
    }
    return result();
  }

private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct Placed {
    std::uint32_t face;
    Corners corner;
  };
  struct Home {
    std::uint32_t point, face;
  };

  bool gone(std::uint32_t v) const { return count_[v] == 0; }
  glm::dvec3 corner(std::uint32_t face, int i) const { return position_[face_[face][i]]; }

  void build_rings() {
    first_.resize(position_.size());
    count_.resize(position_.size());
    for (const glm::uvec3 &f : face_)
      count_[f.x]++, count_[f.y]++, count_[f.z]++;
    std::uint32_t next = 0;
    for (std::size_t v = 0; v < first_.size(); v++)
      first_[v] = next, next += count_[v], count_[v] = 0;
    pool_.resize(next);
    for (std::uint32_t f = 0; f < face_.size(); f++)
      for (int i = 0; i < 3; i++)
        pool_[first_[face_[f][i]] + count_[face_[f][i]]++] = f;
  }

  void build_quadrics() {
    quadric_.resize(position_.size());
    for (std::uint32_t f = 0; f < face_.size(); f++) {
      const glm::dvec3 a = corner(f, 0), normal = cross_product(corner(f, 1) - a, corner(f, 2) - a);
      const double twice_area = glm::length(normal);
      if (!(twice_area > 0)) continue;
      const glm::dvec3 n = normal / twice_area;
      const Quadric q = plane_quadric(n, -glm::dot(n, a), twice_area);
      for (int i = 0; i < 3; i++)
        quadric_[face_[f][i]].add(q);
    }
  }

  // Every vertex of the base is a point that has its home on one face and has to stay near it.
  void build_points() {
    base_first_ = first_, base_pool_ = pool_;
    base_first_.push_back(static_cast<std::uint32_t>(pool_.size()));
    head_.assign(face_.size(), kNone), next_.resize(position_.size()), nearest_.resize(position_.size());
    for (std::uint32_t v = 0; v < position_.size(); v++) {
      nearest_[v] = v;
      if (count_[v]) set_home(v, pool_[first_[v]]);
    }
  }

  void set_home(std::uint32_t point, std::uint32_t face) { next_[point] = head_[face], head_[face] = point; }
  glm::dvec3 point(std::uint32_t v) const { return glm::dvec3(base_.vertex[v]) - origin_; }

  void queue_edges(std::size_t first, std::size_t last) {
    for (std::size_t f = first; f < last; f++)
      for (int i = 0; i < 3; i++)
        if (face_[f][i] < face_[f][(i + 1) % 3]) queue_edge(face_[f][i], face_[f][(i + 1) % 3]);
  }

  void queue_edge(std::uint32_t a, std::uint32_t b) {
    const double limit = std::min(limit_[a], limit_[b]);
    if (!(limit > 0)) return;
    Quadric q = quadric_[a];
    q.add(quadric_[b]);
    const double error = q.at(best_point(q, a, b)) / q.weight();
    if (!(error < limit)) return;
    const double share = std::sqrt(std::max(0.0, error) / limit);
    queue_.push(std::min(kBuckets - 1, static_cast<int>(share * kBuckets)),
                {a, b, version_[a] + version_[b]});
  }

  // Minimum of the quadric plus a weak pull to the midpoint, which makes the system definite.
  glm::dvec3 best_point(const Quadric &q, std::uint32_t a, std::uint32_t b) const {
    const glm::dvec3 middle = 0.5 * (position_[a] + position_[b]);
    const double pull = kPull * q.weight();
    const double xx = q.xx + pull, yy = q.yy + pull, zz = q.zz + pull;
    const glm::dvec3 right(-(q.xx * middle.x + q.xy * middle.y + q.xz * middle.z + q.bx),
                           -(q.xy * middle.x + q.yy * middle.y + q.yz * middle.z + q.by),
                           -(q.xz * middle.x + q.yz * middle.y + q.zz * middle.z + q.bz));
    const double cxx = yy * zz - q.yz * q.yz, cxy = q.xz * q.yz - q.xy * zz, cxz = q.xy * q.yz - q.xz * yy;
    const double cyy = xx * zz - q.xz * q.xz, cyz = q.xy * q.xz - xx * q.yz, czz = xx * yy - q.xy * q.xy;
    const double determinant = xx * cxx + q.xy * cxy + q.xz * cxz;
    if (!(determinant > 0)) return middle;
    const glm::dvec3 step(cxx * right.x + cxy * right.y + cxz * right.z,
                          cxy * right.x + cyy * right.y + cyz * right.z,
                          cxz * right.x + cyz * right.y + czz * right.z);
    return middle + step / determinant;
  }

  // The two faces at an edge are the only triangles over common neighbours, and none of those neighbours
  // loses its ring.
  bool link_holds(std::uint32_t a, std::uint32_t b) {
    stamp_ += 2;
    for (std::uint32_t i = 0; i < count_[a]; i++)
      for (int k = 0; k < 3; k++)
        mark_[face_[pool_[first_[a] + i]][k]] = stamp_;
    mark_[a] = mark_[b] = 0;
    std::uint32_t shared = 0;
    for (std::uint32_t i = 0; i < count_[b]; i++)
      for (int k = 0; k < 3; k++) {
        const std::uint32_t v = face_[pool_[first_[b] + i]][k];
        if (mark_[v] != stamp_) continue;
        mark_[v] = stamp_ + 1;
        if (++shared > 2 || count_[v] <= 3) return false;
      }
    return shared == 2;
  }

  static double quality(const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c, double twice_area) {
    const glm::dvec3 e = b - a, f = c - b, g = a - c;
    return 3.4641016151377544 * twice_area / (glm::dot(e, e) + glm::dot(f, f) + glm::dot(g, g));
  }

  // The faces that `moved` keeps when it goes to x and the edge to `other` vanishes: none may turn over or
  // get too thin.
  bool faces_hold(std::uint32_t moved, std::uint32_t other, const glm::dvec3 &x, double &least_old,
                  double &least_new) {
    for (std::uint32_t i = 0; i < count_[moved]; i++) {
      const std::uint32_t f = pool_[first_[moved] + i];
      glm::dvec3 p[3] = {corner(f, 0), corner(f, 1), corner(f, 2)};
      const glm::dvec3 before = cross_product(p[1] - p[0], p[2] - p[0]);
      const double length_before = glm::length(before);
      least_old = std::min(least_old, quality(p[0], p[1], p[2], length_before));
      const glm::uvec3 &v = face_[f];
      if (v.x == other || v.y == other || v.z == other) continue;
      for (int k = 0; k < 3; k++)
        if (v[k] == moved) p[k] = x;
      const glm::dvec3 after = cross_product(p[1] - p[0], p[2] - p[0]);
      const double length_after = glm::length(after);
      if (!(glm::dot(before, after) > kTurn * length_before * length_after)) return false;
      least_new = std::min(least_new, quality(p[0], p[1], p[2], length_after));
      normal_.push_back(after);
    }
    return true;
  }

  // Seen along the sum of their normals the new faces all look the same way, so that none folds over another.
  bool opens_like_a_fan() const {
    glm::dvec3 view(0);
    for (const glm::dvec3 &n : normal_)
      view += n;
    for (const glm::dvec3 &n : normal_)
      if (!(glm::dot(n, view) > kFan * glm::length(n) * glm::length(view))) return false;
    return true;
  }

  // Moves x along the mean normal so that the collapse of a-b to it leaves the enclosed volume as it is: with
  // the corners p, q of the faces that stay, in order, sum x.(p x q) = sum over the old faces of b.(p x q),
  // all seen from a (Lindstrom and Turk 1998).
  glm::dvec3 keep_volume(std::uint32_t a, std::uint32_t b, const glm::dvec3 &x) const {
    const glm::dvec3 from = position_[a];
    glm::dvec3 normal(0);
    double six_volume = 0;
    for (const std::uint32_t v : {a, b})
      for (std::uint32_t i = 0; i < count_[v]; i++) {
        const glm::uvec3 &f = face_[pool_[first_[v] + i]];
        const std::uint32_t other = v == a ? b : a;
        if (f.x == other || f.y == other || f.z == other) continue;
        const int k = f.x == v ? 0 : f.y == v ? 1 : 2;
        const glm::dvec3 side =
            cross_product(position_[f[(k + 1) % 3]] - from, position_[f[(k + 2) % 3]] - from);
        normal += side;
        if (v == b) six_volume += glm::dot(position_[b] - from, side);
      }
    const double length2 = glm::dot(normal, normal);
    return length2 > 0 ? x + normal * ((six_volume - glm::dot(x - from, normal)) / length2) : x;
  }

  void try_collapse(std::uint32_t a, std::uint32_t b) {
    if (count_[a] + count_[b] > kValence + 4 || !link_holds(a, b)) return;
    Quadric q = quadric_[a];
    q.add(quadric_[b]);
    const glm::dvec3 x = keep_volume(a, b, best_point(q, a, b));
    if (!(q.at(x) < std::min(limit_[a], limit_[b]) * q.weight())) return;
    double least_old = 1, least_new = 1;
    normal_.clear();
    if (!faces_hold(a, b, x, least_old, least_new) || !faces_hold(b, a, x, least_old, least_new)) return;
    if (least_new < std::min(kShape, least_old)) return;
    if (!opens_like_a_fan() || !stays_near(a, b, x)) return;
    collapse(a, b, x, q);
  }

  // The faces around the edge a-b as they would be with both ends at x, and its two faces, which go.
  void look_around(std::uint32_t a, std::uint32_t b, const glm::dvec3 &x) {
    star_.clear(), leaving_.clear();
    for (const std::uint32_t v : {a, b})
      for (std::uint32_t i = 0; i < count_[v]; i++) {
        const std::uint32_t f = pool_[first_[v] + i], other = v == a ? b : a;
        const glm::uvec3 &c = face_[f];
        if (c.x == other || c.y == other || c.z == other) {
          if (v == a) leaving_.push_back(f);
          continue;
        }
        star_.push_back({f, {corner(f, 0), corner(f, 1), corner(f, 2)}});
        for (int k = 0; k < 3; k++)
          if (c[k] == v) star_.back().corner[k] = x;
      }
  }

  // Would every point at home around the edge a-b find a face within its tolerance, and x the base?
  bool stays_near(std::uint32_t a, std::uint32_t b, const glm::dvec3 &x) {
    look_around(a, b, x);
    home_.clear();
    nearest_of_x_ = distance2(x, nearest_[a]) <= distance2(x, nearest_[b]) ? nearest_[a] : nearest_[b];
    for (const Placed &placed : star_)
      if (!find_homes(placed.face, &placed, x)) return false;
    for (const std::uint32_t f : leaving_)
      if (!find_homes(f, nullptr, x)) return false;
    for (std::uint32_t i = base_first_[nearest_of_x_]; i < base_first_[nearest_of_x_ + 1]; i++) {
      const glm::uvec3 &f = base_.face[base_pool_[i]];
      if (point_triangle_distance2(x, {point(f.x), point(f.y), point(f.z)}) <= tolerance2_[nearest_of_x_])
        return true;
    }
    return false;
  }

  // New homes for the points of a face, which is now as `placed`, or goes.
  bool find_homes(std::uint32_t face, const Placed *placed, const glm::dvec3 &x) {
    for (std::uint32_t p = head_[face]; p != kNone; p = next_[p]) {
      if (!find_home(p, placed)) return false;
      if (distance2(x, p) < distance2(x, nearest_of_x_)) nearest_of_x_ = p;
    }
    return true;
  }

  double distance2(const glm::dvec3 &x, std::uint32_t p) const {
    const glm::dvec3 d = x - point(p);
    return glm::dot(d, d);
  }

  // The face that it is on if that is near enough, else the nearest of all.
  bool find_home(std::uint32_t p, const Placed *now) {
    const glm::dvec3 at = point(p);
    if (now && point_triangle_distance2(at, now->corner) <= tolerance2_[p]) {
      home_.push_back({p, now->face});
      return true;
    }
    double least = tolerance2_[p];
    const Placed *best = nullptr;
    for (const Placed &placed : star_) {
      const double d = point_triangle_distance2(at, placed.corner);
      if (d <= least) least = d, best = &placed;
    }
    if (best) home_.push_back({p, best->face});
    return best != nullptr;
  }

  void move_points(std::uint32_t a) {
    for (const Placed &placed : star_)
      head_[placed.face] = kNone;
    for (const std::uint32_t f : leaving_)
      head_[f] = kNone;
    for (const Home &home : home_)
      set_home(home.point, home.face);
    nearest_[a] = nearest_of_x_;
  }

  void collapse(std::uint32_t a, std::uint32_t b, const glm::dvec3 &x, const Quadric &q) {
    move_points(a);
    ring_.clear();
    for (std::uint32_t i = 0; i < count_[a]; i++) {
      const std::uint32_t f = pool_[first_[a] + i];
      if (face_[f].x == b || face_[f].y == b || face_[f].z == b)
        drop_face(f, a, b);
      else
        ring_.push_back(f);
    }
    for (std::uint32_t i = 0; i < count_[b]; i++) {
      const std::uint32_t f = pool_[first_[b] + i];
      if (face_[f].x == face_[f].y) continue; // dropped above
      for (int k = 0; k < 3; k++)
        if (face_[f][k] == b) face_[f][k] = a;
      ring_.push_back(f);
    }
    store_ring(a, b);
    position_[a] = x, quadric_[a] = q, limit_[a] = std::min(limit_[a], limit_[b]);
    version_[a]++, version_[b]++;
    stamp_ += 2;
    for (const std::uint32_t f : ring_)
      for (int k = 0; k < 3; k++) {
        const std::uint32_t v = face_[f][k];
        if (v == a || mark_[v] == stamp_) continue;
        mark_[v] = stamp_;
        queue_edge(std::min(a, v), std::max(a, v));
      }
  }

  // Takes a face of the edge a-b away: out of the ring of its third vertex, and marked by three equal
  // corners.
  void drop_face(std::uint32_t f, std::uint32_t a, std::uint32_t b) {
    std::uint32_t third = face_[f].x;
    for (int k = 0; k < 3; k++)
      if (face_[f][k] != a && face_[f][k] != b) third = face_[f][k];
    std::uint32_t *ring = &pool_[first_[third]];
    const std::uint32_t *end = std::remove(ring, ring + count_[third], f);
    count_[third] = static_cast<std::uint32_t>(end - ring);
    face_[f] = glm::uvec3(a);
  }

  // The merged ring goes to the end of the pool when neither old place is large enough.
  void store_ring(std::uint32_t a, std::uint32_t b) {
    const auto count = static_cast<std::uint32_t>(ring_.size());
    if (count > count_[a]) {
      if (count <= count_[b])
        first_[a] = first_[b];
      else
        first_[a] = static_cast<std::uint32_t>(pool_.size()), pool_.resize(pool_.size() + count);
    }
    std::copy(ring_.begin(), ring_.end(), pool_.begin() + first_[a]);
    count_[a] = count, count_[b] = 0;
  }

  Surface result() const {
    Surface out;
    out.cell = base_.cell, out.origin = base_.origin;
    std::vector<std::uint32_t> number(position_.size());
    for (std::uint32_t v = 0; v < position_.size(); v++) {
      if (gone(v)) continue;
      number[v] = static_cast<std::uint32_t>(out.vertex.size());
      out.vertex.push_back(version_[v] ? written(position_[v] + origin_) : base_.vertex[v]);
    }
    for (const glm::uvec3 &f : face_)
      if (f.x != f.y) out.face.push_back({number[f.x], number[f.y], number[f.z]});
    return out;
  }

  const Surface &base_;
  std::vector<float> limit_; // of the mean squared distance to the planes
  glm::dvec3 origin_{};
  std::vector<glm::dvec3> position_;
  std::vector<Quadric> quadric_;
  std::vector<glm::uvec3> face_;
  std::vector<std::uint32_t> first_, count_, pool_, version_, mark_, ring_;
  std::uint32_t stamp_ = 2;
  std::vector<float> tolerance2_;                     // of each point, squared
  std::vector<std::uint32_t> head_, next_;            // the points at home on each face, a list
  std::vector<std::uint32_t> nearest_;                // of each vertex: a point next to it
  std::vector<std::uint32_t> base_first_, base_pool_; // faces of the base around each of its vertices
  std::vector<Placed> star_;
  std::vector<std::uint32_t> leaving_;
  std::vector<Home> home_;
  std::vector<glm::dvec3> normal_; // of the faces that would be
  std::uint32_t nearest_of_x_ = 0;
  Queue queue_;
};

} // namespace

Surface simplify(const Surface &base, const std::vector<float> &tolerance,
                 const std::function<bool()> &keep_going) {
  return Simplifier(base, tolerance).run(keep_going);
}

} // namespace conceg::mesh
