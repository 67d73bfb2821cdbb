/// Two cases to compare, for tests of what of a recording is kept.
#pragma once

namespace servomill::sim::run {

/// Straightness and squareness errors, and the cases "as_it_is" and "feedback", which corrects
/// them.
inline constexpr const char* kComparedCases = R"([errors.measured]
EYX = { harmonic = { amplitude_um = 20.0, period_mm = 25.0 } }
EXY = { polynomial_um = [0.0, 0.3] }
[[case]]
name = "as_it_is"
[[case]]
name = "feedback"
[[case.strategy]]
type = "feedback"
model = "measured"
)";

}  // namespace servomill::sim::run
