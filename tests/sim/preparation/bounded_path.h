/// Planned paths with limits, and offsets along X, for tests of what a path leaves to an offset.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/preparation/offset_limits.h"

namespace servomill::sim::preparation::bounded_path {

using controllers::JointLimits;
using controllers::Trajectory;
using strategies::PathTimes;

inline constexpr JointLayout kLayout{{Axis::X, Axis::Y, Axis::Z, Axis::B, Axis::C}};
inline constexpr double kH = 0.2 * ms;
inline constexpr std::size_t kEvery = 5;
inline constexpr double kRow = 1 * ms;
inline constexpr double kAround = 0.25;      // s, within which rows change
inline constexpr double kBesides = 5e-3;     // share of a limit, left for what lies between rows
inline constexpr double kRounding = 1e-3;    // share of a limit, by which it may be exceeded
inline constexpr double kRoundingOf = 1e-9;  // share of a quantity

inline constexpr double kV = 0.5, kA = 5.0, kJ = 100.0;  // per s, s^2, s^3

inline JointLimits alike(double v = kV, double a = kA, double j = kJ) {
  return {Joints::Constant(v), Joints::Constant(a), Joints::Constant(j)};
}
// Only X has limits, as if the machine had no other axes.
inline JointLimits of_X(double v = kV, double a = kA, double j = kJ) {
  return {Joints::Unit(0) * v, Joints::Unit(0) * a, Joints::Unit(0) * j};
}

inline Trajectory standing(double seconds) {
  Move move;
  move.kind = MoveKind::dwell;
  move.value = seconds;
  return controllers::plan(std::vector<Move>{move}, kLayout, Joints::Zero(), alike());
}

// Along X, from rest to rest.
inline Trajectory moving(double L, double feed) {
  Move move;
  move.feed = feed;
  move.end = move.end_machine = kLayout.words(Joints::Unit(0) * L);
  move.s_end = L;
  return controllers::plan(std::vector<Move>{move}, kLayout, Joints::Zero(), alike());
}

// A path and its limits. @pre the path lasts that long
struct Bounded {
  PathTimes times;
  OffsetLimits limits;

  Bounded(const Trajectory& path, const JointLimits& of_axes, double behind = 0.0)
      : times(times_of(path, behind)),
        limits(derivatives_of(path, times), times.row_period(), of_axes) {}
  static PathTimes times_of(const Trajectory& path, double behind) {
    PathTimes out{.h = kH, .s = {}, .every = kEvery};
    Trajectory::Cursor cursor{};
    for (int n = 0; n * kH <= path.duration() + behind; ++n) {
      out.s.push_back(path.at(n * kH, cursor).s);
    }
    return out;
  }
  std::size_t rows() const { return times.rows(); }
};

using Series = std::vector<double>;

inline std::vector<Joints> offset_of_X(const Series& u) {
  std::vector<Joints> out;
  for (const double one : u) out.push_back(Joints::Unit(0) * one);
  return out;
}
inline Series X_of(const std::vector<Joints>& u) {
  Series out;
  for (const Joints& one : u) out.push_back(one[0]);
  return out;
}

// A swing of amplitude A at f (Hz) within `half` of t = `middle`, which begins and ends smoothly.
inline Series burst(std::size_t rows, double A, double f, double middle, double half = 0.1) {
  Series out;
  for (std::size_t n = 0; n < rows; ++n) {
    const double t = static_cast<double>(n) * kRow - middle, x = t / half;
    const double envelope = std::abs(x) < 1.0 ? std::pow(1.0 - x * x, 4) : 0.0;
    out.push_back(A * envelope * std::sin(2.0 * std::numbers::pi * f * t));
  }
  return out;
}

// Differences of order 1 to 3 of a series at a row.
inline double difference(const Series& u, std::size_t order, std::size_t n) {
  switch (order) {
    case 1:
      return u[n + 1] - u[n];
    case 2:
      return u[n + 1] - 2.0 * u[n] + u[n - 1];
    default:
      return u[n + 2] - 3.0 * u[n + 1] + 3.0 * u[n] - u[n - 1];
  }
}
inline double largest(const Series& u, std::size_t order) {
  double out = 0.0;
  for (std::size_t n = 1; n + 2 < u.size(); ++n) {
    out = std::max(out, std::abs(difference(u, order, n)));
  }
  return out / std::pow(kRow, static_cast<double>(order));
}

// A series whose third difference is `peak` at one row and small elsewhere, and which comes back to
// rest: a sum, a first and a second moment of its third differences vanish.
inline Series with_one_jerk(std::size_t rows, std::size_t at, double peak) {
  constexpr int kHalf = 60;
  Eigen::MatrixXd moments(2 * kHalf + 1, 3);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(2 * kHalf + 1);
  for (int k = -kHalf; k <= kHalf; ++k) {
    const double x = static_cast<double>(k) / kHalf;
    moments.row(k + kHalf) << 1.0, x, x * x;
  }
  d[kHalf] = 1.0;
  d -= moments * (moments.transpose() * moments).ldlt().solve(moments.transpose() * d);
  d *= peak / d[kHalf];
  Series u(rows, 0.0);
  for (std::size_t k = 0; k < static_cast<std::size_t>(d.size()); ++k) {
    const std::size_t n = at - kHalf + k;
    u[n + 2] = d[static_cast<Eigen::Index>(k)] + u[n - 1] - 3.0 * u[n] + 3.0 * u[n + 1];
  }
  for (std::size_t n = at + kHalf + 3; n < rows; ++n) u[n] = 0.0;
  return u;
}

}  // namespace servomill::sim::preparation::bounded_path
