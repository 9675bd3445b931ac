// SPDX-License-Identifier: BSD-3-Clause
// Finished surfaces on disk. With a name the file outlives a run that is killed: the next run with the same
// key takes over what is whole in it.
#pragma once

#include "components.hpp"
#include "side_file.hpp"

#include <mutex>

namespace conceg::mesh {

// What a later round must know of a cell beside its surface.
struct CellNotes {
  Pieces pieces;
  std::uint64_t base_faces = 0;         // before simplification
  bool whole_base = false;              // its base mesh stands everywhere
  std::vector<std::uint64_t> base_node; // where its base mesh stands, as Apart names nodes
};

struct MovedVertex {
  std::uint32_t vertex;
  glm::vec3 place; // as it is written
};

class SurfaceFile {
public:
  // Without a name, in `folder`.
  SurfaceFile(const std::string &folder, std::size_t cells);
  // The file `path` of the run whose input and parameters have the digest `key`; E_FORMAT when it belongs to
  // another one. A torn end is cut off.
  SurfaceFile(const std::string &path, const std::string &key, std::size_t cells);

  // Cells that the file already holds from the first round, with what is to be known of them.
  std::vector<std::pair<std::uint32_t, CellNotes>> taken_over() const { return taken_over_; }
  // Keeps a surface; of several of one cell the last counts. Notes go with those of the first round, which
  // are all that a later run takes over. Any thread.
  void add(const Surface &surface, const CellNotes *notes);
  // Puts vertices of a kept surface elsewhere. What a later run takes over stays as it was. Any thread, one a
  // cell.
  void move(std::uint32_t cell, const std::vector<MovedVertex> &moved);
  // Surfaces with faces, in the order of cells; good until the next call of `views`.
  Views views();
  void forget() const { mapping_.forget(); }
  std::uint64_t bytes() const { return end_; }

private:
  struct Head;
  struct Kept {
    std::uint64_t at = 0;
    std::uint32_t vertices = 0, faces = 0;
    glm::dvec3 origin{};
    bool for_later = false; // a later run may take it over
  };
  void take_over(const std::string &key);
  bool take_record(std::uint64_t size);

  SideFile file_;
  const bool outlives_;    // the run
  std::vector<Kept> kept_; // per cell
  std::vector<std::pair<std::uint32_t, CellNotes>> taken_over_;
  std::uint64_t end_ = 0;
  std::mutex mutex_;
  Mapping mapping_;
};

} // namespace conceg::mesh
