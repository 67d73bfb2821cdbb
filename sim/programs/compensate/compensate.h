/// Any milling program, corrected for the errors of the machine that runs it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/programs/canonical_moves.h"
#include "sim/programs/compensate/dialect.h"
#include "sim/programs/compensate/path_record.h"
#include "sim/programs/compensate/summary.h"
#include "strategies/displaced_axes.h"

namespace servomill::sim::programs {

class PointUncertainty;  // sim/programs/compensate/point_uncertainty.h

struct CompensateRequest {
  std::string program_file, machine_file;
  std::string error_file;            // of error models, or empty: those of the machine's file
  std::string model;                 // its name; empty: the only one
  std::vector<std::string> changes;  // "KEY=VALUE", of the machine
  std::string servo_file;            // machine file of an identified model; empty: errors alone
  double cutoff = 40.0;              // Hz, of the offset against what that model predicts
  double tolerance = 1e-6;           // m
  double max_block = 0.0;            // m, where the correction varies; 0: no limit
  bool corrects_rapids = false;
  strategies::DisplacedAxes axes = strategies::DisplacedAxes::linear;
  std::array<bool, kLinearJoints> left{};  // X, Y, Z that stay as programmed
  Dialect dialect = Dialect::linuxcnc;
  std::string program_name;         // other dialects: as the file is called, without extension
  int program_number = 0;           // Fanuc: O; 0: not given
  double resolution = 0.0;          // m, of positions in other dialects; 0: the usual one
  double smoothing = 0.0;           // m, tolerance of the control's smoothing; 0: as the control is
  std::optional<double> retract_Z;  // m, machine coordinate; absent: that of the machine's file
  std::optional<int> preset;        // Heidenhain: number of the preset
  std::vector<std::string> without;  // Fanuc: names of kFanucFunctions that the control has not
  ProgramInputs inputs;              // of the program; `machine` is the one above
  std::vector<std::string> work_offsets;  // "X=10,Y=-5" (G54) or "G55:X=10,R=30"; mm, deg
  std::vector<std::string> tool_lengths;  // "1=50": tool 1 is 50 mm long
  std::string start;                      // "X=0,Y=0": machine coordinates; or empty
  bool records = false;                   // the path
  bool lists_uncertainty = false;         // of every corrected point

  const std::string& file_of_errors() const {
    return error_file.empty() ? machine_file : error_file;
  }
};

struct Compensated {
  std::string program;
  Summary summary;
  std::vector<std::string> report;  // what it changed and assumed, one line each
  std::vector<Fault> warnings;
  std::string json;
  std::string machine;  // its name
  PathRecord record;    // where it was asked for
  /// Uncertainty of the corrected points, where the covariance of the errors is known.
  std::shared_ptr<const PointUncertainty> uncertainty;
};

/// Corrected points with their uncertainty, as CSV (PointUncertainty::csv).
/// @pre the uncertainty is known
std::string points_csv(const Compensated& done);

/// The program is read back as its control would read it and compared with the original.
/// @throws InputError, also where they differ
Compensated compensate(const CompensateRequest& request);

struct VerificationReport;

/// The comparison alone, of any text that is to be the compensated program of a request.
/// @throws InputError that shows the line of the original and that of the written program
VerificationReport verify_compensated(const CompensateRequest& request, const std::string& written);

}  // namespace servomill::sim::programs
