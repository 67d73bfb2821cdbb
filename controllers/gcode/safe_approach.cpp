#include "controllers/gcode/safe_approach.h"

#include <fmt/format.h>

#include "controllers/gcode/number_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr int kDecimals = 7;  // mm, deg: as the printer of programs
constexpr int kZ = 2;         // joint

}  // namespace

SafeApproach::SafeApproach(const plant::InverseKinematics& inverse,
                           const SafeApproachParams& params, const Eigen::Vector3d& work_offset,
                           int work_system)
    : inverse_(inverse), params_(params), work_offset_(work_offset), work_system_(work_system) {}

ToolPose SafeApproach::clear_of(const ToolPose& P) const {
  return {P.p_WT + params_.clearance * P.k_W, P.k_W};
}

SafeApproach::Clear SafeApproach::joints_clear_of(const ToolPose& P, const Joints& Q,
                                                  const Eigen::Vector3d& p_ST) const {
  const auto found = plant::inverse_fixed_rotary(inverse_.chain(), clear_of(P).p_WT, Q, p_ST);
  if (!found) return {Q, "the machine cannot move along the tool axis there"};
  const Joints& lower = inverse_.settings().lower;
  const Joints& upper = inverse_.settings().upper;
  for (int j = 0; j < kLinearJoints; ++j) {
    const double slack = inverse_.settings().travel_tolerance;
    if ((*found)[j] >= lower[j] - slack && (*found)[j] <= upper[j] + slack) continue;
    return {Q, fmt::format("{:g} mm away along the tool axis, {} would be at {:.6g} mm, beyond its "
                           "travel; use a smaller --clearance",
                           params_.clearance / mm, inverse_.chain().layout.letter_of(j),
                           (*found)[j] / mm)};
  }
  if ((*found)[kZ] <= params_.retract_Z) return {*found, {}};
  return {Q, fmt::format("{:g} mm away along the tool axis, Z is at {:.6g} mm, above the retract "
                         "height of {:g} mm; raise --retract",
                         params_.clearance / mm, (*found)[kZ] / mm, params_.retract_Z / mm)};
}

Joints SafeApproach::retracted(Joints Q) const {
  Q[kZ] = params_.retract_Z;
  return Q;
}

std::string SafeApproach::retract_line() const {
  return "G49 G53 G0 Z" + fixed_text(params_.retract_Z / mm, kDecimals);
}

std::string SafeApproach::rapid_line(const Joints& Q, int first, int end) const {
  std::string words;
  for (int j = first; j < end; ++j) {
    if (!inverse_.chain().layout.has(j)) continue;
    const bool is_linear = j < kLinearJoints;
    const double value = is_linear ? (Q[j] - work_offset_[j]) / mm : Q[j] / deg;
    words +=
        fmt::format(" {}{}", inverse_.chain().layout.letter_of(j), fixed_text(value, kDecimals));
  }
  if (words.empty()) return {};
  return fmt::format("G{} G0{}", 53 + work_system_, words);
}

std::string SafeApproach::rotary_line(const Joints& Q) const {
  return rapid_line(Q, kLinearJoints, kJoints);
}

std::string SafeApproach::plane_line(const Joints& Q) const { return rapid_line(Q, 0, kZ); }

}  // namespace servomill::controllers
