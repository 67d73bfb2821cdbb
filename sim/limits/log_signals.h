/// Signals of axes in a recorded log: which channel is which axis, in SI.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/recordings/recording.h"

namespace servomill::sim::limits {

/// Samples of one axis.
struct AxisSignal {
  int joint = 0;
  std::string channel;
  int order = 0;  // derivative of the position that it is: 0 position, 1 velocity, 2 acceleration
  double unit = 1.0;  // SI, of one unit of the samples
  std::string unit_name;
  std::vector<double> t;  // s; samples that are missing are left out
  std::vector<double> x;  // in the unit of the file, as its resolution is that of the file
  std::vector<int> line;  // of the program; empty: not recorded
};

struct LogSignals {
  std::vector<AxisSignal> signals;
  std::vector<std::string> notes;  // assumed units, channels that were taken by their names
};

struct LogRequest {
  std::vector<std::string> channels = {};  // "X=joint.0.pos-cmd [mm]"; empty: by their names
  std::string line_channel = {};           // empty: by its name
  std::string case_name = {};              // of a result file with several
  std::optional<double> period = {};       // s, of logs that number their samples
};

/// @throws InputError for channels that there are not, logs without time, axes without channel
LogSignals log_signals(const recordings::Recording& recording, const JointLayout& layout,
                       const LogRequest& request);

}  // namespace servomill::sim::limits
