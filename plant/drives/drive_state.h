/// State and inputs of drives: structure of arrays, in blocks of eight lanes. A lane is one axis of
/// one run. Nothing here but numbers, so that kernels may include it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "plant/vocabulary/lanes.h"

namespace servomill::plant {

/// How a slide with set-valued friction moves.
enum class SlideMode : std::uint8_t { sticking, positive, negative };
/// Which flank of the screw carries; without backlash always `positive`.
enum class ContactMode : std::uint8_t { positive, gap, negative };

/// Step control that the exact step (exact_step.h) keeps between two calls: nothing of the drive
/// itself.
struct StepControl {
  int halvings = 0;              // how far below the longest the last sub-step was, a first guess
  std::uint32_t unresolved = 0;  // sub-steps that missed their tolerance at the finest length
};

/// State of one drive.
struct LaneState {
  double i = 0.0;      // A, torque-forming current
  double w = 0.0;      // rad/s, motor speed
  double delta = 0.0;  // m, r phi - x: wind-up, with backlash within [-gap/2, gap/2] free
  double v = 0.0;      // m/s, slide
  double x = 0.0;      // m, slide
  double z = 0.0;      // m, bristle deflection (LuGre)
  SlideMode slide = SlideMode::sticking;        // counts with set-valued friction only
  ContactMode contact = ContactMode::positive;  // counts with backlash only
  StepControl control{};
  double bed_x = 0.0;  // m, machine bed along the axis, from where it rests; of a drive on a bed
  double bed_v = 0.0;  // m/s
};

/// One number eight times.
constexpr LaneArray all_lanes(double value) {
  LaneArray all{};
  for (double& one : all) one = value;
  return all;
}

/// States of eight drives.
struct DriveBlock {
  LaneArray i{}, w{};  // A, rad/s
  LaneArray delta{};   // m (carried instead of phi: no cancellation)
  LaneArray v{}, x{};  // m/s, m
  LaneArray z{};       // m
  // Friction at the end of the kernel's last step: its speed (m/s; NaN: not known), the force (N)
  // and its slope (N s/m); for LuGre dz/dt (m/s). It follows from the rest of the state.
  LaneArray known_v = all_lanes(std::numeric_limits<double>::quiet_NaN());
  LaneArray known_friction{}, known_slope{};
  std::array<SlideMode, kLaneWidth> slide{};
  std::array<ContactMode, kLaneWidth> contact{};
  std::array<StepControl, kLaneWidth> control{};
  LaneArray bed_x{}, bed_v{};  // m, m/s
};

/// States of any number of drives: lane l is number l % 8 of block l / 8. What the last block has
/// beyond the lanes stands still.
struct DriveState {
  std::vector<DriveBlock> blocks;

  DriveState() = default;
  explicit DriveState(std::size_t lanes) : blocks(blocks_of(lanes)) {}
  LaneState lane(std::size_t l) const;
  void set_lane(std::size_t l, const LaneState& s);
};

/// Inputs of eight drives, constant over a step (zero-order hold).
struct DriveInputBlock {
  LaneArray command{};  // A; V for a drive with a winding
  LaneArray F{};        // N, force against the slide beside the constant F_load
  /// A lane that is not active stays as it is.
  LaneFlags active = {true, true, true, true, true, true, true, true};
};

struct DriveInput {
  std::vector<DriveInputBlock> blocks;

  DriveInput() = default;
  explicit DriveInput(std::size_t lanes) : blocks(blocks_of(lanes)) {}
};

}  // namespace servomill::plant
