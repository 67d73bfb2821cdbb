/// Survey of a program: units, work offsets, tools, extent, cycle time, and the controls that read
/// it.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/translation/translated_program.h"
#include "plant/vocabulary/input_error.h"
#include "sim/programs/canonical_moves.h"
#include "sim/programs/program_extent.h"

namespace servomill::sim::programs {

struct SurveyRequest {
  std::string program_file;
  ProgramInputs inputs;
  std::vector<std::string> work_offsets;  // "G54:X=10,Y=-5"
  std::vector<std::string> tool_lengths;  // "1=50"
};

/// A word of the program and the first line that has it; 0: the control starts with it.
struct FirstUse {
  std::string word;
  int line = 0;
};

struct SurveyedTool {
  int first_line = 0;
  bool is_loaded = false;        // by M6
  bool uses_length = false;      // G43
  bool uses_diameter = false;    // G41, G42
  bool is_in_table = false;      // of --tools
  std::optional<double> length;  // m; none: unknown
  std::optional<double> diameter;
};

/// One of controllers::kReaders, and the first line that stops it.
struct ReaderVerdict {
  std::string_view reader;
  std::optional<Fault> stop;  // none: it reads the program
};

struct CycleTime {
  std::string machine;
  double duration = 0.0;      // s
  std::string why_unknown;    // empty: it is known
  std::vector<int> left_out;  // lines of moves from positions that are not known
  int unknown_dwells = 0;     // in a unit that controls do not agree on
  /// Lines of moves that are not known, by cycle ("CYCL DEF 251"): the time is longer
  std::map<std::string, std::vector<int>, std::less<>> unknown_moves = {};
};

struct ProgramSurvey {
  std::string file;
  controllers::translation::Language language = controllers::translation::Language::gcode;
  std::vector<FirstUse> units;         // G20, G21; empty: no word names one
  std::vector<FirstUse> work_systems;  // that motion uses: G54 ...
  std::vector<FirstUse> shifts;        // G10, G52, G92
  std::map<int, SurveyedTool> tools;
  bool has_tool_table = false;
  ProgramExtent extent;
  std::set<int> unknown_systems;        // P of G54.1 whose offset is not given
  int unknown_radius = 0;               // first line of G41, G42 by a tool that no table has
  int unknown_retract = 0;              // first line of M140 MB MAX without a machine; 0: none
  int tcp_controlled = 0;               // first move under G43.4, G43.5 or G68.2; 0: none
  std::optional<CycleTime> cycle_time;  // with a machine file
  int tool_changes = 0, stops = 0;      // M6; M0, M1, M60
  std::vector<Fault> outside_travel;    // with a machine file: moves that leave its travel
  std::vector<ReaderVerdict> readers;
  int read_to = 0;  // line of the first fault; 0: read to its end
};

/// Reads the program as the chosen reader does, and once as each control reads it. Tools that no
/// table gives are of unknown length and diameter: neither stops the survey, and positions that
/// depend on them are unknown.
/// @throws InputError for inputs other than the program
ProgramSurvey survey_program(const SurveyRequest& request);

/// The work coordinate system as the program names it: "G54", "G54.1 P3", or "preset 1".
std::string system_name(const ProgramSurvey& survey, int system);

/// The survey as indented lines.
std::string to_text(const ProgramSurvey& survey);

/// The same as one JSON object; lengths in mm, angles in deg, null for what is unknown.
std::string to_json(const ProgramSurvey& survey);

}  // namespace servomill::sim::programs
