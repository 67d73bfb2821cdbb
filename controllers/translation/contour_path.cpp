#include "controllers/translation/contour_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace servomill::controllers::translation {
namespace {

constexpr double kTangential =
    1e-4;  // mm, gap between parallels that no control closes by a corner
constexpr double kNearlyTangential = 0.05;  // rad; parallels that do not meet are joined directly
constexpr double kPositionTol = 1e-9;       // relative, of a point on an element

[[noreturn]] void fail(const Place& place, std::string message) {
  throw InputError(place, std::move(message));
}

bool moves_in_plane(const Motion& motion) {
  const auto axes = plane_axes(motion.normal);
  return motion.words[axes[0]].has_value() || motion.words[axes[1]].has_value();
}

void set_end(Motion& motion, const Point& end) {
  const auto axes = plane_axes(motion.normal);
  motion.words[axes[0]] = end.x();
  motion.words[axes[1]] = end.y();
}

Point rotated(const Point& v, double angle) {
  return {std::cos(angle) * v.x() - std::sin(angle) * v.y(),
          std::sin(angle) * v.x() + std::cos(angle) * v.y()};
}

Element line(const Point& begin, const Point& end) { return {begin, end, false, {0.0, 0.0}, 0.0}; }

// The tangent from an outside point touches the circle here; the arc runs from here to the point,
// or from the point to here.
Point tangent_point(const Point& centre, double radius, const Point& outside, double sign,
                    const Place& place) {
  const Point d = outside - centre;
  if (d.norm() < radius) {
    fail(place,
         fmt::format("no line is tangent to the arc of R{:g}: its other end is inside the arc",
                     radius));
  }
  return centre + radius * rotated(d.normalized(), sign * std::acos(radius / d.norm()));
}

}  // namespace

// ------------------------------------------------------------------------- corners of the contour

void ContourPath::add(Motion motion) {
  if (!motion.element) {
    if (corner_) fail(corner_->place, "RND and CHF require a following motion block in the plane");
    if (held_ && !moves_in_plane(motion)) {
      behind_held_.emplace_back(std::move(motion));
      return;
    }
    release_held();
    return compensate(std::move(motion));
  }
  std::optional<Motion> inserted;
  if (corner_) inserted = cut_corner(motion);
  release_held();
  if (inserted) compensate(std::move(*inserted));
  for (GcodeLine& line : std::exchange(behind_corner_, {})) compensate(Entry(std::move(line)));
  held_ = std::move(motion);
}

void ContourPath::note(GcodeLine note) {
  if (corner_) {
    behind_corner_.push_back(std::move(note));
  } else if (held_) {
    behind_held_.emplace_back(std::move(note));
  } else {
    compensate(Entry(std::move(note)));
  }
}

void ContourPath::corner(CornerKind kind, double size, const std::optional<Feed>& feed,
                         const Place& place) {
  const bool has_moved_since =
      std::any_of(behind_held_.begin(), behind_held_.end(),
                  [](const Entry& entry) { return std::holds_alternative<Motion>(entry); });
  if (!held_ || corner_ || has_moved_since) {
    fail(place, "RND and CHF require a preceding motion block in the plane");
  }
  corner_ = Corner{kind, size, feed, place};
}

// Shortens the two elements and returns what comes between them.
Motion ContourPath::cut_corner(Motion& next) {
  Corner corner = *std::exchange(corner_, std::nullopt);
  const bool is_rounding = corner.kind == CornerKind::rounding;
  Motion& before = *held_;
  Element &a = *before.element, &b = *next.element;
  const auto n = static_cast<std::size_t>(before.normal);
  if (before.normal != next.normal || before.words[n] || next.words[n]) {
    fail(corner.place,
         "RND and CHF: both motion blocks must be in the plane; program the depth first");
  }
  const double turn = turn_at(direction_at_end(a), direction_at_begin(b));
  if (std::abs(turn) < kPositionTol)
    fail(corner.place, "RND and CHF require a corner; the contour is tangential here");
  const double sign = turn > 0.0 ? 1.0 : -1.0;
  Element between;
  if (is_rounding) {
    const auto to_a = parallel(a, sign * corner.size), to_b = parallel(b, sign * corner.size);
    const auto centre = to_a && to_b ? meeting_point(*to_a, *to_b, a.end) : std::nullopt;
    if (!centre)
      fail(corner.place,
           fmt::format("{}{:g} does not fit into the corner", words_.rounding, corner.size));
    between = {foot(a, *centre), foot(b, *centre), true, *centre, 0.0};
    between.sweep = sweep_between(*centre, between.begin, between.end, sign);
  } else {
    if (a.is_arc || b.is_arc) fail(corner.place, "CHF: both elements must be straight lines");
    if (corner.kind == CornerKind::chamfer_width) corner.size /= 2.0 * std::cos(turn / 2.0);
    between = line(a.end - corner.size * direction_at_end(a),
                   b.begin + corner.size * direction_at_begin(b));
  }
  if (position_on(a, between.begin, 1.0) < -kPositionTol ||
      position_on(b, between.end, 0.0) > 1.0 + kPositionTol) {
    fail(corner.place, fmt::format("{}{:g} is longer than the elements at the corner",
                                   is_rounding ? words_.rounding : words_.chamfer, corner.size));
  }
  a = cut_at_end(a, between.begin);
  b = cut_at_begin(b, between.end);
  set_end(before, between.begin);
  set_end(next, b.end);
  Motion inserted = next;
  inserted.words.fill(std::nullopt);
  inserted.element = between;
  inserted.place = corner.place;
  set_end(inserted, between.end);
  if (next.side == 0) inserted.side = before.side, inserted.radius = before.radius;
  if (!corner.feed) fail(corner.place, "RND and CHF require an active F");
  inserted.feed = *corner.feed;
  return inserted;
}

void ContourPath::release_held() {
  if (!held_) return;
  Motion motion = *std::exchange(held_, std::nullopt);
  std::vector<Entry> behind = std::exchange(behind_held_, {});
  compensate(std::move(motion));
  for (Entry& entry : behind) compensate(std::move(entry));
}

void ContourPath::flush() {
  if (corner_) fail(corner_->place, "RND and CHF require a following motion block in the plane");
  release_held();
  finish_compensation();
}

// ---------------------------------------------------------------------------- radius compensation

void ContourPath::compensate(Entry entry) {
  if (Motion* motion = std::get_if<Motion>(&entry)) return compensate(std::move(*motion));
  if (side_ != 0 || approach_) {
    waiting_.push_back(std::move(entry));
  } else {
    lines_.put(std::get<GcodeLine>(entry));
  }
}

void ContourPath::compensate(Motion motion) {
  if (motion.side == 0 || motion.is_machine) {
    finish_compensation();
    return lines_.put(motion);
  }
  if (!moves_in_plane(motion)) {
    if (side_ == 0 && !approach_) return lines_.put(motion);
    waiting_.emplace_back(std::move(motion));
    return;
  }
  if (side_ == 0 && !approach_) return begin_compensation(std::move(motion));
  const int side = approach_ ? approach_->side : side_;
  if (motion.side != side) {
    fail(motion.place,
         fmt::format("{}: compensation on the other side is active; program {} in between",
                     words_.compensation, words_.cancel));
  }
  if (!motion.element) {
    fail(motion.place,
         fmt::format(
             "with {} every motion block must start at a known position and have non-zero length",
             words_.compensation));
  }
  join(std::move(motion));
}

void ContourPath::begin_compensation(Motion motion) {
  if (motion.element && motion.element->is_arc) {
    fail(motion.place,
         fmt::format("{} must not be activated in a circle block; program a straight line first",
                     words_.compensation));
  }
  side_ = motion.side;
  entry_ = std::move(motion);
}

void ContourPath::enter_at(const Point& point) {
  Motion entry = *std::exchange(entry_, std::nullopt);
  set_end(entry, point);
  entry.element.reset();
  lines_.put(entry);
  put_waiting();
}

void ContourPath::join(Motion next) {
  auto beside = parallel(*next.element, next.side * next.radius);
  if (!beside) {
    fail(next.place,
         fmt::format("a tool of radius {:g} mm does not fit inside an arc of radius {:g} mm",
                     next.radius, (next.element->begin - next.element->centre).norm()));
  }
  if (approach_) {
    put_approach(next, *beside);
  } else if (entry_) {
    enter_at(beside->begin);
  } else {
    constexpr double kReversal = 1e-9;
    const double turn =
        turn_at(direction_at_end(*last_->element), direction_at_begin(*next.element));
    const bool is_reversal = std::numbers::pi - std::abs(turn) < kReversal;
    const bool is_inside = side_ * turn > 0.0 && !is_reversal;
    const auto corner = is_inside
                            ? meeting_point(*beside_, *beside, (beside_->end + beside->begin) / 2.0)
                            : std::nullopt;
    if (std::abs(turn) * next.radius < kTangential) {
      beside->begin = beside_->end;
    } else if (corner) {
      if (position_on(*beside_, *corner, 1.0) < -kPositionTol ||
          position_on(*beside, *corner, 0.0) > 1.0 + kPositionTol) {
        fail(next.place,
             fmt::format("a tool of radius {:g} mm does not fit into the corner before this block",
                         next.radius));
      }
      *beside_ = cut_at_end(*beside_, *corner);
      *beside = cut_at_begin(*beside, *corner);
    } else if (is_inside && std::abs(turn) > kNearlyTangential) {
      fail(next.place,
           fmt::format("a tool of radius {:g} mm does not fit into the corner before this block",
                       next.radius));
    }
    const bool is_gap = (beside_->end - beside->begin).norm() >= kTangential;
    put_last();
    put_waiting();
    if (is_gap) round_outside(next, *beside);
  }
  last_ = std::move(next);
  beside_ = beside;
}

// The corner itself: an arc about it, outside; inside, where the parallels of nearly tangential
// elements do not meet, a line.
void ContourPath::round_outside(const Motion& next, const Element& to) {
  Motion corner = next;
  corner.words.fill(std::nullopt);
  set_end(corner, to.begin);
  const Point centre = next.element->begin;
  const double turn = turn_at(direction_at_end(*last_->element), direction_at_begin(*next.element));
  const bool is_inside = side_ * turn > 0.0 && std::abs(turn) <= kNearlyTangential;
  corner.element = line(beside_->end, to.begin);
  if (!is_inside) {
    if (corner.feed.kind == Feed::Kind::rapid) {
      fail(next.place, fmt::format("{} after an outside corner with {}; program {}", words_.rapid,
                                   words_.compensation, words_.feed));
    }
    corner.element->is_arc = true;
    corner.element->centre = centre;
    corner.element->sweep = sweep_between(centre, beside_->end, to.begin, -side_);
  }
  lines_.put(corner);
}

void ContourPath::put_last() {
  Motion motion = *last_;
  if (motion.is_feed_of_contour && beside_->is_arc && motion.feed.kind == Feed::Kind::per_minute) {
    const double radius = (motion.element->begin - motion.element->centre).norm();
    motion.feed.value *= (beside_->begin - beside_->centre).norm() / radius;
  }
  motion.element = *beside_;
  set_end(motion, beside_->end);
  lines_.put(motion);
}

void ContourPath::put_waiting() {
  for (Entry& entry : std::exchange(waiting_, {})) {
    if (const Motion* motion = std::get_if<Motion>(&entry)) {
      lines_.put(*motion);
    } else {
      lines_.put(std::get<GcodeLine>(entry));
    }
  }
}

void ContourPath::finish_compensation() {
  if (approach_) fail(approach_->place, "APPR requires a following contour element");
  if (entry_) {
    const auto beside =
        entry_->element ? parallel(*entry_->element, entry_->side * entry_->radius) : std::nullopt;
    if (!beside)
      fail(entry_->place,
           fmt::format("{} requires a following contour element", words_.compensation));
    enter_at(beside->end);
  }
  if (last_) put_last();
  put_waiting();
  last_.reset();
  beside_.reset();
  side_ = 0;
}

// -------------------------------------------------------------------------- approach and departure

void ContourPath::move_to(const Run& run, const Point& end, const Feed& feed) {
  Motion motion;
  motion.normal = run.normal;
  motion.feed = feed;
  motion.place = run.place;
  set_end(motion, end);
  lines_.put(motion);
}

void ContourPath::move_on(const Run& run, const Element& arc, const Feed& feed) {
  Motion motion;
  motion.normal = run.normal;
  motion.feed = feed;
  motion.place = run.place;
  motion.element = arc;
  set_end(motion, arc.end);
  lines_.put(motion);
}

void ContourPath::approach(const Run& run) {
  flush();
  approach_ = run;
}

void ContourPath::put_approach(const Motion& first, const Element& beside) {
  const Run run = *std::exchange(approach_, std::nullopt);
  side_ = run.side;
  const Point along = direction_at_begin(*first.element);
  const Point across = run.side * left_of(along);  // towards the tool
  const Point& to = beside.begin;
  const double sign = run.side * (run.radius < 0.0 ? -1.0 : 1.0), R = std::abs(run.radius);
  const Point centre = to + run.radius * across;
  Point by = to;  // auxiliary point PH
  if (run.kind == Run::Kind::LT) by = to - run.length * along;
  if (run.kind == Run::Kind::LN) by = to + run.length * across;
  if (run.kind == Run::Kind::CT) by = centre + rotated(to - centre, -sign * run.angle);
  if (run.kind == Run::Kind::LCT) by = tangent_point(centre, R, run.start, sign, run.place);
  move_to(run, by, run.first);
  if (run.depth) {
    Motion down;
    down.words[static_cast<std::size_t>(run.normal)] = run.depth;
    down.feed = run.first;
    down.place = run.place;
    lines_.put(down);
  }
  if (run.kind == Run::Kind::LT || run.kind == Run::Kind::LN) {
    move_to(run, to, run.feed);
  } else {
    move_on(run, {by, to, true, centre, sweep_between(centre, by, to, sign)}, run.feed);
  }
  put_waiting();
}

Point ContourPath::depart(const Run& run) {
  if (corner_) fail(corner_->place, "RND and CHF require a following motion block in the plane");
  release_held();
  if (!last_) fail(run.place, "DEP requires a preceding contour element with RL or RR");
  const Element from = *beside_;
  const int side = side_;
  finish_compensation();
  const Point along = direction_at_end(from);
  const Point across = side * left_of(along);
  const double sign = side * (run.radius < 0.0 ? -1.0 : 1.0), R = std::abs(run.radius);
  const Point centre = from.end + run.radius * across;
  if (run.kind == Run::Kind::LT || run.kind == Run::Kind::LN) {
    const Point end = from.end + run.length * (run.kind == Run::Kind::LT ? along : across);
    move_to(run, end, run.feed);
    return end;
  }
  const Point end = run.kind == Run::Kind::CT
                        ? Point(centre + rotated(from.end - centre, sign * run.angle))
                        : tangent_point(centre, R, run.target, -sign, run.place);
  move_on(run, {from.end, end, true, centre, sweep_between(centre, from.end, end, sign)}, run.feed);
  if (run.kind == Run::Kind::CT) return end;
  move_to(run, run.target, run.feed);
  return run.target;
}

}  // namespace servomill::controllers::translation
