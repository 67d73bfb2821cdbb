/// Deviation that a correction leaves.
#pragma once

namespace servomill::strategies {

/// Residual of a correction: true minus ideal pose by the identified model.
struct Residual {
  double tip = 0.0;   // m
  double axis = 0.0;  // rad, of the direction of the tool; turns about itself do not count
};

}  // namespace servomill::strategies
