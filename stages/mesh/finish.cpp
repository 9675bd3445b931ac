// SPDX-License-Identifier: BSD-3-Clause
#include "finish.hpp"
#include "simplify.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <unordered_set>

namespace conceg::mesh {
namespace {

// Vertices of the base mesh that must stay, per surface; `whole` = nothing of it may change.
struct Locks {
  std::vector<std::vector<std::uint8_t>> vertex;
  std::vector<std::uint8_t> whole;
};

void simplify_all(const std::vector<Surface> &base, const Locks &locks, std::vector<std::uint32_t> todo,
                  double tolerance, std::vector<Surface> &out, Workers &workers, const Progress &progress) {
  // Large ones first, so that the last task is a small one.
  std::stable_sort(todo.begin(), todo.end(), [&](std::uint32_t l, std::uint32_t r) {
    return base[l].face.size() > base[r].face.size();
  });
  std::atomic<std::size_t> next{0};
  std::atomic<std::uint64_t> done{0};
  std::atomic<bool> stop{false};
  workers.loop(todo.size(), 1, [&](std::size_t, unsigned) {
    const std::uint32_t s = todo[next++];
    const auto keep_going = [&] {
      if (progress && !progress("mesh: simplify", done, todo.size())) stop = true;
      return !stop.load();
    };
    out[s] = locks.whole[s] ? base[s] : simplify(base[s], tolerance, locks.vertex[s], keep_going);
    done++;
  });
  if (stop) throw Error(CONCEG_E_CANCELLED, "");
}

// Places of one surface that go back to the base mesh: a set of cubes of edge `width`, relative to the
// surface's origin.
class Zone {
public:
  explicit Zone(double width) : inverse_(1 / width) {}
  // The cubes that a face and one cube around it touch.
  void add(const Surface &current, std::uint32_t face) {
    const glm::uvec3 &f = current.face[face];
    const glm::ivec3 a = cube(current.vertex[f.x]), b = cube(current.vertex[f.y]),
                     c = cube(current.vertex[f.z]);
    const glm::ivec3 low = glm::min(glm::min(a, b), c) - 1, high = glm::max(glm::max(a, b), c) + 1;
    for (int z = low.z; z <= high.z; z++)
      for (int y = low.y; y <= high.y; y++)
        for (int x = low.x; x <= high.x; x++)
          cubes_.insert(key({x, y, z}));
  }
  bool empty() const { return cubes_.empty(); }
  void lock(const Surface &base, std::vector<std::uint8_t> &locked) const {
    locked.resize(base.vertex.size());
    for (std::size_t v = 0; v < base.vertex.size(); v++)
      if (cubes_.count(key(cube(base.vertex[v])))) locked[v] = 1;
  }

private:
  glm::ivec3 cube(const glm::vec3 &p) const { return glm::ivec3(glm::floor(glm::dvec3(p) * inverse_)); }
  static std::uint64_t key(const glm::ivec3 &c) {
    const auto bits = [](int i) { return static_cast<std::uint64_t>(i) & 0x1fffff; };
    return bits(c.z) << 42 | bits(c.y) << 21 | bits(c.x);
  }
  double inverse_;
  std::unordered_set<std::uint64_t> cubes_;
};

// Locks what the defects touch and tells which surfaces the next round redoes.
std::vector<std::uint32_t> plan_repair(const std::vector<Surface> &base, const std::vector<Surface> &current,
                                       const std::vector<Defect> &defects, double width, bool last,
                                       Locks &locks) {
  std::vector<Zone> zone(base.size(), Zone(width));
  std::vector<std::uint8_t> affected(base.size());
  const auto mark = [&](std::uint32_t surface, std::uint32_t face, bool whole) {
    affected[surface] = 1;
    if (whole)
      locks.whole[surface] = 1;
    else
      zone[surface].add(current[surface], face);
  };
  for (const Defect &defect : defects) {
    const bool pair = is_pair(defect.flaw);
    mark(defect.surface, defect.face, last || !pair);
    if (pair) mark(defect.other_surface, defect.other_face, last);
  }
  std::vector<std::uint32_t> todo;
  for (std::uint32_t s = 0; s < base.size(); s++) {
    if (!affected[s]) continue;
    todo.push_back(s);
    if (!zone[s].empty()) zone[s].lock(base[s], locks.vertex[s]);
  }
  return todo;
}

} // namespace

Finished finish(const std::vector<Surface> &base, const conceg_box &box, const FinishOptions &options,
                Workers &workers, const Progress &progress) {
  Finished result;
  Locks locks = {std::vector<std::vector<std::uint8_t>>(base.size()), std::vector<std::uint8_t>(base.size())};
  result.surfaces.resize(base.size());
  std::vector<std::uint32_t> todo(base.size());
  std::iota(todo.begin(), todo.end(), 0u);
  CheckOptions check;
  check.gap = options.gap;
  check.least_gap = 0.5 * options.gap;
  double width = options.h;
  for (int round = 0;; round++, width *= 2) {
    simplify_all(base, locks, todo, options.tolerance, result.surfaces, workers, progress);
    result.check = check_surfaces(result.surfaces, box, check, workers, progress);
    result.rounds = round;
    if (result.check.defects.empty() || !(options.tolerance > 0) || round == options.rounds) return result;
    result.repaired_pairs += result.check.defects.size();
    todo =
        plan_repair(base, result.surfaces, result.check.defects, width, round + 1 == options.rounds, locks);
  }
}

} // namespace conceg::mesh
