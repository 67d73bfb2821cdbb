/// What every way of compensating a machine's geometric errors offers to a run.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plant/geometry/volumetric.h"
#include "plant/kinematics/chain.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"
#include "plant/vocabulary/set_point_entry.h"

namespace servomill::strategies {

/// `generate` brings the believed errors out on the part, as paper [G] does; `correct` removes
/// them.
enum class Sign : std::int8_t { generate = 1, correct = -1 };

/// What a strategy believes and knows. Never the truth: the errors are an identified model.
struct Belief {
  JointLayout layout;
  plant::VolumetricModel model;                    // machine and errors as identified
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, tool tip at the spindle nose
  Joints lower = Joints::Zero();                   // m, rad; travel of the machine
  Joints upper = Joints::Zero();
  Joints reference = Joints::Zero();             // m, rad; where the machine starts
  Eigen::Vector3d Kv = Eigen::Vector3d::Zero();  // 1/s, position gains that the NC is set to;
                                                 // NaN unless the entry reads_gains
};

/// Offset of the linear set points, added in the NC where `entry` says.
class SetPointPart {
 public:
  virtual ~SetPointPart() = default;
  virtual SetPointEntry entry() const = 0;
  /// @param Q_ref  interpolated position (5; m, rad)
  /// @return offset of X, Y, Z (3; m)
  virtual Eigen::Vector3d offset(const Joints& Q_ref) const = 0;
};

/// Offset of the position feedback: the NC reads x_measured + d, hence moves the axis by -d.
/// Evaluated once per model period of the feedback hardware; state belongs to one run.
class FeedbackPart {
 public:
  virtual ~FeedbackPart() = default;
  /// Settles at standstill in Q_meas, as if the hardware had been on for long.
  virtual Eigen::Vector3d settle(const Joints& Q_meas) = 0;
  /// @param Q_meas  scale readings of this instant (5; m, rad)
  /// @return d for X, Y, Z (3; m), acting one model period later
  Eigen::Vector3d evaluate(const Joints& Q_meas) {
    FeedbackPart* const self = this;
    Eigen::Vector3d d;
    evaluate_together({&self, 1}, {&Q_meas, 1}, {&d, 1});
    return d;
  }

  /// Whether this part and another one, of another run, can be evaluated together.
  virtual bool goes_with(const FeedbackPart& other) const { return this == &other; }
  /// Evaluates parts that all go with this one, in less time than one by one and with the same
  /// bits.
  /// @param Q_meas, d  as of `evaluate`, one for each part
  virtual void evaluate_together(std::span<FeedbackPart* const> parts,
                                 std::span<const Joints> Q_meas, std::span<Eigen::Vector3d> d) = 0;
};

/// Up to three parts, each optional. A strategy is constant and may be shared by runs; the parts
/// that it makes have the state of one run.
class Strategy {
 public:
  virtual ~Strategy() = default;

  /// Rewrites the moves of a program; the line and arc length of the original are carried over.
  virtual bool rewrites() const { return false; }
  virtual std::vector<Move> rewrite(const std::vector<Move>& moves) const { return moves; }

  virtual std::unique_ptr<SetPointPart> set_point() const { return nullptr; }

  /// @param model_period  s, time between two calls of FeedbackPart::evaluate
  virtual std::unique_ptr<FeedbackPart> feedback(double model_period) const {
    (void)model_period;
    return nullptr;
  }
};

}  // namespace servomill::strategies
