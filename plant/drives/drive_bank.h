/// Drives in lanes, moved between instants of the base clock.
#pragma once

#include <cassert>
#include <memory>
#include <span>
#include <vector>

#include "plant/drives/drive_kernel.h"
#include "plant/drives/prepared_drives.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

/// Exact propagator of drives between instants of the base clock:
///   x(t + h) = exp(A h) x(t) + int_0^h exp(A s) ds B u.
/// Matrices are prepared once for every step length that the schedule contains and every drive that
/// differs from the others. A drive that is not linear takes part with its friction as a constant
/// force while it glides (struct Gliding); else it is moved by its ExactStep.
///
/// Lane l lives in blocks[l / 8] at l % 8. What a lane computes depends on its own numbers only,
/// bit for bit: not on its place, its neighbours, how many they are or whether they are active.
class DriveBank {
 public:
  /// @param lanes        one entry per lane
  /// @param base_period  s
  /// @param steps        step lengths that `advance` will be asked for, in ticks; none: it will not
  ///                     be called, nor anything prepared for it
  /// @param kept         drives prepared earlier, and where those prepared now are kept
  /// @param level        instruction set; results differ between them by rounding
  /// @param stretches    that `advance_with_stops` will be asked for
  DriveBank(std::span<const FeedDriveParams> lanes, double base_period, std::span<const Tick> steps,
            PreparedDrives* kept = nullptr, SimdLevel level = simd_level(),
            std::span<const Stretch> stretches = {});
  DriveBank(DriveBank&&) = default;  // a copy's block_steps_ would point into the original

  std::size_t lanes() const { return drives_.size(); }

  /// Moves the active lanes by `step` ticks. @pre step is one of those given at construction; state
  /// and input have the blocks of lanes()
  void advance(DriveState& state, const DriveInput& input, Tick step) const {
    assert(state.blocks.size() == constants_.size() && input.blocks.size() == constants_.size());
    const BlockStep* const steps = steps_of(step);
    const std::size_t end = constants_.size();
    const LanesLeft left =
        kernel_.advance(state.blocks.data(), input.blocks.data(), steps, nullptr, 0, end);
    if (left.block != end) advance_rest(state, input, step, steps, left);
  }

  /// Moves the active lanes by a stretch, in one where that is exact, and tells where they were on
  /// the way: less work than as many steps.
  /// @param stretch    number of one of those given at construction
  /// @param positions  x of block b at stop n goes to positions[n * blocks + b]
  void advance_with_stops(DriveState& state, const DriveInput& input, std::size_t stretch,
                          std::span<LaneArray> positions) const;

  /// Motor angle (rad) of a lane: (delta + x) / r.
  double motor_angle(const DriveState& state, std::size_t lane) const {
    const DriveBlock& block = state.blocks[lane / kLaneWidth];
    return (block.delta[lane % kLaneWidth] + block.x[lane % kLaneWidth]) * inverse_r_[lane];
  }

  /// At rest at x (m or rad, one per lane), holding the constant loads.
  DriveState at_rest(std::span<const double> x) const;

  /// Sub-steps of a lane that missed their tolerance since the state began: more than 0 means that
  /// its result is not to be trusted.
  static std::uint32_t unresolved(const DriveState& state, std::size_t lane) {
    return state.blocks[lane / kLaneWidth].control[lane % kLaneWidth].unresolved;
  }

 private:
  // From the first block of which lanes are left.
  void advance_rest(DriveState& state, const DriveInput& input, Tick step, const BlockStep* steps,
                    LanesLeft left) const;
  // Lane by lane.
  void advance_lanes(DriveState& state, const DriveInputBlock& input, Tick step,
                     LanesLeft left) const;
  void advance_in_pieces(DriveState& state, const DriveInputBlock& of_all, const Stretch& stretch,
                         std::span<LaneArray> positions, LanesLeft left) const;
  // Prepared steps of the blocks.
  const BlockStep* steps_of(Tick step) const {
    assert(static_cast<std::size_t>(step) < first_of_step_.size());
    assert(first_of_step_[static_cast<std::size_t>(step)] >= 0);
    return block_steps_.data() + first_of_step_[static_cast<std::size_t>(step)];
  }
  void prepare_stretches();
  void prepare_block(std::size_t block);
  void prepare_lane(std::size_t block, std::size_t j, const PreparedDrive& drive);
  void prepare_parabolas(std::size_t block, std::size_t j, const PreparedDrive& drive);

  std::vector<std::shared_ptr<const PreparedDrive>> drives_;  // of each lane
  std::vector<double> inverse_r_;                             // 1/m, of each lane
  std::vector<int> first_of_step_;                            // in block_steps_; -1: not prepared
  std::vector<Tick> steps_;
  std::vector<HoldBlock> holds_;           // step after step, block after block
  std::vector<DriveConstants> constants_;  // of each block
  // of each block with friction that the kernel moves: steps as a whole, then the rungs
  std::vector<std::vector<ParabolaBlock>> parabolas_;
  std::vector<BlockStep> block_steps_;  // as holds_
  std::vector<Stretch> stretches_;
  std::vector<StopBlock> stops_;          // block after block, its stops stretch after stretch
  std::vector<BlockStep> stretch_steps_;  // stretch after stretch, block after block
  DriveKernel kernel_;
};

}  // namespace servomill::plant
