// Arcs: G2 and G3 with I J K, CR, AR or polar; CIP, CT; threads and tapping.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::siemens {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;
constexpr double kSamePoint = 1e-6;   // mm
constexpr double kRadiusFits = 0.01;  // mm, CIRCLE_ERROR_CONST of MD21000 as delivered

Point turned(const Point& v, double angle) {
  return {std::cos(angle) * v.x() - std::sin(angle) * v.y(),
          std::sin(angle) * v.x() + std::cos(angle) * v.y()};
}

}  // namespace

double Translator::coordinate(const Number& number, double now) const {
  return number.value * unit() + (is_increment(number) ? now : 0.0);
}

// AP and RP about the pole. RP is absolute and stays; AP stays until another pole or plane, and
// AP=IC counts from the one programmed last. NC programming 12/2019 (6FC5398-2EP40-0BA0) p. 175
Point Translator::polar_point(const Block& block) {
  if (!pole_) fail("AP and RP require a pole in the same frame; program G111 first");
  if (block.RP && block.RP->value < 0.0) fail(block.RP->place, "RP must be >= 0");
  if (block.RP) polar_radius_ = block.RP->value * unit();
  if (!polar_radius_) fail("RP is missing and was not programmed before");
  if (block.AP) {
    const Number& AP = *block.AP;
    if (AP.measure == Measure::modal && modes_.is_incremental) {
      fail(AP.place, "AP with G91 is ambiguous; write AP=AC(...) or AP=IC(...)");
    }
    const bool is_by = AP.measure == Measure::incremental;
    if (is_by && !polar_angle_) {
      fail(AP.place, "AP=IC requires a previous angle about this pole; program AP=AC(...) first");
    }
    polar_angle_ = AP.value + (is_by ? *polar_angle_ : 0.0);
  }
  if (!polar_angle_) fail("AP is missing and was not programmed since the pole was set");
  return *pole_ + *polar_radius_ * turned(Point(1.0, 0.0), *polar_angle_ * deg);
}

std::optional<Point> Translator::end_in_plane(const Block& block, const Point& start) {
  if (block.is_polar()) return polar_point(block);
  const auto axes = plane_axes(modes_.normal);
  Point end = start;
  bool is_named = false;
  for (int i = 0; i < 2; ++i) {
    const auto& number = block.axes[axes[static_cast<std::size_t>(i)]];
    if (!number) continue;
    is_named = true;
    require_same_offset(axes[static_cast<std::size_t>(i)], *number);
    end[i] = coordinate(*number, start[i]);
  }
  return is_named ? std::optional(end) : std::nullopt;
}

// I, J and K count from the start, with AC from the origin. [F] "Circular interpolation with center
// point"
std::optional<Point> Translator::programmed_centre(const Block& block, const Point& start) const {
  if (!block.has_centre()) {
    return block.is_polar() ? pole_ : std::nullopt;
  }
  const auto axes = plane_axes(modes_.normal);
  if (const auto& off = block.centre[static_cast<std::size_t>(modes_.normal)]) {
    fail(off->place,
         fmt::format("{} is not in the plane of G{}", "IJK"[modes_.normal], 19 - modes_.normal));
  }
  Point centre = start;
  for (int i = 0; i < 2; ++i) {
    const auto& number = block.centre[axes[static_cast<std::size_t>(i)]];
    if (!number) continue;
    const bool is_absolute = number->measure == Measure::absolute;
    centre[i] = number->value * unit() + (is_absolute ? 0.0 : start[i]);
  }
  return centre;
}

void Translator::arc(const Block& block) {
  const double sign = modes_.motion == MotionCode::clockwise ? -1.0 : 1.0;
  const auto start = program_point(modes_.normal);
  if (!start)
    fail("the start position of the arc is unknown here; program both axes of the plane before");
  const auto end = end_in_plane(block, *start);
  const auto centre = programmed_centre(block, *start);
  Element element;
  if (block.CR && (centre || block.AR)) {
    fail(block.CR->place,
         "CR is not allowed with the centre or the angle of the arc; program one of them");
  }
  if (centre) {
    element = about_centre(block, *start, *centre, end, sign);
    if (end) {
      element.end = *end;
      const bool is_closed = (*end - *start).norm() < kSamePoint;
      element.sweep =
          is_closed ? sign * kFullTurn : translation::sweep_between(*centre, *start, *end, sign);
    }
  } else {
    if (!end) fail("an arc requires an end point or a centre");
    element = through_end(block, *start, *end, sign);
  }
  if (block.TURN) {
    constexpr double kMaxTurns = 999.0;
    const double turns = block.TURN->value;
    if (turns < 0.0 || turns > kMaxTurns || turns != std::floor(turns)) {
      fail(block.TURN->place, "TURN must be an integer from 0 to 999");
    }
    element.sweep += sign * turns * kFullTurn;
  }
  add_arc(block, element, modes_.normal);
}

// Centre alone: a full circle, or the angle AR.
Element Translator::about_centre(const Block& block, const Point& start, const Point& centre,
                                 const std::optional<Point>& end, double sign) {
  const double radius = (start - centre).norm();
  if (radius < kSamePoint) fail("the centre of the arc is its start point");
  Element out{start, start, true, centre, sign * kFullTurn};
  if (end && std::abs((*end - centre).norm() - radius) > kRadiusFits) {
    fail(fmt::format("the arc starts {:.4f} mm and ends {:.4f} mm from its centre", radius,
                     (*end - centre).norm()));
  }
  if (block.AR && end) fail("AR is not allowed with both the end point and the centre of the arc");
  if (block.AR) {
    if (!(block.AR->value > 0.0)) fail(block.AR->place, "AR must be > 0");
    out.sweep = sign * block.AR->value * deg;
    out.end = centre + turned(start - centre, out.sweep);
  }
  return out;
}

// CR > 0: up to a semicircle, CR < 0: more. AR: the angle of the arc. [F] "Circular interpolation
// with radius and end point", "with opening angle"
Element Translator::through_end(const Block& block, const Point& start, const Point& end,
                                double sign) {
  const double chord = (end - start).norm();
  if (chord < kSamePoint) fail("an arc with CR or AR cannot end at its start point");
  double radius = 0.0;
  bool is_large = false;
  if (block.CR) {
    radius = std::abs(block.CR->value) * unit();
    is_large = block.CR->value < 0.0;
    if (radius < chord / 2.0 && radius > chord / 2.0 - kRadiusFits) radius = chord / 2.0;
  } else if (block.AR) {
    const double angle = block.AR->value * deg;
    if (!(angle > 0.0) || angle >= kFullTurn) fail(block.AR->place, "AR must be > 0 and < 360");
    radius = chord / (2.0 * std::abs(std::sin(angle / 2.0)));
    is_large = angle > std::numbers::pi;
  } else {
    fail("an arc requires I, J, K, CR or AR");
  }
  const auto element = translation::arc_of_radius(start, end, radius, sign, is_large);
  if (!element) {
    fail(fmt::format("CR={:g} is less than half the chord length of {:.4f} mm", radius, chord));
  }
  return *element;
}

// Start, point and end in a plane of two axes; the direction follows from them. [F] "Circular
// interpolation via intermediate point"
void Translator::arc_through_point(const Block& block) {
  Eigen::Vector3d start, end, by;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto now = program_position(k);
    if (!now) fail(fmt::format("CIP: the position of {} is unknown here", "XYZ"[i]));
    start[i] = *now;
    if (block.axes[k]) require_same_offset(k, *block.axes[k]);
    end[i] = block.axes[k] ? coordinate(*block.axes[k], *now) : *now;
    by[i] = block.through[k] ? coordinate(*block.through[k], *now) : *now;
  }
  int normal = -1;
  for (const int i : {modes_.normal, 2, 0, 1}) {
    const bool is_level =
        std::abs(end[i] - start[i]) < kSamePoint && std::abs(by[i] - start[i]) < kSamePoint;
    if (normal < 0 && is_level) normal = i;
  }
  if (normal < 0) fail("CIP is supported only in the planes G17, G18 and G19");
  const auto axes = plane_axes(normal);
  const auto in_plane = [&](const Eigen::Vector3d& p) {
    return Point(p[static_cast<Eigen::Index>(axes[0])], p[static_cast<Eigen::Index>(axes[1])]);
  };
  const Point a = in_plane(start), b = in_plane(by), c = in_plane(end);
  const Point u = b - a, v = c - a;
  const double cross = u.x() * v.y() - u.y() * v.x();
  if (std::abs(cross) < kSamePoint * v.norm() || v.norm() < kSamePoint) {
    fail("CIP: the three points are collinear");
  }
  const Point centre = a + Point(v.y() * u.squaredNorm() - u.y() * v.squaredNorm(),
                                 u.x() * v.squaredNorm() - v.x() * u.squaredNorm()) /
                               (2.0 * cross);
  const double sign = cross > 0.0 ? 1.0 : -1.0;
  add_arc(block, {a, c, true, centre, translation::sweep_between(centre, a, c, sign)}, normal);
}

void Translator::tangential_arc(const Block& block) {
  const auto start = program_point(modes_.normal);
  if (!start || !last_element_ || last_normal_ != modes_.normal) {
    fail("CT requires a preceding line or arc in the plane");
  }
  const auto end = end_in_plane(block, *start);
  if (!end) fail("CT requires an end point");
  const Point along = translation::direction_at_end(*last_element_);
  const auto element = translation::tangential_arc(*start, along, *end);
  if (!element) {
    const bool is_ahead = along.dot(*end - *start) > 0.0;
    if (!is_ahead)
      fail("CT: the end point is opposite to the path tangent; no tangential arc exists");
    return move_straight(block);
  }
  add_arc(block, *element, modes_.normal);
}

// From the program's plane to that of the work system, with the depth of a helix.
void Translator::add_arc(const Block& block, Element element, int normal) {
  if (block.axes[3] || block.axes[4] || block.axes[5]) {
    fail("an arc with a rotary axis is not supported; post-process to lines");
  }
  const Frame& frame = modes_.frame;
  if (!frame.keeps_plane(normal)) {
    fail(
        "an arc in a plane tilted by ROT is not supported; post-process to lines, or use CYCLE800");
  }
  if (!frame.is_alike_in_plane(normal))
    fail("an arc requires equal SCALE factors in the axes of its plane");
  const auto axes = plane_axes(normal);
  Block depth = block;
  depth.axes[axes[0]].reset();
  depth.axes[axes[1]].reset();
  depth.AP.reset();
  depth.RP.reset();
  Motion motion = motion_of(depth);
  Element work = element;
  work.begin = work_point(normal, element.begin);
  work.end = work_point(normal, element.end);
  work.centre = work_point(normal, element.centre);
  if (frame.is_mirrored(normal)) work.sweep = -element.sweep;
  if (motion.is_incremental)
    fail("helix: the position along its axis is unknown here; program it absolutely");
  motion.words[axes[0]] = work.end.x();
  motion.words[axes[1]] = work.end.y();
  motion.element = work;
  if (motion.feed.kind == Feed::Kind::rapid) motion.feed = modal_feed();
  const int plane = std::exchange(modes_.normal, normal);
  add(std::move(motion));
  modes_.normal = plane;
  last_element_ = element;
  last_normal_ = normal;
  programmed_[axes[0]] = element.end.x();
  programmed_[axes[1]] = element.end.y();
}

// -------------------------------------------------------------------------------------- threads

// The axes follow the spindle at the pitch of one of them.
void Translator::require_axis_of_pitch(const Block& block) const {
  for (std::size_t i = 0; i < block.axes.size(); ++i) {
    const bool is_of_pitch = i < 3 && block.centre[i].has_value();
    if (block.axes[i].has_value() == is_of_pitch) continue;
    const Place& place = block.axes[i] ? block.axes[i]->place : block.centre[i]->place;
    fail(place,
         "a thread must run along the axis of its pitch only; program X with I, Y with J or Z with "
         "K");
  }
  require_lengths_kept("a thread");
}

void Translator::require_lengths_kept(std::string_view what) const {
  if (modes_.frame.keeps_lengths()) return;
  fail(
      fmt::format("{} while SCALE is active: it is undocumented whether the pitch is scaled; "
                  "cancel it with SCALE",
                  what));
}

// G33 cuts with the spindle that runs; G331 and G332 turn it, to the right for K > 0 and back. The
// axes follow the spindle, as a feed of the pitch per revolution. [F] "Thread cutting", "Tapping
// without compensating chuck"
void Translator::thread(const Block& block) {
  require_no_compensation("G33, G331 and G332");
  if (!speed_ || *speed_ <= 0.0) fail("G33, G331 and G332 require an active S");
  const bool is_cut = block.has("G33");
  if (!is_cut && !block.has("G331") && !block.has("G332")) {
    fail("a motion after a thread requires G33, G331 or G332 in its block, or G0 or G1");
  }
  Block end = block;
  std::optional<Number> pitch;
  for (auto& one : end.centre) {
    if (one && pitch) fail(one->place, "the pitch appears twice in the block");
    if (one) pitch = std::exchange(one, std::nullopt);
  }
  if (!pitch || pitch->value == 0.0) fail("G33, G331 and G332 require the pitch as I, J or K");
  require_axis_of_pitch(block);
  const bool is_right = pitch->value > 0.0;
  if (!is_cut) {
    const bool is_forward = block.has("G331") == is_right;
    spindle_ = is_forward ? 1 : -1;
    note(is_forward ? "M3" : "M4");
  } else if (spindle_ == 0) {
    fail("G33 requires M3 or M4");
  }
  Motion motion;
  motion.place = place_;
  motion.words = ends(end, motion.is_incremental);
  motion.feed = {Feed::Kind::per_minute, std::abs(pitch->value) * unit() * *speed_};
  add(std::move(motion));
  last_element_.reset();
  if (block.has("G332")) {
    spindle_ = 0;
    note("M5");
  }
}

// G63 acts in its block only; F must fit the pitch, override is without effect. [F] "Tapping with
// compensating chuck"
void Translator::tap_with_chuck(const Block& block) {
  const MotionCode before = std::exchange(modes_.motion, MotionCode::line);
  const double override = std::exchange(override_, 1.0);
  move_straight(block);
  modes_.motion = before;
  override_ = override;
}

}  // namespace servomill::controllers::siemens
