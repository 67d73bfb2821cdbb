#include "plant/kinematics/nonlinear_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace servomill::plant {
namespace {

ToolPose pose_of(const CutterLocation& location) { return {location.P, location.U.normalized()}; }

std::optional<Joints> post_processed(const InverseKinematics& inverse, const Eigen::Vector3d& p_ST,
                                     const CutterLocation& location, const Joints& Q_near) {
  const JointSolution solution = inverse.nearest(pose_of(location), p_ST, Q_near);
  if (!solution.is_reached()) return {};
  return solution.Q;
}

// The last point of an even division may fall on the end.
constexpr double kSameLength = 1e-9;  // share of a spacing

}  // namespace

double shape_at(ErrorShape shape, double t) {
  return shape == ErrorShape::harmonic ? std::sin(std::numbers::pi * t) : 4.0 * t * (1.0 - t);
}

std::optional<PostProcessedSegment> PostProcessedSegment::post(const InverseKinematics& inverse,
                                                               const Eigen::Vector3d& p_ST,
                                                               const CutterLocation& from,
                                                               const CutterLocation& to,
                                                               const Joints& Q_near) {
  const auto Q_0 = post_processed(inverse, p_ST, from, Q_near);
  if (!Q_0) return {};
  // The rotary solution next to the first location, as a post-processor takes it.
  const auto Q_1 = post_processed(inverse, p_ST, to, *Q_0);
  if (!Q_1) return {};
  PostProcessedSegment segment(inverse, p_ST, *Q_0, *Q_1);
  segment.from_ = from;
  segment.to_ = to;
  return segment;
}

PostProcessedSegment::PostProcessedSegment(const InverseKinematics& inverse,
                                           const Eigen::Vector3d& p_ST, const Joints& Q_0,
                                           const Joints& Q_1)
    : inverse_(&inverse), p_ST_(p_ST), Q_0_(Q_0), Q_1_(Q_1) {
  const auto located = [&](const Joints& Q) {
    const ToolPose P = forward(inverse.chain(), Q, p_ST);
    return CutterLocation{P.p_WT, P.k_W};
  };
  from_ = located(Q_0);
  to_ = located(Q_1);
}

CutterLocation PostProcessedSegment::at(double t) const {
  return {from_.P + t * (to_.P - from_.P), from_.U + t * (to_.U - from_.U)};
}

std::optional<Joints> PostProcessedSegment::joints(NonlinearError definition, double t) const {
  // By one definition the joints move linearly and the tip leaves its chord; by the other the tip
  // is on the chord and the joints leave theirs.
  if (definition == NonlinearError::joint_interpolation) return linear(t);
  const CutterLocation location = at(t);
  if (location.U.norm() == 0.0) return {};
  return post_processed(*inverse_, p_ST_, location, linear(t));
}

std::optional<Eigen::Vector3d> PostProcessedSegment::error(NonlinearError definition, double t,
                                                           ErrorFrame frame) const {
  const auto Q = joints(definition, t);
  if (!Q) return {};
  if (definition == NonlinearError::post_processed_location) return (*Q - linear(t)).head<3>();
  if (frame == ErrorFrame::workpiece) {
    return forward(inverse_->chain(), *Q, p_ST_).p_WT - at(t).P;
  }
  // In the machine the error is the travel of the linear axes that brings the tip back to the
  // chord, rotary axes as they are.
  const auto onto_chord = inverse_fixed_rotary(inverse_->chain(), at(t).P, *Q, p_ST_);
  if (!onto_chord) return {};
  return (*Q - *onto_chord).head<3>();
}

std::optional<Joints> PostProcessedSegment::compensated(NonlinearError definition, ErrorShape shape,
                                                        const Eigen::Vector3d& amplitude, double t,
                                                        ErrorFrame frame) const {
  auto Q = joints(definition, t);
  if (!Q) return {};
  const Eigen::Vector3d eps = amplitude * shape_at(shape, t);
  if (definition == NonlinearError::post_processed_location || frame == ErrorFrame::machine) {
    Q->head<3>() -= eps;
    return Q;
  }
  const Eigen::Vector3d tip = forward(inverse_->chain(), *Q, p_ST_).p_WT;
  return inverse_fixed_rotary(inverse_->chain(), tip - eps, *Q, p_ST_);
}

std::optional<std::vector<PathPoint>> PostProcessedSegment::compensated_points(
    NonlinearError definition, ErrorShape shape, double tolerance, double spacing,
    ErrorFrame frame) const {
  assert(spacing > 0.0);
  const auto amplitude = error(definition, 0.5, frame);
  if (!amplitude) return {};
  std::vector<PathPoint> points;
  if (amplitude->norm() > tolerance) {
    // A chord along which the axes move but the tip hardly does has no length to be divided: the
    // error, out and back, stands in for it.
    const double intervals = std::max(length(), 2.0 * amplitude->norm()) / spacing;
    for (double n = 1.0; n < intervals - kSameLength; n += 1.0) {
      const double t = n / intervals;
      const auto Q = compensated(definition, shape, *amplitude, t, frame);
      if (!Q) return {};
      points.push_back({t, *Q});
    }
  }
  points.push_back({1.0, Q_1_});
  return points;
}

std::optional<NonlinearPeaks> nonlinear_peaks(const PostProcessedSegment& segment,
                                              NonlinearError definition, ErrorFrame frame,
                                              int intervals) {
  const auto a = segment.error(definition, 0.5, frame);
  if (!a) return {};
  NonlinearPeaks peaks;
  peaks.middle = a->norm();
  for (int n = 0; n <= intervals; ++n) {
    const double t = static_cast<double>(n) / intervals;
    const auto e = segment.error(definition, t, frame);
    if (!e) return {};
    const auto left = [&](ErrorShape shape) { return (*e - *a * shape_at(shape, t)).norm(); };
    peaks.error = std::max(peaks.error, e->norm());
    peaks.harmonic = std::max(peaks.harmonic, left(ErrorShape::harmonic));
    peaks.parabolic = std::max(peaks.parabolic, left(ErrorShape::parabolic));
  }
  return peaks;
}

}  // namespace servomill::plant
