/// Probing moves G38.2 to G38.5: the interface to whatever a touch probe meets.
#pragma once

#include <optional>

#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

/// The four probing moves, as LinuxCNC has them.
struct ProbingMode {
  int digit = 2;  // of G38.2 ... G38.5
  /// G38.4 and G38.5 leave a surface: the probe switches when it no longer touches.
  bool leaves() const { return digit >= 4; }
  /// G38.2 and G38.4: no switching is a fault of the program; the others go on.
  bool must_switch() const { return digit % 2 == 0; }
};

/// A straight move with the probe armed. m, rad.
struct ProbingMove {
  ProbingMode mode;
  AxisWords begin = AxisWords::Zero(), end = AxisWords::Zero();                  // work coordinates
  AxisWords begin_machine = AxisWords::Zero(), end_machine = AxisWords::Zero();  // axis positions
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // of the tool offset in force
  double feed = 0.0;                               // m/s, or rad/s where only rotary axes move
  int line = 0;
};

/// Positions in work coordinates, m and rad.
struct ProbeContact {
  AxisWords latched = AxisWords::Zero();  // where the probe switched: #5061 ...
  AxisWords rest = AxisWords::Zero();     // where the axes stand afterwards
};

/// The surroundings of a probe: one object for one run of a program.
class Probed {
 public:
  virtual ~Probed() = default;
  /// Place at which the probe switches on its way; nullopt: it does not.
  /// @throws InputError, without a place, where the move cannot begin so
  virtual std::optional<ProbeContact> contact(const ProbingMove& move) = 0;
  /// Nothing is known of the surroundings: the answers only let the program go on.
  virtual bool is_assumed() const { return false; }
};

/// Takes every move to touch at its end, as LinuxCNC's stand-alone interpreter does: it then stands
/// 0.254 mm before that point (0.01 inch), whatever the length of the move.
class AssumedContact : public Probed {
 public:
  std::optional<ProbeContact> contact(const ProbingMove& move) override;
  bool is_assumed() const override { return true; }
};

}  // namespace servomill::controllers
