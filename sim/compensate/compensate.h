/// Any milling program, corrected for the errors of the machine that runs it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/canon.h"
#include "sim/compensate/path_record.h"
#include "sim/compensate/summary.h"
#include "strategies/compensation.h"

namespace servomill::sim {

enum class Dialect : std::uint8_t { linuxcnc, heidenhain, fanuc, siemens };
inline constexpr std::array<std::string_view, 4> kDialects = {"linuxcnc", "heidenhain", "fanuc",
                                                              "siemens"};

struct CompensateRequest {
  std::string program_file, machine_file;
  std::string error_file;            // of error models, or empty: those of the machine's file
  std::string model;                 // its name; empty: the only one
  std::vector<std::string> changes;  // "KEY=VALUE", of the machine
  double tolerance = 1e-6;           // m
  double max_block = 0.0;            // m, where the correction varies; 0: no limit
  bool splits_rapids = false;
  strategies::DisplacedAxes axes = strategies::DisplacedAxes::linear;
  Dialect dialect = Dialect::linuxcnc;
  ProgramInputs inputs;                   // of the program; `machine` is the one above
  std::vector<std::string> work_offsets;  // "X=10,Y=-5" (G54) or "G55:X=10,R=30"; mm, deg
  std::string start;                      // "X=0,Y=0": machine coordinates; or empty
  bool records = false;                   // the path
};

struct Compensated {
  std::string program;
  Summary summary;
  std::vector<std::string> report;  // what it changed and assumed, one line each
  std::vector<Fault> warnings;
  std::string json;
  std::string machine;  // its name
  PathRecord record;    // where it was asked for
};

/// @throws InputError
Compensated compensate(const CompensateRequest& request);

}  // namespace servomill::sim
