// SPDX-License-Identifier: BSD-3-Clause
// The scene as bytes: positions as 16-bit steps from the corner of all that is drawn.
#include "scene.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace conceg::reporting {
namespace {

constexpr double steps = 65535.0;

template <class T> void append(std::vector<std::uint8_t> &bytes, T value) {
  std::uint8_t raw[sizeof value]; // little-endian, as all machines that ConCeG builds for
  std::memcpy(raw, &value, sizeof value);
  bytes.insert(bytes.end(), raw, raw + sizeof value);
}

template <class T> Block block_of(const char *name, const std::vector<T> &values) {
  Block block{name, {}};
  for (const T &value : values)
    append(block.bytes, value);
  return block;
}

struct Frame {
  glm::dvec3 lo{0.0};
  double step = 1.0; // um
  void append_to(std::vector<std::uint8_t> &bytes, const glm::dvec3 &p) const {
    for (int a = 0; a < 3; a++)
      append(bytes, static_cast<std::uint16_t>(std::clamp(std::round((p[a] - lo[a]) / step), 0.0, steps)));
  }
};

Frame frame_of(const Scene &scene) {
  glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi(-lo);
  const auto take = [&](const glm::dvec3 &p) { lo = glm::min(lo, p), hi = glm::max(hi, p); };
  for (const glm::dvec3 &p : scene.skeleton.runs.position)
    take(p);
  for (const Surface &surface : scene.mesh.surfaces)
    for (const glm::dvec3 &p : surface.vertex)
      take(p);
  if (!(lo.x <= hi.x)) return {};
  const glm::dvec3 size = hi - lo;
  return {lo, std::max({size.x, size.y, size.z, 1e-6}) / steps};
}

} // namespace

std::vector<Block> pack(const Scene &scene, Json &json) {
  const Frame frame = frame_of(scene);
  const Runs &runs = scene.skeleton.runs;
  float widest = 0.0f;
  for (const float radius : runs.radius)
    widest = std::max(widest, radius);

  Block position{"run-position", {}}, radius{"run-radius", {}}, vertex{"mesh-position", {}},
      face{"mesh-face", {}}, soma{"soma", {}};
  for (const glm::dvec3 &p : runs.position)
    frame.append_to(position.bytes, p);
  for (const float r : runs.radius)
    append(radius.bytes, static_cast<std::uint16_t>(std::round(r / widest * static_cast<float>(steps))));
  for (std::size_t i = 0; i < scene.cells; i++) {
    for (int a = 0; a < 3; a++)
      append(soma.bytes, static_cast<float>(scene.soma[i][a]));
    append(soma.bytes, scene.soma_radius[i]);
  }
  json.key("scene").open('{');
  json.key("lo").open('[').number(frame.lo.x).number(frame.lo.y).number(frame.lo.z).close(']');
  json.key("step").number(frame.step).key("radius_step").number(static_cast<double>(widest) / steps);
  json.key("cells").whole(std::uint64_t{scene.cells}).key("points").whole(std::uint64_t{scene.points});
  json.key("faces").whole(scene.faces).key("level").whole(static_cast<std::int64_t>(scene.level));
  json.key("id").open('[');
  for (const std::uint64_t id : scene.id)
    json.whole(id);
  json.close(']').key("surfaces").open('[');
  std::uint32_t base = 0;
  for (const Surface &surface : scene.mesh.surfaces) {
    for (const glm::dvec3 &p : surface.vertex)
      frame.append_to(vertex.bytes, p);
    for (const glm::uvec3 &f : surface.face)
      append(face.bytes, f.x + base), append(face.bytes, f.y + base), append(face.bytes, f.z + base);
    json.open('[').whole(std::uint64_t{surface.cell}).whole(std::uint64_t{surface.vertex.size()});
    json.whole(std::uint64_t{surface.face.size()}).close(']');
    base += static_cast<std::uint32_t>(surface.vertex.size());
  }
  json.close(']').key("left_out").open('[');
  for (const std::string &line : scene.left_out)
    json.text(line);
  json.close(']').close('}');
  return {std::move(position),
          std::move(radius),
          block_of("run-offset", runs.point_offset),
          block_of("run-cell", runs.cell),
          block_of("run-kind", runs.kind),
          std::move(soma),
          block_of("cell-type", scene.type),
          std::move(vertex),
          std::move(face)};
}

} // namespace conceg::reporting
