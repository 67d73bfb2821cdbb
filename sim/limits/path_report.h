/// Distances of a recorded motion from the path of its program.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace servomill::sim::limits {

/// Largest distances in one line of the program.
struct LineDeviation {
  int line = 0;
  double tolerance = 0.0;  // m
  double deviation = 0.0;  // m, of a sample from the path
  double time = 0.0;       // s, when; -inf: no sample is in the line
  /// rad, of a rotary axis or of the tool axis; none: not recorded
  std::optional<double> rotary = {};
  /// m, between the corner at the end of the line and the motion; none: no corner
  std::optional<double> corner = {};
  double corner_time = 0.0;   // s, when it is passed
  double corner_floor = 0.0;  // m, by which the motion may pass between two samples

  /// False: all of the line lies between two samples, and the deviation is not known.
  bool is_sampled() const;
  /// The larger of both, of the tolerance.
  double factor() const;
};

struct PathReport {
  std::string program;
  std::vector<LineDeviation> lines;  // in the order in which they are passed first
  double floor = 0.0;                // m, by which the resolution of the log may change a distance
  double passed = 0.0;               // of the length of the path, 0 to 1
  int last_line = 0;                 // that is reached
  std::size_t corners = 0;
  double time_beyond = 0.0;  // s, in which the path is left by more than its tolerance
  std::vector<std::string> notes;

  bool is_beyond(const LineDeviation& one) const;
  std::size_t lines_beyond() const;
};

/// @param top  number of lines that are listed
std::string to_text(const PathReport& report, std::size_t top);
std::string to_json(const PathReport& report, std::size_t top);

}  // namespace servomill::sim::limits
