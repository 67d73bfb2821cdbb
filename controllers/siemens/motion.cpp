// Straight lines, feeds, corners.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/translator.h"

namespace servomill::controllers::siemens {
namespace {

constexpr double kShortest = 1e-9;  // mm; a shorter line is dropped

bool moves_rotary(const Motion& motion) {
  return motion.words[3] || motion.words[4] || motion.words[5];
}

bool moves_linear(const Motion& motion) {
  return motion.words[0] || motion.words[1] || motion.words[2];
}

}  // namespace

bool Translator::moves(const Block& block) const {
  const bool is_circle = block.has_centre() || block.CR || block.AR || block.TURN;
  const bool has_direction = std::any_of(block.direction.begin(), block.direction.end(),
                                         [](const auto& one) { return one.has_value(); });
  return block.has_axes() || block.is_polar() || is_circle || has_direction;
}

void Translator::move(const Block& block) {
  if (block.has("G63")) return tap_with_chuck(block);
  if (codes_[static_cast<std::size_t>(Group::suppression)] != nullptr) {
    return move_to_machine(block);
  }
  warn_of_start(block);
  if (!plane_line_.empty() && (block.axes[3] || block.axes[4] || block.axes[5])) {
    fail("rotary axes cannot be programmed in a plane of CYCLE800; program CYCLE800() first");
  }
  check_length_axis(false);
  switch (modes_.motion) {
    case MotionCode::rapid:
    case MotionCode::line:
      move_straight(block);
      return corner(block);
    case MotionCode::thread:
      return thread(block);
    case MotionCode::through_point:
      arc_through_point(block);
      return corner(block);
    case MotionCode::tangential:
      tangential_arc(block);
      return corner(block);
    default:
      arc(block);
      corner(block);
  }
}

// ------------------------------------------------------------------------------------------ feeds

// Before the override, which threads and taps do without.
Feed Translator::modal_feed(double override) {
  const std::string why = "no F is active";
  if (!feed_ && !setup_.accepts_unknown_feeds) fail(why);
  if (!feed_) {
    warn_once("feed", why + "; the cycle time is unknown");
    return {Feed::Kind::unknown};
  }
  return effective(*feed_, override);
}

Feed Translator::modal_feed() { return modal_feed(override_); }

Feed Translator::feed_of_block(const Block&) {
  return modes_.motion == MotionCode::rapid ? Feed{} : modal_feed();
}

// ----------------------------------------------------------------------------------------- motion

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

// Stores the end position and passes the motion on with the side of the tool.
void Translator::add(Motion motion) {
  const auto axes = plane_axes(modes_.normal);
  motion.normal = modes_.normal;
  const bool in_plane = motion.words[axes[0]] || motion.words[axes[1]];
  if (modes_.side != 0 && in_plane) {
    motion.side = modes_.frame.is_mirrored(modes_.normal) ? -modes_.side : modes_.side;
    motion.radius = survey_knows_no_radius() ? 0.0 : tool_radius();
    motion.is_feed_of_contour = modes_.is_contour_feed;
    if (!modes_.frame.keeps_plane(modes_.normal)) {
      fail("G41 and G42 in a plane tilted by ROT are not supported");
    }
  } else if (modes_.side != 0) {
    motion.side = modes_.side;
  }
  is_beside_ = is_beside_ || (modes_.side == 0 && path_.is_compensating());
  if (is_beside_ && modes_.side == 0 && in_plane) {
    // the end of the compensation needs both axes of the plane: the other one returns, too
    is_beside_ = false;
    if (motion.element && motion.element->is_arc)
      fail("G40 is not allowed with an arc; program a line first");
    for (const std::size_t axis : axes) {
      if (!motion.words[axis] && !motion.is_incremental) motion.words[axis] = work_[axis];
    }
  }
  store_end(motion);
  if (moves_rotary(motion) && is_tcp_) last_element_.reset();
  path_.add(std::move(motion));
}

Motion Translator::motion_of(const Block& block) {
  Motion motion;
  motion.place = place_;
  motion.normal = modes_.normal;
  motion.words = ends(block, motion.is_incremental);
  motion.feed = feed_of_block(block);
  return motion;
}

// The motion of G0 and G1, to a polar position, too.
Motion Translator::straight_motion(const Block& block) {
  if (!block.is_polar()) return motion_of(block);
  const auto axes = plane_axes(modes_.normal);
  if (block.axes[axes[0]] || block.axes[axes[1]]) {
    fail("AP and RP are not allowed with an axis of the plane");
  }
  Block cartesian = block;
  const Point end = polar_point(block);
  for (int i = 0; i < 2; ++i) {
    cartesian.axes[axes[static_cast<std::size_t>(i)]] =
        Number{end[i] / unit(), Measure::absolute, place_};
  }
  return motion_of(cartesian);
}

void Translator::move_straight(const Block& block) {
  const auto before = program_point(modes_.normal);
  const auto axes = plane_axes(modes_.normal);
  const auto from_u = work_[axes[0]], from_v = work_[axes[1]];
  Motion motion = straight_motion(block);
  if (moves_rotary(motion) && !moves_linear(motion) && !is_tcp_ && feed_unit_ != 1.0 &&
      motion.feed.kind == Feed::Kind::per_minute) {
    fail(
        "F in inches for rotary axes only: the conversion to degrees depends on FGREF; program "
        "G710");
  }
  if (moves_rotary(motion) && moves_linear(motion) && !is_tcp_ &&
      motion.feed.kind == Feed::Kind::per_minute) {
    warn_once("mixed feed",
              "F in a block with linear and rotary axes: treated as the feed rate of the linear "
              "axes (FGROUP, MD22420)");
  }
  const bool in_plane = motion.words[axes[0]] || motion.words[axes[1]];
  if (in_plane && from_u && from_v && !motion.is_incremental) {
    const Point begin(*from_u, *from_v);
    const Point end(motion.words[axes[0]].value_or(*from_u),
                    motion.words[axes[1]].value_or(*from_v));
    if ((end - begin).norm() > kShortest) motion.element = Element{begin, end, false, {0, 0}, 0};
  }
  add(std::move(motion));
  last_element_.reset();
  const auto after = program_point(modes_.normal);
  if (in_plane && before && after && (*after - *before).norm() > kShortest) {
    last_element_ = Element{*before, *after, false, {0, 0}, 0};
    last_normal_ = modes_.normal;
  }
}

// G53, G153 and SUPA count from the machine datum. The tool length stays in force, unless MD10760
// is 1: [F] "Deselection of frames".
void Translator::move_to_machine(const Block& block) {
  const Code& code = *codes_[static_cast<std::size_t>(Group::suppression)];
  require_no_compensation(code.name);
  if (is_tcp_)
    fail(code.place,
         fmt::format("{} is not allowed with TRAORI; cancel it with TRAFOOF", code.name));
  if (modes_.motion != MotionCode::rapid && modes_.motion != MotionCode::line) {
    fail(code.place, fmt::format("{} is not allowed with an arc or a thread", code.name));
  }
  Motion motion;
  motion.place = place_;
  motion.is_machine = true;
  motion.feed = feed_of_block(block);
  for (std::size_t i = 0; i < motion.words.size(); ++i) {
    if (!block.axes[i]) continue;
    const Number& number = *block.axes[i];
    if (is_increment(number))
      fail(number.place, fmt::format("{} requires absolute positions", code.name));
    if (number.measure != Measure::modal && number.measure != Measure::absolute) {
      fail(number.place,
           fmt::format("{} does not accept DC, ACP or ACN; program the absolute position",
                       code.name));
    }
    motion.words[i] = number.value * (i < 3 ? unit() : 1.0);
  }
  if (!block.has_axes()) fail(code.place, fmt::format("{} requires an axis", code.name));
  if (motion.words[2] && tool_length() != 0.0) {
    const bool is_dropped = setting("$MN_G53_TOOLCORR", 0.0) != 0.0;
    if (!is_dropped) *motion.words[2] += tool_length();
    warn_once("G53_TOOLCORR",
              fmt::format("{} with an active tool length: {} (MD10760); program D0, or pass "
                          "--parameter '$MN_G53_TOOLCORR={}'",
                          code.name, is_dropped ? "it is suppressed" : "it remains active",
                          is_dropped ? 0 : 1));
  }
  for (std::size_t i = 0; i < motion.words.size(); ++i) {
    if (!motion.words[i]) continue;
    work_[i].reset();
    programmed_[i] = 0.0;  // no frame applied: a following IC is treated as after a frame change
  }
  put_beside_plane(std::move(motion));
  last_element_.reset();
}

// RND, CHF and CHR follow the element of their block. CHF is the length of the chamfer, CHR that
// along each element. [F] "Chamfer, rounding"
void Translator::corner(const Block& block) {
  const auto& size = block.RND ? block.RND : block.CHR ? block.CHR : block.CHF;
  if (!size) return;
  if (!(size->value > 0.0)) fail(size->place, "RND, CHF and CHR must be > 0");
  if (modes_.motion == MotionCode::rapid) {
    fail(size->place, "RND, CHF and CHR between rapid moves are not supported; use G1");
  }
  if (modes_.feed_code == 93) {
    fail(size->place, "RND, CHF and CHR with G93 are not supported; use them with G94 or G95");
  }
  std::optional<Feed> feed;
  if (block.FRC) {
    if (!(block.FRC->value > 0.0)) fail(block.FRC->place, "FRC must be > 0");
    const double unit = unit_of_feed(block.FRC->place);
    feed = effective(unit == 0.0 ? Feed{Feed::Kind::unknown}
                                 : Feed{Feed::Kind::per_minute, block.FRC->value * unit},
                     override_);
  } else if (feed_) {
    feed = effective(*feed_, override_);
  }
  const double length = size->value * unit() * modes_.frame.scale_in_plane(modes_.normal);
  using Kind = ContourPath::CornerKind;
  const Kind kind = block.RND ? Kind::rounding : block.CHR ? Kind::chamfer : Kind::chamfer_width;
  path_.corner(kind, length, feed, place_);
  blocks_behind_corner_ = 0;
  last_element_.reset();
}

}  // namespace servomill::controllers::siemens
