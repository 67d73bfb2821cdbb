/// Settings of the control at the start of a program.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "controllers/gcode/decimal_point.h"
#include "controllers/gcode/probing.h"
#include "controllers/gcode/program_text.h"
#include "controllers/gcode/reader.h"
#include "controllers/gcode/tool_table.h"
#include "controllers/path/tool_centre_point.h"
#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

class PossibleReaders;

/// The controls that would read one program: found once for all runs of it that share this.
struct SharedTrials {
  std::shared_ptr<const PossibleReaders> found;
};

/// Data of the machine before the first block.
struct ProgramSetup {
  std::map<int, double> stored;  // of the parameter file, in mm and degrees
  /// "#101", "#<name>" or "#<_name>", in program terms (whatever unit the program gives them).
  std::map<std::string, double> parameters;
  std::array<AxisWords, 9> work_offset = zero_offsets();  // G54 ... G59.3; m, rad
  std::array<double, 9> work_rotation{};                  // about Z, rad
  int work_system = 1;  // in force at the start; 1 is G54. `stored` does not set it
  ToolTable tools;
  int tool = 0;                      // in the spindle at the start; 0: none
  Reader reader = Reader::linuxcnc;  // whose rules the text follows
  /// The reader linuxcnc takes G43.4, G43.5, G53.1, G68.2 and G69, which LinuxCNC itself lacks, as
  /// programs have them that are written here.
  bool takes_five_axis_codes = true;
  DecimalPoint decimal_point = DecimalPoint::unset;  // not for the reader linuxcnc
  std::optional<double> feed;  // m/s, of moves before any F; not for the reader linuxcnc
  /// Work offsets of G54.1 P1 ... and G154 P1 ..., by P; m, rad.
  std::map<int, AxisWords> additional_offsets;
  /// Numbers of M codes of the machine's builder that have no effect on motion, as the user says;
  /// not for the reader linuxcnc.
  std::set<int> ignored_codes;
  /// Called with the number of an M code of the machine's builder before it is refused.
  std::function<void(int)> refuses_code = {};
  /// Lengths of tools may be unknown: machine coordinates of such moves are not to be used.
  bool accepts_unknown_lengths = false;
  /// Dwells may be unknown (NaN), where controls read P in different units.
  bool accepts_unknown_dwells = false;
  /// For surveys: positions may be unknown that only the machine or --additional-offset gives.
  /// G54.1 P lies at the work system in force, M140 MB MAX goes to the stored position of G28,
  /// G53.1 and G43.5 leave the rotary axes, and the tip is reckoned with these at zero.
  bool accepts_unknown_positions = false;
  /// For surveys: feeds may be unknown (NaN), as those of moves before the first F.
  bool accepts_unknown_feeds = false;
  /// Finds out whether the reader would read the program, not how: what stops servomill and not
  /// the control is thrown as `Undetermined`.
  bool is_trial = false;
  AxisWords start = AxisWords::Zero();  // machine coordinates before the first block; m, rad
  bool block_delete = false;            // leave out the lines that start with '/'
  /// The file of a subroutine that the program calls and does not define: `o<name> call` asks for
  /// "name", `o100 call` and `M98 P100` for "100". Empty: there are no such files.
  std::function<std::optional<ProgramText>(const std::string& name)> subroutine_file;
  /// Loops turned and subroutines called before a program counts as endless, or ten times as many
  /// lines in them.
  long most_jumps = 1'000'000;
  /// The machine, for tool-centre-point control and tilted planes. Without it a program may use
  /// G43.4 and G68.2 as long as its rotary axes are at zero where they are switched on and off.
  std::shared_ptr<const ToolCentrePoint> machine;
  /// Answers to G38.2 ... G38.5; nullptr: refused.
  std::shared_ptr<Probed> probed;
  std::shared_ptr<SharedTrials> trials;  // nullptr: shared with no other run

  static std::array<AxisWords, 9> zero_offsets();
};

}  // namespace servomill::controllers
