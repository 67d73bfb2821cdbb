#include "controllers/path/feed_reduction.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

// Time that a block asks for, s; 0: as fast as the joints can.
double time_of(const Move& move, const AxisWords& from, const PathOptions& options) {
  const AxisWords step = move.end_machine - from;
  const bool is_curve = move.kind == MoveKind::arc || move.kind == MoveKind::spline;
  const double way = is_curve                                    ? move.s_end - move.s_begin
                     : step.head<3>() != Eigen::Vector3d::Zero() ? step.head<3>().norm()
                                                                 : step.tail<3>().norm();
  return move.feed > 0.0 ? way / (move.feed * options.feed_override) : 0.0;
}

}  // namespace

double FeedReduction::share() const { return std::pow(allowed / needed, 1.0 / order); }

double least_time(const MoveRange& moves, const AxisWords& start, const PathOptions& options) {
  double sum = 0.0;
  AxisWords before = start;
  for (const Move& move : moves) {
    if (!is_motion(move.kind)) continue;
    const AxisWords from = std::exchange(before, move.end_machine);
    const bool counts = move.kind != MoveKind::rapid && move.tool_control == ToolControl::none &&
                        move.feed_mode != FeedMode::units_per_revolution;
    if (counts) sum += time_of(move, from, options);
  }
  return sum;
}

std::optional<FeedReduction> slowed_inverse_time(const MoveRange& moves, const JointLayout& layout,
                                                 const Joints& start, const JointLimits& limits,
                                                 const PathOptions& options) {
  constexpr double kRounding = 1e-6;  // of F, as programs print it
  std::optional<FeedReduction> worst;
  std::size_t count = 0;
  AxisWords before = layout.words(start);
  for (const Move& move : moves) {
    if (!is_motion(move.kind)) continue;
    const AxisWords from = std::exchange(before, move.end_machine);
    const bool is_asked = move.kind != MoveKind::rapid && move.tool_control == ToolControl::none &&
                          move.feed_mode == FeedMode::inverse_time;
    const double time = is_asked ? time_of(move, from, options) : 0.0;
    if (!(time > 0.0)) continue;
    const Joints rate = layout.joints(AxisWords((move.end_machine - from).cwiseAbs() / time));
    std::optional<FeedReduction> here;
    for (int j = 0; j < kJoints; ++j) {
      if (!layout.has(j) || rate[j] <= (1.0 + kRounding) * limits.v[j]) continue;
      const FeedReduction one{move.line, j, rate[j], limits.v[j]};
      if (!here || one.share() < here->share()) here = one;
    }
    if (!here) continue;
    ++count;
    if (!worst || here->share() < worst->share()) worst = here;
  }
  if (worst) worst->others = count - 1;
  return worst;
}

std::string to_string(const FeedReduction& s, const JointLayout& layout) {
  constexpr double kWaits = 1e-3;  // of the programmed feed: next to nothing
  const bool is_near = s.singular_angle < kNearSingular;
  if (s.share() < kWaits) {
    return fmt::format("{}the TCP is at rest while {} {}",
                       is_near ? "in a singular direction of the tool axis " : "",
                       layout.letter_of(s.joint), s.joint < kLinearJoints ? "moves" : "rotates");
  }
  const bool is_linear_joint = s.joint < kLinearJoints;
  const double unit = is_linear_joint ? mm : deg;
  const std::string rate = fmt::format("{}/s{}", is_linear_joint ? "mm" : "deg",
                                       s.order == 1 ? "" : fmt::format("^{}", s.order));
  const std::string where =
      is_near ? fmt::format(", {:.2f} deg from a singular direction of the tool axis",
                            s.singular_angle / deg)
              : "";
  const std::string others = s.others == 0   ? ""
                             : s.others == 1 ? ", and in one other block"
                                             : fmt::format(", and in {} other blocks", s.others);
  return fmt::format(
      "the programmed feed rate requires {} at {:.4g} {}{}; its limit is {:.4g}: the feed rate is "
      "reduced to {}{:.3g} %{}",
      layout.letter_of(s.joint), s.needed / unit, rate, where, s.allowed / unit,
      s.order == 1 ? "" : "about ", 100.0 * s.share(), others);
}

}  // namespace servomill::controllers
