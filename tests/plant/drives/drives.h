/// The drive that tests move: axis X of the HSM 600U with the friction that goes with it.
#pragma once

#include <numbers>

#include "plant/drives/feed_drive.h"

namespace servomill::plant {

inline constexpr double kTick = 10e-6;  // s

inline FeedDriveParams x_axis() {
  FeedDriveParams p;
  p.r = 0.02 / (2 * std::numbers::pi);
  p.J = 9.6e-3;
  p.M = 750;
  p.k = 2.2e8;
  p.c = 4.0e4;
  p.b_motor = 0.01;
  p.b_load = 1500;
  p.Kt = 1.6;
  p.i_max = 50;
  p.T_i = 0.35e-3;
  return p;
}

inline FrictionParams friction(FrictionKind kind) {
  return {.kind = kind,
          .Fc_positive = 450,
          .Fc_negative = 450,
          .Fs_positive = 560,
          .Fs_negative = 560,
          .vs = 2e-3,
          .v0 = 1e-4,
          .sigma0 = 5e7,
          .sigma1 = 3e4};
}

inline FeedDriveParams x_axis_with(FrictionKind kind) {
  FeedDriveParams p = x_axis();
  p.friction = friction(kind);
  return p;
}

}  // namespace servomill::plant
