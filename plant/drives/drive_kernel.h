/// What the kernel of the drives (drive_kernel.cpp) reads: eight drives side by side, prepared by
/// DriveBank. Included by the kernel: no Eigen here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "plant/drives/drive_state.h"
#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/simd.h"

namespace servomill::plant {

/// One bit for each of eight lanes, lane 0 the lowest.
using LaneBits = std::uint8_t;

/// Eight drives over a step of one length while the force against each slide is constant:
/// (i, w, delta, v, x + increment) from (i, w, delta, v, command, force).
struct HoldBlock {
  static constexpr std::size_t kRows = 5, kColumns = 6;
  std::array<LaneArray, kRows * kColumns> end{};  // row after row
  std::array<LaneArray, kColumns> middle{};       // v at half the step
};

/// What of eight drives does not depend on the length of the step.
struct DriveConstants {
  LaneArray F_load{};                      // N
  LaneArray glide_speed{};                 // m/s, struct Gliding; below 0: the drive is linear
  LaneArray Fc_positive{}, Fc_negative{};  // N
  LaneArray sigma0{};                      // N/m
  bool has_bristles = false;               // any of them
  LaneBits has_slide_mode = 0;             // those with set-valued friction
};

/// Functions that are compiled for each instruction set.
struct DriveKernel {
  /// Moves the active lanes that are linear all over the step and returns the others, untouched.
  LaneBits (*advance)(DriveBlock&, const DriveInputBlock&, const HoldBlock&, const DriveConstants&);
};

template <SimdLevel level>
DriveKernel make_drive_kernel();

}  // namespace servomill::plant
