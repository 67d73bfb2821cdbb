#include "controllers/path/travel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

struct Range {
  AxisWords low, high;
  void include(const AxisWords& words) {
    low = low.cwiseMin(words);
    high = high.cwiseMax(words);
  }
};

// The quadrant points of the circle that lie on the arc.
void include_extremes(Range& range, const Move& move, const AxisWords& from) {
  const ArcSweep arc = arc_sweep(move, from.head<3>());
  const double quarter = std::numbers::pi / 2.0;
  const double low = std::min(arc.angle, arc.angle + arc.sweep);
  const double high = std::max(arc.angle, arc.angle + arc.sweep);
  const double first = std::ceil(low / quarter);
  for (int n = 0; n < 4 && (first + n) * quarter <= high; ++n) {  // a full turn has four
    AxisWords words = from;
    words.head<3>() = arc.point(((first + n) * quarter - arc.angle) / arc.sweep);
    range.include(words);
  }
}

Range range_of(const Move& move, const AxisWords& from) {
  Range range{from, from};
  range.include(move.end_machine);
  if (move.kind == MoveKind::arc) include_extremes(range, move, from);
  return range;
}

std::string message(char name, bool rotary, double value, double limit, bool above) {
  const double unit = rotary ? deg : mm;
  return fmt::format("{} moves to {:.4f} {}, outside the travel; must be {} {:.4f}", name,
                     value / unit, rotary ? "deg" : "mm", above ? "<=" : ">=", limit / unit);
}

}  // namespace

std::vector<Fault> travel_faults(std::span<const Move> moves, const JointLayout& layout,
                                 const Joints& start, const Joints& lower, const Joints& upper,
                                 const std::string& file) {
  std::vector<Fault> faults;
  AxisWords at = layout.words(start);
  for (const Move& move : moves) {
    if (!is_motion(move.kind)) continue;
    const Range range = range_of(move, at);
    const Joints low = layout.joints(range.low), high = layout.joints(range.high);
    for (int k = 0; k < kJoints; ++k) {
      if (!layout.has(k)) continue;
      const bool above = high[k] > upper[k];
      if (!above && low[k] >= lower[k]) continue;
      Fault& fault = faults.emplace_back();  // in place: a temporary here confuses g++ 12
      fault.place = {file, move.line, 0};
      fault.message = message(layout.letter_of(k), k >= kLinearJoints, above ? high[k] : low[k],
                              above ? upper[k] : lower[k], above);
    }
    at = move.end_machine;
  }
  return faults;
}

}  // namespace servomill::controllers
