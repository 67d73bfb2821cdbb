/// Geometric errors of a machine by their names of ISO 230-1 (linear axes) and ISO 230-7 (rotary).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "plant/geometry/error_function.h"
#include "plant/geometry/error_name.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::plant {

/// An error name in a program: `"EC0Y"_err`; a wrong one does not compile.
consteval ErrorName operator""_err(const char* text, std::size_t size) {
  return error_name_of({text, size}).value();
}

/// Why an error of that name cannot do anything on a machine with these axes (the machine lacks the
/// axis, or the location error moves the axis within itself), or nullopt if it can. The text
/// continues a sentence that begins with the name.
std::optional<std::string> why_meaningless(const ErrorName& name, const JointLayout& layout);

/// The name that a user wrote.
/// @throws InputError if it is none, with the nearest name of this machine, or if it is meaningless
ErrorName parse_error_name(std::string_view text, const JointLayout& layout, const Place& at);

/// All errors of a machine. Component errors are functions of their axis' own coordinate, location
/// errors are constants; along X, Y, Z in m, about A, B, C in rad. Empty: the ideal machine.
///
/// One sign convention: an error is the deviation of the tool side as seen from the workpiece side,
/// whichever side of the bed carries the axis, in the axes of M at zero. The errors of an inclined
/// rotary axis count in its own frame (ChainAxis::R_MA), so that of an inclined B axis EYB still is
/// along the axis, EXB and EZB across, EBB in its angle, and EY0B and EB0B mean nothing.
///
// clang-format off
///     Z ^  EZ. along, EC. about            Y  actual   nominal
///       |                                      .       ^          EC0Y > 0 (counter-clockwise):
///       |                                       .      |          the tool drifts to -X as Y grows
///       |        Y                               .     |
///       +------> EY. along, EB. about             .    |          EC0Y: dx = -EC0Y y
///      /                                           .   |          EB0Z: dx = +EB0Z z
///     v X  EX. along, EA. about                     .  |          EA0Z: dy = -EA0Z z
///                                                    . |
///     turns count right-handed                         +-----> X
///
/// With J(q) the ideal motion of an axis (`plant/kinematics/chain.h`), all about its centre:
///
///     tool side       H = L J(q) L^-1 E(q)      the error belongs to the body that the axis moves:
///     workpiece side  H = E(q) L J(q) L^-1      the one towards the tool, or towards the workpiece
///
///     E(q) = Trans(EX., EY., EZ.) Rot(EA., EB., EC.)          component errors at q
///     L    = Rot(EA0., EB0., EC0.) Trans(EX0., EY0., EZ0.)    location errors
///
/// Rot(e) is the turn by |e| about e, the exponential of [e]x; to first order 1 + [e]x.
// clang-format on
struct ErrorModel {
  std::array<std::array<ErrorFunction, kErrorDirections>, kAxisWords>
      components;                               // [axis][direction]
  std::array<AxisWords, kAxisWords> locations;  // [axis][direction]

  ErrorModel() { locations.fill(AxisWords::Zero()); }

  /// @pre name.is_location is false for component(), true for location()
  ErrorFunction& component(const ErrorName& name);
  const ErrorFunction& component(const ErrorName& name) const;
  double& location(const ErrorName& name);
  double location(const ErrorName& name) const;

  bool is_zero() const;
  bool operator==(const ErrorModel&) const = default;
};

ErrorModel operator+(const ErrorModel& a, const ErrorModel& b);
ErrorModel scaled(const ErrorModel& errors, double factor);

}  // namespace servomill::plant
