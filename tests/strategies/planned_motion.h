/// Motions from rest to rest along a path, for tests of what is found at a place of it.
#pragma once

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "strategies/path_offset.h"

namespace servomill::strategies::planned_motion {

inline constexpr double kH = 0.2 * ms;
inline constexpr double kJerk = 50.0;         // m/s^3
inline constexpr double kRounding = 1e-12;    // of sums of some numbers
inline constexpr double kRoundingOfT = 1e-9;  // instants: of sums of times

// Motion over L (m) from rest to rest that reaches the speed v (m/s): jerk +J, none, -J at each
// end.
class SCurve {
 public:
  SCurve(double L, double v, double a = 2.0)
      : L_(L),
        v_(v),
        T_j_(std::min(a / kJerk, std::sqrt(v / kJerk))),
        T_a_(v / (kJerk * T_j_) - T_j_) {}

  double duration() const { return L_ / v_ + T_a_ + 2.0 * T_j_; }
  double at(double t) const {
    if (t <= 0.0) return 0.0;
    if (t >= duration()) return L_;
    return t <= 0.5 * duration() ? begin(t) : L_ - begin(duration() - t);
  }

 private:
  // Jerk from rest: what has been switched on is switched off later.
  double begin(double t) const {
    const auto since = [&](double on) { return std::pow(std::max(0.0, t - on), 3) / 6.0; };
    return kJerk * (since(0.0) - since(T_j_) - since(T_j_ + T_a_) + since(2.0 * T_j_ + T_a_));
  }
  double L_, v_, T_j_, T_a_;
};

// m, m/s; a motion over kL ends in the last third of an interval, so that the instant before is not
// yet there, to rounding of s
inline constexpr double kL = 20.005 * mm, kFeed = 50.0 * mm;

// There, a dwell, and as far again.
struct TwoMoves {
  SCurve move;
  double dwell;  // s
  explicit TwoMoves(double v, double seconds = 0.0) : move(kL, v), dwell(seconds) {}
  double departure() const { return move.duration() + dwell; }
  double duration() const { return departure() + move.duration(); }
  double at(double t) const {
    return t <= departure() ? move.at(t) : kL + move.at(t - departure());
  }
};

template <class Motion>
inline PathTimes times_of(const Motion& motion, double behind = 0.01) {
  PathTimes out;
  out.h = kH;
  for (int n = 0; n * kH <= motion.duration() + behind; ++n) out.s.push_back(motion.at(n * kH));
  return out;
}

}  // namespace servomill::strategies::planned_motion
