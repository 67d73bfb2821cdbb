/// How a case is to be run: loops, feedback hardware, wear, and how exactly it is recorded.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/ticks.h"
#include "sim/records/chunk_encoder.h"

namespace servomill::sim::model {

enum class ServoModel : std::uint8_t {
  cascade,  // loops and drives as described
  ideal,    // the axes stand where the NC wants them, readings included: Q_true + d(Q_true) = Q_cmd
};

/// Signals pass through the hardware of the feedback strategy, whether or not it displaces them.
struct FeedbackHardware {
  bool connected = false;
  Tick signal_delay = 1;  // from reading the scale to what the NC reads
  Tick model_period = 6;  // a model evaluated at tick n acts from n + model_period on
};

/// Factor on the terms of the edge: at the beginning, and its growth with the length of cut.
struct CuttingWear {
  double initial = 1.0;
  double per_m = 0.0;  // 1/m
};

/// How exactly recorded signals are kept. A Series holds what a file of it holds, so that a
/// comparison made from the file gives the same numbers.
struct RecordFormat {
  /// Lengths are rounded to multiples of the power of two (of their unit) next below this. Angles
  /// and directions are rounded as it is seen from 1 m, rates as it is passed in 10 ms, currents
  /// and torques to that many times 0.1 A (N m) a micrometre, forces to that many times 1 N. 0:
  /// every bit is kept.
  double resolution = 0.0;  // m
  /// Storage of all signals but time, s and counts, which stay float64.
  records::Storage storage = records::Storage::float64;
};

/// Rows of these sections and those of these times are recorded; without any, all rows.
struct RecordWindows {
  std::vector<std::string> sections;
  Place sections_place;
  std::vector<std::array<double, 2>> times;  // s since the start of the program, both ends included
  int every = 1;  // of the passes of each section: the first, then each so many-th

  bool limited() const { return !sections.empty() || !times.empty(); }
  /// True if every row of a section is recorded, whenever it comes.
  bool covers(const std::string& section) const;
};

/// Note of commands that run a scenario without them.
inline constexpr const char* kWindowsLeftOut = "record.windows are ignored: every row is evaluated";

}  // namespace servomill::sim::model
