/// Component and location errors as comma-separated values.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "controllers/tables/control_table.h"
#include "controllers/tables/error_grid.h"

namespace servomill::controllers {

/// One error over the position of its axis, by its name of ISO 230-1 or ISO 230-7.
struct ErrorColumn {
  std::string file;
  std::string name = {};                // "EXX"
  Axis base_axis = Axis::X;             // of the first column
  int direction = 0;                    // of travel: 1 up, -1 down, 0 both
  std::vector<TablePoint> points = {};  // `up` and `down` both hold the error; m, rad
};

struct LocationValue {
  double value = 0.0;  // m, rad
  int line = 0;
  std::string file = {};
};

struct ErrorColumns {
  std::vector<ErrorColumn> components;
  std::map<std::string, LocationValue, std::less<>> locations;  // by name
  std::vector<ErrorGrid> grids = {};       // component errors over other axes than their own
  std::vector<std::string> not_read = {};  // parameters of the file that are no errors
};

/// Rules (RFC 4180): the first line names the columns. A file of component errors begins with the
/// axis and its unit (X_mm, C_deg); its other columns are NAME_UNIT, NAME_up_UNIT or
/// NAME_down_UNIT, unit um or urad. A file of location errors has the columns error, value, unit.
/// @param files  those whose names end in .csv are read
/// @throws InputError with file and line
ErrorColumns read_csv_tables(std::span<const TableText> files);

}  // namespace servomill::controllers
