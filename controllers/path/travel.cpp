#include "controllers/path/travel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/spline_curve.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

template <class Vector>
struct Range {
  Vector low, high;
  void include(const Vector& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
};

// The quadrant points of the circle that lie on the arc.
void include_extremes(Range<AxisWords>& range, const Move& move, const AxisWords& from) {
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

// Range of the joints during a move without TCP control.
Range<Joints> range_of(const Move& move, const Joints& from, const JointLayout& layout) {
  const AxisWords words = layout.words(from);
  Range<AxisWords> range{words, words};
  range.include(move.end_machine);
  if (move.kind == MoveKind::arc) include_extremes(range, move, words);
  if (move.kind == MoveKind::spline) {
    const auto [low, high] = move.spline->curve.extent();
    for (const Eigen::Vector3d& corner : {low, high}) {
      AxisWords at = words;
      at.head<3>() = corner;
      range.include(at);
    }
  }
  return {layout.joints(range.low), layout.joints(range.high)};
}

// A program of millions of lines may lie outside: of all but the first faults only the number.
class ShownFaults {
 public:
  explicit ShownFaults(const std::string& file) : file_(file) {}

  void add(int line, std::string message) {
    if (faults_.size() == kShown) {
      ++more_;
      last_line_ = line;
      return;
    }
    put(line, std::move(message));
  }
  std::vector<Fault> take() {
    if (more_ > 0) {
      put(last_line_, fmt::format("the last of {} more motions outside the travel", more_));
    }
    return std::move(faults_);
  }

 private:
  static constexpr std::size_t kShown = 1000;

  void put(int line, std::string message) {
    Fault& fault = faults_.emplace_back();  // in place: a temporary here confuses g++ 12
    fault.place = {file_, line, 0};
    fault.message = std::move(message);
  }

  const std::string& file_;
  std::vector<Fault> faults_;
  std::size_t more_ = 0;
  int last_line_ = 0;
};

std::string message(char name, bool rotary, double value, double limit, bool above) {
  const double unit = rotary ? deg : mm;
  return fmt::format("{} moves to {:.4f} {}, outside its travel; must be {} {:.4f}", name,
                     value / unit, rotary ? "deg" : "mm", above ? "<=" : ">=", limit / unit);
}

}  // namespace

std::string outside_travel(const JointLayout& layout, int joint, double low, double high,
                           double lower, double upper) {
  const bool above = high > upper;
  if (!above && low >= lower) return {};
  return message(layout.letter_of(joint), joint >= kLinearJoints, above ? high : low,
                 above ? upper : lower, above);
}

std::vector<Fault> travel_faults(const MoveRange& moves, const JointLayout& layout,
                                 const Joints& start, const Joints& lower, const Joints& upper,
                                 const std::string& file, const TipMotions& tip) {
  ShownFaults faults(file);
  Joints at = start;
  std::size_t next = 0;
  for (const Move& move : moves) {
    const std::size_t i = next++;
    if (!is_motion(move.kind)) continue;
    Range<Joints> range{at, at};
    if (move.tool_control == ToolControl::none) {
      range = range_of(move, at, layout);
      at = layout.joints(move.end_machine);
    } else {
      const std::span<const JointChord> chords = tip.chords_of(tip.of(i));
      for (const JointChord& chord : chords) range.include(chord.end);
      at = chords.back().end;
    }
    const auto& [low, high] = range;
    for (int k = 0; k < kJoints; ++k) {
      if (!layout.has(k)) continue;
      std::string message = outside_travel(layout, k, low[k], high[k], lower[k], upper[k]);
      if (!message.empty()) faults.add(move.line, std::move(message));
    }
  }
  return faults.take();
}

}  // namespace servomill::controllers
