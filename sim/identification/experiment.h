/// An experiment: recordings of axes, the control that they were made with, what is to be
/// estimated. Everything that `servomill identify` reads, checked.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/config/document.h"
#include "sim/config/reader.h"
#include "sim/identification/record.h"
#include "sim/identification/sampled_loop.h"
#include "sim/identification/synthesize.h"

namespace servomill::sim::identification {

/// A number of the machine or of the loop that is to be estimated. Values are in `unit`.
struct Estimate {
  static constexpr std::size_t kAllRecords = std::numeric_limits<std::size_t>::max();
  std::vector<std::string> keys;  // "axis.X.moving_mass", "loop.dead_time_ms": one value for all
  std::string unit;               // as written: "kg"; empty: a plain number
  double start = 0.0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  Place place;
  bool of_nc = false;                // LoopKind::nc: the NC has it, too, and knows it changes
  std::size_t record = kAllRecords;  // number of the only record that it is for

  bool is_at_bound() const { return start == lower || start == upper; }
  bool is_for(std::size_t number) const { return record == kAllRecords || record == number; }
};

/// A record of one axis.
struct AxisRecord {
  Record record;
  std::size_t number = 0;  // among those of the experiment
  int joint = 0;
  Place place;
  std::vector<std::string> notes;  // sentences on what was done to it
};

/// A friction law to be compared with others.
struct Law {
  std::string name;
  std::vector<std::string> changes;  // "KEY=VALUE", on the machine
  std::vector<Estimate> estimates;   // of this law, in place of the experiment's with equal keys
};

struct Experiment {
  std::string name, path;
  std::string machine_path;   // as it is named in the experiment; empty: it stands in it
  config::Document document;  // resolved: tables `machine` and `loop`; `controller`: the machine
                              // as its NC takes it to be, with LoopKind::nc
  LoopSettings loop;
  std::vector<AxisRecord> records;
  std::vector<Estimate> estimates;
  NoiseSettings noise, rotary_noise;  // of made-up recordings of linear and of rotary axes
  bool compares_laws = false;
};

/// Files of recordings that are named beside the experiment, relative to the folder of the user.
struct RecordingFiles {
  std::vector<std::string> estimation;  // in place of those that the list names, one after another
  std::vector<std::string> validation;  // beside them, with the channels of the first
};

/// @throws InputError with all faults of the file at once; faults of recordings name those
Experiment read_experiment(const std::string& path, const RecordingFiles& files = {});

/// The loop of the table `loop` of an experiment's document. Faults go to the reader.
LoopSettings read_loop(config::Reader& table);

}  // namespace servomill::sim::identification
