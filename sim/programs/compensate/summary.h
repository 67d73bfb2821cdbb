/// Summary of a compensated program.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/programs/compensate/servo_prediction.h"
#include "strategies/residual.h"

namespace servomill::sim::programs {

struct Summary {
  struct At {
    int line = 0;
    AxisWords machine = AxisWords::Zero();     // programmed (6; m, rad)
    AxisWords correction = AxisWords::Zero();  // 6; m, rad
  };

  std::size_t blocks_before = 0, blocks_after = 0;  // of motion, as executed
  std::size_t points_added = 0;
  std::size_t arcs_before = 0, arcs_kept = 0, arcs_split = 0, arcs_to_lines = 0;
  At largest;                                   // of all block ends, by the length of X Y Z
  double largest_turn = 0.0;                    // rad
  double length = 0.0, corrected_length = 0.0;  // m, of feed motion
  double time = 0.0, corrected_time = 0.0;      // s, of it at the programmed feed
  std::optional<At> outside;                    // the first end outside the travel, and how many
  std::size_t outside_count = 0;
  std::optional<At> most_left;  // the place where correcting leaves most
  strategies::Residual left;
  std::size_t reversals = 0;    // of axes at feed, whose errors depend on the direction of travel
  double reversal_width = 0.0;  // m, largest change of the tip at one
  double reversal_distance = 0.0;        // m, travel that one takes at most
  std::optional<At> undirected;          // first feed with an axis that has not travelled yet
  double undirected_width = 0.0;         // m, by which the tip may be off there
  std::optional<ServoPrediction> servo;  // of the model; none: errors alone are corrected
  std::string smoothing;                 // what the control's leaves; empty: not set
  bool unrolled = false;                 // loops, subroutines
  bool has_expressions = false;          // became numbers
  bool has_cycles = false, has_cutter_compensation = false;
  std::map<int, double> tools;       // m, length of each tool that worked
  std::vector<std::string> assumed;  // one sentence each

  /// Lines of the report.
  std::vector<std::string> report(const JointLayout& layout) const;
  /// The same as one JSON object.
  /// @param uncertainty  of the corrected points, as JSON
  std::string json(const JointLayout& layout, std::string_view uncertainty = "null") const;
};

}  // namespace servomill::sim::programs
