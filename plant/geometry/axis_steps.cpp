#include "plant/geometry/axis_steps.h"

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>

#include "plant/geometry/rotation_vector.h"

namespace servomill::plant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d turn_of_location(const ChainAxis& axis, const ErrorModel& errors) {
  Vector3d angles;
  for (int i = 0; i < 3; ++i) {
    angles[i] = errors.location({kAllAxes[static_cast<std::size_t>(i) + 3], axis.axis, true});
  }
  return angles;
}

// Geometric errors of one axis.
struct Faults {
  Vector3d shift, angles;  // location errors
  bool has_functions = false, has_angles = false;

  Faults(const ChainAxis& axis, const ErrorModel& errors, const AxisFunctions& functions)
      : angles(turn_of_location(axis, errors)) {
    for (std::size_t i = 0; i < kErrorComponents; ++i) {
      if (functions[i].is_zero()) continue;
      has_functions = true;
      if (i >= 3) has_angles = true;
    }
    for (int i = 0; i < 3; ++i) {
      shift[i] = errors.location({kAllAxes[static_cast<std::size_t>(i)], axis.axis, true});
    }
  }
  bool has_location() const { return !shift.isZero(0.0) || !angles.isZero(0.0); }
};

void write(const Matrix3d& R, double (&out)[3][3]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out[i][j] = R(i, j);
  }
}

// C L J L^-1 C^-1 with C = Trans(centre), L = Rot(R) Trans(t), and J = one of three constant
// matrices, as each coordinate of a turned vector has a part that stays, one that goes with the
// cosine, and one that goes with the sine.
void write_tilted_turn(const Matrix3d& R, const Vector3d& t, VolumetricStep& step) {
  const Vector3d axis = Vector3d::Unit(step.direction), centre = Vector3d::Map(step.centre);
  const auto part = [&](const Matrix3d& J, const Vector3d& d, double* out) {
    const Matrix3d M = R * J * R.transpose();
    for (int i = 0; i < 3; ++i) Vector3d::Map(out + 3 * i) = M.row(i);
    Vector3d::Map(out + 9) = d - M * centre - R * (J * t);
  };
  const Matrix3d still = axis * axis.transpose();
  Matrix3d across;
  for (int i = 0; i < 3; ++i) across.col(i) = axis.cross(Vector3d::Unit(i));
  part(still, centre + R * t, step.still);
  part(Matrix3d::Identity() - still, Vector3d::Zero(), step.turning[0]);
  part(across, Vector3d::Zero(), step.turning[1]);
}

void add_steps(const ChainAxis& axis, const ErrorModel& errors, const AxisFunctions& functions,
               std::vector<VolumetricStep>& out) {
  const Faults faults(axis, errors, functions);
  VolumetricStep step{};
  step.direction = static_cast<std::uint8_t>(index_of(axis.axis) % 3);
  step.joint = static_cast<std::uint8_t>(axis.joint);
  step.has_angles = faults.has_angles;
  Vector3d::Map(step.centre) = axis.centre;
  const Matrix3d R = TurnOf(faults.angles).matrix();  // L = Rot(angles) Trans(shift)
  const bool workpiece = axis.side == Side::workpiece;
  if (is_linear(axis.axis)) {
    step.move = faults.has_functions ? VolumetricMove::faulty_shift : VolumetricMove::shift;
    if (workpiece) Vector3d::Map(step.lever_slope) = R.col(step.direction);
    step.has_lever = workpiece || !axis.centre.isZero(0.0);
    out.push_back(step);
    return;
  }
  step.has_lever = !axis.centre.isZero(0.0);
  VolumetricStep fault = step;
  fault.move = VolumetricMove::fault;
  step.move = faults.has_location() ? VolumetricMove::tilted_turn : VolumetricMove::turn;
  write_tilted_turn(R, faults.shift, step);
  if (faults.has_functions && !workpiece) out.push_back(fault);
  out.push_back(step);
  if (faults.has_functions && workpiece) out.push_back(fault);
}

}  // namespace

AxisFunctions functions_of(const ChainAxis& axis, const ErrorModel& errors) {
  AxisFunctions all;
  for (const Axis direction : kAllAxes) {
    all[static_cast<std::size_t>(index_of(direction))] =
        errors.component({direction, axis.axis, false});
  }
  const Vector3d angles = turn_of_location(axis, errors);
  if (!is_linear(axis.axis) || angles.isZero(0.0)) return all;
  const Vector3d d = Vector3d::Unit(index_of(axis.axis)), Ld = TurnOf(angles).matrix() * d;
  for (int i = 0; i < 3; ++i) {
    ErrorFunction& f = all[static_cast<std::size_t>(i)];
    f = f + polynomial({0.0, Ld[i] - d[i]});
  }
  return all;
}

std::vector<VolumetricStep> steps_of(const ChainAxis& axis, const ErrorModel& errors,
                                     const AxisFunctions& functions) {
  std::vector<VolumetricStep> out;
  if (!axis.is_inclined) {
    add_steps(axis, errors, functions, out);
    return out;
  }
  VolumetricStep frame{};
  frame.joint = static_cast<std::uint8_t>(axis.joint);
  Vector3d::Map(frame.centre) = axis.centre;
  write(axis.R_MA, frame.R);
  ChainAxis upright = axis;
  upright.centre.setZero();
  frame.move = VolumetricMove::enter_frame;
  out.push_back(frame);
  add_steps(upright, errors, functions, out);
  frame.move = VolumetricMove::leave_frame;
  out.push_back(frame);
  return out;
}

bool is_turn(const VolumetricStep& step) {
  return step.move == VolumetricMove::turn || step.move == VolumetricMove::tilted_turn;
}
bool is_frame(const VolumetricStep& step) {
  return step.move == VolumetricMove::enter_frame || step.move == VolumetricMove::leave_frame;
}
bool is_shift(const VolumetricStep& step) {
  return step.move == VolumetricMove::shift || step.move == VolumetricMove::faulty_shift;
}

}  // namespace servomill::plant
