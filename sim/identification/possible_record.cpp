#include "sim/identification/possible_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace servomill::sim::identification {
namespace {

constexpr double kOtherUnit = 30.0;  // no loop leaves that much of its command, mm and m are 1000

struct Range {
  double low, high;
  double width() const { return high - low; }
};
Range range_of(const std::vector<double>& signal) {
  const auto [low, high] = std::minmax_element(signal.begin(), signal.end());
  return {*low, *high};
}

}  // namespace

std::optional<std::string> impossible(const Record& r) {
  const Range feedback = range_of(r.feedback);
  if (feedback.width() == 0.0) {
    return fmt::format(
        "does not move: its feedback is {:g} from {:.4g} to {:.4g} s; the identification requires "
        "motion",
        feedback.low, r.time(0), r.time(r.size() - 1));
  }
  if (r.command.empty()) return std::nullopt;
  const Range command = range_of(r.command);
  if (command.width() == 0.0) return std::nullopt;
  double along = 0.0;
  std::size_t fastest = 1;
  for (std::size_t k = 1; k < r.size(); ++k) {
    const double step = r.command[k] - r.command[k - 1];
    along += step * (r.feedback[k] - r.feedback[k - 1]);
    if (std::abs(step) > std::abs(r.command[fastest] - r.command[fastest - 1])) fastest = k;
  }
  if (along < 0.0) {
    return fmt::format(
        "has a feedback that moves against the command, first at {:.4g} s: one of them has the "
        "wrong sign; set factor = -1",
        r.time(fastest));
  }
  const double ratio = feedback.width() / command.width();
  if (ratio < kOtherUnit && ratio > 1.0 / kOtherUnit) return std::nullopt;
  return fmt::format(
      "has a feedback that moves {:.3g} times as far as the command, {:.4g} against {:.4g}: one of "
      "them has the wrong unit",
      ratio, feedback.width(), command.width());
}

}  // namespace servomill::sim::identification
