// SPDX-License-Identifier: BSD-3-Clause
#include "chunk_file.hpp"

#include <algorithm>
#include <cstring>

namespace conceg::mesh {

void ChunkFile::add(const std::vector<Marched> &block) {
  static thread_local std::vector<std::byte> bytes;
  bytes.clear();
  const auto put = [&](const auto &values) {
    const auto *from = reinterpret_cast<const std::byte *>(values.data());
    bytes.insert(bytes.end(), from, from + values.size() * sizeof values[0]);
  };
  std::vector<std::size_t> start;
  for (const Marched &marched : block) {
    start.push_back(bytes.size());
    put(marched.chunk.vertex), put(marched.chunk.face);
  }
  const std::uint64_t at = end_.fetch_add(bytes.size());
  file_.write(at, bytes.data(), bytes.size());
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::size_t i = 0; i < block.size(); i++) {
    const Chunk &c = block[i].chunk;
    kept_[block[i].cell].push_back({at + start[i], c.row, static_cast<std::uint32_t>(c.vertex.size()),
                                    static_cast<std::uint32_t>(c.face.size()), c.lift, c.first});
  }
}

std::uint64_t ChunkFile::faces(std::uint32_t cell) const {
  std::uint64_t sum = 0;
  for (const Kept &kept : kept_[cell])
    sum += kept.faces;
  return sum;
}

std::vector<Chunk> ChunkFile::take(std::uint32_t cell) {
  std::vector<Kept> kept;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    kept.swap(kept_[cell]);
  }
  std::stable_sort(kept.begin(), kept.end(), [](const Kept &l, const Kept &r) { return l.row < r.row; });
  std::vector<Chunk> chunks(kept.size());
  for (std::size_t i = 0; i < kept.size(); i++) {
    Chunk &c = chunks[i];
    c.row = kept[i].row, c.lift = kept[i].lift, c.first = kept[i].first;
    c.vertex.resize(kept[i].vertices), c.face.resize(kept[i].faces);
    const std::size_t first = c.vertex.size() * sizeof c.vertex[0];
    file_.read(kept[i].at, c.vertex.data(), first);
    file_.read(kept[i].at + first, c.face.data(), c.face.size() * sizeof c.face[0]);
  }
  return chunks;
}

void ChunkFile::clear() {
  file_.cut(0);
  end_ = 0;
}

} // namespace conceg::mesh
