/// Axes that a correction displaces.
#pragma once

#include <cstdint>

namespace servomill::strategies {

/// Which axes are displaced: X, Y, Z, which can correct the position of the tip, or all, which can
/// correct the tool axis, too (strategies/pose_compensation.h).
enum class DisplacedAxes : std::uint8_t { linear, all };

}  // namespace servomill::strategies
