/// Numbers of corrected blocks, as the modes of a line have them.
#pragma once

#include "plant/vocabulary/axes.h"
#include "sim/programs/compensate/corrected_path.h"
#include "sim/programs/compensate/edited_line.h"

namespace servomill::sim::programs {

inline constexpr double kHalf = 0.5 + 1e-6;  // of a grid step

/// mm or inch in metres, or a degree in rad.
/// @param axis  0 ... 5, X to C
double unit_of(int axis, double unit);

/// Prints numbers of a block in the modes of its line and keeps account of where that leads.
class MotionPrinter {
 public:
  /// @param line  that the words go into; nullptr: a line of their own
  MotionPrinter(const EditedLine& modes, const EditedLine* line, int decimals)
      : modes_(modes), line_(line), decimals_(decimals) {}

  MotionWords print(const FittedBlock& block, bool is_rapid, const AxisWords& at);
  /// Adds F, unless the line has it already.
  void feed(MotionWords& words, double F) const;
  /// End of the move as the printed numbers give it.
  const AxisWords& end() const { return end_; }

 private:
  bool is_named(char letter) const;
  bool is_constant(char letter) const {
    return is_named(letter) && line_->is_constant_word(letter);
  }
  bool keeps(char letter, double value, double half) const;
  int decimals(int axis) const;
  double number(char letter, double value, int digits);  // @return as printed
  void axis(int i, double target, double at);
  void centre(const FittedBlock& block, const AxisWords& at);

  const EditedLine& modes_;
  const EditedLine* line_;
  int decimals_;
  MotionWords words_;
  AxisWords end_;
};

}  // namespace servomill::sim::programs
