// SPDX-License-Identifier: BSD-3-Clause
#include "finish.hpp"
#include "simplify.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <numeric>

namespace conceg::mesh {
namespace {

constexpr std::size_t kNoSlot = ~std::size_t(0);

class Finisher {
public:
  Finisher(const Scene &scene, const Index &index, const Origins &origins, const conceg_box &box,
           const FinishOptions &options, Workers &workers, const Progress &progress)
      : scene_(scene), index_(index), origins_(origins), box_(box), options_(options), workers_(workers),
        progress_(progress), apart_(scene.cells), made_(scene.cells), slot_(scene.cells, kNoSlot),
        faces_(scene.cells) {
    result_.pieces.resize(scene.cells);
  }

  Finished run() {
    chunks_ = march_blocks(scene_, index_, options_.cluster, workers_, progress_);
    std::vector<std::uint32_t> todo(scene_.cells);
    std::iota(todo.begin(), todo.end(), 0u);
    CheckOptions check;
    check.gap = options_.gap, check.least_gap = kLeastGap * options_.gap;
    const bool exact = !options_.cluster && !(options_.tolerance > 0); // nothing to go back to
    int width = 1;
    for (int round = 0;; round++, width *= 2) {
      make_all(todo);
      collect();
      std::vector<std::uint8_t> changed(result_.surfaces.size());
      for (const std::uint32_t cell : todo)
        if (slot_[cell] != kNoSlot) changed[slot_[cell]] = 1;
      check_again(result_.surfaces, changed, box_, check, workers_, progress_, result_.check);
      result_.rounds = round;
      if (result_.check.defects.empty() || exact || round == options_.rounds) break;
      result_.repaired_pairs += result_.check.defects.size();
      todo = plan_repair(width, round + 1 == options_.rounds);
    }
    result_.base_faces = std::accumulate(faces_.begin(), faces_.end(), std::uint64_t(0));
    return std::move(result_);
  }

private:
  // Large ones first, so that the last task is a small one.
  void make_all(std::vector<std::uint32_t> todo) {
    std::stable_sort(todo.begin(), todo.end(),
                     [&](std::uint32_t l, std::uint32_t r) { return chunks_[l].size() > chunks_[r].size(); });
    std::atomic<std::size_t> next{0};
    std::atomic<std::uint64_t> done{0};
    std::atomic<bool> stop{false};
    workers_.loop(todo.size(), 1, [&](std::size_t, unsigned) {
      const std::uint32_t cell = todo[next++];
      const auto keep_going = [&] {
        if (progress_ && !progress_("mesh: simplify", done, todo.size())) stop = true;
        return !stop.load();
      };
      make(cell, keep_going);
      done++;
    });
    if (stop) throw Error(CONCEG_E_CANCELLED, "");
  }

  void make(std::uint32_t cell, const std::function<bool()> &keep_going) {
    Surface base = join_cell(scene_, index_, cell, origins_.origin[cell], chunks_[cell], apart_[cell]);
    result_.pieces[cell] =
        keep_soma_piece(base, origins_.soma[cell] - base.origin, origins_.soma_radius[cell] > 0);
    faces_[cell] = base.face.size();
    if (options_.tolerance > 0 && !apart_[cell].whole && !base.face.empty())
      base = simplify(base, tolerances(base, cell), keep_going);
    base.room = {};
    made_[cell] = std::move(base);
  }

  // How far simplification may move each vertex (README, equation 5): 0 next to nodes that keep the base
  // mesh.
  std::vector<float> tolerances(const Surface &base, std::uint32_t cell) const {
    std::vector<float> tolerance(base.vertex.size());
    const double near = kLeastGap * options_.gap;
    for (std::uint32_t v = 0; v < tolerance.size(); v++) {
      const double free = 0.5 * (base.room[v] - near);
      tolerance[v] = static_cast<float>(std::min(options_.tolerance, std::max(near * 0.5, free)));
      if (locked_.size() > cell && holds(locked_[cell], node_at(base.at(v)))) tolerance[v] = 0;
    }
    return tolerance;
  }

  static bool holds(const Apart &apart, const glm::ivec3 &node) {
    return !apart.empty() && apart.holds(node);
  }

  glm::ivec3 node_at(const glm::dvec3 &position) const {
    return glm::ivec3(glm::floor(scene_.grid.voxel_of(position) + 0.5));
  }

  // The surfaces of the first round find their places; later rounds replace them there.
  void collect() {
    for (std::uint32_t cell = 0; cell < scene_.cells; cell++) {
      if (made_[cell].face.empty()) continue;
      if (slot_[cell] == kNoSlot) slot_[cell] = result_.surfaces.size(), result_.surfaces.emplace_back();
      result_.surfaces[slot_[cell]] = std::move(made_[cell]);
      made_[cell] = Surface();
    }
  }

  // Takes the places of the defects back to the base mesh and tells which cells the next round makes again.
  std::vector<std::uint32_t> plan_repair(int width, bool last) {
    locked_.resize(scene_.cells);
    std::vector<std::vector<NodeBox>> places(scene_.cells);
    const auto mark = [&](std::uint32_t surface, std::uint32_t face, bool whole) {
      const Surface &s = result_.surfaces[surface];
      if (whole)
        apart_[s.cell].whole = true;
      else
        places[s.cell].push_back(zone(s, face, width));
    };
    std::vector<std::uint8_t> affected(scene_.cells);
    for (const Defect &defect : result_.check.defects) {
      const bool pair = is_pair(defect.flaw);
      mark(defect.surface, defect.face, last || !pair);
      affected[result_.surfaces[defect.surface].cell] = 1;
      if (!pair) continue;
      mark(defect.other_surface, defect.other_face, last);
      affected[result_.surfaces[defect.other_surface].cell] = 1;
    }
    std::vector<std::uint32_t> todo;
    for (std::uint32_t cell = 0; cell < scene_.cells; cell++)
      if (affected[cell]) todo.push_back(cell);
    for (const std::uint32_t cell : todo)
      for (const NodeBox &box : places[cell])
        apart_[cell].add(box), locked_[cell].add(box);
    march_again(scene_, index_, todo, apart_, places, workers_, chunks_);
    return todo;
  }

  // The nodes around a face, `width` steps and a half beyond its box.
  NodeBox zone(const Surface &surface, std::uint32_t face, int width) const {
    const glm::uvec3 &f = surface.face[face];
    const glm::ivec3 a = node_at(surface.at(f.x)), b = node_at(surface.at(f.y)), c = node_at(surface.at(f.z));
    return {glm::min(glm::min(a, b), c) - width, glm::max(glm::max(a, b), c) + width};
  }

  const Scene &scene_;
  const Index &index_;
  const Origins &origins_;
  const conceg_box &box_;
  const FinishOptions &options_;
  Workers &workers_;
  const Progress &progress_;
  Chunks chunks_;
  std::vector<Apart> apart_;      // per cell: where the base mesh stands unclustered
  std::vector<Apart> locked_;     // per cell: where it is not simplified either; empty in the first round
  std::vector<Surface> made_;     // per cell, of this round
  std::vector<std::size_t> slot_; // per cell: its row in the result
  std::vector<std::uint64_t> faces_;
  Finished result_;
};

} // namespace

Finished finish(const Scene &scene, const Index &index, const Origins &origins, const conceg_box &box,
                const FinishOptions &options, Workers &workers, const Progress &progress) {
  return Finisher(scene, index, origins, box, options, workers, progress).run();
}

} // namespace conceg::mesh
