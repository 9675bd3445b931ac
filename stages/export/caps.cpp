// SPDX-License-Identifier: BSD-3-Clause
#include "caps.hpp"
#include "guard.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace conceg::exporting {
namespace {

using Wide = __int128;

struct Corner {
  std::int64_t u, v; // 2^-24 um
  std::uint32_t vertex;
};
using Polygon = std::vector<Corner>;

bool same_place(const Corner &a, const Corner &b) {
  return a.u == b.u && a.v == b.v;
}

// Twice the area of a triangle, exactly.
Wide turn(const Corner &a, const Corner &b, const Corner &c) {
  return Wide(b.u - a.u) * (c.v - a.v) - Wide(b.v - a.v) * (c.u - a.u);
}

Wide twice_area(const Polygon &p) {
  Wide sum = 0;
  for (std::size_t i = 1; i + 1 < p.size(); i++)
    sum += turn(p[0], p[i], p[i + 1]);
  return sum;
}

// Even-odd rule; the point is on no edge.
bool holds(const Polygon &p, const Corner &point) {
  bool inside = false;
  for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++)
    if ((p[i].v > point.v) != (p[j].v > point.v)) {
      const Wide side = turn(p[i], p[j], point);
      inside ^= (p[j].v > p[i].v) == (side > 0);
    }
  return inside;
}

bool in_triangle(const Corner &a, const Corner &b, const Corner &c, const Corner &p) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

// Between two corners, ends left out.
bool on_segment(const Corner &a, const Corner &b, const Corner &p) {
  return turn(a, b, p) == 0 && !same_place(a, p) && !same_place(b, p) &&
         Wide(p.u - a.u) * (p.u - b.u) + Wide(p.v - a.v) * (p.v - b.v) < 0;
}

bool cross(const Corner &a, const Corner &b, const Corner &c, const Corner &d) {
  const Wide c_side = turn(a, b, c), d_side = turn(a, b, d), a_side = turn(c, d, a), b_side = turn(c, d, b);
  return ((c_side > 0 && d_side < 0) || (c_side < 0 && d_side > 0)) &&
         ((a_side > 0 && b_side < 0) || (a_side < 0 && b_side > 0));
}

bool is_free(const Polygon &p, const Corner &a, const Corner &b) {
  for (std::size_t i = 0; i < p.size(); i++)
    if (cross(a, b, p[i], p[(i + 1) % p.size()]) || on_segment(a, b, p[i])) return false;
  return true;
}

// Does the way from corner i of a polygon to a point begin inside?
bool begins_inside(const Polygon &p, std::size_t i, const Corner &to) {
  const Corner &before = p[(i + p.size() - 1) % p.size()], &at = p[i], &after = p[(i + 1) % p.size()];
  const bool left_of_both = turn(before, at, to) > 0 && turn(at, after, to) > 0,
             left_of_one = turn(before, at, to) > 0 || turn(at, after, to) > 0;
  return turn(before, at, after) > 0 ? left_of_both : left_of_one;
}

bool earlier(const Corner &a, const Corner &b) {
  return a.u != b.u ? a.u < b.u : a.v < b.v;
}

// Joins a hole to its outline by a way there and back that crosses nothing.
void bridge(Polygon &outline, const Polygon &hole, const std::vector<Polygon> &holes) {
  struct Way {
    Wide length2;
    std::size_t from, to;
  };
  std::vector<Way> ways;
  for (std::size_t h = 0; h < hole.size(); h++)
    for (std::size_t o = 0; o < outline.size(); o++)
      ways.push_back({Wide(hole[h].u - outline[o].u) * (hole[h].u - outline[o].u) +
                          Wide(hole[h].v - outline[o].v) * (hole[h].v - outline[o].v),
                      h, o});
  std::stable_sort(ways.begin(), ways.end(),
                   [](const Way &l, const Way &r) { return l.length2 < r.length2; });
  for (const Way &way : ways) {
    const Corner &a = hole[way.from], &b = outline[way.to];
    if (!begins_inside(outline, way.to, a) || !begins_inside(hole, way.from, b) || !is_free(outline, a, b) ||
        !std::all_of(holes.begin(), holes.end(), [&](const Polygon &p) { return is_free(p, a, b); }))
      continue;
    Polygon joined(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(way.to) + 1);
    for (std::size_t i = 0; i <= hole.size(); i++)
      joined.push_back(hole[(way.from + i) % hole.size()]);
    joined.insert(joined.end(), outline.begin() + static_cast<std::ptrdiff_t>(way.to), outline.end());
    outline.swap(joined);
    return;
  }
  fail(CONCEG_E_UNSUPPORTED, "caps: a hole of a cut finds no way to its outline");
}

bool is_ear(const Polygon &p, std::size_t i) {
  const Corner &a = p[(i + p.size() - 1) % p.size()], &b = p[i], &c = p[(i + 1) % p.size()];
  if (turn(a, b, c) <= 0) return false;
  return std::none_of(p.begin(), p.end(), [&](const Corner &q) {
    return !same_place(q, a) && !same_place(q, b) && !same_place(q, c) && in_triangle(a, b, c, q);
  });
}

template <class Use> void clip_ears(Polygon p, const Use &use) {
  while (p.size() > 2) {
    std::size_t i = 0;
    while (i < p.size() && !is_ear(p, i))
      i++;
    if (i == p.size()) fail(CONCEG_E_UNSUPPORTED, "caps: a cut's outline touches itself");
    use(p[(i + p.size() - 1) % p.size()].vertex, p[i].vertex, p[(i + 1) % p.size()].vertex);
    p.erase(p.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

class Capper {
public:
  Capper(CutSurface &surface, int axis, double value, int inward)
      : surface_(surface), axis_(axis), value_(value), faces_up_(inward < 0) {}

  void run() {
    find_rims();
    std::vector<Polygon> outlines, holes;
    for (Polygon &loop : loops())
      (twice_area(loop) > 0 ? outlines : holes).push_back(std::move(loop));
    const auto by_place = [](const Polygon &l, const Polygon &r) { return earlier(l[0], r[0]); };
    std::sort(outlines.begin(), outlines.end(), by_place), std::sort(holes.begin(), holes.end(), by_place);
    std::vector<std::vector<Polygon>> holes_of(outlines.size());
    for (const Polygon &hole : holes)
      holes_of[smallest_around(outlines, hole[0])].push_back(hole);
    for (std::size_t i = 0; i < outlines.size(); i++) {
      for (const Polygon &hole : holes_of[i])
        bridge(outlines[i], hole, holes_of[i]);
      const std::uint32_t source = source_of_[outlines[i][0].vertex];
      clip_ears(outlines[i], [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        surface_.face.emplace_back(a, faces_up_ ? b : c, faces_up_ ? c : b);
        surface_.source_face.push_back(source);
      });
    }
  }

private:
  bool in_plane(std::uint32_t vertex) const { return surface_.vertex[vertex][axis_] == value_; }

  // Edges in the plane that have one face; a lid runs along them the other way. Lids on opposite sides are
  // divided alike, both seen from above, so that what cuts them later finds the same edges.
  void find_rims() {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::size_t f = 0; f < surface_.face.size(); f++)
      for (int k = 0; k < 3; k++) {
        const std::uint32_t a = surface_.face[f][k], b = surface_.face[f][(k + 1) % 3];
        if (!in_plane(a) || !in_plane(b)) continue;
        if (!edges.erase({b, a})) edges.insert({a, b});
        source_of_[a] = surface_.source_face[f];
      }
    for (const auto &[a, b] : edges)
      if (!(faces_up_ ? next_.emplace(b, a) : next_.emplace(a, b)).second)
        fail(CONCEG_E_UNSUPPORTED, "caps: two rims of a cut touch at (%g, %g, %g) um", surface_.vertex[b].x,
             surface_.vertex[b].y, surface_.vertex[b].z);
  }

  Corner corner(std::uint32_t vertex) const {
    const auto fixed = [](double x) { return static_cast<std::int64_t>(std::floor(x * 0x1p24 + 0.5)); };
    return {fixed(surface_.vertex[vertex][(axis_ + 1) % 3]), fixed(surface_.vertex[vertex][(axis_ + 2) % 3]),
            vertex};
  }

  // Each begins with its first corner in space, so that images of a cut are treated alike.
  std::vector<Polygon> loops() {
    std::vector<Polygon> out;
    while (!next_.empty()) {
      Polygon loop = {corner(next_.begin()->first)};
      for (auto at = next_.begin(); at != next_.end(); at = next_.find(loop.back().vertex)) {
        loop.push_back(corner(at->second));
        next_.erase(at);
      }
      close(loop);
      out.push_back(std::move(loop));
    }
    return out;
  }

  static void close(Polygon &loop) {
    if (loop.size() < 4 || loop.back().vertex != loop.front().vertex)
      fail(CONCEG_E_UNSUPPORTED, "caps: the rim of a cut is not closed; expected a closed surface");
    loop.pop_back();
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end(), earlier), loop.end());
  }

  static std::size_t smallest_around(const std::vector<Polygon> &outlines, const Corner &point) {
    std::size_t best = outlines.size();
    for (std::size_t i = 0; i < outlines.size(); i++)
      if (holds(outlines[i], point) &&
          (best == outlines.size() || twice_area(outlines[i]) < twice_area(outlines[best])))
        best = i;
    if (best == outlines.size()) fail(CONCEG_E_UNSUPPORTED, "caps: a hole of a cut lies in no outline");
    return best;
  }

  CutSurface &surface_;
  int axis_;
  double value_;
  bool faces_up_;
  std::map<std::uint32_t, std::uint32_t> next_, source_of_;
};

} // namespace

void add_caps(CutSurface &surface, int axis, double value, int inward) {
  Capper(surface, axis, value, inward).run();
}

} // namespace conceg::exporting
