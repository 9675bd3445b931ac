// SPDX-License-Identifier: BSD-3-Clause
#include "walk.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::simulate {

namespace {

constexpr int bounce_limit = 100;
// A jump is made where the membranes are so many standard deviations of each coordinate away: where the way
// between its ends matters to them (README.md), and where each touch may let the walker through.
constexpr double jump_reach = 3.0, jump_reach_permeable = 5.0;
constexpr std::uint64_t least_jump = 4; // steps; below, single steps are quicker

// The walker while it walks.
struct State {
  glm::dvec3 place, displacement;
  bool inside, gone;
};

class Walker {
public:
  Walker(const Walls &walls, const Timeline &timeline, const Physics &physics, const Start &start,
         std::uint64_t seed, Tally &tally)
      : walls_(walls), timeline_(timeline), physics_(physics),
        directions_(conceg_rng_stream(seed, "simulate.step", start.number)),
        normals_(conceg_rng_stream(seed, "simulate.jump", start.number)),
        passing_(conceg_rng_stream(seed, "simulate.pass", start.number)),
        tally_(tally), state_{start.place, glm::dvec3(0.0), start.inside, false} {
    out_.vector.assign(timeline.shapes, glm::dvec3(0.0));
    begin_interval();
    spot_ = walls_.spot(state_.place);
  }
  // One step or jump; false when the timeline is over.
  bool move();
  Walk result() const;

private:
  const Medium &medium(bool inside) const { return inside ? physics_.intra : physics_.extra; }
  void begin_interval();
  void end_interval();
  void step();
  void jump(double radius);
  void travel(glm::dvec3 rest, double time);
  void advance(const glm::dvec3 &move, double time);
  void bounce(glm::dvec3 move, double time, glm::dvec3 &rest);
  bool passes(std::uint32_t face, double length, const Medium &here);

  const Walls &walls_;
  const Timeline &timeline_;
  const Physics &physics_;
  Directions directions_;
  Normals normals_;
  conceg_rng passing_;
  Tally &tally_;
  State state_;
  Spot spot_;
  Walk out_;
  // The interval that it is in.
  std::size_t interval_ = 0;
  std::uint64_t left_ = 0; // steps
  double begin_ms_ = 0.0, step_ms_ = 0.0;
  bool with_area_ = false;
  glm::dvec3 area_ = glm::dvec3(0.0);                  // integral of the displacement, um ms
  double length_[2], jump_square_[2], jump_radius_[2]; // outside, inside
  double reach_[2]; // longest piece of a jump that stays within the walls' reach where it goes on faster
  double inside_ms_ = 0.0;
};

void Walker::begin_interval() {
  const std::size_t intervals = timeline_.intervals();
  if (interval_ >= intervals) return;
  const double time = timeline_.end[interval_] - begin_ms_;
  const double steps = std::max(1.0, std::ceil(time / physics_.step_ms - 1e-9));
  left_ = static_cast<std::uint64_t>(steps), step_ms_ = time / steps;
  tally_.steps += left_;
  with_area_ = false, area_ = glm::dvec3(0.0);
  for (std::size_t k = 0; k < timeline_.shapes; k++)
    with_area_ |= timeline_.shape[k * intervals + interval_] != 0.0;
  const double longest = std::max(step_length(physics_.intra, 1.0), step_length(physics_.extra, 1.0));
  const double jump_reach_here = physics_.permeability.empty() ? jump_reach : jump_reach_permeable;
  for (const bool inside : {false, true}) {
    const double d = medium(inside).diffusivity;
    length_[inside] = step_length(medium(inside), step_ms_);
    reach_[inside] = walls_.reach_um() * (step_length(medium(inside), 1.0) / longest);
    jump_square_[inside] = jump_reach_here * jump_reach_here * 2.0 * d * step_ms_;
    jump_radius_[inside] = std::sqrt(jump_square_[inside] * static_cast<double>(least_jump)) + clearance_um;
  }
}

void Walker::end_interval() {
  const std::size_t intervals = timeline_.intervals();
  for (std::size_t k = 0; with_area_ && k < timeline_.shapes; k++)
    out_.vector[k] += timeline_.shape[k * intervals + interval_] * area_;
  if (timeline_.record[interval_]) out_.displacement.push_back(state_.displacement);
  begin_ms_ = timeline_.end[interval_++];
  begin_interval();
}

bool Walker::move() {
  if (interval_ >= timeline_.intervals() || state_.gone) return false;
  std::uint64_t many = 1;
  tally_.moves++;
  const bool was_inside = state_.inside;
  if (physics_.jumps && left_ >= least_jump &&
      walls_.is_free(spot_, state_.place, jump_radius_[state_.inside])) {
    const double radius = walls_.free_radius(spot_, state_.place) - clearance_um;
    many = static_cast<std::uint64_t>(
        std::min(static_cast<double>(left_), std::max(1.0, radius * radius / jump_square_[state_.inside])));
    left_ -= many;
    const double step_ms = step_ms_;
    step_ms_ *= static_cast<double>(many);
    jump(radius);
    step_ms_ = step_ms;
  } else {
    left_--;
    step();
  }
  if (was_inside) inside_ms_ += static_cast<double>(many) * step_ms_;
  if (state_.gone) {
    out_.absorbed_ms = timeline_.end[interval_] - static_cast<double>(left_) * step_ms_;
    return false;
  }
  if (!left_) end_interval();
  spot_ = walls_.spot(state_.place);
  return true;
}

Walk Walker::result() const {
  Walk out = out_;
  const double total = timeline_.intervals() ? timeline_.end.back() : 0.0;
  out.weight = conceg_exp(-inside_ms_ * physics_.intra.relaxation_rate -
                          (total - inside_ms_) * physics_.extra.relaxation_rate);
  out.place = state_.place, out.inside = state_.inside, out.absorbed = state_.gone;
  return out;
}

// P = 2 kappa l / (3 D) for steps of fixed length l, here with the step's own l and D (README.md).
bool Walker::passes(std::uint32_t face, double length, const Medium &here) {
  if (physics_.permeability.empty()) return false;
  const double kappa = physics_.permeability[walls_.source(face)];
  if (!(kappa > 0.0)) return false;
  return conceg_rng_uniform(&passing_) < 2.0 * kappa * length / (3.0 * here.diffusivity);
}

// One straight move of at most the walls' reach that is reflected on its way, its length preserved. The area
// gains the integral of the displacement along the broken line; `rest`, what is still to come of a longer
// move, is turned with it. After too many reflections the walker stays where it was.
void Walker::bounce(glm::dvec3 move, double time, glm::dvec3 &rest) {
  const glm::dvec3 rest_before = rest;
  glm::dvec3 place = state_.place, gained(0.0);
  Spot spot = spot_;
  bool inside = state_.inside, gone = false;
  double left = time, speed = 1.0; // of the medium, over that of the one where the move began
  const double length = glm::length(move);
  for (int bounces = 0;; bounces++) {
    const Contact contact = walls_.first_contact(spot, place, move);
    if (contact.face == Contact::none && bounces == 0) return advance(move, time);
    if (contact.face == Contact::none) {
      gained += left * (state_.displacement + (place - state_.place) + 0.5 * move);
      place += move;
      break;
    }
    if (bounces == bounce_limit) {
      tally_.retractions++;
      area_ += time * state_.displacement;
      rest = rest_before;
      return;
    }
    const glm::dvec3 before = contact.at * move;
    gained += contact.at * left * (state_.displacement + (place - state_.place) + 0.5 * before);
    place += before, move -= before, left *= 1.0 - contact.at;
    const Medium &here = medium(inside);
    if (!passes(contact.face, length * speed, here)) {
      move -= 2.0 * glm::dot(move, contact.normal) * contact.normal;
      rest -= 2.0 * glm::dot(rest, contact.normal) * contact.normal;
      tally_.reflections++;
    } else {
      tally_.passages++;
      // Set down as far beyond the membrane as it stopped before it; the rest of the time at the other side's
      // speed.
      const double across = glm::dot(move, contact.normal);
      place += 2.0 * clearance_um * (across > 0.0 ? contact.normal : -contact.normal);
      inside = across < 0.0;
      const double faster = std::sqrt(medium(inside).diffusivity / here.diffusivity);
      move *= faster, rest *= faster, speed *= faster;
      if (physics_.absorb) {
        gone = true;
        break;
      }
    }
    // The rest of a move that left the box begins at another image.
    glm::dvec3 wrapped = place;
    walls_.wrap_place(wrapped);
    state_.place += wrapped - place, place = wrapped;
    spot = walls_.spot(place);
  }
  area_ += gained;
  state_.displacement += place - state_.place;
  state_.place = place, state_.inside = inside, state_.gone = gone;
  walls_.wrap_place(state_.place);
}

// A straight move that meets nothing.
void Walker::advance(const glm::dvec3 &move, double time) {
  if (with_area_) area_ += time * (state_.displacement + 0.5 * move);
  state_.place += move, state_.displacement += move;
  walls_.wrap_place(state_.place);
}

// A move of any length, reflected: at once as far as nothing can be met, else in pieces that the walls can
// hold against membranes.
void Walker::travel(glm::dvec3 rest, double time) {
  for (double length; !state_.gone && (length = glm::length(rest)) > 0.0;) {
    const double radius = walls_.free_radius(spot_, state_.place) - clearance_um,
                 reach = reach_[state_.inside];
    const double share = std::max(radius, reach) < length ? std::max(radius, reach) / length : 1.0;
    const glm::dvec3 piece = share * rest;
    rest = share < 1.0 ? rest - piece : glm::dvec3(0.0);
    if (radius > reach) {
      advance(piece, share * time);
    } else {
      tally_.casts++;
      bounce(piece, share * time, rest);
    }
    time -= share * time;
    spot_ = walls_.spot(state_.place);
  }
}

// The exact joint law of displacement and its integral over the time t in free space, per axis:
// var x = 2 D t, var int = 2 D t^3 / 3, cov = D t^2: a straight way and the bridge's share.
void Walker::jump(double radius) {
  const double time = step_ms_, spread = std::sqrt(2.0 * medium(state_.inside).diffusivity * time);
  const glm::dvec3 move = spread * normals_.next();
  tally_.jumps++;
  if (with_area_) area_ += (time * spread / std::sqrt(12.0)) * normals_.next();
  if (glm::dot(move, move) < radius * radius)
    advance(move, time);
  else
    travel(move, time);
}

void Walker::step() {
  const glm::dvec3 move = length_[state_.inside] * directions_.next();
  if (physics_.skip && walls_.is_clear(spot_, move, state_.inside)) return advance(move, step_ms_);
  tally_.casts++;
  glm::dvec3 no_rest(0.0);
  bounce(move, step_ms_, no_rest);
}

} // namespace

void Tally::add(const Tally &other) {
  steps += other.steps, moves += other.moves, jumps += other.jumps, casts += other.casts;
  reflections += other.reflections, passages += other.passages, retractions += other.retractions;
}

std::size_t Timeline::records() const {
  return static_cast<std::size_t>(std::count(record.begin(), record.end(), std::uint8_t{1}));
}

std::vector<Walk> walk(const Walls &walls, const Timeline &timeline, const Physics &physics,
                       const Start *start, std::size_t count, std::uint64_t seed, Tally &tally) {
  std::vector<Walk> out;
  out.reserve(count);
  // One after the other: walkers that take turns drive each other's surroundings out of the cache.
  for (std::size_t i = 0; i < count; i++) {
    Walker walker(walls, timeline, physics, start[i], seed, tally);
    while (walker.move()) {
    }
    out.push_back(walker.result());
  }
  return out;
}

} // namespace conceg::simulate
