// SPDX-License-Identifier: BSD-3-Clause
// Chunks on disk until all blocks of their cell have been marched.
#pragma once

#include "march.hpp"
#include "side_file.hpp"

#include <atomic>
#include <mutex>

namespace conceg::mesh {

class ChunkFile {
public:
  ChunkFile(const std::string &folder, std::size_t cells) : file_(folder), kept_(cells) {}
  struct Marched {
    std::uint32_t cell;
    Chunk chunk;
  };
  // The chunks of one block, in the order of its labels. Any thread.
  void add(const std::vector<Marched> &block);
  std::uint64_t faces(std::uint32_t cell) const;
  // All chunks of a cell in the order of blocks; the file forgets them. Not while some are being added to it.
  std::vector<Chunk> take(std::uint32_t cell);
  // Once everything has been taken the room is given back.
  void clear();

private:
  struct Kept {
    std::uint64_t at;
    std::uint32_t row, vertices, faces;
    glm::ivec3 lift, first;
  };
  SideFile file_;
  std::atomic<std::uint64_t> end_{0};
  std::mutex mutex_;
  std::vector<std::vector<Kept>> kept_; // per cell
};

} // namespace conceg::mesh
