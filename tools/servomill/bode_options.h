/// The options of `servomill bode`.
#pragma once

#include <string>
#include <vector>

#include "sim/frequency/bode.h"
#include "sim/model/forward.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

void add_bode_options(Options& options);

/// One loop of one axis.
struct BodeTask {
  int joint = 0;
  sim::frequency::BodeSettings settings;
};

/// Reads these options: all loops of one axis after the other, each checked before the first is
/// measured.
/// @throws InputError
std::vector<BodeTask> bode_tasks(const Options& options,
                                 const sim::model::MachineSettings& machine);

/// Excitation of a loop in the unit that its option takes.
std::string in_words(sim::frequency::BodeLoop loop, int joint, double si);

}  // namespace servomill::tools
