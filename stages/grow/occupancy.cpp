// SPDX-License-Identifier: BSD-3-Clause
#include "occupancy.hpp"

#include "geometry.hpp"

#include <algorithm>
#include <limits>

namespace conceg::grow {

namespace {

constexpr double grid_step_um = 1.0;
constexpr double contact_margin_um = 1e-6; // far above rounding, far below anything seen
constexpr double largest_reach_um = 1.0;   // of the field when capsules decide exactly

glm::dvec3 half_of(const Segment &segment) {
  return glm::dvec3(segment.half);
}

Region region_around(const glm::dvec3 &point, double margin) {
  return {point - margin, point + margin};
}

// The image of the difference d nearest to zero, and how many sides were taken off.
glm::dvec3 nearest_image(const conceg_box &box, glm::dvec3 d, int taken[3]) {
  for (int a = 0; a < 3; a++) {
    taken[a] = 0;
    if (!box.periodic[a]) continue;
    const double side = conceg_box_side(&box, a);
    if (std::fabs(d[a]) < 0.49 * side) continue; // nearly always: spares a division
    taken[a] = static_cast<int>(__builtin_floor(d[a] / side + 0.5));
    d[a] -= side * taken[a];
  }
  return d;
}

// Two nearest owners: by distance, then by owner, so that the order of insertion does not matter.
bool nearer(float d1, std::uint32_t o1, float d2, std::uint32_t o2) {
  return d1 < d2 || (d1 == d2 && o1 < o2);
}

void insert_owner(NodeField &field, float distance, std::uint32_t owner) {
  if (field.owner1 == owner) {
    field.distance1 = std::min(field.distance1, distance);
  } else if (nearer(distance, owner, field.distance1, field.owner1)) {
    field.distance2 = field.distance1, field.owner2 = field.owner1;
    field.distance1 = distance, field.owner1 = owner;
  } else if (field.owner2 == owner) {
    field.distance2 = std::min(field.distance2, distance);
  } else if (nearer(distance, owner, field.distance2, field.owner2)) {
    field.distance2 = distance, field.owner2 = owner;
  }
}

// Distance of a node to a segment's surface; at least `reach` where it is not less.
float surface_distance(const Input &input, const Segment &segment, const glm::dvec3 &place, float reach) {
  int taken[3];
  const glm::dvec3 d = nearest_image(input.box, place - segment.middle, taken);
  const double far = static_cast<double>(segment.half_length) + segment.radius + reach + 1e-4;
  if (glm::dot(d, d) > far * far) return reach;
  return static_cast<float>(point_segment_distance(d, glm::dvec3(0.0), half_of(segment)) - segment.radius);
}

// Whether an entry's segment is surely farther from a place than `within`; single precision proposes.
bool passed_over(const conceg_box &box, const Entry &entry, const glm::dvec3 &place, double within) {
  float square = 0.0f;
  for (int a = 0; a < 3; a++) {
    float d = static_cast<float>(place[a]) - entry.middle[a];
    if (box.periodic[a]) {
      const auto side = static_cast<float>(conceg_box_side(&box, a));
      if (std::fabs(d) >= 0.49f * side) d -= side * __builtin_floorf(d / side + 0.5f);
    }
    square += d * d;
  }
  const float far = entry.bound + static_cast<float>(within);
  return square > far * far;
}

NodeField empty_field(const Space &space, std::uint32_t node) {
  const auto reach = static_cast<float>(space.reach);
  NodeField field{reach, reach, none, none};
  // What nobody owns limits every cell: it stands on both places.
  if (!space.obstacle.empty() && space.obstacle[node] < reach)
    field.distance1 = field.distance2 = space.obstacle[node];
  return field;
}

void bucket_nodes(Space &space, const Network &network) {
  std::vector<std::uint32_t> cell_of(network.nodes);
  space.site_offset.assign(space.grid.cells() + 1, 0);
  for (std::uint32_t node = 0; node < network.nodes; node++) {
    std::uint32_t cell = 0;
    for_grid_cells(space.grid, region_around(network.at(node), 0.0),
                   [&](std::size_t c) { cell = static_cast<std::uint32_t>(c); });
    cell_of[node] = cell;
    space.site_offset[cell + 1]++;
  }
  for (std::size_t cell = 0; cell < space.grid.cells(); cell++)
    space.site_offset[cell + 1] += space.site_offset[cell];
  space.sites.resize(network.nodes), space.site_of.resize(network.nodes);
  std::vector<std::uint64_t> next(space.site_offset.begin(), space.site_offset.end() - 1);
  for (std::uint32_t node = 0; node < network.nodes; node++) {
    const std::uint64_t place = next[cell_of[node]]++;
    space.site_of[node] = static_cast<std::uint32_t>(place);
    space.sites[place] = {network.at(node), empty_field(space, node), node, none};
  }
}

void place_somas(State &state) {
  Space &space = state.space;
  const Cells &cells = state.input.cells;
  for (std::uint32_t cell = 0; cell < cells.count; cell++) {
    if (!(cells.radius[cell] > 0.0f)) continue;
    const glm::dvec3 soma = cells.at(cell);
    space.segments.push_back(make_segment(state.input.box, soma, soma, cells.radius[cell], cell, none, 0.0));
    const auto id = static_cast<std::uint32_t>(space.segments.size() - 1);
    space.segments[id].in_field = 1;
    insert_capsule(space, id);
    lower_field(state.input, space, id);
  }
}

// A node whose allowed radius is smaller than the somas explain stands beside something that no cell owns.
void find_obstacles(State &state) {
  const Network &network = state.input.network;
  Space &space = state.space;
  float cap = 0.0f;
  for (std::size_t node = 0; node < network.nodes; node++)
    cap = std::max(cap, network.radius[node]);
  const float reach = static_cast<float>(space.reach), tolerance = 1e-3f;
  for (std::uint32_t node = 0; node < network.nodes; node++) {
    const float radius = network.radius[node];
    if (radius >= std::min(cap, reach) || radius >= space.site(node).field.distance1 - tolerance) continue;
    if (space.obstacle.empty()) space.obstacle.assign(network.nodes, reach);
    space.obstacle[node] = radius;
  }
  if (space.obstacle.empty()) return;
  for (std::uint32_t node = 0; node < network.nodes; node++)
    space.site(node).field = fresh_field(state.input, space, node);
}

// Room left around a segment beside its own soma, which it may leave but not enter again.
bool clear_of_own_soma(double distance, double path, double need) {
  return distance >= -contact_margin_um && distance >= std::min(need, 0.3 * path) - contact_margin_um;
}

} // namespace

Grid make_grid(const conceg_box &box, double step_um) {
  Grid grid;
  for (int a = 0; a < 3; a++) {
    const double side = conceg_box_side(&box, a);
    grid.count[a] = std::max(1, static_cast<int>(side / step_um));
    grid.lo[a] = box.lo[a];
    grid.step[a] = side / grid.count[a];
    grid.periodic[a] = box.periodic[a] != 0;
  }
  return grid;
}

Segment make_segment(const conceg_box &box, const glm::dvec3 &a, const glm::dvec3 &b, double radius,
                     std::uint32_t cell, std::uint32_t bar, double path_middle) {
  Segment segment;
  const glm::dvec3 middle = 0.5 * (a + b);
  segment.half = glm::vec3(0.5 * (b - a));
  segment.half_length = static_cast<float>(0.5 * glm::distance(a, b));
  segment.radius = static_cast<float>(radius);
  segment.cell = cell, segment.bar = bar, segment.path = static_cast<float>(path_middle);
  for (int axis = 0; axis < 3; axis++) {
    const int lift = conceg_box_lift(&box, axis, middle[axis]);
    segment.lift[axis] = static_cast<std::int16_t>(lift);
    segment.middle[axis] = lift ? middle[axis] - lift * conceg_box_side(&box, axis) : middle[axis];
  }
  segment.alive = 1;
  return segment;
}

Region region_of(const Segment &segment, double margin) {
  const glm::dvec3 extent = glm::abs(half_of(segment)) + (segment.radius + margin);
  return {segment.middle - extent, segment.middle + extent};
}

void insert_capsule(Space &space, std::uint32_t id) {
  const Segment &segment = space.segments[id];
  const Region region = region_of(segment, 0.0);
  Entry entry{{}, segment.half_length + segment.radius + 1e-4f, id, {}};
  for (int a = 0; a < 3; a++) {
    entry.middle[a] = static_cast<float>(segment.middle[a]);
    entry.first[a] = grid_range(space.grid, region, a).first;
    const double side = space.grid.step[a] * space.grid.count[a];
    entry.bound += 2.5e-7f * static_cast<float>(std::fabs(space.grid.lo[a]) + side);
  }
  for_grid_cells(space.grid, region, [&](std::size_t cell) { space.segment_list[cell].push_back(entry); });
}

void remove_capsule(Space &space, std::uint32_t id) {
  for_grid_cells(space.grid, region_of(space.segments[id], 0.0), [&](std::size_t cell) {
    std::vector<Entry> &list = space.segment_list[cell];
    const auto found =
        std::find_if(list.begin(), list.end(), [&](const Entry &entry) { return entry.segment == id; });
    if (found == list.end()) return;
    *found = list.back();
    list.pop_back();
  });
  space.segments[id].alive = 0;
}

void lower_field(const Input &input, Space &space, std::uint32_t id) {
  const Segment &segment = space.segments[id];
  const auto reach = static_cast<float>(space.reach);
  for_grid_cells(space.grid, region_of(segment, space.reach), [&](std::size_t cell) {
    for (std::uint64_t i = space.site_offset[cell]; i < space.site_offset[cell + 1]; i++) {
      Site &site = space.sites[i];
      const float distance = surface_distance(input, segment, site.place, reach);
      if (distance < reach) insert_owner(site.field, distance, segment.cell);
    }
  });
}

NodeField fresh_field(const Input &input, const Space &space, std::uint32_t node) {
  NodeField field = empty_field(space, node);
  const auto reach = static_cast<float>(space.reach);
  const glm::dvec3 place = input.network.at(node);
  for_grid_cells(space.grid, region_around(place, space.reach), [&](std::size_t cell) {
    for (const Entry &entry : space.segment_list[cell]) {
      if (passed_over(input.box, entry, place, space.reach)) continue;
      const Segment &segment = space.segments[entry.segment];
      if (!segment.in_field) continue;
      const float distance = surface_distance(input, segment, place, reach);
      if (distance < reach) insert_owner(field, distance, segment.cell);
    }
  });
  return field;
}

void restore_field(const Input &input, Space &space, const std::vector<Segment> &removed) {
  const auto reach = static_cast<float>(space.reach);
  for (const Segment &segment : removed) {
    for_grid_cells(space.grid, region_of(segment, space.reach), [&](std::size_t cell) {
      for (std::uint64_t i = space.site_offset[cell]; i < space.site_offset[cell + 1]; i++) {
        NodeField &field = space.sites[i].field;
        if (field.owner1 != segment.cell && field.owner2 != segment.cell) continue;
        const float distance = surface_distance(input, segment, space.sites[i].place, reach);
        if (distance >= reach) continue;
        // A min field cannot be decremented: only where the removed piece was the minimum it is made anew.
        const float held = field.owner1 == segment.cell ? field.distance1 : field.distance2;
        if (distance <= held) field = fresh_field(input, space, space.sites[i].node);
      }
    });
  }
}

double tree_distance(const State &state, std::uint32_t bar1, double path1, std::uint32_t bar2, double path2,
                     double limit) {
  const auto &projections = state.projections;
  if (projections[bar1].tree != projections[bar2].tree) return std::numeric_limits<double>::infinity();
  const auto depth_of = [&](std::uint32_t bar) {
    int depth = 0;
    while (projections[bar].host != none)
      bar = projections[bar].host, depth++;
    return depth;
  };
  int depth1 = depth_of(bar1), depth2 = depth_of(bar2);
  double distance = 0.0;
  const auto climb = [&](std::uint32_t &bar, double &path, int &depth) {
    distance += std::max(0.0, path - projections[bar].start_path);
    path = projections[bar].start_path, bar = projections[bar].host, depth--;
  };
  while (bar1 != bar2 && distance <= limit) {
    if (depth1 == 0 && depth2 == 0) return std::numeric_limits<double>::infinity();
    if (depth1 >= depth2)
      climb(bar1, path1, depth1);
    else
      climb(bar2, path2, depth2);
  }
  return distance + (bar1 == bar2 ? std::fabs(path1 - path2) : 0.0);
}

double clearance(const State &state, const Segment &segment, double want, double need) {
  const Space &space = state.space;
  const glm::dvec3 half = half_of(segment);
  double room = want;
  bool blocked = false;
  Region region = region_of(segment, 0.0);
  region.lo -= want - segment.radius, region.hi += want - segment.radius;
  const auto meet = [&](const Segment &other) {
    int taken[3];
    const glm::dvec3 between = -nearest_image(state.input.box, other.middle - segment.middle, taken);
    const double far = segment.half_length + other.half_length + other.radius + room + 1e-4;
    if (glm::dot(between, between) > far * far) return;
    const double distance = segment_segment_distance(between, half, half_of(other)) - other.radius;
    if (distance >= room + contact_margin_um) return;
    if (other.cell == segment.cell) {
      bool same_image = true;
      for (int a = 0; a < 3; a++)
        same_image &= segment.lift[a] - taken[a] == other.lift[a];
      if (same_image && other.bar == none) {
        if (!clear_of_own_soma(distance, segment.path - segment.half_length, need)) blocked = true;
        return;
      }
      if (same_image) {
        const double near = 2.0 + 4.0 * (other.radius + want);
        if (tree_distance(state, segment.bar, segment.path, other.bar, other.path, near) <= near) return;
      }
    }
    room = distance - contact_margin_um;
    if (room < need) blocked = true;
  };
  for_grid_places(space.grid, region, [&](std::size_t cell, const int place[3], const bool edge[3]) {
    if (blocked) return;
    for (const Entry &entry : space.segment_list[cell]) {
      // Once: in the first grid cell that both regions touch.
      if (!(edge[0] || place[0] == entry.first[0]) || !(edge[1] || place[1] == entry.first[1]) ||
          !(edge[2] || place[2] == entry.first[2]))
        continue;
      if (passed_over(state.input.box, entry, segment.middle, segment.half_length + room)) continue;
      meet(space.segments[entry.segment]);
      if (blocked) return;
    }
  });
  return blocked ? -1.0 : room;
}

void make_space(State &state) {
  Space &space = state.space;
  const Bars &bars = state.input.bars;
  double largest = state.parameters.r_min_um;
  for (std::size_t bar = 0; bar < bars.count; bar++) {
    const double half_span = 0.5 * (bars.asked_end[bar] - bars.asked_start[bar]);
    largest = std::max(
        {largest, bars.radius[bar] + std::fabs(bars.taper[bar]) * half_span, bars.radius_floor[bar]});
  }
  // With nodes alone deciding, the field must know every radius that a process can have.
  space.reach =
      state.parameters.occupancy == Occupancy::nodes ? largest : std::min(largest, largest_reach_um);
  space.grid = make_grid(state.input.box, grid_step_um);
  space.segment_list.assign(space.grid.cells(), {});
  bucket_nodes(space, state.input.network);
  place_somas(state);
  find_obstacles(state);
}

} // namespace conceg::grow
