/// Motion that the axes of a case are asked for: its path with the offsets of all strategies.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/engine/case_result.h"

namespace servomill::sim::engine {

/// Finds the demands of a run, one position period after the other. Between two of them neither a
/// table nor a virtual encoder has a derivative. So velocity, acceleration and jerk are means: n
/// differences over the n-th power of their step are the n-th derivative of any motion through
/// these instants, weighted by a B-spline that is positive and has the integral 1. A motion within
/// limits has no mean beyond them; one with a mean beyond a limit exceeds it.
/// Source: C. de Boor, "A Practical Guide to Splines", Springer 2001, chapter IX.
class DemandMeter {
 public:
  /// @param period   s, of the position loops
  /// @param periods  step of the differences, at least 1
  explicit DemandMeter(double period, std::size_t periods = 1);

  /// Has been at standstill here for long.
  void start(const Joints& path, const Joints& offset);
  /// One position period after the call before.
  /// @param time  s, that the peaks are given by
  void add(double time, const Joints& path, const Joints& offset);
  const AxisDemands& demands() const { return demands_; }

 private:
  const Joints& ago(std::size_t steps) const;

  double step_;  // s
  std::size_t periods_;
  std::vector<Joints> places_;  // of the last three steps, around the newest
  std::size_t newest_ = 0;
  Joints offset_ = Joints::Zero();  // largest so far
  std::array<Joints, AxisDemands::kOrders> largest_ = {offset_, offset_, offset_};  // differences
  AxisDemands demands_;
};

/// Displacement of the axes by what the position loops are to follow without feed-forward,
/// d' = Kv (wanted - d): that of a loop around an ideal velocity loop. A velocity v that is added
/// to the command is a displacement v / Kv that is wanted.
class LoopDisplacement {
 public:
  /// @param Kv      1/s; a joint with 0 is not displaced
  /// @param period  s, of the position loops
  LoopDisplacement(const Joints& Kv, double period);
  void start(const Joints& wanted) { d_ = wanted; }
  /// One position period later.
  /// @param wanted  m, rad
  /// @param added   m/s, rad/s
  const Joints& advance(const Joints& wanted, const Joints& added) {
    d_ += share_.cwiseProduct(wanted + added.cwiseProduct(per_Kv_) - d_);
    return d_;
  }

 private:
  Joints share_ = Joints::Zero();   // of what is wanting, in a period
  Joints per_Kv_ = Joints::Zero();  // s
  Joints d_ = Joints::Zero();
};

/// Step of the differences where offsets follow from readings (position periods): a quarter of the
/// shortest time constant of the loops. It resolves what they pass, not the steps of encoders and
/// of a virtual encoder with another period.
std::size_t periods_of_readings(const Joints& Kv, double period);

}  // namespace servomill::sim::engine
