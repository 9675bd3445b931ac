// SPDX-License-Identifier: BSD-3-Clause
// Which elements come close: Embree's rtcCollide over chunks of elements finds candidates, double arithmetic
// decides.
#pragma once

#include "chains.hpp"
#include "distance.hpp"
#include "parallel.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace conceg::relax {

// Element e and the image of element f that is lifted by `lift` box sides; e < f, or e == f and lift > 0 (its
// first component that is not 0).
struct Pair {
  std::uint32_t e, f;
  std::int32_t lift[3];
};

inline bool same_copy(const Pair &p) {
  return p.lift[0] == 0 && p.lift[1] == 0 && p.lift[2] == 0;
}

inline RoundCone cone_of(const Bodies &bodies, std::uint32_t e, const std::vector<double> &radius) {
  const Element &x = bodies.elements[e];
  return {bodies.position[x.a], bodies.position[x.b], radius[x.radius_a], radius[x.radius_b]};
}

// The two round cones of a pair, the second one lifted.
inline void cones_of(const Bodies &bodies, const Pair &pair, const std::vector<double> &radius,
                     const glm::dvec3 &side, RoundCone &first, RoundCone &second) {
  first = cone_of(bodies, pair.e, radius);
  second = cone_of(bodies, pair.f, radius);
  const glm::dvec3 shift = side * glm::dvec3(pair.lift[0], pair.lift[1], pair.lift[2]);
  second.a += shift, second.b += shift;
}

// Chunks i and j, the second one lifted by `up` sides; i == j without a lift is a chunk with itself.
struct ChunkPair {
  std::uint32_t i, j;
  std::int32_t up[3];
};

struct ChunkSearch {
  std::vector<ChunkPair> pairs; // each unordered pair once, in an order that does not depend on threads
  std::vector<glm::ivec3> lift; // per chunk, sides that bring it into the box
  std::uint64_t candidates = 0; // that Embree gave
  std::uint64_t joined = 0;     // chunk pairs that share a point: each of them must be among the candidates
};

struct Search {
  std::vector<Pair> pairs;       // sorted by (e, f, lift)
  std::uint64_t chunk_pairs = 0; // candidates that Embree gave
  std::uint64_t visited = 0;     // pairs of elements in them, neighbours in the tree included
};

class Collider {
public:
  // Fails with E_STAGE when Embree cannot start.
  explicit Collider(unsigned threads);
  ~Collider();
  Collider(const Collider &) = delete;
  Collider &operator=(const Collider &) = delete;

  // All pairs of chunks whose bounds, `reach` apart, meet over all periodic images. E_STAGE when Embree
  // reports an error or when the search missed a pair of chunks that touch by construction.
  ChunkSearch find_chunks(const Bodies &bodies, const std::vector<double> &radius, const conceg_box &box,
                          double reach, Workers &workers);

  // All pairs of elements, over all periodic images, whose gap can be below `reach`: the distance of the axes
  // less the larger radius of each is. Neighbours in the tree are left out. Fails as find_chunks does.
  Search find(const Bodies &bodies, const std::vector<double> &radius, const conceg_box &box, double reach,
              Workers &workers);

private:
  struct Device;
  std::unique_ptr<Device> device_;
};

} // namespace conceg::relax
