/// Results of the points of a sweep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/evaluation/comparison_row.h"

namespace servomill::sim::run {

struct CaseOutput;  // sim/run/run_case.h

/// How a point of a sweep ended. The numbers stand in result files.
enum class PointStatus : std::uint8_t {
  not_run = 0,  // or interrupted
  done = 1,
  stopped = 2,  // ran, but in some case the machine stopped
  refused = 3,  // the input is wrong there
  failed = 4,   // the program or the system failed there
};
inline constexpr std::size_t kPointStatuses = 5;

/// "not_run", "done", ...
std::string_view name_of(PointStatus status);

/// Result of one point.
struct BatchResult {
  PointStatus status = PointStatus::not_run;
  std::string reason;                           // why it is not `done`, in one line
  std::vector<evaluation::ComparisonRow> rows;  // of what ran: `done` or `stopped`
  // with their signals, where they are kept; else none
  std::shared_ptr<const std::vector<CaseOutput>> cases = {};
};

/// Data to keep of the cases of a batch.
enum class Keep : std::uint8_t { comparison, series };

}  // namespace servomill::sim::run
