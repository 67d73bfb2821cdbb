/// Cutter location (CL) data: tool positions from a CAM system, independent of any machine.
///
/// Two forms are read.
///
/// APT, one statement a line, `MAJOR/word,word,...` in upper or lower case:
///
///     PARTNO text             name of the part         $$ begins a comment
///     UNITS/MM|INCH           of what follows          $ at the end: goes on in the next line
///     GOTO/x,y,z[,i,j,k]      tip and tool axis; without i,j,k the axis stays
///     FEDRAT/f[,unit]         MMPM IPM (per minute), MMPR IPR (per revolution); either order
///     RAPID                   the next GOTO, and that alone, is a rapid
///     SPINDL/n[,RPM][,CLW|CCLW]  SPINDL/ON|OFF
///     COOLNT/ON|FLOOD|MIST|OFF
///     LOADTL/n                DELAY/s                  STOP  OPSTOP  PPRINT text  FINI
///     CYCLE/OFF               of no effect, for cycles are not read
///
/// CSV, in files whose name ends in `.csv`: a header, then a line a location. Columns x, y, z
/// (x_mm or x_in say the unit, x is in mm), i, j, k and, if wanted, feed (mm/min); lines that begin
/// with '#' are comments. All locations are feed moves.
///
/// A word that would change where the tool goes and is not known here is refused; so is one that
/// looks like a misspelt known one. All others are skipped with a warning.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/move.h"
#include "plant/vocabulary/tool_pose.h"

namespace servomill::controllers {

/// One record. Kinds other than `rapid` and `feed`, and their fields, are those of `Move`.
struct ClRecord {
  MoveKind kind = MoveKind::feed;
  int line = 0;
  ToolPose P;          // rapid, feed: m, unit vector; in workpiece coordinates
  double feed = 0.0;   // feed: m/s of the tip; 0: the file gives none
  double value = 0.0;  // dwell: s; spindle: rad/s
  int number = 0;      // tool, coolant, stop
  int direction = 0;   // spindle
  std::string text;    // message
};

/// A questionable record that was read nevertheless.
struct Warning {
  Place place;
  std::string message;
};

/// "file:line:column: warning: message"
std::string to_string(const Warning& warning);

struct ClData {
  std::string part;  // of PARTNO
  std::vector<ClRecord> records;
  std::vector<Warning> warnings;  // in order of place

  std::size_t locations() const;
  /// First location before any LOADTL; nullptr if a tool is loaded before all of them.
  const ClRecord* first_without_tool() const;
};

/// @param file        name for messages; its extension selects the form
/// @param of_refused  receives the warnings if the file is refused
/// @throws InputError with every fault: among them a tool axis without a direction, a file without
/// a location
ClData read_cl_data(std::string_view text, const std::string& file,
                    std::vector<Warning>* of_refused = nullptr);

}  // namespace servomill::controllers
