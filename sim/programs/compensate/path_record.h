/// The path of a compensated program and its correction, for figures.
#pragma once

#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::sim::programs {

class Correction;
struct Step;

/// One row a place: ends of blocks, and places between them no farther apart than 1 mm.
class PathRecord {
 public:
  void add(const Step& step, const Correction& correction);

  /// Writes /compensate of a result file of kind "compensate".
  /// @throws InputError if the file exists and `force` is not set, SystemError
  void write(const std::string& path, bool force, const std::string& title,
             const std::string& machine) const;

 private:
  void add_place(const Step& step, double t, const AxisWords& corrected, bool is_end);

  double way_ = 0.0;  // m
  std::vector<double> s_, line_, block_end_, rapid_;
  std::vector<double> position_[3], correction_[3];
};

}  // namespace servomill::sim::programs
