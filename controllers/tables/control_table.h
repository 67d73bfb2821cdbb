/// Compensation tables as a control evaluates them.
///
/// The readers in this room follow the documents of the controls alone; they verify what is written
/// for a control and therefore include no header of the writer.
#pragma once

#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

/// One point of a table: displacement that the control adds to the command, by direction of travel.
struct TablePoint {
  double position = 0.0;  // m, rad; of the base axis
  double up = 0.0;        // m, rad; travelling towards larger positions
  double down = 0.0;      // m, rad; travelling towards smaller positions
  int line = 0;           // of the file
};

/// Displacement of one axis as a function of the position of another axis or its own. Linear
/// between points, constant beyond the first and the last.
struct ControlTable {
  std::string file;
  Axis base_axis = Axis::X;
  Axis compensated_axis = Axis::X;
  std::vector<TablePoint> points = {};  // at least two, in order of position
  bool is_one_turn = false;             // the control takes positions into 0 to 360 deg
  bool repeats = false;                 // positions are taken into the range of the table

  /// Displacement added to the command (m, rad).
  /// @param direction  1: towards larger positions, -1: towards smaller ones
  double at(double position, int direction) const;

  /// The point at or below a position, for messages.
  const TablePoint& point_below(double position) const;

 private:
  double within(double position) const;  // the position that the control looks up
};

/// One file of tables.
struct TableText {
  std::string name;
  std::string text;
};

}  // namespace servomill::controllers
