/// One recording of one axis as identification uses it: uniform samples in SI.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace servomill::sim::identification {

/// Part of a recording, in samples.
struct SampleRange {
  std::size_t begin = 0, end = 0;
};

/// Channels of one axis on one clock, one sample a period of the loop. Channels that were not
/// recorded are empty; the others have `size()` samples.
struct Record {
  std::string name;                  // of the file, for messages
  double period = 0.0;               // s
  double start = 0.0;                // s, of the first sample, in the time of the file
  std::vector<double> command;       // m or rad: setpoint of the position loop
  std::vector<double> feedback;      // m or rad: position that the loop reads
  std::vector<double> scale;         // m or rad: of the slide, where the loop reads another one
  std::vector<double> force;         // N or N m: of the drive, towards +x, by its command
  std::vector<double> disturbance;   // N or N m: from outside on the slide, towards +x
  double force_per_current = 0.0;    // N/A: with which a current became the force; 0: it is one
  std::vector<SampleRange> omitted;  // samples that do not count: gaps, clipped current
  bool validation = false;           // not used for estimation
  bool is_rotary = false;

  std::size_t size() const { return feedback.size(); }
  /// Unit of deviations in reports.
  const char* micro() const { return is_rotary ? "urad" : "um"; }
  double time(std::size_t sample) const { return start + period * static_cast<double>(sample); }
};

/// Positions that a simulation of the record may take: 100 times the range of its command and
/// feedback, and 100 mm (0.1 rad). One beyond them diverges. Without a loop nothing holds the axis:
/// then 1000 km.
struct PossiblePositions {
  double centre = 0.0, limit = 0.0;
  bool contain(double position) const { return std::abs(position - centre) <= limit; }
};
PossiblePositions possible_positions(const Record& record, bool has_loop);

/// Position and speed of the first sample, from a parabola through the first ones (m, m/s or rad).
struct StartOfMotion {
  double position = 0.0, speed = 0.0;
};
/// @pre the record has a sample
StartOfMotion start_of_motion(const Record& record);

}  // namespace servomill::sim::identification
