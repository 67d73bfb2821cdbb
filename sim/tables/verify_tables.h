/// Verification of written compensation tables against the error model.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/tables/table_files.h"

namespace servomill::sim::tables {

/// Result of a verification without a fault.
struct TableVerification {
  std::size_t positions = 0;  // of all tables, both directions of travel
  double length = 0.0;        // m: largest difference to the error model, interpolation included
  double angle = 0.0;         // rad
  int right_angles = 0;       // of skew corrections
};

/// Reads the files as the control documents them (controllers/tables) and evaluates them at 1000
/// positions over the travel of each axis, in both directions of travel.
///
/// The error model is evaluated here with the kinematics of the machine with errors, not with the
/// functions that made the tables: the displacement needed at q is the one that brings the actual
/// tip to the nominal one. The tables must agree with its chords over the requested points to one
/// digit of the format; axes without a table must need none. Number of points, first position and
/// spacing must be the requested ones.
///
/// @throws InputError with file and line for a file that the control would read otherwise: position
///         and both values
TableVerification verify_tables(const TableExport& tables, const std::vector<TextFile>& files);

/// "verified: 6000 positions, largest difference to the error model 0.0012 um"
std::string to_string(const TableVerification& verification);

}  // namespace servomill::sim::tables
