// Positions and straight lines.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/translator.h"

namespace servomill::controllers::siemens {
namespace {

constexpr double kShortest = 1e-9;  // mm; a shorter line is dropped
constexpr double kTurn = 360.0;

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
  for (const auto& one : block.direction) {
    if (one) {
      fail(one->place,
           "A3=, B3=, C3=: tool directions are not supported; post-process to rotary axes");
    }
  }
  if (block.has("G63")) return tap_with_chuck(block);
  if (codes_[static_cast<std::size_t>(Group::suppression)] != nullptr) {
    return move_to_machine(block);
  }
  warn_of_start(block);
  if (!plane_line_.empty() && (block.axes[3] || block.axes[4] || block.axes[5])) {
    fail("a rotary axis in a plane of CYCLE800; program CYCLE800() first");
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

// ------------------------------------------------------------------------------------- positions

bool Translator::is_increment(const Number& number) const {
  return number.measure == Measure::incremental ||
         (number.measure == Measure::modal && modes_.is_incremental);
}

// An increment behind a new frame or length takes it in as SD42440 and SD42442 say: K2
// (6FC5397-0BP10-0BA0) p. 1-7.
void Translator::require_same_offset(std::size_t axis, const Number& number) const {
  constexpr double kSame = 1e-9;  // mm
  if (!is_increment(number) || !programmed_[axis]) return;
  const auto now = program_position(static_cast<int>(axis));
  if (now && std::abs(*now - *programmed_[axis]) < kSame) return;
  fail(number.place,
       fmt::format("an increment of {} behind a change of the frame, the work offset or the tool "
                   "length: whether it takes the change in depends on SD42440 and SD42442; program "
                   "an absolute position first",
                   letter(kAllAxes[axis])));
}

// The position of an axis in the program's coordinates, where those that it depends on are known.
std::optional<double> Translator::program_position(int axis) const {
  Eigen::Vector3d work = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto& known = work_[static_cast<std::size_t>(i)];
    if (!known && modes_.frame.couples_back(axis, i)) return std::nullopt;
    work[i] = known.value_or(0.0);
  }
  return modes_.frame.to_program(work)[axis];
}

std::optional<Point> Translator::program_point(int normal) const {
  const auto axes = plane_axes(normal);
  const auto u = program_position(static_cast<int>(axes[0]));
  const auto v = program_position(static_cast<int>(axes[1]));
  if (!u || !v) return std::nullopt;
  return Point(*u, *v);
}

/// @pre the frame keeps the plane
Point Translator::work_point(int normal, const Point& program) const {
  const auto axes = plane_axes(normal);
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int i = 0; i < 2; ++i)
    p[static_cast<Eigen::Index>(axes[static_cast<std::size_t>(i)])] = program[i];
  const Eigen::Vector3d work = modes_.frame.to_work(p);
  return {work[static_cast<Eigen::Index>(axes[0])], work[static_cast<Eigen::Index>(axes[1])]};
}

// X, Y, Z that move, since the block names them or the frame is turned. Increments from unknown
// positions stay increments.
void Translator::linear_ends(const Block& block, Values& end, bool& is_incremental) {
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), by = Eigen::Vector3d::Zero();
  std::array<bool, 3> is_named{}, is_known{};
  std::size_t named = 0, free = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto now = program_position(static_cast<int>(i));
    is_known[i] = now.has_value();
    p[k] = now.value_or(0.0);
    if (!block.axes[i]) continue;
    const Number& number = *block.axes[i];
    if (number.measure != Measure::modal && number.measure != Measure::absolute &&
        number.measure != Measure::incremental) {
      fail(number.place,
           fmt::format("{}: DC, ACP and ACN are for rotary axes", letter(kAllAxes[i])));
    }
    require_same_offset(i, number);
    is_named[i] = true;
    ++named;
    by[k] = number.value * unit();
    const bool is_by = is_increment(number);
    if (is_by && !now) ++free;
    p[k] = by[k] + (is_by ? p[k] : 0.0);
    is_known[i] = is_known[i] || !is_by;
  }
  if (free > 0 && free < named) {
    fail(
        "an increment from a position that is unknown here, beside other axes; program an "
        "absolute position first");
  }
  is_incremental = free > 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!is_named[i]) continue;
    programmed_[i].reset();
    if (!is_incremental) programmed_[i] = p[static_cast<Eigen::Index>(i)];
  }
  const Eigen::Vector3d to = is_incremental ? modes_.frame.increment(by) : modes_.frame.to_work(p);
  for (int i = 0; i < 3; ++i) {
    bool is_moved = false;
    for (int j = 0; j < 3; ++j) {
      is_moved = is_moved || (is_named[static_cast<std::size_t>(j)] && modes_.frame.couples(i, j));
    }
    if (!is_moved) continue;
    for (int j = 0; j < 3 && !is_incremental; ++j) {
      if (is_known[static_cast<std::size_t>(j)] || !modes_.frame.couples(i, j)) continue;
      fail(fmt::format("the frame is rotated, and the position of {} is unknown here; program it",
                       "XYZ"[j]));
    }
    end[static_cast<std::size_t>(i)] = to[i];
  }
}

// A modulo axis goes to a position within the turn that it is in; DC takes the shorter way, ACP and
// ACN the way in one direction. [F] "Absolute dimension for rotary axes"
double Translator::rotary_end(std::size_t axis, const Number& number) {
  const double target = modes_.frame.rotary_to_work(axis, number.value);
  if (number.measure == Measure::absolute || number.measure == Measure::modal) {
    return target + turns_[axis];
  }
  if (!work_[axis]) {
    fail(number.place, fmt::format("{}: the position of the axis is unknown here; program an "
                                   "absolute position first",
                                   letter(kAllAxes[axis])));
  }
  constexpr double kRounding = 1e-9;
  const double way = target - *work_[axis];
  double turned = std::remainder(way, kTurn);
  if (number.measure != Measure::shortest) {
    turned = way - kTurn * std::floor((way + kRounding) / kTurn);
    if (number.measure == Measure::negative && turned > kRounding) turned -= kTurn;
  } else if (std::abs(std::abs(turned) - kTurn / 2.0) < 1e-6) {
    fail(number.place,
         fmt::format("{}=DC: would turn by 180 degrees: the direction is undetermined",
                     letter(kAllAxes[axis])));
  }
  turns_[axis] = *work_[axis] + turned - target;
  return *work_[axis] + turned;
}

Values Translator::ends(const Block& block, bool& is_incremental) {
  Values end;
  linear_ends(block, end, is_incremental);
  for (std::size_t i = 3; i < end.size(); ++i) {
    if (!block.axes[i]) continue;
    const Number& number = *block.axes[i];
    if (!is_increment(number)) {
      if (is_incremental) fail(number.place, "absolute and unknown positions in one block");
      end[i] = rotary_end(i, number);
    } else if (is_incremental || !work_[i]) {
      if (!is_incremental &&
          std::any_of(end.begin(), end.end(), [](const auto& one) { return one.has_value(); })) {
        fail(number.place, "an increment of a rotary axis whose position is unknown here");
      }
      is_incremental = true;
      end[i] = modes_.frame.rotary_increment(i, number.value);
    } else {
      end[i] = *work_[i] + modes_.frame.rotary_increment(i, number.value);
    }
  }
  return end;
}

// ------------------------------------------------------------------------------------------ feeds

Feed Translator::modal_feed() {
  const std::string why = "no F is active";
  if (!feed_ && !setup_.accepts_unknown_feeds) fail(why);
  if (!feed_) {
    warn_once("feed", why + "; the cycle time stays unknown");
    return {Feed::Kind::unknown};
  }
  return *feed_;
}

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
      fail("G41 and G42 in a plane that ROT has turned in space are not supported");
    }
  } else if (modes_.side != 0) {
    motion.side = modes_.side;
  }
  is_beside_ = is_beside_ || (modes_.side == 0 && path_.is_compensating());
  if (is_beside_ && modes_.side == 0 && in_plane) {
    // the end of the compensation needs both axes of the plane: the other one returns, too
    is_beside_ = false;
    if (motion.element && motion.element->is_arc) fail("G40 with an arc; program a line first");
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
    fail("AP and RP beside an axis of the plane");
  }
  Block cartesian = block;
  const Point end = *polar_point(block, modes_.normal);
  for (int i = 0; i < 2; ++i) {
    cartesian.axes[axes[static_cast<std::size_t>(i)]] =
        Number{end[i] / unit(), Measure::absolute, place_};
  }
  return motion_of(cartesian);
}

void Translator::move_straight(const Block& block) {
  if (block.has_centre() || block.CR || block.AR || block.TURN) {
    fail("I, J, K, CR, AR or TURN without G2, G3 or CIP");
  }
  const auto before = program_point(modes_.normal);
  const auto axes = plane_axes(modes_.normal);
  const auto from_u = work_[axes[0]], from_v = work_[axes[1]];
  Motion motion = straight_motion(block);
  if (moves_rotary(motion) && moves_linear(motion) && !is_tcp_ &&
      motion.feed.kind == Feed::Kind::per_minute) {
    warn_once("mixed feed",
              "F of a block with linear and rotary axes: taken as the feed of the linear axes "
              "(FGROUP, MD22420)");
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
  if (is_tcp_) fail(code.place, fmt::format("{} with TRAORI; end it with TRAFOOF", code.name));
  if (modes_.motion != MotionCode::rapid && modes_.motion != MotionCode::line) {
    fail(code.place, fmt::format("{} with an arc or a thread", code.name));
  }
  Motion motion;
  motion.place = place_;
  motion.is_machine = true;
  motion.feed = feed_of_block(block);
  for (std::size_t i = 0; i < motion.words.size(); ++i) {
    if (!block.axes[i]) continue;
    const Number& number = *block.axes[i];
    if (is_increment(number)) fail(number.place, fmt::format("{} with an increment", code.name));
    motion.words[i] = number.value * (i < 3 ? unit() : 1.0);
  }
  if (!block.has_axes()) fail(code.place, fmt::format("{} without an axis", code.name));
  if (motion.words[2] && tool_length() != 0.0) {
    const bool is_dropped = setting("$MN_G53_TOOLCORR", 0.0) != 0.0;
    if (!is_dropped) *motion.words[2] += tool_length();
    warn_once("G53_TOOLCORR",
              fmt::format("{} with a tool length in force: {} (MD10760); program D0, or pass "
                          "--parameter '$MN_G53_TOOLCORR={}'",
                          code.name, is_dropped ? "it is dropped" : "it stays in force",
                          is_dropped ? 0 : 1));
  }
  for (std::size_t i = 0; i < motion.words.size(); ++i) {
    if (motion.words[i]) work_[i].reset();
    if (motion.words[i] && i < 3) programmed_[i].reset();
  }
  put_beside_plane(std::move(motion));
  last_element_.reset();
}

// RND, CHF and CHR follow the element of their block. CHF is the length of the chamfer, CHR that
// along each element. [F] "Chamfer, rounding"
void Translator::corner(const Block& block) {
  if (block.RNDM && block.RNDM->value != 0.0) {
    fail(block.RNDM->place, "RNDM: modal rounding is not supported; program RND in each block");
  }
  if (block.FRCM && block.FRCM->value != 0.0) {
    fail(block.FRCM->place, "FRCM is not supported; program FRC in each block");
  }
  const auto& size = block.RND ? block.RND : block.CHR ? block.CHR : block.CHF;
  if (!size) return;
  if (!(size->value > 0.0)) fail(size->place, "RND, CHF and CHR must be > 0");
  std::optional<Feed> feed = feed_;
  if (block.FRC && modes_.feed_code != 94) {
    fail(block.FRC->place,
         fmt::format("FRC with G{} is not supported; use it with G94", modes_.feed_code));
  }
  if (block.FRC) {
    feed = Feed{Feed::Kind::per_minute, block.FRC->value * (modes_.is_feed_inch ? 25.4 : 1.0)};
  }
  const double length = size->value * unit() * modes_.frame.scale_in_plane(modes_.normal);
  using Kind = ContourPath::CornerKind;
  const Kind kind = block.RND ? Kind::rounding : block.CHR ? Kind::chamfer : Kind::chamfer_width;
  path_.corner(kind, length, feed, place_);
  last_element_.reset();
}

}  // namespace servomill::controllers::siemens
