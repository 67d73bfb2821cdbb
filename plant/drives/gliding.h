/// Speeds at which a drive with friction is linear.
#pragma once

#include <cmath>
#include <limits>

#include "plant/drives/feed_drive.h"

namespace servomill::plant {

/// Speeds at which the force against a slide is constant to the last bit, so that its drive is
/// linear.
struct Gliding {
  double speed = std::numeric_limits<double>::infinity();  // m/s: beyond it; infinite: nowhere
  double Fc_positive = 0.0, Fc_negative = 0.0;             // N
  double sigma0 = 0.0;                                     // N/m; 0: no bristles

  bool holds(double v) const { return std::abs(v) > speed; }
  /// The same of a state: its bristles must have settled, too.
  bool holds(double v, double z) const {
    constexpr double kSettled = 1e-10;  // of Fc
    return holds(v) &&
           (sigma0 == 0.0 || std::abs(sigma0 * z - force(v)) <= kSettled * std::abs(force(v)));
  }
  double force(double v) const { return v > 0.0 ? Fc_positive : -Fc_negative; }
};

/// A drive on a bed glides nowhere: the kernel does not know the bed.
Gliding gliding_of(const FeedDriveParams& params);

}  // namespace servomill::plant
