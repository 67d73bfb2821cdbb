/// Change of a cutting force where the cutter is off its nominal path: the depth of cut follows
/// the actual position of the tool, the stock is what the nominal path has left of it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace servomill::sim::engine {

/// Forces of a cut whose cutter is displaced across its feed by kStep.
struct DisplacedCut {
  static constexpr double kStep = 20e-6;      // m
  static constexpr double kLargest = 100e-6;  // m, displacement up to which forces are extended

  struct Force {
    Eigen::Vector3d shear = Eigen::Vector3d::Zero();  // N per m of feed per tooth, in W
    Eigen::Vector3d edge = Eigen::Vector3d::Zero();   // N of a new edge, in W
    std::int32_t teeth = -1;                          // engagement; -1: none
  };
  std::array<Eigen::Vector3d, 2> across;  // unit, in W
  std::array<Force, 4> at;                // + and - along the first, + and - along the second
};

/// One place of a cut with its forces as they are now.
struct ForcesNearby {
  double share = 0.0;                 // of this place among those that the cutter is between
  const DisplacedCut* cut = nullptr;  // nullptr: the depth is the nominal one
  Eigen::Vector3d nominal = Eigen::Vector3d::Zero();  // N, in W
  std::array<Eigen::Vector3d, 4> displaced = {};      // N, in W
};

/// Force at the actual depth of cut, and how far from the nominal path it acts.
struct ForceAtDepth {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, in W
  double off_path = 0.0;  // m, of the cutter from its nominal path across the feed
  bool digs_in = false;   // the cut draws the cutter in faster than the structure resists
};

/// Force at the actual depth of cut: linear in the displacement on each side, and in balance with
/// the structure,
///
///     F = F_nominal + G (d + C F)
///
/// A force that would turn round is zero: the cutter has left the material. Without a balance,
/// det(I - G C) <= 0, the tool digs in. Across the feed d counts up to kLargest.
/// @param places     one or two
/// @param deviation  d, m, of the tool from its nominal path without that by cutting, in W
/// @param C          m/N, compliance of the structure in W
ForceAtDepth force_at_actual_depth(const std::array<ForcesNearby, 2>& places,
                                   const Eigen::Vector3d& deviation, const Eigen::Matrix3d& C);

}  // namespace servomill::sim::engine
