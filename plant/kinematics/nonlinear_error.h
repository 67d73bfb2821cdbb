/// Nonlinear error of a machine with rotary axes between two cutter locations, its one-term models,
/// and the compensation with them. Source: X. Li, Simulation of motion nonlinear error compensation
/// of CNC machine tools with multi-axis linkage (2024), sections 3.2.2 to 3.2.5.
///
/// A location is post-processed to joints; between two posts S_0 and S_1 the error has two
/// definitions, which the paper does not keep apart:
///
///   joint_interpolation   The joints move linearly from S_0 to S_1. Error: the tip minus the point
///                         of the chord P_0 P_1 at the same t; or, of the same length, where the
///                         linear axes are minus where they would bring the tip onto it.
///   post_processed_location       P and U are interpolated linearly and post-processed. Error: the
///   linear joints
///                         of the post minus the point of the line S_0 S_1 at the same t, in the
///                         machine (equation 3.3).
///
/// Models of the error e(t) with a = e(1/2), t in [0, 1] (eps of equation 3.4):
///
///   harmonic    eps(t) = a sin(pi t)         (equation 3.3)
///   parabolic   eps(t) = 4 a t (1 - t)       e has a constant second derivative to leading order,
///                                            so the sine approximates this
///
/// Compensation takes eps away from the interpolated points (equation 3.4). With
/// joint_interpolation the tip then keeps to the chord. Its amplitude is taken in the machine, as
/// equation 3.3 does. Of the paper's locations a parabola then leaves half as much as with that in
/// the workpiece (example 1: 0.53 instead of 1.05 % of the peak); of others it may leave more.
/// With post_processed_location, as published, the
/// posts come to the line between S_0 and S_1: that is where the machine goes of itself, and the
/// tip is as far from the chord as without.
#pragma once

#include <optional>
#include <vector>

#include "plant/kinematics/straight_tool_path.h"

namespace servomill::plant {

enum class NonlinearError : std::uint8_t { joint_interpolation, post_processed_location };
enum class ErrorShape : std::uint8_t { harmonic, parabolic };

/// Frame in which the vector e of joint_interpolation is expressed, and with it the amplitude of a
/// model. |e| is the same in both. An error by post_processed_location is always in the machine
/// frame.
enum class ErrorFrame : std::uint8_t { machine, workpiece };

/// Tip and tool axis as a CAM system gives them. The length of U does not matter for the post; it
/// does a little for locations between.
struct CutterLocation {
  Eigen::Vector3d P = Eigen::Vector3d::Zero();   // m, in W
  Eigen::Vector3d U = Eigen::Vector3d::UnitZ();  // any length but 0
};

/// sin(pi t) or 4 t (1 - t).
double shape_at(ErrorShape shape, double t);

/// Two locations and their posts.
class PostProcessedSegment {
 public:
  /// Posts two locations, the second next to the first.
  /// @param inverse  must outlive the segment
  /// @param Q_near   joints before; chooses among solutions
  /// @return nullopt if one cannot be reached
  static std::optional<PostProcessedSegment> post(const InverseKinematics& inverse,
                                                  const Eigen::Vector3d& p_ST,
                                                  const CutterLocation& from,
                                                  const CutterLocation& to, const Joints& Q_near);

  /// Segment of a program: locations are where the joints put the tool.
  PostProcessedSegment(const InverseKinematics& inverse, const Eigen::Vector3d& p_ST,
                       const Joints& Q_0, const Joints& Q_1);

  const Joints& Q_0() const { return Q_0_; }
  const Joints& Q_1() const { return Q_1_; }
  double length() const { return (to_.P - from_.P).norm(); }  ///< of the chord (m)

  /// Joints at t: linear (joint_interpolation), or post-processed; nullopt where the latter is not
  /// reached.
  std::optional<Joints> joints(NonlinearError definition, double t) const;

  /// e(t) (3; m).
  std::optional<Eigen::Vector3d> error(NonlinearError definition, double t,
                                       ErrorFrame frame = ErrorFrame::machine) const;

  /// Joints with e - eps in place of e.
  /// @param amplitude  a (3; m), in the frame
  std::optional<Joints> compensated(NonlinearError definition, ErrorShape shape,
                                    const Eigen::Vector3d& amplitude, double t,
                                    ErrorFrame frame = ErrorFrame::machine) const;

  /// Points of the segment, behind its start, that are compensated with a model. Only the end if
  /// the largest error of the model, |a|, does not exceed the tolerance; else one every `spacing`
  /// of the chord, counted from the start, and the end. Where the tip stands nearly still, the way
  /// that the error takes it, 2 |a|, is divided instead.
  /// @return nullopt if a point cannot be reached
  std::optional<std::vector<PathPoint>> compensated_points(
      NonlinearError definition, ErrorShape shape, double tolerance, double spacing,
      ErrorFrame frame = ErrorFrame::machine) const;

 private:
  CutterLocation at(double t) const;
  Joints linear(double t) const { return Q_0_ + t * (Q_1_ - Q_0_); }

  const InverseKinematics* inverse_;
  Eigen::Vector3d p_ST_;
  CutterLocation from_, to_;
  Joints Q_0_, Q_1_;
};

/// The largest of a segment, over evenly spaced t.
struct NonlinearPeaks {
  double error = 0.0;      // m, of |e|
  double middle = 0.0;     // m, |a|
  double harmonic = 0.0;   // m, of |e - a sin(pi t)|
  double parabolic = 0.0;  // m, of |e - 4 a t (1 - t)|
};

/// @return nullopt if a location between cannot be post-processed
std::optional<NonlinearPeaks> nonlinear_peaks(const PostProcessedSegment& segment,
                                              NonlinearError definition,
                                              ErrorFrame frame = ErrorFrame::machine,
                                              int intervals = 1000);

}  // namespace servomill::plant
