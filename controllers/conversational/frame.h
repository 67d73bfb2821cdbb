/// Coordinate frame of the program relative to the preset: cycles 7, 8, 10 and 11. Lengths
/// in mm, angles in degrees.
#pragma once

#include <array>
#include <string>

#include "controllers/translation/gcode_lines.h"

namespace servomill::controllers::conversational {

using translation::Point;

/// work = shift + rotation * mirror * scale * program; rotary axes are shifted and mirrored only.
struct Frame {
  std::array<double, kAxisWords> shift{};      // cycle 7, TRANS DATUM
  std::array<bool, kAxisWords> is_mirrored{};  // cycle 8
  double rotation = 0.0;                       // cycle 10, about Z
  double scale = 1.0;                          // cycle 11
  bool operator==(const Frame&) const = default;

  bool is_plain() const { return *this == Frame{}; }
  bool is_mirrored_in_plane() const { return is_mirrored[0] != is_mirrored[1]; }
  bool is_any_mirrored() const;
  /// X and Y of the preset both depend on X and Y of the program.
  bool couples_plane() const { return rotation != 0.0; }

  Point to_work(const Point& program) const;
  Point to_program(const Point& work) const;
  /// One axis, where its position does not depend on a second one.
  double to_work(std::size_t axis, double program) const;
  double to_program(std::size_t axis, double work) const;
  /// An increment of one axis.
  double increment(std::size_t axis, double program) const;

  /// Reason why the result depends on the order in which the cycles were programmed; empty if it
  /// does not.
  std::string ambiguity() const;
};

}  // namespace servomill::controllers::conversational
