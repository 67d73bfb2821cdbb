/// The rotary axis that is free where the tool axis is singular: its angle before the tool axis
/// leaves that direction.
#pragma once

#include <optional>
#include <vector>

#include "plant/kinematics/inverse.h"
#include "plant/kinematics/straight_tool_path.h"

namespace servomill::controllers {

inline constexpr double kSameAxis = 1e-9;   // rad; tool axes nearer to each other are one
inline constexpr double kSameAngle = 1e-6;  // rad; a free axis so near to its place need not turn

/// Largest rotation of a rotary joint between two positions (rad).
double rotation_between(const Joints& Q_0, const Joints& Q_1);

class FreeAxis {
 public:
  /// @param tolerance  of the chords between inserted points
  FreeAxis(const plant::InverseKinematics& inverse, const plant::ToolTolerance& tolerance)
      : inverse_(inverse), tolerance_(tolerance) {}

  void set_tool(const Eigen::Vector3d& p_ST) { p_ST_ = p_ST; }

  plant::LinearisedPath linearised(const plant::StraightToolPath& path, const Joints& Q) const {
    return plant::linearise(inverse_, p_ST_, path, Q, tolerance_);
  }

  /// Joints at the first of several poses with one singular tool axis that need not change where a
  /// path leads the tool axis from the last of them to `next`; nullopt if there are none.
  std::optional<Joints> before_leaving(const std::vector<ToolPose>& upright, const ToolPose& next,
                                       const Joints& Q) const;

  /// Rotation of the free axis with the tip in place, and the path after it.
  struct Departure {
    std::vector<Joints> rotation;  // ends of the blocks that it takes
    plant::LinearisedPath path;
  };

  /// Lets the tool axis go a path from a singular direction by rotating the free axis first;
  /// nullopt if the direction is not singular or no rotation helps.
  /// @param here  pose at the start of the path, with the joints Q
  std::optional<Departure> departure(const plant::StraightToolPath& path, const ToolPose& here,
                                     const Joints& Q) const;

 private:
  std::vector<Joints> branches(const plant::StraightToolPath& path, const Joints& Q_near) const;
  std::optional<Joints> on_branch(const ToolPose& P, const Joints& branch) const;
  bool arrives(const plant::StraightToolPath& path, const Joints& branch) const;
  bool rotate_in_place(const ToolPose& here, const Joints& Q_0, const Joints& Q_1,
                       int halvings_left, std::vector<Joints>& out) const;

  const plant::InverseKinematics& inverse_;
  plant::ToolTolerance tolerance_;
  Eigen::Vector3d p_ST_ = Eigen::Vector3d::Zero();  // m
};

}  // namespace servomill::controllers
