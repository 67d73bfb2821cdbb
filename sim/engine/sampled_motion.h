/// Motion of which only positions at equal intervals are known.
#pragma once

#include <array>

#include "plant/vocabulary/axes.h"

namespace servomill::sim::engine {

/// Velocity and acceleration at the last of four positions, by differences of order 2.
class SampledMotion {
 public:
  /// @param h  s, between two positions
  explicit SampledMotion(double h) : h_(h) {}

  /// At rest at Q (5; m, rad).
  void start(const Joints& Q) { Q_.fill(Q); }
  void add(const Joints& Q) { Q_ = {Q, Q_[0], Q_[1], Q_[2]}; }

  const Joints& Q() const { return Q_[0]; }
  Joints dQ() const { return (3.0 * (Q_[0] - Q_[1]) - (Q_[1] - Q_[2])) / (2.0 * h_); }
  Joints ddQ() const {
    return (2.0 * (Q_[0] - Q_[1]) - 3.0 * (Q_[1] - Q_[2]) + (Q_[2] - Q_[3])) / (h_ * h_);
  }

 private:
  double h_;
  std::array<Joints, 4> Q_{};  // the last one first
};

}  // namespace servomill::sim::engine
