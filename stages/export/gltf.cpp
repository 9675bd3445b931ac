// SPDX-License-Identifier: BSD-3-Clause
// Binary glTF 2.0 (Khronos): a JSON chunk that names views of one binary chunk.
#include "folder.hpp"
#include "job.hpp"
#include "shapes.hpp"

#include <glm/common.hpp>

namespace conceg::exporting {
namespace {

std::string list(const glm::dvec3 &v) {
  return "[" + number_text(v.x) + "," + number_text(v.y) + "," + number_text(v.z) + "]";
}

void put32(std::string &bytes, std::uint32_t value) {
  for (int i = 0; i < 4; i++)
    bytes += static_cast<char>(value >> (8 * i) & 255u);
}

// A view of `length` bytes that were just added.
std::string view(std::size_t from, std::size_t length, int target) {
  return "{\"buffer\":0,\"byteOffset\":" + std::to_string(from) +
         ",\"byteLength\":" + std::to_string(length) + ",\"target\":" + std::to_string(target) + "}";
}

} // namespace

void write_glb(OutputFile &file, const std::vector<NamedSurface> &surfaces) {
  std::string binary, nodes, meshes, accessors, views, children;
  constexpr int floats = 5126, unsigned_ints = 5125, vertices = 34962, indices = 34963;
  for (std::size_t i = 0; i < surfaces.size(); i++) {
    const Surface &surface = *surfaces[i].surface;
    const std::string comma = i ? "," : "", count = std::to_string(2 * i), next = std::to_string(2 * i + 1);
    const glm::dvec3 origin = surface.vertex[0];
    glm::vec3 low(INFINITY), high(-INFINITY);
    std::size_t from = binary.size();
    for (const glm::dvec3 &p : surface.vertex) {
      const glm::vec3 local(p - origin);
      low = glm::min(low, local), high = glm::max(high, local);
      binary.append(reinterpret_cast<const char *>(&local), sizeof local);
    }
    views += comma + view(from, binary.size() - from, vertices);
    from = binary.size();
    binary.append(reinterpret_cast<const char *>(surface.face.data()),
                  surface.face.size() * sizeof surface.face[0]);
    views += "," + view(from, binary.size() - from, indices);
    accessors += comma + "{\"bufferView\":" + count + ",\"componentType\":" + std::to_string(floats) +
                 ",\"count\":" + std::to_string(surface.vertex.size()) +
                 ",\"type\":\"VEC3\",\"min\":" + list(glm::dvec3(low)) +
                 ",\"max\":" + list(glm::dvec3(high)) + "},{\"bufferView\":" + next +
                 ",\"componentType\":" + std::to_string(unsigned_ints) +
                 ",\"count\":" + std::to_string(3 * surface.face.size()) + ",\"type\":\"SCALAR\"}";
    meshes +=
        comma + "{\"primitives\":[{\"attributes\":{\"POSITION\":" + count + "},\"indices\":" + next + "}]}";
    nodes += ",{\"name\":" + quoted_json(surfaces[i].name) + ",\"mesh\":" + std::to_string(i) +
             ",\"translation\":" + list(origin) + "}";
    children += comma + std::to_string(i + 1);
    if (binary.size() > 0xf0000000u)
      fail(CONCEG_E_UNSUPPORTED, "gltf: a .glb file holds at most 4 GB; export single cells");
  }
  // x y z -> x z -y: a quarter turn about x.
  std::string json =
      "{\"asset\":{\"version\":\"2.0\",\"generator\":\"ConCeG\",\"extras\":{\"length_unit\":\"um\"}},"
      "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
      "\"nodes\":[{\"name\":\"substrate\",\"matrix\":[1,0,0,0,0,0,-1,0,0,1,0,0,0,0,0,1],\"children\":[" +
      children + "]}" + nodes + "],\"meshes\":[" + meshes + "],\"accessors\":[" + accessors +
      "],\"bufferViews\":[" + views + "],\"buffers\":[{\"byteLength\":" + std::to_string(binary.size()) +
      "}]}";
  json.append((4 - json.size() % 4) % 4, ' ');
  std::string head;
  put32(head, 0x46546c67u), put32(head, 2),
      put32(head, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size()));
  put32(head, static_cast<std::uint32_t>(json.size())), put32(head, 0x4e4f534au);
  file.write(head + json);
  head.clear();
  put32(head, static_cast<std::uint32_t>(binary.size())), put32(head, 0x004e4942u);
  file.write(head);
  file.write(binary);
}

} // namespace conceg::exporting
