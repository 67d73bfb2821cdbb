/// One drive that is moved by the exact step, and drives so simple that closed forms know their
/// motion.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "plant/drives/exact_step.h"
#include "tests/plant/drives/drives.h"

namespace servomill::plant {

inline constexpr Tick kStep = 20;           // 200 us
inline constexpr double kNanometre = 1e-9;  // m

/// A mass of 100 kg without anything else.
inline FeedDriveParams bare_mass(FrictionKind kind) {
  FeedDriveParams p;
  p.kind = DriveKind::rigid;
  p.r = 1.0;
  p.J = 40;
  p.M = 60;
  p.friction = friction(kind);
  return p;
}

inline FeedDriveParams bare_mass_with_coulomb() {
  FeedDriveParams p = bare_mass(FrictionKind::set_valued);
  p.friction.Fs_positive = p.friction.Fc_positive;
  p.friction.Fs_negative = p.friction.Fc_negative;
  return p;
}

/// A rigid drive whose state is set to move at v.
inline LaneState moving(const FeedDriveParams& p, double v) {
  LaneState s;
  s.v = v;
  s.w = v / p.r;
  return s;
}

/// t -> command, F
using Inputs = std::function<std::array<double, 2>(double)>;

inline LaneState run(const ExactStep& drive, LaneState s, int steps, Tick step,
                     const Inputs& inputs) {
  for (int n = 0; n < steps; ++n) {
    const auto [command, F] = inputs(static_cast<double>(n * step) * kTick);
    drive.advance(s, command, F, step);
  }
  EXPECT_EQ(s.control.unresolved, 0U);
  return s;
}

inline Inputs constant_inputs(double command, double F = 0.0) {
  return [=](double) { return std::array{command, F}; };
}

}  // namespace servomill::plant
