/// Names of geometric errors in exchange files: EYX (component), C0Y (position error).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "controllers/tables/csv_table.h"

namespace servomill::controllers {

struct ErrorParameter {
  Axis direction = Axis::X;
  Axis axis = Axis::X;
  bool is_location = false;

  /// Name of ISO 230-1: "EYX", "EC0Y".
  std::string iso_name() const;
  double unit() const;  ///< m per mm, or 1: values are in mm or rad
};

/// The parameter that a name of TF5280 denotes: three letters, E or the direction first, 0 in the
/// middle of a position error.
/// Source: Beckhoff TF5280, List of parameters supported
/// (infosys.beckhoff.com/content/1033/tf5280_volumetric_comp/296423819.html).
std::optional<ErrorParameter> error_parameter_of(std::string_view name);

/// SI value of the coordinate of an axis that a file holds in mm or deg.
double coordinate_unit(Axis axis);

/// Adds a component error. @throws InputError if it is there already, has fewer than two points or
/// positions that do not increase
void add_component(ErrorColumns& errors, ErrorColumn column, int line);

/// Adds a component error over several axes. @throws InputError if it is there already
void add_grid(ErrorColumns& errors, ErrorGrid grid);

/// Adds a position error. @throws InputError if it is there already
void add_location(ErrorColumns& errors, const std::string& file, const ErrorParameter& parameter,
                  LocationValue value);

}  // namespace servomill::controllers
