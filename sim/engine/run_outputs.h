/// Outputs of a run that will be read.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace servomill::sim::engine {

/// Outputs that the caller of a run reads, beside how it ends: all, unless it says so. Each has the
/// same bits whichever others there are.
struct RunOutputs {
  using Names = std::set<std::string, std::less<>>;

  /// Recorded signals, beside time, s, line, section and rapid; none: every one.
  std::optional<Names> signals = {};
  bool demands = true;     // of the axes
  bool last_ticks = true;  // of a run that stops
  /// Rows are made in a thread beside the run; false where every core runs cases of its own.
  bool makes_rows_beside = true;

  bool wants(std::string_view signal) const { return !signals || signals->contains(signal); }
};

}  // namespace servomill::sim::engine
