// SPDX-License-Identifier: BSD-3-Clause
// Volumes by face label of bodies whose volumes are known, and the three radii.
#include "truth.hpp"
#include "guard.hpp"

#include "check.h"

#include <cmath>

using namespace conceg;
using namespace conceg::fit;

namespace {

constexpr double pi = 3.14159265358979323846;

struct Body {
  std::vector<double> vertex;
  std::vector<std::uint32_t> face;
  std::vector<std::uint8_t> compartment;
  Surfaces surfaces() const {
    Surfaces s;
    s.cell = {0}, s.vertex_offset = {0, vertex.size() / 3}, s.face_offset = {0, face.size() / 3};
    s.vertex = vertex.data(), s.face = face.data(), s.compartment = compartment.data();
    return s;
  }
};

struct Ring {
  double radius, z;
  std::uint8_t below; // label of the band between this ring and the next
};

// A closed surface of revolution; the first and the last ring have radius 0.
Body revolved(const std::vector<Ring> &rings, std::uint32_t n, double shift) {
  Body body;
  const auto add = [&](double x, double y, double z) {
    body.vertex.insert(body.vertex.end(), {x + shift, y - shift, z + shift});
  };
  const auto at = [&](std::size_t ring, std::uint32_t k) {
    if (ring == 0) return std::uint32_t{0};
    if (ring + 1 == rings.size()) return static_cast<std::uint32_t>(1 + (rings.size() - 2) * n);
    return static_cast<std::uint32_t>(1 + (ring - 1) * n) + k % n;
  };
  for (std::size_t i = 0; i < rings.size(); i++)
    for (std::uint32_t k = 0; k < (i == 0 || i + 1 == rings.size() ? 1 : n); k++)
      add(rings[i].radius * std::cos(2 * pi * k / n), rings[i].radius * std::sin(2 * pi * k / n), rings[i].z);
  for (std::size_t i = 0; i + 1 < rings.size(); i++)
    for (std::uint32_t k = 0; k < n; k++) {
      const std::uint32_t a = at(i, k), b = at(i, k + 1), c = at(i + 1, k), d = at(i + 1, k + 1);
      if (c != d) body.face.insert(body.face.end(), {a, c, d}), body.compartment.push_back(rings[i].below);
      if (a != b) body.face.insert(body.face.end(), {a, d, b}), body.compartment.push_back(rings[i].below);
    }
  return body;
}

// A ball of radius 5 with a process of radius 1 above and one of radius 0.5 below, 10 um long each.
Body cell(double shift) {
  std::vector<Ring> rings = {{0, 20, 4}, {1, 20, 4}};
  const double top = std::sqrt(24.0), bottom = -std::sqrt(24.75);
  rings.push_back({1, top, 1});
  const int steps = 400;
  const double from = std::acos(top / 5), to = std::acos(bottom / 5);
  for (int i = 1; i < steps; i++) {
    const double angle = from + (to - from) * i / steps;
    rings.push_back({5 * std::sin(angle), 5 * std::cos(angle), 1});
  }
  rings.push_back({0.5, bottom, 3}), rings.push_back({0.5, -12, 3}), rings.push_back({0, -12, 3});
  return revolved(rings, 400, shift);
}

void volumes() {
  const double top = std::sqrt(24.0), bottom = std::sqrt(24.75);
  const auto cap = [](double h) { return pi * h * h * (15.0 - h) / 3.0; };
  const double soma = 4.0 / 3.0 * pi * 125 - cap(5 - top) - cap(5 - bottom);
  const double processes = pi * (20 - top) + 0.25 * pi * (12 - bottom);
  for (const double shift : {0.0, 500.0}) {
    const Body body = cell(shift);
    const SomaVolume v = soma_volume(body.surfaces(), 0);
    CHECK_NEAR(v.soma, soma, 1e-4 * soma); // 400 corners take 4e-5 off
    CHECK_NEAR(v.total - v.soma, processes, 1e-3 * processes);
  }
  // All soma; no soma; a nucleus is part of it.
  Body body = cell(0);
  const double total = soma_volume(body.surfaces(), 0).total;
  for (std::uint8_t &code : body.compartment)
    code = code == 1 ? 19 : 1;
  CHECK_NEAR(soma_volume(body.surfaces(), 0).soma, total, 1e-9 * total);
  body.compartment.assign(body.compartment.size(), 3);
  CHECK_NEAR(soma_volume(body.surfaces(), 0).soma, 0.0, 0);
  body.face[7] = 1000000;
  try {
    soma_volume(body.surfaces(), 0);
    CHECK(false);
  } catch (const Error &error) {
    CHECK_EQUAL(error.status(), CONCEG_E_FORMAT);
  }
}

void three_radii() {
  const Radii r = radii_of({6, 8, 0, 0});
  CHECK_NEAR(r.mean, 7, 1e-12);
  CHECK_NEAR(r.volume_weighted, (1296.0 + 4096.0) / (216.0 + 512.0), 1e-12);
  CHECK_NEAR(r.effective, std::pow((279936.0 + 2097152.0) / 728.0, 0.25), 1e-12);
  CHECK_NEAR(radii_of({5, 5}).effective, 5, 1e-12);
  CHECK_NEAR(radii_of({}).mean, 0, 0);
}

} // namespace

int main() {
  volumes();
  three_radii();
  return check_done();
}
