/// Signals of the recording of a case: names, units, what they say and to what they are rounded.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "sim/engine/run_outputs.h"
#include "sim/model/forward.h"
#include "sim/model/run_settings.h"
#include "sim/records/series.h"

namespace servomill::sim::engine {

/// Signals that not every case has.
struct SignalParts {
  bool imposed = false;        // displacement by imposed errors
  bool uncorrectable = false;  // deviation that the axes cannot compensate
  bool cut = false;            // force and deflection
  bool teeth = false;          // the force is that of single teeth: angle of the spindle
  bool programmed = false;     // positions on the programmed path
  bool oriented = false;       // direction of the tool across its axis
  bool windows = false;        // number of the window, and rows around it
};

/// Signals by which rows are found: every recording has them.
inline constexpr std::array<std::string_view, 5> kOfEveryRow = {"time", "s", "line", "section",
                                                                "rapid"};
/// True if a signal of the axes and their loops is asked for.
bool wants_axis_signals(const RunOutputs& outputs);

/// Number of these signals, each of all axes.
std::size_t axis_signals();

/// True if the bed of the machine moves under some axis.
bool stands_on_bed(const model::MachineSettings& machine);

/// All signals of a row, in the order of its columns.
std::vector<records::Signal> recorded_signals(const model::MachineSettings& machine,
                                              SignalParts parts);

/// Gives every signal the quantum and the storage of a format.
void round_to(const model::RecordFormat& format, std::vector<records::Signal>& signals);

}  // namespace servomill::sim::engine
