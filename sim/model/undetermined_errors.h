/// Errors that a calibration has not determined: unknown, not 0.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "plant/geometry/error_name.h"
#include "plant/vocabulary/axes.h"

namespace servomill::plant {
struct ErrorModel;  // plant/geometry/error_model.h
}  // namespace servomill::plant

namespace servomill::sim::model {

struct UncertainErrors;  // sim/model/tip_uncertainty.h

/// Squarenesses of XY, XZ and YZ, as turns of either axis.
inline constexpr std::array<std::array<plant::ErrorName, 2>, 3> kSquarenesses = {{
    {{{Axis::C, Axis::Y, true}, {Axis::C, Axis::X, true}}},
    {{{Axis::B, Axis::Z, true}, {Axis::B, Axis::X, true}}},
    {{{Axis::A, Axis::Z, true}, {Axis::A, Axis::Y, true}}},
}};

/// Meaningful component errors over the position of an axis.
std::vector<plant::ErrorName> components_of(const JointLayout& layout, Axis axis);

/// Component errors and squarenesses of the machine that have neither an identified number nor a
/// value in the model. A squareness may be given for either of its two axes: EC0X or EC0Y.
std::vector<plant::ErrorName> undetermined_errors(const plant::ErrorModel& errors,
                                                  const UncertainErrors& identified,
                                                  const JointLayout& layout);

/// True if there are identified errors, those of the model of this name.
bool is_of_model(const std::shared_ptr<const UncertainErrors>& identified,
                 const std::string& model);

/// "ECY, ECZ"
std::string list_of(const std::vector<plant::ErrorName>& names);

}  // namespace servomill::sim::model
