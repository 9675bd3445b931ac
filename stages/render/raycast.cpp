// SPDX-License-Identifier: BSD-3-Clause
#include "raycast.hpp"

#include "embree_scene.hpp"

#include <glm/geometric.hpp>

#include <atomic>
#include <cmath>

namespace conceg::rendering {
namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;
constexpr int tile_pixels = 32;
constexpr int filter_reach = 2; // samples on each side over which ambient occlusion is averaged
constexpr int occlusion_rays = 2;
constexpr double wire_px = 1.1; // width of the edges of triangles
const Colour edge_colour(0.16f, 0.18f, 0.22f);

// What a sample of the picture saw.
struct Sample {
  Colour albedo = Colour(0.0f); // linear
  glm::vec3 normal = glm::vec3(0.0f);
  float direct = 0.0f, occlusion = 0.0f, depth = 0.0f;
  std::int32_t body = nothing;
  static constexpr std::int32_t nothing = -1, edge = -2;
};

std::uint32_t hash(std::uint32_t x) {
  x ^= x >> 16, x *= 0x7feb352du, x ^= x >> 15, x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

// Points of [0, 1)^2 that fill it evenly (Roberts' R2 sequence).
glm::dvec2 even_point(std::uint32_t n) {
  const double a = 0.5 + n * 0.75487766624669276, b = 0.5 + n * 0.56984029099805327;
  return {a - std::floor(a), b - std::floor(b)};
}

glm::dvec3 around(const glm::dvec3 &normal, const glm::dvec2 &u) {
  const glm::dvec3 helper = std::fabs(normal.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 s = glm::normalize(glm::cross(normal, helper)), t = glm::cross(normal, s);
  const double radius = std::sqrt(u.x), angle = 360.0 * degree * u.y;
  return radius * std::cos(angle) * s + radius * std::sin(angle) * t + std::sqrt(1.0 - u.x) * normal;
}

class Caster {
public:
  Caster(const Scene &scene, const RayScene &rays, const Camera &camera, const Frame &view)
      : scene_(scene), rays_(rays), camera_(camera), view_(view),
        key_(glm::normalize(-camera.forward() + 0.55 * camera.up() - 0.75 * camera.right())),
        occlusion_reach_(0.12 * glm::length(scene.hi - scene.lo) / std::sqrt(3.0)),
        step_(1e-5 * glm::length(scene.hi - scene.lo)) {
    for (const Body &body : scene.bodies)
      albedo_.push_back(to_linear(body.colour));
  }

  Sample cast(int sx, int sy) const {
    const double step = view_.um_per_pixel / view_.samples_per_side;
    const glm::dvec2 at((sx + 0.5) * step - 0.5 * view_.width * view_.um_per_pixel,
                        0.5 * view_.height * view_.um_per_pixel - (sy + 0.5) * step);
    const glm::dvec3 start = camera_.start(at);
    Sample sample;
    double from = 0.0, to = camera_.depth();
    const double edge = rays_.edge_distance(start, camera_.forward());
    RayHit hit;
    if (clip_to_box(scene_, start, camera_.forward(), from, to)) hit = first_in_box(start, from, to);
    if (hit.body < 0 && !std::isfinite(edge)) return sample;
    if (hit.body < 0 || edge < hit.distance) {
      sample.body = Sample::edge, sample.depth = static_cast<float>(edge),
      sample.albedo = to_linear(edge_colour);
      return sample;
    }
    shade(start, from, hit, sx, sy, sample);
    return sample;
  }

  // The finished colour of a sample, in linear light.
  Colour finish(const Sample &sample, float occlusion) const {
    if (sample.body == Sample::edge) return sample.albedo;
    const float head = std::max(0.0f, glm::dot(sample.normal, glm::vec3(-camera_.forward())));
    const float light =
        0.42f * occlusion + 0.30f * head * (0.35f + 0.65f * occlusion) + 0.55f * sample.direct;
    // Far parts fade towards the paper, which reads as depth.
    const float fade = 0.30f * glm::clamp(sample.depth / static_cast<float>(camera_.depth()), 0.0f, 1.0f);
    return glm::mix(sample.albedo * light * 1.12f, Colour(0.86f), fade * fade + 0.25f * fade);
  }

private:
  // The first surface in the box, or the cut face of the cell in which the ray enters it.
  RayHit first_in_box(const glm::dvec3 &start, double from, double to) const {
    const glm::dvec3 entry = start + from * camera_.forward();
    RayHit hit = rays_.first(start, camera_.forward(), from, to);
    if (!scene_.clipped || from <= 0.0 || hit.inside) return hit;
    // Cones overlap within a cell, so a ray that begins in one may first meet another from outside: their
    // owner is asked for.
    std::int32_t owner = rays_.cone_owner(entry);
    if (owner < 0 && hit.body < 0) {
      // Near an edge of the box a ray may leave it again within the same cell: a ray to the middle tells.
      const glm::dvec3 inward = 0.5 * (scene_.lo + scene_.hi) - entry;
      const double length = glm::length(inward);
      const RayHit wall = length > 0.0 ? rays_.first(entry, inward / length, 0.0, length) : RayHit();
      if (wall.inside) owner = wall.body;
    }
    if (owner >= 0) hit.body = owner, hit.inside = true, hit.distance = from;
    return hit;
  }

  void shade(const glm::dvec3 &start, double from, const RayHit &hit, int sx, int sy, Sample &sample) const {
    glm::dvec3 normal = hit.normal, place = start + hit.distance * camera_.forward();
    sample.body = hit.body, sample.depth = static_cast<float>(hit.distance);
    sample.albedo = albedo_[static_cast<std::size_t>(hit.body)];
    if (!hit.inside && hit.rim < 0.5 * wire_px * view_.um_per_pixel)
      sample.albedo = glm::mix(sample.albedo, to_linear(edge_colour), 0.55f);
    if (hit.inside) { // the ray entered the box within a cell: the cell's cut face is seen
      place = start + from * camera_.forward(), normal = box_normal(scene_, place),
      sample.depth = static_cast<float>(from);
      sample.albedo = glm::mix(sample.albedo, Colour(1.0f), 0.10f);
    } else if (glm::dot(normal, camera_.forward()) > 0.0) {
      normal = glm::normalize(normal - 1.02 * glm::dot(normal, camera_.forward()) *
                                           camera_.forward()); // smoothed beyond the rim
    }
    sample.normal = glm::vec3(normal);
    const glm::dvec3 above = place + step_ * normal;
    const double facing = glm::dot(normal, key_);
    if (facing > 0.0 && !blocked(above, key_, glm::length(scene_.hi - scene_.lo)))
      sample.direct = static_cast<float>(facing);
    // 16 patterns repeat over 4 x 4 samples; the filter averages over more than one period.
    const std::uint32_t pattern = static_cast<std::uint32_t>((sx & 3) + 4 * (sy & 3));
    int open = 0;
    for (std::uint32_t k = 0; k < occlusion_rays; k++) {
      const std::uint32_t number = pattern * occlusion_rays + k;
      const double share = ((hash(number) & 1023u) + 0.5) / 1024.0;
      open += !blocked(above, around(normal, even_point(number)), occlusion_reach_ * (0.15 + 0.85 * share));
    }
    sample.occlusion = static_cast<float>(open) / occlusion_rays;
  }

  bool blocked(const glm::dvec3 &start, const glm::dvec3 &direction, double length) const {
    double from = 0.0, to = length;
    return clip_to_box(scene_, start, direction, from, to) && rays_.blocked(start, direction, to);
  }

  const Scene &scene_;
  const RayScene &rays_;
  const Camera &camera_;
  const Frame view_;
  const glm::dvec3 key_; // towards the main light
  const double occlusion_reach_, step_;
  std::vector<Colour> albedo_;
};

// One square of the picture: casts its samples with a margin, averages the occlusion over neighbours of like
// depth and direction, and blends the result over the picture.
class TilePainter {
public:
  TilePainter(const Caster &caster, const Frame &view, double depth_tolerance)
      : caster_(caster), view_(view), depth_tolerance_(static_cast<float>(depth_tolerance)) {}

  void paint(Image &image, int left, int top) {
    const int per_pixel = view_.samples_per_side;
    const int width = std::min(tile_pixels, view_.width - left),
              height = std::min(tile_pixels, view_.height - top);
    columns_ = width * per_pixel + 2 * filter_reach;
    const int rows = height * per_pixel + 2 * filter_reach;
    samples_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows), Sample());
    for (int y = 0; y < rows; y++)
      for (int x = 0; x < columns_; x++)
        at(x, y) = caster_.cast(left * per_pixel + x - filter_reach, top * per_pixel + y - filter_reach);
    for (int y = 0; y < height; y++)
      for (int x = 0; x < width; x++) {
        Colour sum(0.0f);
        int covered = 0;
        for (int j = 0; j < per_pixel; j++)
          for (int i = 0; i < per_pixel; i++) {
            const int sx = filter_reach + x * per_pixel + i, sy = filter_reach + y * per_pixel + j;
            if (at(sx, sy).body == Sample::nothing) continue;
            sum += to_srgb(caster_.finish(at(sx, sy), occlusion(sx, sy)));
            covered++;
          }
        if (!covered) continue;
        Colour &pixel = image.at(view_.left + left + x, view_.top + top + y);
        const float all = static_cast<float>(per_pixel * per_pixel);
        pixel = sum / all + pixel * (1.0f - static_cast<float>(covered) / all);
      }
  }

private:
  Sample &at(int x, int y) {
    return samples_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(x)];
  }

  float occlusion(int sx, int sy) {
    const Sample &centre = at(sx, sy);
    float sum = 0.0f, weight = 0.0f;
    for (int y = sy - filter_reach; y <= sy + filter_reach; y++)
      for (int x = sx - filter_reach; x <= sx + filter_reach; x++) {
        const Sample &other = at(x, y);
        if (other.body != centre.body || std::fabs(other.depth - centre.depth) > depth_tolerance_) continue;
        const float alike = glm::dot(other.normal, centre.normal);
        if (alike < 0.7f) continue;
        // The outer columns and rows of the 5 x 5 window count half, so that each of the 4 x 4 patterns
        // weighs the same.
        const float w = (std::abs(x - sx) == filter_reach ? 0.5f : 1.0f) *
                        (std::abs(y - sy) == filter_reach ? 0.5f : 1.0f);
        sum += w * other.occlusion, weight += w;
      }
    return weight > 0.0f ? sum / weight : centre.occlusion;
  }

  const Caster &caster_;
  const Frame &view_;
  const float depth_tolerance_;
  int columns_ = 0;
  std::vector<Sample> samples_;
};

} // namespace

Camera::Camera(const Scene &scene, double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * degree, e = elevation_deg * degree;
  forward_ = -glm::dvec3(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
  right_ = glm::dvec3(-std::sin(a), std::cos(a), 0.0);
  up_ = glm::cross(right_, forward_);
  middle_ = 0.5 * (scene.lo + scene.hi);
  const glm::dvec3 size = scene.hi - scene.lo;
  const auto reach = [&](const glm::dvec3 &axis) { return glm::dot(glm::abs(axis), size); };
  extent_ = {reach(right_), reach(up_)};
  depth_ = reach(forward_) * (1.0 + 1e-6);
}

glm::dvec2 Camera::project(const glm::dvec3 &p) const {
  return {glm::dot(p - middle_, right_), glm::dot(p - middle_, up_)};
}

void draw_scene(Image &image, const Frame &view, const Scene &scene, const RayScene &rays,
                const Camera &camera, Workers &workers, const Progress &progress) {
  const Caster caster(scene, rays, camera, view);
  const int across = (view.width + tile_pixels - 1) / tile_pixels,
            down = (view.height + tile_pixels - 1) / tile_pixels;
  const auto tiles = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  std::atomic<std::size_t> done{0};
  workers.loop(tiles, 1, [&](std::size_t i, unsigned) {
    TilePainter painter(caster, view, 8.0 * view.um_per_pixel);
    painter.paint(image, static_cast<int>(i % static_cast<std::size_t>(across)) * tile_pixels,
                  static_cast<int>(i / static_cast<std::size_t>(across)) * tile_pixels);
    report(progress, "render: rays", ++done, tiles);
  });
}

} // namespace conceg::rendering
