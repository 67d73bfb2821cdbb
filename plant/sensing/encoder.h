/// Position encoders as the NC reads them.
#pragma once

#include <cmath>

namespace servomill::plant {

/// Quantises a position to whole measuring steps: y = q round(x / q); 0 leaves it as it is.
/// The step of an encoder is its signal period over its subdivision (20 um / 1024 = 19.5 nm).
struct Encoder {
  double step = 0.0;          // m or rad, measuring step; 0: ideal
  double inverse_step = 0.0;  // 1/m or 1/rad, kept beside it for the hot loop

  /// @param measuring_step  m or rad, >= 0
  static Encoder with_step(double measuring_step) {
    return {measuring_step, measuring_step > 0.0 ? 1.0 / measuring_step : 0.0};
  }

  double read(double position) const {
    return step > 0.0 ? step * std::nearbyint(position * inverse_step) : position;
  }
};

}  // namespace servomill::plant
