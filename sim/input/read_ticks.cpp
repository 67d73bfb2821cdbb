#include "sim/input/read_ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "plant/vocabulary/units.h"

namespace servomill::sim::input {
namespace {

constexpr double kLongestPeriod = 60.0;  // s

double unit_of(std::string_view key) { return key.ends_with("_us") ? us : ms; }

}  // namespace

Tick read_ticks(config::Reader& table, std::string_view key, double fallback, double base_period,
                Tick least) {
  const Tick harmless = std::max<Tick>(least, 1);
  const std::size_t before = table.faults();
  const double seconds =
      least > 0 ? table.real_or(key, fallback, config::kTime,
                                {config::above(0.0), config::at_most(kLongestPeriod)})
                : table.real_or(key, fallback, config::kTime,
                                {config::at_least(0.0), config::at_most(kLongestPeriod)});
  if (table.faults() > before) return harmless;
  const auto whole = whole_ticks(seconds, base_period);
  if (whole && *whole >= least) return *whole;
  const std::string rule = fmt::format(
      "must be an integer multiple of base_period_us = {:g} of the machine", base_period / us);
  if (table.has(key)) {
    table.fault(key, rule);
  } else {
    table.fault(
        fmt::format("{} is not set, and its default {:g} {}", key, fallback / unit_of(key), rule));
  }
  return harmless;
}

}  // namespace servomill::sim::input
