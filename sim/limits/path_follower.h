/// Follows a recorded motion along the path of its program.
#pragma once

#include <cstddef>
#include <deque>

#include "plant/vocabulary/axes.h"
#include "sim/limits/logged_path.h"
#include "sim/limits/programmed_path.h"

namespace servomill::sim::limits {

/// The place of the path that belongs to a sample, and how far the sample is from it.
struct PathPlace {
  std::size_t piece = 0;
  double s = 0.0;       // m, along the path
  double linear = 0.0;  // m, distance of X Y Z, of the tip where the program controls it
  double rotary = 0.0;  // rad, largest difference of a rotary axis; of the tool axis where the
                        // program turns that on a great circle
  bool knows_rotary = false;
};

/// Takes the samples in their order and never goes back: of the places ahead it takes the nearest,
/// and looks no farther ahead than
///
///     3 |step of the sample| + 4 (distance of the sample before) + 0.1 mm                     (1)
///
/// so that a path which crosses itself or returns is followed in its order, and a corner that is
/// cut is passed. Rotary axes count with a radius of 100 mm.
class PathFollower {
 public:
  /// Both must outlive this.
  /// @throws InputError where the program controls the tip and a rotary axis is not recorded
  PathFollower(const ProgrammedPath& program, const LoggedPath& log);

  /// @param sample  not before the one of the last call
  PathPlace at(std::size_t sample);

  /// A sample in the coordinates of a piece (6; m, rad).
  AxisWords in_coordinates_of(const engine::ProgramPath::Piece& piece, std::size_t sample) const;

 private:
  struct Candidate {
    double share = 0.0, cost = 0.0;  // of the piece; m^2
  };

  const engine::ProgramPath::Piece& piece(std::size_t index);
  double length_of(const engine::ProgramPath::Piece& piece) const;
  double rotary_radius_of(const engine::ProgramPath::Piece& piece) const;
  AxisWords weighted(const engine::ProgramPath::Piece& piece, AxisWords d) const;
  Candidate nearest(const engine::ProgramPath::Piece& piece, const AxisWords& p, double low,
                    double high) const;
  double cost(const engine::ProgramPath::Piece& piece, const AxisWords& p, double share) const;
  double reach(std::size_t sample);
  PathPlace place(std::size_t sample);

  const ProgrammedPath& program_;
  const LoggedPath& log_;
  std::deque<engine::ProgramPath::Piece> ahead_;  // pieces from index_ on, as far as looked at
  std::size_t index_ = 0;
  double share_ = 0.0;      // of that piece
  double distance_ = 0.0;   // m, of the sample before
  std::size_t sample_ = 0;  // of the last call
};

}  // namespace servomill::sim::limits
