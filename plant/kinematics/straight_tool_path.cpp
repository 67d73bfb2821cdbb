#include "plant/kinematics/straight_tool_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "plant/kinematics/branches.h"

namespace servomill::plant {
namespace {

// Halvings: 2^-24 = 6e-8 of the path.
constexpr int kMaxSplits = 24;
constexpr double kSameAxis = 1e-9;  // rad; nearer, a straight line is the great circle

class Lineariser {
 public:
  Lineariser(const InverseKinematics& inverse, const Eigen::Vector3d& p_ST,
             const StraightToolPath& path, const Joints& Q_0, const ToolTolerance& tolerance)
      : inverse_(inverse), p_ST_(p_ST), path_(path), tolerance_(tolerance), at_{0.0, Q_0} {}

  LinearisedPath run() {
    const PathPoint start = at_;
    go_to(1.0, kMaxSplits);
    if (out_.is_complete || !inverse_.nearest(path_.at(0.0), p_ST_, start.Q).is_singular) {
      return std::move(out_);
    }
    LinearisedPath nearest = std::exchange(out_, {});
    const double t = std::min(1.0, tolerance_.axis / path_.angle());
    for (const Joints& Q : departures(inverse_, path_.at(t), p_ST_, start.Q)) {
      at_ = start;
      out_ = {};
      depart(t, Q);
      if (out_.is_complete) return std::move(out_);
    }
    return nearest;
  }

 private:
  // From the singular direction to the end by the branch of Q, which belongs to t.
  void depart(double t, Joints Q) {
    for (int splits_left = kMaxSplits; !holds(t, Q); --splits_left) {
      if (splits_left == 0) {
        out_.is_complete = false;
        return;
      }
      t *= 0.5;
      // the solution of this branch: its neighbour has the other sign of an axis
      Q = inverse_.nearest(path_.at(t), p_ST_, Q).Q;
    }
    at_ = {t, Q};
    out_.points.push_back(at_);
    if (t < 1.0) go_to(1.0, kMaxSplits);
  }

  // Every solution is sought next to a point that holds, so that no branch is taken unseen.
  void go_to(double t, int splits_left) {
    const JointSolution next = inverse_.nearest(path_.at(t), p_ST_, at_.Q);
    if (next.is_reached() && holds(t, next.Q)) {
      at_ = {t, next.Q};
      out_.points.push_back(at_);
      return;
    }
    if (splits_left == 0) {
      out_.is_complete = false;
      out_.t = t;
      out_.failure = next;
      return;
    }
    go_to(0.5 * (at_.t + t), splits_left - 1);
    if (out_.is_complete) go_to(t, splits_left - 1);
  }

  bool holds(double t, const Joints& Q) const {
    for (const double f : {0.25, 0.5, 0.75}) {
      const ToolPose wanted = path_.at(at_.t + f * (t - at_.t));
      const ToolPose is = forward(inverse_.chain(), at_.Q + f * (Q - at_.Q), p_ST_);
      if (!((is.p_WT - wanted.p_WT).norm() <= tolerance_.tip)) return false;
      if (!(angle_between(is.k_W, wanted.k_W) <= tolerance_.axis)) return false;
    }
    return true;
  }

  const InverseKinematics& inverse_;
  const Eigen::Vector3d& p_ST_;
  const StraightToolPath& path_;
  ToolTolerance tolerance_;
  PathPoint at_;
  LinearisedPath out_;
};

}  // namespace

StraightToolPath::StraightToolPath(const ToolPose& from, const ToolPose& to)
    : from_(from), to_(to), angle_(angle_between(from.k_W, to.k_W)) {
  assert(angle_ < kRoundTurn);
}

ToolPose StraightToolPath::at(double t) const {
  ToolPose P;
  P.p_WT = from_.p_WT + t * (to_.p_WT - from_.p_WT);
  if (angle_ < kSameAxis) {
    P.k_W = (from_.k_W + t * (to_.k_W - from_.k_W)).normalized();
  } else {
    P.k_W =
        (std::sin((1.0 - t) * angle_) * from_.k_W + std::sin(t * angle_) * to_.k_W).normalized();
  }
  return P;
}

LinearisedPath linearise(const InverseKinematics& inverse, const Eigen::Vector3d& p_ST,
                         const StraightToolPath& path, const Joints& Q_0,
                         const ToolTolerance& tolerance) {
  return Lineariser(inverse, p_ST, path, Q_0, tolerance).run();
}

}  // namespace servomill::plant
