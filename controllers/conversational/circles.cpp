// Circles and helices: CC, C, CP, CR, CT, CTP.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "controllers/conversational/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;
constexpr double kSmallestRadius = 1e-3;  // mm
// mm; MP7431 allows 0.016 at most: TNC 410 user's manual p. 79
constexpr double kRadiusTolerance = 0.016;
constexpr double kSmallestSweep = 1e-3 * deg;  // rounding decides between it and a full circle

int plane_of(const Positioning& p, int fallback) {
  const bool x = p.target[0].has_value(), y = p.target[1].has_value(), z = p.target[2].has_value();
  if (x && y) return 2;
  if (z && x) return 1;
  if (y && z) return 0;
  return fallback;
}

}  // namespace

// CC X+25 Y+25: two coordinates choose the plane; increments count from the position; CC alone
// takes the position. TNC 410 user's manual p. 79.
void Translator::pole(const HeidenhainBlock& block) {
  Words words(std::span(block.words).subspan(1));
  Positioning p = read_positioning(words, "CC");
  words.refuse_rest("CC");
  if (p.feed || p.side || p.direction || !p.functions.empty()) fail("CC accepts only coordinates");
  if (!p.has_target()) {
    pole_ = program_point(2);
    pole_normal_ = 2;
    if (!pole_) fail("CC: the position is unknown here");
    return;
  }
  int count = 0;
  for (std::size_t i = 0; i < p.target.size(); ++i) count += p.target[i] ? i < 3 ? 1 : 3 : 0;
  if (count == 3) fail("CC requires two of X, Y, Z, or no coordinate");
  const int normal = count == 2 ? plane_of(p, 2) : 2;
  if (count == 1 && p.target[2]) fail("CC requires two of X, Y, Z, or no coordinate");
  const auto axes = plane_axes(normal);
  const auto now = program_point(normal);
  Point at;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto& target = p.target[axes[i]];
    if ((!target || target->is_increment) && !now) fail("CC: the position is unknown here");
    if (!target) {
      // [407] p. 5-15: a coordinate that is left out stays that of the last pole
      if (!pole_ || pole_normal_ != normal) fail("CC with one coordinate requires a preceding CC");
      at[k] = (*pole_)[k];
    } else {
      at[k] = length(target->value) + (target->is_increment ? (*now)[k] : 0.0);
    }
  }
  pole_ = at;
  pole_normal_ = normal;
}

void Translator::require_arc(const Positioning& p) const {
  if (p.target[3] || p.target[4] || p.target[5]) fail("a rotary axis on a circle is not supported");
  if (p.has(91)) fail("M91 is not allowed in a circle block");
  if (p.retract || p.is_retract_to_limit) fail("M140 is not allowed in a circle block");
  if (p.feed && p.feed->kind == Feed::Kind::rapid)
    fail("FMAX is not allowed in a circle block; program F");
}

// From program coordinates to work coordinates and on.
void Translator::add_arc(const Positioning& p, int normal, Element arc) {
  const auto axes = plane_axes(normal);
  const auto n = static_cast<std::size_t>(normal);
  last_element_ = arc;
  last_normal_ = normal;
  const auto to_work = [&](const Point& point) {
    if (normal == 2) return frame_.to_work(point);
    return Point(frame_.to_work(axes[0], point.x()), frame_.to_work(axes[1], point.y()));
  };
  Element element = arc;
  element.begin = to_work(arc.begin);
  element.end = to_work(arc.end);
  element.centre = to_work(arc.centre);
  if (frame_.is_mirrored[axes[0]] != frame_.is_mirrored[axes[1]]) element.sweep = -element.sweep;
  if (normal != 2 && frame_.scale != 1.0)
    fail("a circle in a plane with Z is not supported while cycle 11 is active");
  Motion motion;
  motion.place = place_;
  motion.normal = normal;
  motion.feed = feed_of(p);
  if (p.target[n]) {
    Positioning along;
    along.target[n] = p.target[n];
    bool is_incremental = false;
    motion.words[n] = ends(along, is_incremental)[n];
    if (is_incremental)
      fail("helix: the position along its axis is unknown here; program it absolutely");
  }
  motion.words[axes[0]] = element.end.x();
  motion.words[axes[1]] = element.end.y();
  motion.element = element;
  const Element kept = *last_element_;
  add(std::move(motion));
  last_element_ = kept;
}

// C X+45 Y+25 DR+, CP PA+90 DR+, CP IPA+720 IZ+5 DR+.
void Translator::circle(const HeidenhainBlock& block, bool is_polar) {
  const std::string_view name = is_polar ? "CP" : "C";
  Words words(std::span(block.words).subspan(1));
  Positioning p = read_positioning(words, name);
  words.refuse_rest(name);
  if (p.polar_radius || p.polar_angle.has_value() != is_polar) {
    fail(is_polar ? "CP requires PA and does not accept PR"
                  : "C does not accept PA or PR; use CP with PA");
  }
  if (!pole_) fail("a circle requires a preceding CC in the same coordinate system");
  if (!is_polar && !p.has_target()) fail(fmt::format("{} requires coordinates", name));
  require_arc(p);
  const int normal = pole_normal_;
  const auto begin = program_point(normal);
  if (!begin) fail("the start position of the circle is unknown here");
  const double radius = (*begin - *pole_).norm();
  if (radius < kSmallestRadius) fail("the circle starts at its centre (CC)");
  begin_functions(p);
  set_side(p);
  if (is_polar) {
    helix(p, normal);
    return end_functions(p);
  }
  if (!p.direction)
    fail("C without DR: the direction of rotation depends on the preceding block; program DR");
  const auto axes = plane_axes(normal);
  if (p.target[static_cast<std::size_t>(normal)])
    fail("C does not accept the axis normal to its plane; use CP for a helix");
  Point end = *begin;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto& target = p.target[axes[i]];
    if (target) end[k] = length(target->value) + (target->is_increment ? (*begin)[k] : 0.0);
  }
  const double end_radius = (end - *pole_).norm();
  if (std::abs(end_radius - radius) > kRadiusTolerance) {
    fail(
        fmt::format("the end of the circle is {:.4f} mm from CC, its start {:.4f} mm; controls "
                    "accept a difference of at most {} mm (MP7431)",
                    end_radius, radius, kRadiusTolerance));
  }
  Element arc{*begin, end, true, *pole_, sweep_between(*pole_, *begin, end, *p.direction)};
  const double size = std::abs(arc.sweep);
  const bool is_closed = (end - *begin).norm() < 1e-6;
  if (!is_closed && (size < kSmallestSweep || kFullTurn - size < kSmallestSweep)) {
    fail(fmt::format("arc of {:.5f} degrees: rounding decides between a full circle and no motion",
                     size / deg));
  }
  add_arc(p, normal, arc);
  end_functions(p);
}

// IPA is the total angle, with its revolutions: TNC 430 user's manual p. 153.
void Translator::helix(const Positioning& p, int normal) {
  const Point begin = *program_point(normal);
  const Point ray = begin - *pole_;
  const double from = std::atan2(ray.y(), ray.x());
  const double written = value(p.polar_angle->value) * deg;
  double sweep = written;
  constexpr double kMaxAngle = 5400.0 * deg;  // [640] p. 631
  if (!(std::abs(written) <= kMaxAngle)) fail("CP: the angle must be -5400 to 5400 degrees");
  if (p.polar_angle->is_increment) {
    if (p.direction && written != 0.0 && (written > 0.0) != (*p.direction > 0)) {
      fail(p.polar_angle->value.place,
           "IPA and DR have opposite directions; they must have the same sign");
    }
  } else {
    if (!p.direction)
      fail("CP without DR: the direction of rotation depends on the preceding block; program DR");
    sweep = std::remainder(written - from, kFullTurn);
    if (*p.direction * sweep <= 1e-9) sweep += *p.direction * kFullTurn;
  }
  if (std::abs(sweep) < kSmallestSweep) fail("CP: the arc has zero length");
  const double to = from + sweep;
  Element arc;
  arc.begin = begin;
  arc.end = *pole_ + ray.norm() * Point(std::cos(to), std::sin(to));
  if (std::abs(std::remainder(sweep, kFullTurn)) < 1e-9) arc.end = begin;
  arc.is_arc = true;
  arc.centre = *pole_;
  arc.sweep = sweep;
  add_arc(p, normal, arc);
}

// CR: R > 0 the arc below 180 degrees, R < 0 the one above. [530] p. 223.
void Translator::circle_of_radius(const HeidenhainBlock& block) {
  Words words(std::span(block.words).subspan(1));
  Positioning p = read_positioning(words, "CR");
  const auto R = words.take_number("R");
  const Positioning more = read_positioning(words, "CR");
  words.refuse_rest("CR");
  if (!p.direction) p.direction = more.direction;
  if (!p.feed) p.feed = more.feed;
  if (!p.side) p.side = more.side;
  p.functions.insert(p.functions.end(), more.functions.begin(), more.functions.end());
  if (!R) fail("CR requires R");
  if (!p.direction)
    fail("CR without DR: the direction of rotation depends on the preceding block; program DR");
  require_arc(p);
  const int normal = plane_of(p, 2);
  if (p.target[static_cast<std::size_t>(normal)]) fail("CR requires two coordinates");
  const auto begin = program_point(normal);
  if (!begin) fail("the start position of the circle is unknown here");
  const auto axes = plane_axes(normal);
  Point end = *begin;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto& target = p.target[axes[i]];
    if (target) end[k] = length(target->value) + (target->is_increment ? (*begin)[k] : 0.0);
  }
  begin_functions(p);
  set_side(p);
  const double radius = length(*R);
  const auto arc = arc_of_radius(*begin, end, std::abs(radius), *p.direction, radius < 0.0);
  if (!arc) {
    fail(
        fmt::format("CR R{:g}: start and end are {:.4f} mm apart; the distance must be > 0 and at "
                    "most the diameter; program a full circle in two blocks",
                    radius, (end - *begin).norm()));
  }
  add_arc(p, normal, *arc);
  end_functions(p);
}

// CT begins along the end of the element before it: [530] p. 225.
void Translator::tangential_circle(const HeidenhainBlock& block, bool is_polar) {
  const std::string_view name = is_polar ? "CTP" : "CT";
  Words words(std::span(block.words).subspan(1));
  Positioning p = read_positioning(words, name);
  words.refuse_rest(name);
  require_arc(p);
  if (p.direction)
    fail(
        fmt::format("{} does not accept DR: the preceding element determines the direction", name));
  const int normal = is_polar ? pole_normal_ : plane_of(p, 2);
  if (!last_element_ || last_normal_ != normal) {
    fail(fmt::format("{} requires a preceding motion block in the plane of the arc", name));
  }
  const Element before = *last_element_;
  begin_functions(p);
  set_side(p);
  if (is_polar) {
    if (!p.polar_angle && !p.polar_radius) fail("CTP requires PR or PA");
    set_program_point(p, normal, *polar_point(p, normal));
  }
  const auto axes = plane_axes(normal);
  const Point begin = before.end;
  Point end = begin;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto& target = p.target[axes[i]];
    if (target) end[k] = length(target->value) + (target->is_increment ? begin[k] : 0.0);
  }
  if ((end - begin).norm() < kSmallestRadius) fail(fmt::format("{}: start and end coincide", name));
  const auto arc = tangential_arc(begin, direction_at_end(before), end);
  if (!arc) {
    const bool is_ahead = direction_at_end(before).dot(end - begin) > 0.0;
    if (!is_ahead)
      fail(fmt::format(
          "{}: the end is opposite to the tangent at the start; no tangential arc exists", name));
    move_straight(p);
    return end_functions(p);
  }
  add_arc(p, normal, *arc);
  end_functions(p);
}

}  // namespace servomill::controllers::conversational
