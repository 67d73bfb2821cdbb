// Straight lines: L, LP, M91, M140; RND and CHF.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "controllers/conversational/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

constexpr double kShortest = 1e-9;  // mm; a shorter line is dropped
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool is_rotary_only(const Positioning& p) { return !p.target[0] && !p.target[1] && !p.target[2]; }

bool moves_rotary(const Positioning& p) { return p.target[3] || p.target[4] || p.target[5]; }

}  // namespace

void Translator::line(const HeidenhainBlock& block) {
  const bool has_head = block.words.front().text == "L";
  Words words(std::span(block.words).subspan(has_head ? 1 : 0));
  const Positioning p = read_positioning(words, "L");
  words.refuse_rest("L");
  if (p.direction || p.polar_angle || p.polar_radius)
    fail("L does not accept DR, PR or PA; use LP with PR and PA");
  begin_functions(p);
  set_side(p);
  move_straight(p);
  end_functions(p);
}

void Translator::set_side(const Positioning& p) {
  if (!p.side) return;
  if (*p.side != 0 && is_tcp_) fail("RL and RR are not allowed with M128; cancel it with M129");
  side_ = *p.side;
}

void Translator::move_straight(const Positioning& p) {
  if (p.retract) return retract(p);
  if (p.is_retract_to_limit) return retract_to_limit(p);
  if (!p.has_target()) {
    if (p.has(91)) fail("M91 requires a coordinate");
    if (p.feed && p.feed->kind == Feed::Kind::per_minute) feed_ = p.feed->value;
    return;
  }
  if (p.has(91)) return move_to_machine(p);
  if (p.has(92)) return move_to_reference(p);
  if (moves_rotary(p) && turn_to_plane(p)) return;
  if (moves_rotary(p) && plane_)
    fail("rotary axes cannot be programmed in a tilted plane; program PLANE RESET first");
  const Feed feed = feed_of(p);
  if (moves_rotary(p) && !is_rotary_only(p) && !is_tcp_ && feed.kind == Feed::Kind::per_minute) {
    warn_once("mixed feed",
              "F in a block with linear and rotary axes: treated as the feed rate of the linear "
              "axes; on some machines it applies to all axes combined");
  }
  Motion motion = motion_of(p);
  motion.feed = feed;
  if (is_rotary_only(p) && is_inch_ && feed.kind == Feed::Kind::per_minute) {
    motion.feed.value /= 2.54;  // degrees per minute
  }
  const auto before = program_point(2);
  const auto begin = work_point(2);
  const bool in_plane = motion.words[0] || motion.words[1];
  if (in_plane && begin && !motion.is_incremental) {
    const Point end(motion.words[0].value_or(begin->x()), motion.words[1].value_or(begin->y()));
    if ((end - *begin).norm() > kShortest) motion.element = Element{*begin, end, false, {0, 0}, 0};
  }
  add(std::move(motion));
  last_element_.reset();
  const auto after = program_point(2);
  if (in_plane && before && after && (*after - *before).norm() > kShortest) {
    last_element_ = Element{*before, *after, false, {0, 0}, 0};
    last_normal_ = 2;
  }
}

Motion Translator::motion_of(const Positioning& p) {
  Motion motion;
  motion.place = place_;
  motion.words = ends(p, motion.is_incremental);
  return motion;
}

double Translator::tool_radius(const Place& place) const {
  const ToolEntry* tool = setup_.tools.find(tool_);
  if (!has_tool_call_ && tool_ == 0) fail(place, "RL and RR require a preceding TOOL CALL");
  if (tool == nullptr) {
    fail(place, fmt::format("RL and RR: the radius of tool {} is unknown; pass a tool table with "
                            "--tools",
                            tool_));
  }
  if (tools_without_radius_.contains(tool_)) {
    fail(place,
         fmt::format("RL and RR: TOOL DEF {} has no R, so the radius is unknown; add R", tool_));
  }
  return tool->diameter / 2.0 / mm + delta_radius_;
}

// A survey that lacks the radius follows the programmed contour, without DR.
bool Translator::survey_knows_no_radius() {
  const bool is_unknown = setup_.tools.find(tool_) != nullptr &&
                          setup_.tools.entry_of(tool_) == nullptr &&
                          !tools_without_radius_.contains(tool_);
  if (is_unknown) {
    warn_once("radius",
              fmt::format("RL and RR: the radius of tool {} is unknown; the path is the programmed "
                          "contour; pass a tool table with --tools",
                          tool_));
  }
  return is_unknown;
}

// The end of a motion is the position programmed last.
void Translator::store_end(const Motion& motion) {
  for (std::size_t i = 0; i < motion.words.size(); ++i) {
    if (!motion.words[i]) continue;
    if (!motion.is_incremental) {
      work_[i] = motion.words[i];
    } else if (work_[i]) {
      *work_[i] += *motion.words[i];
    }
  }
}

// The tool leaves the contour with the first block of its plane after R0.
void Translator::end_compensation(bool names_both) {
  if (!names_both && !survey_knows_no_radius()) {
    fail(
        "the block after R0 must program both axes of the plane: the position of the other axis is "
        "undocumented");
  }
  is_beside_ = false;
}

// Stores the end position and passes the motion on with the side of the tool.
void Translator::add(Motion motion) {
  motion.side = frame_.is_mirrored_in_plane() ? -side_ : side_;
  if (are_feeds_unknown_ && motion.feed.kind != Feed::Kind::rapid) {
    motion.feed = {Feed::Kind::unknown};
  }
  const auto axes = plane_axes(motion.normal);
  const bool names_first = motion.words[axes[0]].has_value();
  const bool names_second = motion.words[axes[1]].has_value();
  const bool in_plane = names_first || names_second;
  if (side_ != 0 && in_plane) {
    if (motion.normal != 2) fail("RL and RR are supported in the XY plane only");
    motion.radius = survey_knows_no_radius() ? 0.0 : tool_radius(place_);
    if (motion.radius < 0.0) fail("RL and RR: the tool radius including DR is negative");
  }
  if (side_ == 0 && path_.is_compensating()) is_beside_ = true;
  if (is_beside_ && side_ == 0 && in_plane) end_compensation(names_first && names_second);
  store_end(motion);
  // the tip stays where it is, the other way round
  const bool turns = motion.words[3] || motion.words[4] || motion.words[5];
  if (turns && is_tcp_) last_element_.reset();
  if (motion.words[2] && !motion.is_machine) {
    *motion.words[2] += motion.is_incremental ? 0.0 : delta_length_;
  }
  path_.add(std::move(motion));
}

// Coordinates of M91 count from the machine datum; length of the tool, shift and mirroring do not
// act on them.
void Translator::move_to_machine(const Positioning& p) {
  require_no_compensation("M91");
  // [530] p. 290 (M128), TNC 407 manual, M91 (tilted plane)
  if (is_tcp_) fail("M91 is not allowed with M128; cancel it with M129");
  if (plane_) fail("M91 is not allowed in a tilted plane; program PLANE RESET first");
  Motion motion;
  motion.place = place_;
  motion.is_machine = true;
  motion.feed = feed_of(p);
  for (std::size_t i = 0; i < motion.words.size(); ++i) {
    if (!p.target[i]) continue;
    const auto& target = *p.target[i];
    if (target.is_increment) fail(target.value.place, "M91 requires absolute coordinates");
    motion.words[i] = i < 3 ? length(target.value) : value(target.value);
  }
  path_.add(motion);
  for (std::size_t i = 0; i < motion.words.size(); ++i) {
    if (!motion.words[i]) continue;
    work_[i].reset();
    is_rotary_zero_left_ |= i >= 3 && *motion.words[i] != 0.0;
  }
  last_element_.reset();
}

// M92 counts from a point that the machine's builder has set (TNC 640: MP additional datum; iTNC
// 530: MP960; from memory). Surveys take the second home of G30, which is not known either.
void Translator::move_to_reference(const Positioning& p) {
  require_no_compensation("M92");
  if (is_tcp_ || plane_)
    fail("M92 is not supported with M128 or in a tilted plane; cancel them first");
  const std::string why = "M92: the machine builder's reference point is unknown; use M91";
  if (!setup_.accepts_unknown_positions) fail(why);
  feed_of(p);
  warn_once("M92", why);
  std::string axes;
  for (std::size_t i = 0; i < work_.size(); ++i) {
    if (!p.target[i]) continue;
    if (p.target[i]->is_increment)
      fail(p.target[i]->value.place, "M92 requires absolute coordinates");
    axes += fmt::format(" {}0", letter(kAllAxes[i]));
    work_[i].reset();
  }
  note("G91 G30" + axes);
  note("G90");
  last_element_.reset();
}

// M140 MB: along the tool axis.
void Translator::retract(const Positioning& p) {
  if (p.has_target()) fail("M140 does not accept coordinates; program them in a separate block");
  if (is_tcp_)
    fail(
        "M140 with M128 is not supported: the retraction follows the inclined tool axis; program "
        "L");
  if (plane_ && !is_tool_in_plane_) {
    if (can_leave_plane_unknown()) return forget_linear_positions();
    fail(
        "MB after PLANE ... STAY, before the rotary axes are positioned: the direction is "
        "undetermined (tool axis or Z of the plane); position them first, or program L");
  }
  Motion motion;
  motion.place = place_;
  motion.feed = p.feed ? *p.feed : Feed{};
  motion.words[2] = *p.retract;
  motion.is_incremental = true;
  add(std::move(motion));
}

// M140 MB MAX: along the tool axis to the end of travel, at rapid where the block has no F. Where
// the machine is unknown, surveys take the stored position of G28 for a position that is not known.
void Translator::retract_to_limit(const Positioning& p) {
  if (p.has_target()) fail("M140 does not accept coordinates; program them in a separate block");
  if (is_tcp_ || plane_) {
    fail(
        "M140 MB MAX with M128 or in a tilted plane is not supported: the retraction follows the "
        "inclined tool axis; cancel them first, or program MB with a number");
  }
  require_no_compensation("M140 MB MAX");
  std::optional<double> end;
  if (setup_.machine) {
    const auto joint = setup_.machine->chain().layout.joint_of(Axis::Z);
    const double upper = joint ? setup_.machine->upper_travel()[*joint] : kInfinity;
    if (std::isfinite(upper)) end = upper / mm;
  }
  const std::string why =
      "M140 MB MAX: the upper travel limit of Z is unknown; pass a machine with --machine, or use "
      "MB with a number or M91";
  if (!end && !setup_.accepts_unknown_positions) fail(why);
  if (end) {
    Motion motion;
    motion.place = place_;
    motion.is_machine = true;
    motion.feed = p.feed ? *p.feed : Feed{};
    motion.words[2] = end;
    path_.add(std::move(motion));
  } else {
    warn_once("M140", why);
    for (const char* text : {"G91 G28 Z0", "G90"}) note(text);
  }
  work_[2].reset();
  last_element_.reset();
}

// --------------------------------------------------------------------------------- polar, corners

// PR and PA about the pole, in program coordinates; a coordinate left out keeps its value.
// Increments count from the position: [530] p. 231.
std::optional<Point> Translator::polar_point(const Positioning& p, int normal) const {
  if (!pole_) fail("polar coordinates require a preceding CC in the same coordinate system");
  const auto now = program_point(normal);
  const bool needs_now = !p.polar_radius || !p.polar_angle || p.polar_radius->is_increment ||
                         p.polar_angle->is_increment;
  if (needs_now && !now) fail("polar coordinates: the position in the plane is unknown here");
  const Point ray = now ? Point(*now - *pole_) : Point(Point::Zero());
  double radius = ray.norm();
  double angle = std::atan2(ray.y(), ray.x()) / deg;
  if (p.polar_radius) {
    const double written = length(p.polar_radius->value);
    radius = p.polar_radius->is_increment ? radius + written : written;
  }
  if (p.polar_angle) {
    const double written = value(p.polar_angle->value);
    angle = p.polar_angle->is_increment ? angle + written : written;
  }
  return *pole_ + radius * Point(std::cos(angle * deg), std::sin(angle * deg));
}

void Translator::polar_line(const HeidenhainBlock& block) {
  Words words(std::span(block.words).subspan(1));
  Positioning p = read_positioning(words, "LP");
  words.refuse_rest("LP");
  if (!p.polar_radius && !p.polar_angle) fail("LP requires PR or PA");
  if (p.has(91)) fail("LP does not accept M91");
  const auto axes = plane_axes(pole_normal_);
  if (p.target[axes[0]] || p.target[axes[1]]) fail("LP does not accept axes of the plane of CC");
  begin_functions(p);
  set_side(p);
  set_program_point(p, pole_normal_, *polar_point(p, pole_normal_));
  move_straight(p);
  end_functions(p);
}

void Translator::round_or_chamfer(const HeidenhainBlock& block, bool is_rounding) {
  const std::string_view name = is_rounding ? "RND" : "CHF";
  // "RND R5", "RND5", "CHF 12", "CHF12"
  std::vector<HeidenhainWord> all(block.words.begin(), block.words.end());
  if (is_rounding && all.front().rest.empty()) all.erase(all.begin());
  Words words(all);
  auto size = words.take_number(name);
  if (!size && is_rounding) size = words.take_number("R");
  if (!size && !is_rounding) size = words.take_number("L");
  if (!size) fail(fmt::format("{} requires a {}", name, is_rounding ? "radius" : "length"));
  const Positioning p = read_positioning(words, name);
  words.refuse_rest(name);
  if (p.has_target()) fail(fmt::format("{} does not accept coordinates", name));
  const double written = length(*size) * frame_.scale;
  if (!(written > 0.0)) fail(fmt::format("{}: must be > 0", name));
  std::optional<Feed> feed = p.feed;
  if (!feed && feed_) feed = modal_feed();
  if (feed && feed->kind != Feed::Kind::per_minute)
    fail(fmt::format("{}: F must be in mm/min", name));
  begin_functions(p);
  using Kind = ContourPath::CornerKind;
  path_.corner(is_rounding ? Kind::rounding : Kind::chamfer, written, feed, place_);
  last_element_.reset();
  end_functions(p);
}

}  // namespace servomill::controllers::conversational
