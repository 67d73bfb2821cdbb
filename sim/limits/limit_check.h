/// Check of a recorded motion against the limits of a machine.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/limits/log_signals.h"
#include "sim/limits/path_report.h"
#include "sim/limits/program_request.h"
#include "sim/model/forward.h"

namespace servomill::sim::limits {

/// Velocity, acceleration, jerk: the derivative of the position by its order.
inline constexpr std::array<std::string_view, 4> kLimited = {"", "velocity", "acceleration",
                                                             "jerk"};

/// A time in which a limit is exceeded, from window to window.
struct Excess {
  double from = 0.0, to = 0.0;  // s, middle of the first and last window
  double factor = 0.0;          // largest mean over the limit
  int line = 0;                 // of the program there; 0: not recorded
};

/// One limit of one axis.
struct LimitResult {
  int joint = 0;
  int order = 1;                 // 1 velocity, 2 acceleration, 3 jerk
  std::string channel;           // from which it is known
  double limit = 0.0;            // SI
  double window = 0.0;           // s, over which means are taken
  std::size_t windows = 0;       // over which means were taken; 0: not evaluated
  double floor = 0.0;            // SI, by which the resolution of the log may change them, largest
  double largest = 0.0;          // SI, largest mean
  double time = 0.0;             // s, where it is
  int line = 0;                  // there; 0: not recorded
  std::vector<Excess> excesses;  // certain ones: by more than the floor; the largest first
  double time_beyond = 0.0;      // s, all of them together
  bool is_resolved = true;       // the floor is below the limit
  double factor() const { return largest / limit; }
  bool is_evaluated() const { return windows > 0; }
};

struct LimitReport {
  std::string log, machine;
  JointLayout layout;
  double duration = 0.0;  // s
  double period = 0.0;    // s, median
  std::size_t samples = 0;
  std::vector<LimitResult> results;
  std::vector<std::string> notes;
  std::optional<PathReport> path = {};  // if there is a program to compare with
  bool is_exceeded() const;             ///< a limit or a tolerance, with certainty
  /// None where nothing is exceeded but a limit is not evaluated or not resolved.
  std::optional<bool> is_within() const;
  bool lacks_evaluation() const;  ///< of a limit: no window fits into the log
};

struct LimitRequest {
  LogRequest log;
  std::optional<double> window = {};      // s; none: as short as the resolution of the log allows
  std::optional<double> resolution = {};  // of positions, m or rad; none: that of the samples
  std::optional<ProgramRequest> program = {};
};

/// A machine file may lack limits: those are not checked, and noted.
/// @throws InputError
LimitReport check_limits(const recordings::Recording& recording,
                         const model::MachineSettings& machine, const LimitRequest& request);

/// @param top  number of excesses that are listed for each limit
std::string to_text(const LimitReport& report, std::size_t top);
std::string to_json(const LimitReport& report, std::size_t top);

}  // namespace servomill::sim::limits
