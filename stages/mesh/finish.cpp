// SPDX-License-Identifier: BSD-3-Clause
#include "finish.hpp"
#include "nudge.hpp"
#include "simplify.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>
#include <thread>

namespace conceg::mesh {
namespace {

constexpr std::size_t kNoSlot = ~std::size_t(0);
constexpr int kNudges = 6;          // turns after each round
constexpr double kFarthest = 0.5;   // of the gap, and half of that of a step: how far a vertex goes in a turn
constexpr double kWorthwhile = 0.7; // of the pairs must be left at most for another turn

class Finisher {
public:
  Finisher(const Scene &scene, const Index &index, const Origins &origins, const conceg_box &box,
           const FinishOptions &options, Workers &workers, const Progress &progress)
      : scene_(scene), index_(index), origins_(origins), box_(box), options_(options), workers_(workers),
        progress_(progress), chunks_(options.folder, scene.cells), apart_(scene.cells), faces_(scene.cells) {
    result_.pieces.resize(scene.cells);
    result_.file = options.side_file.empty()
                       ? std::make_unique<SurfaceFile>(options.folder, scene.cells)
                       : std::make_unique<SurfaceFile>(options.side_file, options.key, scene.cells);
  }

  Finished run() {
    std::vector<std::uint32_t> todo = cells_to_make();
    CheckOptions check;
    check.least_gap = check.reach = options_.least_gap();
    check.memory = options_.check_memory;
    check.forget = [this] { result_.file->forget(); };
    const bool exact = !options_.cluster && !(options_.tolerance > 0); // nothing to go back to
    int width = 1;
    for (round_ = 0;; round_++, width *= 2) {
      make_all(todo);
      result_.surfaces = result_.file->views();
      check_again(result_.surfaces, {changed(todo)}, box_, check, workers_, progress_, result_.check);
      result_.rounds = round_;
      const bool whole = round_ + 1 >= options_.rounds;
      if (options_.nudge && !exact) move_apart(check);
      if (result_.check.defects.empty() || exact || (whole && !can_retreat())) break;
      result_.repaired_pairs += result_.check.defects.size();
      todo = plan_repair(width, whole);
    }
    result_.base_faces = std::accumulate(faces_.begin(), faces_.end(), std::uint64_t(0));
    return std::move(result_);
  }

private:
  // All but those that an earlier run has left in the file.
  std::vector<std::uint32_t> cells_to_make() {
    std::vector<std::uint8_t> there(scene_.cells);
    for (const auto &[cell, notes] : result_.file->taken_over()) {
      there[cell] = 1;
      result_.pieces[cell] = notes.pieces, faces_[cell] = notes.base_faces;
      apart_[cell].whole = notes.whole_base, apart_[cell].add(notes.base_node);
    }
    std::vector<std::uint32_t> todo;
    for (std::uint32_t cell = 0; cell < scene_.cells; cell++)
      if (!there[cell]) todo.push_back(cell);
    result_.taken_over = scene_.cells - todo.size();
    return todo;
  }

  // In the first round everything is new, also what was taken over.
  std::vector<std::uint8_t> changed(const std::vector<std::uint32_t> &todo) {
    std::vector<std::uint8_t> of_surface(result_.surfaces.size(), round_ == 0);
    slot_.assign(scene_.cells, kNoSlot);
    for (std::size_t s = 0; s < result_.surfaces.size(); s++)
      slot_[result_.surfaces[s].cell] = s;
    for (const std::uint32_t cell : todo)
      if (slot_[cell] != kNoSlot) of_surface[slot_[cell]] = 1;
    return of_surface;
  }

  // Blocks are marched in order; a cell whose last block is done goes before further blocks, so that little
  // waits. Which worker does what leaves no trace in the result.
  void make_all(const std::vector<std::uint32_t> &todo) {
    wanted_.assign(scene_.cells, 0);
    for (const std::uint32_t cell : todo)
      wanted_[cell] = 1;
    RowCount count = rows_of(scene_, index_, wanted_);
    left_ = std::move(count.rows);
    ready_.clear(), next_row_ = 0, taken_ = 0, stop_ = false, rows_ = count.row.size();
    for (const std::uint32_t cell : todo)
      if (left_[cell] == 0) push_ready(cell);
    const std::size_t all = todo.size();
    workers_.loop(workers_.threads(), 1, [&](std::size_t, unsigned) {
      try {
        while (!stop_ && work(count.row, all)) {
        }
      } catch (...) {
        stop_ = true;
        throw;
      }
    });
    chunks_.clear();
    if (stop_) throw Error(CONCEG_E_CANCELLED, "");
  }

  // One cell or one block; false when nothing is left to begin.
  bool work(const std::vector<std::uint32_t> &rows, std::size_t all) {
    std::uint32_t cell = 0;
    if (pop_ready(cell)) {
      make(cell);
      return true;
    }
    const std::size_t next = next_row_.fetch_add(1);
    if (next < rows.size()) {
      march(rows[next]);
      if (next % 64 == 0) tell();
      return true;
    }
    if (taken_ == all) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1)); // others march the last blocks
    return true;
  }

  void tell() {
    const std::size_t done = std::min(next_row_.load(), rows_);
    if (progress_ && !progress_(round_ ? "mesh: repair" : "mesh: surfaces", done, rows_)) stop_ = true;
  }

  void march(std::uint32_t row) {
    static thread_local std::vector<ChunkFile::Marched> marched;
    static thread_local std::vector<std::uint32_t> cells;
    march_row(scene_, index_, row, options_.cluster, wanted_, apart_, marched, cells);
    chunks_.add(marched);
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const std::uint32_t cell : cells)
      if (--left_[cell] == 0) push_ready(cell);
  }

  // Large ones first, so that the last task is a small one.
  void push_ready(std::uint32_t cell) {
    ready_.emplace_back(chunks_.faces(cell), cell);
    std::push_heap(ready_.begin(), ready_.end());
  }

  bool pop_ready(std::uint32_t &cell) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (ready_.empty()) return false;
    std::pop_heap(ready_.begin(), ready_.end());
    cell = ready_.back().second;
    ready_.pop_back(), taken_++;
    return true;
  }

  void make(std::uint32_t cell) {
    std::vector<Chunk> chunks = chunks_.take(cell);
    Surface base = join_cell(scene_, index_, cell, origins_.origin[cell], chunks, apart_[cell]);
    chunks = {};
    CellNotes notes;
    notes.pieces = keep_soma_piece(base, origins_.soma[cell] - base.origin, origins_.soma_radius[cell] > 0);
    notes.base_faces = base.face.size();
    notes.whole_base = apart_[cell].whole, notes.base_node = apart_[cell].nodes();
    result_.pieces[cell] = notes.pieces, faces_[cell] = notes.base_faces;
    const auto keep_going = [&] {
      tell();
      return !stop_.load();
    };
    if (options_.tolerance > 0 && !apart_[cell].whole && !base.face.empty())
      base = simplify(base, tolerances(base, cell), keep_going);
    if (!stop_) result_.file->add(base, round_ == 0 ? &notes : nullptr);
  }

  // How far simplification may move each vertex (README, equation 5): both sides of a gap together leave half
  // of what is asked; 0 next to nodes that keep the base mesh.
  std::vector<float> tolerances(const Surface &base, std::uint32_t cell) const {
    std::vector<float> tolerance(base.vertex.size());
    for (std::uint32_t v = 0; v < tolerance.size(); v++) {
      const double gap = std::max(options_.gap, double(base.room[v]));
      tolerance[v] = static_cast<float>(std::min(options_.tolerance, 0.5 * (gap - options_.least_gap())));
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

  // A cell that has become its base mesh may meet a light neighbour: as long as one of two is light, it can
  // go back.
  bool can_retreat() const {
    const auto light = [&](std::uint32_t surface) { return !apart_[result_.surfaces[surface].cell].whole; };
    for (const Defect &defect : result_.check.defects)
      if (light(defect.surface) || (is_pair(defect.flaw) && light(defect.other_surface))) return true;
    return false;
  }

  // Moves faces apart, turn by turn, as long as that helps. Cells that are their base mesh stay.
  void move_apart(const CheckOptions &check) {
    const NudgeOptions options{options_.least_gap(),
                               kFarthest * std::min(options_.gap, 0.5 * scene_.grid.unit)};
    auto &defects = result_.check.defects;
    for (int turn = 0; turn < kNudges && !defects.empty(); turn++) {
      const std::size_t before = defects.size();
      std::vector<std::uint8_t> fixed;
      for (const SurfaceView &surface : result_.surfaces)
        fixed.push_back(apart_[surface.cell].whole);
      const Nudged nudged = nudge(result_.surfaces, defects, fixed, box_, options, workers_);
      if (!nudged.count) return;
      result_.moved_vertices += nudged.count;
      workers_.loop(result_.surfaces.size(), 1, [&](std::size_t s, unsigned) {
        if (!nudged.vertex[s].empty()) result_.file->move(result_.surfaces[s].cell, nudged.vertex[s]);
      });
      result_.surfaces = result_.file->views();
      check_again(result_.surfaces, nudged.changed, box_, check, workers_, progress_, result_.check);
      if (double(defects.size()) > kWorthwhile * double(before)) return;
    }
  }

  // Takes the places of the defects back to the base mesh and tells which cells the next round makes again.
  std::vector<std::uint32_t> plan_repair(int width, bool last) {
    locked_.resize(scene_.cells);
    std::vector<std::uint8_t> affected(scene_.cells);
    const auto mark = [&](std::uint32_t surface, std::uint32_t face, bool whole) {
      const SurfaceView &s = result_.surfaces[surface];
      affected[s.cell] = 1;
      if (whole) {
        apart_[s.cell].whole = true;
        return;
      }
      const NodeBox box = zone(s, face, width);
      apart_[s.cell].add(box), locked_[s.cell].add(box);
    };
    for (const Defect &defect : result_.check.defects) {
      const bool pair = is_pair(defect.flaw);
      mark(defect.surface, defect.face, last || !pair);
      if (pair) mark(defect.other_surface, defect.other_face, last);
    }
    std::vector<std::uint32_t> todo;
    for (std::uint32_t cell = 0; cell < scene_.cells; cell++)
      if (affected[cell]) todo.push_back(cell);
    return todo;
  }

  // The nodes around a face, `width` steps and a half beyond its box.
  NodeBox zone(const SurfaceView &surface, std::uint32_t face, int width) const {
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
  ChunkFile chunks_;
  std::vector<Apart> apart_;      // per cell: where the base mesh stands unclustered
  std::vector<Apart> locked_;     // per cell: where it is not simplified either; empty in the first round
  std::vector<std::size_t> slot_; // per cell: its row in the result
  std::vector<std::uint64_t> faces_;
  int round_ = 0;
  std::vector<std::uint8_t> wanted_;                           // per cell: is made in this round
  std::vector<std::uint32_t> left_;                            // per cell: blocks to be marched
  std::vector<std::pair<std::uint64_t, std::uint32_t>> ready_; // heap of (faces, cell)
  std::mutex mutex_;                                           // of left_ and ready_
  std::atomic<std::size_t> next_row_{0}, taken_{0};
  std::size_t rows_ = 0; // to be marched in this round
  std::atomic<bool> stop_{false};
  Finished result_;
};

} // namespace

Finished finish(const Scene &scene, const Index &index, const Origins &origins, const conceg_box &box,
                const FinishOptions &options, Workers &workers, const Progress &progress) {
  return Finisher(scene, index, origins, box, options, workers, progress).run();
}

} // namespace conceg::mesh
