#include "sim/programs/compensate/timed_feed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/number_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::programs {
namespace {

constexpr double kStanding = 1e-12;      // m, rounding of offsets
constexpr double kSlowestInverse = 0.1;  // mm or inch a minute
constexpr double kSameFeed = 5e-4;       // relative: no word for less
constexpr double kShortestShare = 1e-4;  // of a move, for blocks that lead to it

}  // namespace

TimedFeed::TimedFeed(const Step& step, const EditedLine& line)
    : step_(step), line_(line), mode_(line.feed_mode) {
  is_rapid_ = step.move->kind == MoveKind::rapid;
  is_inverse_ = line.feed_mode == FeedMode::inverse_time;
  const bool turns = line.feed_mode == FeedMode::units_per_minute && step.programmed.turns_axes();
  only_turns_ = turns && step.programmed.length() < kStanding;
  is_mixed_ = turns && !only_turns_;
  F_ = line.feed_linear * minute / line.unit;
}

// 1/min
double TimedFeed::rate(double share, double way) const {
  const double feed = step_.move->feed * minute;
  if (is_inverse_) return share > 0.0 ? line_.value('F') / share : feed / std::max(way, 1e-9);
  const double angle = (step_.programmed.end - step_.programmed.begin).tail<3>().norm();
  const double whole = only_turns_ ? angle : step_.programmed.length();
  return feed / (whole * std::max(share, kShortestShare));
}

void TimedFeed::set_mode(MotionWords& words, FeedMode mode) {
  if (mode_ == mode) return;
  words.prefix = mode == FeedMode::inverse_time ? "G93" : "G94";
  mode_ = mode;
  is_changed_ = true;
}

void TimedFeed::set(MotionWords& words, const MotionPrinter& printer, const FittedBlock& block,
                    const AxisWords& begin) {
  if (is_rapid_ || !(is_inverse_ || only_turns_ || (is_mixed_ && !block.arc))) return;
  const AxisWords moved = printer.end() - begin;
  const double way = moved.head<3>().norm();
  const double per_minute = rate(block.t_end - block.t_begin, way);
  const bool is_slow = way > 0.0 && !block.arc && way * per_minute < kSlowestInverse * line_.unit;
  if ((is_inverse_ || (only_turns_ && way > 0.0)) && !is_slow) {
    set_mode(words, FeedMode::inverse_time);
    return printer.feed(words, per_minute);
  }
  const double own = way > 0.0 ? way / line_.unit : moved.tail<3>().norm() / deg;
  const double F = own * per_minute;
  const bool is_other = mode_ != FeedMode::units_per_minute || is_inverse_;
  if (!is_other && std::abs(F - F_) <= kSameFeed * F_) return;
  set_mode(words, FeedMode::units_per_minute);
  printer.feed(words, F);
  F_ = F;
  is_changed_ = true;
}

std::string TimedFeed::restored() const {
  if (is_inverse_) return "G93";
  const std::string F = controllers::significant_text(line_.feed_linear * minute / line_.unit);
  return fmt::format("{}F{}", only_turns_ ? "G94 " : "", F);
}

}  // namespace servomill::sim::programs
