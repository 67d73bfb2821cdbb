/// Data of the kernel of the drives (drive_kernel.cpp): eight drives side by side, prepared by
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

/// A coefficient of eight drives, and the one of all where a block has eight times the same drive
/// (DriveConstants::same): then the kernel reads this one, an eighth of the memory.
template <std::size_t n>
struct Coefficients {
  std::array<LaneArray, n> each{};
  std::array<double, n> of_all{};

  void set(std::size_t which, std::size_t lane, double value) {
    each[which][lane] = of_all[which] = value;
  }
};

/// Eight drives over a step of one length while the force against each slide is constant:
/// (i, w, delta, v, x + increment) from (i, w, delta, v, command, force).
struct HoldBlock {
  static constexpr std::size_t kRows = 5, kColumns = 6;
  Coefficients<kRows * kColumns> end;  // row after row
  Coefficients<kColumns> middle;       // v at half the step
};

/// Eight drives over a sub-step while the force against each slide is a parabola: the rows of
/// Propagator::slide, each by its columns.
struct ParabolaBlock {
  static constexpr std::size_t kRows = 8, kColumns = 8;
  double h = 0.0;                       // s
  Coefficients<kRows * kColumns> rows;  // row after row
  LaneArray speed_tolerance{};          // m/s, of the last correction of Newton's iteration
};

/// An instant within a step at which positions are wanted: the row of the position, while the force
/// against each slide is constant and while it is a parabola over the step.
struct StopBlock {
  Coefficients<HoldBlock::kColumns> hold;
  Coefficients<ParabolaBlock::kColumns> parabola;
};

/// Lengths into which a step may be cut: rung n is 2^(n - kDepth) base periods.
struct Ladder {
  static constexpr int kDepth = 4;
  int ticks = 0;                         // of the step
  const ParabolaBlock* whole = nullptr;  // the step in one; null: no lane ever needs one
  const ParabolaBlock* rungs = nullptr;
};

/// Constants of eight drives that do not depend on the length of the step.
struct DriveConstants {
  LaneArray F_load{};                      // N
  LaneArray glide_speed{};                 // m/s, struct Gliding; below 0: the drive is linear
  LaneArray Fc_positive{}, Fc_negative{};  // N, FrictionParams
  LaneArray Fs_positive{}, Fs_negative{};  // N
  LaneArray b_positive{}, b_negative{};    // N s/m
  LaneArray inverse_vs{}, inverse_v0{};    // s/m
  LaneArray sigma0{}, sigma1{};            // N/m, N s/m
  LaneArray inverse_mass{};                // 1/kg, of the slide
  LaneArray tolerance{};                   // m, of a sub-step: a share of Resolution's
  /// Bounds of regularised friction's derivatives by speed, the first to the third (N s/m, ...):
  /// everywhere, and where tanh has ended.
  std::array<LaneArray, 3> steep{}, gentle{};
  LaneArray tanh_end{};                    // m/s
  std::array<int, kLaneWidth> coarsest{};  // rung of the longest sub-step
  int least_coarsest = 31;                 // of those that the kernel moves with their friction
  bool linear = true;                      // no lane has friction, backlash or cogging
  bool same = false;                       // eight lanes with the same drive
  LaneBits has_slide_mode = 0;             // lanes with set-valued friction
  LaneBits regularised = 0, lugre = 0;     // lanes that the kernel moves with their friction
  LaneBits has_kink = 0;                   // friction is continuous at v = 0, its slope is not
};

/// A step of one length of eight drives.
struct BlockStep {
  const HoldBlock* hold;
  const DriveConstants* constants;
  Ladder ladder;
  const StopBlock* stops = nullptr;
  std::size_t stop_count = 0;
  int least_wanted = 0;  // rung: with stops, lanes that want shorter sub-steps do not try the step
};

/// Lanes of a block that the kernel cannot move and leaves untouched: friction that is no function
/// of speed, backlash, cogging; sub-steps below the lowest rung; and if there are stops, all that
/// does not take the step in one.
struct LanesLeft {
  std::size_t block;  // behind the last one: none are left
  LaneBits lanes;
};

/// Functions that are compiled for each instruction set.
struct DriveKernel {
  /// Moves the active lanes of the blocks from `first` to before `end`, or up to and with the first
  /// block of which lanes are left. states[n], inputs[n] and steps[n] belong together, and
  /// positions[stop * end + n], which are not written for lanes that are left.
  LanesLeft (*advance)(DriveBlock* states, const DriveInputBlock* inputs, const BlockStep* steps,
                       LaneArray* positions, std::size_t first, std::size_t end);
};

template <SimdLevel level>
DriveKernel make_drive_kernel();

}  // namespace servomill::plant
