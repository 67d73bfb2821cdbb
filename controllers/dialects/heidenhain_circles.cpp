// Circles and helices: CC, C, CP.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "controllers/dialects/heidenhain_control.h"
#include "controllers/dialects/planar_arc.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::heidenhain {
namespace {

using Point = std::array<double, 2>;

constexpr double kFullTurn = 2.0 * std::numbers::pi;
// An arc so short that rounding could make a full circle of it, or the reverse
constexpr double kSmallestSweep = 1e-3 * deg;

// First and second axis of the plane with this normal. Angles count from the first one: X in XY, Y
// in YZ, Z in ZX. [PIL] p. 8
std::array<std::size_t, 2> plane_axes(int normal) {
  return {static_cast<std::size_t>((normal + 1) % 3), static_cast<std::size_t>((normal + 2) % 3)};
}

double radius(const Point& centre, const Point& p) {
  return std::hypot(p[0] - centre[0], p[1] - centre[1]);
}

double angle_at(const Point& centre, const Point& p) {
  return std::atan2(p[1] - centre[1], p[0] - centre[0]);
}

}  // namespace

// CC X+25 Y+25, CC IX+5 IY+0, CC: pole of circles and polar coordinates, without a motion. An
// increment counts from the position programmed last; CC alone takes that. [410] p. 79, [PIL] p. 8
void Control::run_pole(const HeidenhainBlock& block) {
  Positioning p = read_words(block, 1);
  if (p.feed_word != Positioning::FeedWord::none || p.functions_count > 0 || p.direction ||
      p.radius_angle) {
    fail(place_, "CC requires two coordinates, or none");
  }
  State::Pole pole;
  KnownPosition at = state_.position;
  if (p.has_target()) {
    int count = 0;
    for (int axis = 0; axis < kAxisWords; ++axis) {
      if (p.target[static_cast<std::size_t>(axis)].word) count += axis < 3 ? 1 : 3;
    }
    if (count != 2) fail(place_, "CC requires two of X, Y, Z, or no coordinate");
    pole.normal = !p.target[0].word ? 0 : !p.target[1].word ? 1 : 2;
    require_arc_frame(p);
    for (auto& target : p.target) {
      if (!target.word || !target.is_increment || rules_.increments_of_cc_start_at_position)
        continue;
      const auto i = static_cast<std::size_t>(&target - p.target.data());
      const auto axes = plane_axes(pole.normal);
      if (state_.pole) at[i] = state_.pole->at[i == axes[0] ? 0 : 1];
    }
    const KnownPosition now = state_.position;
    state_.position = at;
    at = targets(p);
    state_.position = now;
  } else if (!rules_.cc_alone_takes_position) {
    return;
  }
  const auto axes = plane_axes(pole.normal);
  if (!at[axes[0]] || !at[axes[1]]) fail(place_, "CC: the position is unknown here");
  pole.at = {*at[axes[0]], *at[axes[1]]};
  state_.pole = pole;
}

void Control::require_arc_frame(const Positioning& p) const {
  require_frame(place_, false);
  const bool is_in_xy = !p.target[2].word;
  if (!is_in_xy && (plane_rotation() != 0.0 || is_mirrored(0) || is_mirrored(1))) {
    fail(place_,
         "a circle in a plane with Z is not covered while the coordinates are rotated or mirrored");
  }
}

Point Control::start_on_plane() const {
  if (!state_.pole) fail(place_, "a circle requires a preceding CC with the same reference");
  const auto axes = plane_axes(state_.pole->normal);
  const auto& first = state_.position[axes[0]];
  const auto& second = state_.position[axes[1]];
  if (!first || !second) fail(place_, "the start position of the circle is unknown here");
  if (radius(state_.pole->at, {*first, *second}) < um)
    fail(place_, "the circle starts at its centre (CC)");
  return {*first, *second};
}

// Signed angle of the arc from `start` to `end`; a full turn where they are equal.
double Control::sweep_to(const Point& start, const Point& end, int direction) const {
  const Point& centre = state_.pole->at;
  if (std::hypot(end[0] - start[0], end[1] - start[1]) < 1.0 * nm) {
    return rules_.equal_ends_make_full_circle ? direction * kFullTurn : 0.0;
  }
  double sweep = angle_at(centre, end) - angle_at(centre, start);
  while (direction * sweep <= 0.0) sweep += direction * kFullTurn;
  while (direction * sweep > kFullTurn) sweep -= direction * kFullTurn;
  const double size = std::abs(sweep);
  if (size < kSmallestSweep || kFullTurn - size < kSmallestSweep) {
    fail(place_,
         fmt::format("arc of {:.5f} degrees: rounding decides between a full circle and no motion",
                     size / deg));
  }
  return sweep;
}

void Control::move_on_arc(const Positioning& p, KnownPosition end, double sweep) {
  using FeedWord = Positioning::FeedWord;
  if (p.feed_word == FeedWord::fmax) fail(place_, "FMAX on a circle is not covered");
  for (int axis = 3; axis < kAxisWords; ++axis) {
    const HeidenhainWord* word = p.target[static_cast<std::size_t>(axis)].word;
    if (word)
      fail(word->place,
           fmt::format("'{}': a rotary axis is not allowed in a circle block", word->text));
  }
  const State::Pole& pole = *state_.pole;
  const auto axes = plane_axes(pole.normal);
  MachineAction action = new_motion(ActionKind::arc);
  action.is_commanded[axes[0]] = action.is_commanded[axes[1]] = true;
  action.normal_axis = pole.normal;
  action.centre[static_cast<Eigen::Index>(axes[0])] = pole.at[0];
  action.centre[static_cast<Eigen::Index>(axes[1])] = pole.at[1];
  const double turns = std::ceil(std::abs(sweep) / kFullTurn - 1e-9);
  action.turns = static_cast<int>(sweep < 0.0 ? -turns : turns);
  move_to(p, end, action);
}

// The control takes radii that differ by up to 16 um, selectable ([410] p. 79); all take 5 um.
void Control::check_ends(const Point& start, const Point& end) const {
  const Point& centre = state_.pole->at;
  constexpr int kNormal = 2;
  const auto fault = arc_fault({start[0], start[1], 0.0}, {end[0], end[1], 0.0},
                               {centre[0], centre[1], 0.0}, kNormal);
  if (fault) fail(place_, *fault);
}

// C X+45 Y+25 DR+: about CC, from the position programmed last. Equal ends make a full circle.
void Control::run_circle(const HeidenhainBlock& block) {
  const Positioning p = read_words(block, 1);
  if (p.radius_angle) fail(place_, "C does not accept a polar angle; use CP");
  if (!p.direction)
    fail(place_, "C requires DR: the direction of rotation is undetermined without it");
  if (!p.has_target()) fail(place_, "C requires coordinates");
  if (p.has_m(91) || p.is_retract) fail(place_, "M91 and M140 are not allowed in a circle block");
  act_at_start(p);
  require_radius_off(p, block);
  require_arc_frame(p);
  const Point start = start_on_plane();
  const auto axes = plane_axes(state_.pole->normal);
  for (std::size_t i = 0; i < 3; ++i) {
    if (p.target[i].word && i != axes[0] && i != axes[1]) {
      fail(p.target[i].word->place,
           fmt::format("'{}' is not in the plane of CC; a helix requires CP",
                       p.target[i].word->text));
    }
  }
  KnownPosition end = targets(p);
  const Point last = {*end[axes[0]], *end[axes[1]]};
  check_ends(start, last);
  int direction = *p.direction * (rules_.dr_plus_is_counter_clockwise ? 1 : -1);
  if (is_mirrored(0) != is_mirrored(1) && rules_.mirror_reverses_arcs) direction = -direction;
  const double sweep = sweep_to(start, last, direction);
  if (std::abs(sweep) == kFullTurn) {
    for (std::size_t i = 0; i < axes.size(); ++i) end[axes[i]] = start[i];
  }
  move_on_arc(p, end, sweep);
  act_at_end(p);
}

// IPA counts revolutions, and its sign and DR agree ([430] p. 153; M); PA is an angle in the plane.
double Control::helix_sweep(const Positioning& p, double start_angle) const {
  const bool is_reversed = is_mirrored(0) != is_mirrored(1);
  int direction = *p.direction * (rules_.dr_plus_is_counter_clockwise ? 1 : -1);
  if (is_reversed && rules_.mirror_reverses_arcs) direction = -direction;
  if (p.is_angle_increment) {
    if (*p.radius_angle == 0.0 || (*p.radius_angle > 0.0) != (*p.direction > 0)) {
      fail(place_, "IPA and DR must have the same sign, and IPA must not be 0");
    }
    double angle = std::abs(*p.radius_angle);
    if (!rules_.ipa_counts_revolutions) angle = std::fmod(angle, kFullTurn);
    return direction * angle;
  }
  if (is_mirrored(0) || is_mirrored(1)) fail(place_, "PA while cycle 8 is active is not covered");
  double to = *p.radius_angle;
  if (state_.pole->normal == 2) to += plane_rotation();
  if (state_.pole->normal == 1 && !rules_.zx_angle_starts_at_z) to = kFullTurn / 4.0 - to;
  double sweep = std::remainder(to - start_angle, kFullTurn);
  if (std::abs(sweep) < kSmallestSweep) {
    fail(place_, "CP PA: start and end coincide: a full circle or no motion");
  }
  if (direction * sweep < 0.0) sweep += direction * kFullTurn;
  return sweep;
}

// CP IPA-1800 IZ+5 DR-: a circle or helix about CC, with the radius of its start. [430] p. 153
void Control::run_helix(const HeidenhainBlock& block) {
  const Positioning p = read_words(block, 1);
  if (!p.radius_angle) fail(place_, "CP requires PA or IPA");
  if (!p.direction)
    fail(place_, "CP requires DR: the direction of rotation is undetermined without it");
  if (p.has_m(91) || p.is_retract) fail(place_, "M91 and M140 are not allowed in a circle block");
  act_at_start(p);
  require_radius_off(p, block);
  require_frame(place_, false);
  const Point start = start_on_plane();
  const State::Pole& pole = *state_.pole;
  const auto axes = plane_axes(pole.normal);
  for (const std::size_t axis : axes) {
    const HeidenhainWord* word = p.target[axis].word;
    if (word)
      fail(word->place, fmt::format("'{}': CP requires an angle for this axis", word->text));
  }
  const double start_angle = angle_at(pole.at, start);
  const double sweep = helix_sweep(p, start_angle);
  const double r = radius(pole.at, start);
  KnownPosition end = targets(p);
  end[axes[0]] = pole.at[0] + r * std::cos(start_angle + sweep);
  end[axes[1]] = pole.at[1] + r * std::sin(start_angle + sweep);
  move_on_arc(p, end, sweep);
  act_at_end(p);
}

}  // namespace servomill::controllers::heidenhain
