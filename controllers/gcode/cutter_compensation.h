/// Cutter radius compensation in the plane: where the centre of a round tool goes so that its
/// circumference follows the programmed path. As LinuxCNC 2.9 does it; values in, values out.
///
/// The tool stands beside the path, `radius` away from it. Where the path turns away from the tool
/// (convex corner) the tool rolls around the corner; where it turns towards the tool (concave
/// corner) the move before ends early and the next begins late, at the one point that is `radius`
/// away from both. So a move can be given out only when the next one is known.
///
///        . - - - .              -----------+  . . . tool, before and after
///        |   arc  .                        |
///     ---|-----+  .             - - - - +  |
///   tool       |  .                     .  |  path
///    above     |  .                     .  |
///
/// Laws, for a path without gouging: (1) every point of the compensated path is `radius` away from
/// the programmed path, (2) the compensated path is continuous, (3) so is its direction, but for
/// concave corners, and corners that turn by less than 0.05 rad: there the path of the tool has a
/// small kink, and is off by at most radius / cos(0.025 rad) - radius, 0.03 % of the radius.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace servomill::controllers {

struct Cutter {
  double radius = 0.0;  // m, > 0
  bool is_left = true;  // of the path, seen along it
};

/// A line or an arc, (2; m) in the order of the plane: X Y for G17, Z X for G18.
struct PlaneMove {
  Eigen::Vector2d begin = Eigen::Vector2d::Zero();
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  bool is_arc = false;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // of an arc
  int turns = 0;                                     // of an arc, as in `Arc`
};

/// A move of the centre of the tool whose end may still change.
struct HeldMove {
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  bool is_arc = false;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  int turns = 0;
  /// Line: which way the move must go; zero if any will do.
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();
  /// Arc: angle of the programmed one, rad, signed.
  double sweep = 0.0;
};

/// A move, or why it cannot be made (`fault` not empty).
struct Compensated {
  HeldMove move;
  std::string fault;
};

/// The first move after compensation is switched on, from where the tool stands: its end is beside
/// the end of the programmed move. An arc stays an arc; it begins where the tool is and ends in the
/// direction of the programmed one.
/// @param programmed  begins where the tool stands
Compensated entry_move(const Cutter& cutter, const PlaneMove& programmed);

/// Any later move, up to its end. Where it begins is said by `corner`.
Compensated following_move(const Cutter& cutter, const PlaneMove& programmed);

enum class CornerKind {
  straight,  // nothing to be done
  convex,    // an arc about the corner leads to `point`
  concave,   // the move before ends at `point`, the next begins there
};

struct Corner {
  CornerKind kind = CornerKind::straight;
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  std::string fault;
};

/// The corner in front of a programmed move.
/// @param tool    where the tool stands at the end of the move before
/// @param before  that move, compensated
Corner corner(const Cutter& cutter, const Eigen::Vector2d& tool, const HeldMove& before,
              const PlaneMove& next);

/// The point beside the begin of a programmed move, `radius` away from it.
Eigen::Vector2d point_beside_begin(const Cutter& cutter, const PlaneMove& move);

/// Result of `move_end`.
struct EndTolerance {
  double radius;  // m, how much the radius of an arc may change
  double sweep;   // rad, how much an arc may become longer
};
/// In LinuxCNC both are numbers whose unit is that of the program, the angle, too.
inline constexpr EndTolerance kEndToleranceMm = {1e-5, 0.0254};
inline constexpr EndTolerance kEndToleranceInch = {2.54e-4, 1e-3};

/// Ends a move elsewhere.
/// @param begin  where it begins; nullopt if that is not known, then nothing is checked but the
///               radius of an arc
/// @return why the tool cannot go there without cutting into the part, or an empty text
std::string move_end(HeldMove& move, const std::optional<Eigen::Vector2d>& begin,
                     const Eigen::Vector2d& end, const EndTolerance& tolerance);

}  // namespace servomill::controllers
