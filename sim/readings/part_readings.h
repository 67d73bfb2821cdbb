/// Deviations of a part point by point, as a coordinate measuring machine (CMM) has found them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::readings {

/// A nominal point of the surface in work coordinates.
struct PartPoint {
  Place place;       // of what was read
  std::string name;  // in a result file: "point 3 of side"; empty: of a row
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // out of the part; unit
  double deviation = 0.0;                             // m along the normal; > 0: material is left
};

/// Reads a table with the columns x, y, z, deviation (lengths) and i, j, k (or nx, ny, nz), the
/// normal; others are not read.
/// @throws InputError: a column that is missing or without unit, an empty field, a normal whose
///         length is not 1, no rows
std::vector<PartPoint> read_part_table(const std::string& path);

/// Reads the probed points of a case of a result file, deviations as means of the repetitions.
/// @param probes  features; empty: all
/// @throws InputError: a case or feature that is missing, a point that the CMM has not met
std::vector<PartPoint> read_part_of_case(const std::string& path, const std::string& case_name,
                                         const std::vector<std::string>& probes);

}  // namespace servomill::sim::readings
