/// Windows of a recording, along the pieces of a programmed path.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sim/model/run_settings.h"

namespace servomill::sim::engine {

class ProgramPath;

/// Tells which rows lie in the windows. A bit for each piece, whatever the duration.
class RecordingWindows {
 public:
  /// One window of all rows.
  RecordingWindows() = default;
  RecordingWindows(const model::RecordWindows& windows, const ProgramPath& path);

  /// False if it contains all rows.
  bool limited() const { return limited_; }
  /// @param piece  of the path
  /// @param time   s, since the start
  bool contains(std::size_t piece, double time) const;

 private:
  bool limited_ = false;
  std::vector<bool> pieces_;
  std::vector<std::array<double, 2>> times_;  // s
};

}  // namespace servomill::sim::engine
