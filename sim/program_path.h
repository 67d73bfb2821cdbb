/// The programmed path: what every case of a scenario is compared along.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"
#include "plant/vocabulary/move_curve.h"

namespace servomill::sim {

/// The motion of the original program in machine coordinates, by arc length s (m).
class ProgramPath {
 public:
  /// @param moves  canonical moves with s_begin, s_end
  /// @param start  where the machine stands before the first (6; m, rad)
  ProgramPath(std::span<const Move> moves, const AxisWords& start);

  struct Piece {
    MoveCurve curve;
    AxisWords end = AxisWords::Zero();
    double s_begin = 0.0, s_end = 0.0;  // m
    int line = 0;
    int tool_offset = 0;
    bool rapid = false;
    int section = 0;  // index into sections()
  };

  /// Index of the piece that holds s; `near` is where to look first (the piece found last).
  std::size_t piece_at(double s, std::size_t near) const;

  const Piece& piece(std::size_t index) const { return pieces_[index]; }
  std::size_t size() const { return pieces_.size(); }

  /// Programmed position at arc length s within that piece (6; m, rad).
  AxisWords at(std::size_t index, double s) const;

  double length() const { return pieces_.empty() ? 0.0 : pieces_.back().s_end; }

  /// Distance (m) of the point p (3; m, machine coordinates) to the path near the given piece.
  double distance(const Eigen::Vector3d& p, std::size_t index) const;

  /// Names of the program's sections: a comment (MSG, name) begins one; the first is "".
  const std::vector<std::string>& sections() const { return sections_; }

 private:
  std::vector<Piece> pieces_;
  std::vector<std::string> sections_ = {""};
};

}  // namespace servomill::sim
