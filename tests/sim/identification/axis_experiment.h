/// A small axis, its loop, a motion and experiments with it, as files.
#pragma once

#include <string>
#include <vector>

#include "sim/identification/record.h"
#include "sim/identification/simulate_record.h"

namespace servomill::sim::identification {

/// 95 kg on a screw without inertia, 200 N s/m, 20 N of Coulomb friction, r = 1 m/rad.
plant::FeedDriveParams small_axis();

/// P over P as a control of 1 ms has it: 160 1/s, 8557 N s/m, the mean of two samples.
LoopSettings small_loop();

/// Ramps between speeds of both directions, 1 m/s^2, `seconds` long, sampled every ms.
Record ramps(double seconds);

/// The same recorded without any disturbance.
Record recorded(const Record& motion, const AxisModel& model);

/// Folder of a test with the files of an experiment: machine.toml with axis X as small_axis(),
/// recording.csv, experiment.toml.
class AxisExperiment {
 public:
  AxisExperiment();
  ~AxisExperiment();
  AxisExperiment(const AxisExperiment&) = delete;
  AxisExperiment& operator=(const AxisExperiment&) = delete;

  /// Writes a recording with the columns time, q, y, F.
  void write_recording(const Record& record, const std::string& name = "recording.csv") const;
  /// Writes experiment.toml: the machine, the loop of small_loop(), the recording, then `rest`.
  /// @return its path
  std::string write(const std::string& rest) const;
  std::string path(const std::string& name) const { return folder_ + "/" + name; }

 private:
  std::string folder_;
};

}  // namespace servomill::sim::identification
