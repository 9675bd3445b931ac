// SPDX-License-Identifier: BSD-3-Clause
#include "surface_file.hpp"
#include "guard.hpp"

#include <cstring>

namespace conceg::mesh {
namespace {

constexpr char kMagic[16] = "ConCeG mesh 1\n";
constexpr std::size_t kKey = 64; // characters of a digest
constexpr std::uint64_t kFirst = sizeof kMagic + kKey;

// FNV-1a over words: tells a record that was written to its end.
std::uint64_t sum_of(const std::vector<std::uint64_t> &words, std::size_t count) {
  std::uint64_t sum = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < count; i++)
    sum = (sum ^ words[i]) * 0x100000001b3u;
  return sum;
}

std::size_t words_of(std::size_t bytes) {
  return (bytes + 7) / 8;
}

} // namespace

// A record: head, vertices, faces, nodes, sum. All of it in words.
struct SurfaceFile::Head {
  std::uint64_t words; // of the whole record
  std::uint32_t cell, vertices, faces, first_round;
  double origin[3];
  std::uint64_t base_faces, base_nodes;
  double detached_volume, cavity_volume;
  std::uint32_t detached, cavities, soma_found, whole_base;
};

SurfaceFile::SurfaceFile(const std::string &folder, std::size_t cells)
    : file_(folder), outlives_(false), kept_(cells) {}

SurfaceFile::SurfaceFile(const std::string &path, const std::string &key, std::size_t cells)
    : file_(SideFile::named(path)), outlives_(true), kept_(cells) {
  if (file_.size() < kFirst) {
    file_.cut(0);
    file_.write(0, kMagic, sizeof kMagic);
    file_.write(sizeof kMagic, key.data(), kKey);
    end_ = kFirst;
    return;
  }
  take_over(key);
}

void SurfaceFile::take_over(const std::string &key) {
  char magic[sizeof kMagic], held[kKey];
  file_.read(0, magic, sizeof magic);
  file_.read(sizeof magic, held, kKey);
  if (std::memcmp(magic, kMagic, sizeof kMagic) != 0)
    fail(CONCEG_E_FORMAT, "%s: expected a file of unfinished meshes or none; name another file",
         file_.name().c_str());
  if (key.compare(0, kKey, held, kKey) != 0)
    fail(CONCEG_E_FORMAT,
         "%s: holds unfinished meshes of other cells or other parameters; remove it or name another file",
         file_.name().c_str());
  end_ = kFirst;
  const std::uint64_t size = file_.size();
  while (take_record(size)) {
  }
  file_.cut(end_);
}

// False at the end, or where the file is torn.
bool SurfaceFile::take_record(std::uint64_t size) {
  Head head;
  if (size - end_ < sizeof head) return false;
  file_.read(end_, &head, sizeof head);
  const std::uint64_t words = words_of(sizeof head) + words_of(head.vertices * sizeof(glm::vec3)) +
                              words_of(head.faces * sizeof(glm::uvec3)) + head.base_nodes + 1;
  if (head.words != words || head.cell >= kept_.size() || words > (size - end_) / 8) return false;
  std::vector<std::uint64_t> record(words);
  file_.read(end_, record.data(), words * 8);
  if (record.back() != sum_of(record, words - 1)) return false;
  if (head.first_round) {
    kept_[head.cell] = {end_ + sizeof head,
                        head.vertices,
                        head.faces,
                        {head.origin[0], head.origin[1], head.origin[2]},
                        true};
    CellNotes notes;
    notes.pieces = {head.detached, head.detached_volume, head.cavities, head.cavity_volume,
                    head.soma_found != 0};
    notes.base_faces = head.base_faces, notes.whole_base = head.whole_base != 0;
    notes.base_node.assign(record.end() - 1 - static_cast<std::ptrdiff_t>(head.base_nodes), record.end() - 1);
    taken_over_.emplace_back(head.cell, std::move(notes));
  }
  end_ += words * 8;
  return true;
}

void SurfaceFile::add(const Surface &surface, const CellNotes *notes) {
  static_assert(sizeof(Head) % 8 == 0, "records are made of words");
  const CellNotes none, &n = notes ? *notes : none;
  Head head = {};
  head.cell = surface.cell, head.first_round = notes != nullptr;
  head.vertices = static_cast<std::uint32_t>(surface.vertex.size());
  head.faces = static_cast<std::uint32_t>(surface.face.size());
  for (int axis = 0; axis < 3; axis++)
    head.origin[axis] = surface.origin[axis];
  head.base_faces = n.base_faces, head.base_nodes = n.base_node.size();
  head.detached_volume = n.pieces.detached_volume, head.cavity_volume = n.pieces.cavity_volume;
  head.detached = n.pieces.detached, head.cavities = n.pieces.cavities;
  head.soma_found = n.pieces.soma_found, head.whole_base = n.whole_base;
  const std::size_t vertices = surface.vertex.size() * sizeof(glm::vec3),
                    faces = surface.face.size() * sizeof(glm::uvec3);
  head.words = sizeof head / 8 + words_of(vertices) + words_of(faces) + head.base_nodes + 1;
  std::vector<std::uint64_t> record(head.words);
  std::uint64_t *at = record.data();
  std::memcpy(at, &head, sizeof head), at += sizeof head / 8;
  if (vertices) std::memcpy(at, surface.vertex.data(), vertices), at += words_of(vertices);
  if (faces) std::memcpy(at, surface.face.data(), faces), at += words_of(faces);
  if (head.base_nodes) std::memcpy(at, n.base_node.data(), head.base_nodes * 8);
  record.back() = sum_of(record, record.size() - 1);
  std::uint64_t start;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    start = end_, end_ += record.size() * 8;
    kept_[surface.cell] = {start + sizeof head, head.vertices, head.faces, surface.origin,
                           notes && outlives_};
  }
  file_.write(start, record.data(), record.size() * 8);
}

void SurfaceFile::move(std::uint32_t cell, const std::vector<MovedVertex> &moved) {
  Kept &kept = kept_[cell];
  if (kept.for_later) { // moved in a copy
    Surface copy;
    copy.cell = cell, copy.origin = kept.origin;
    copy.vertex.resize(kept.vertices), copy.face.resize(kept.faces);
    file_.read(kept.at, copy.vertex.data(), kept.vertices * sizeof(glm::vec3));
    file_.read(kept.at + 8 * words_of(kept.vertices * sizeof(glm::vec3)), copy.face.data(),
               kept.faces * sizeof(glm::uvec3));
    for (const MovedVertex &v : moved)
      copy.vertex[v.vertex] = v.place;
    add(copy, nullptr);
    return;
  }
  for (const MovedVertex &v : moved)
    file_.write(kept.at + v.vertex * sizeof v.place, &v.place, sizeof v.place);
}

Views SurfaceFile::views() {
  Mapping now(file_, end_);
  mapping_.swap(now);
  Views views;
  for (std::uint32_t cell = 0; cell < kept_.size(); cell++) {
    const Kept &kept = kept_[cell];
    if (!kept.faces) continue;
    SurfaceView view;
    view.cell = cell, view.origin = kept.origin, view.vertices = kept.vertices, view.faces = kept.faces;
    const std::byte *data = mapping_.data() + kept.at;
    view.relative = reinterpret_cast<const glm::vec3 *>(data);
    view.face = reinterpret_cast<const glm::uvec3 *>(data + 8 * words_of(kept.vertices * sizeof(glm::vec3)));
    views.push_back(view);
  }
  return views;
}

} // namespace conceg::mesh
