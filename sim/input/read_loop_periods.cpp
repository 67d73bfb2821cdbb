#include "sim/input/read_loop_periods.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

#include "plant/vocabulary/ticks.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"

namespace servomill::sim::input {
namespace {

constexpr std::array<std::string_view, 2> kPresets = {"CC422", "CC424"};
constexpr std::array<std::string_view, 3> kFilters = {"none", "mean", "triangle"};

struct Preset {
  double position, velocity, current;  // s
};
// CC 424: Service Manual iTNC 530 (2010), p. 648, and estimates for what it does not give
constexpr std::array<Preset, 2> kPresetPeriods = {
    {{1.8e-3, 0.6e-3, 0.1e-3}, {0.2e-3, 0.2e-3, 0.1e-3}}};

constexpr double kMinBase =
    0.1 * us;  // a long run of shorter ones would overflow the count of ticks

Tick period(config::Reader& nc, std::string_view key, double fallback, double base) {
  const std::size_t before = nc.faults();
  const double seconds = nc.real_or(key, fallback, config::kTime,
                                    {config::above(0.0), config::at_most(kLongestPeriod)});
  if (nc.faults() > before) return 1;
  const auto ticks = whole_ticks(seconds, base);
  if (ticks && *ticks > 0) return *ticks;
  if (nc.has(key)) {
    nc.fault(key, fmt::format("must be an integer multiple of base_period_us = {:g}", base / us));
  } else {
    nc.fault("base_period_us",
             fmt::format("must divide the preset's {} of {:g} us", key, seconds / us));
  }
  return 1;
}

}  // namespace

model::LoopPeriods read_periods(config::Reader& nc) {
  model::LoopPeriods periods;
  const std::size_t before = nc.faults();
  periods.base = nc.real_or("base_period_us", 10 * us, config::kTime, {config::at_least(kMinBase)});
  const Preset& preset = kPresetPeriods[nc.choice_or("preset", 1, kPresets)];
  if (nc.faults() > before) return {};
  periods.position = period(nc, "position_period_us", preset.position, periods.base);
  periods.velocity = period(nc, "velocity_period_us", preset.velocity, periods.base);
  periods.current = period(nc, "current_period_us", preset.current, periods.base);
  if (!model::can_be_scheduled({periods.position, periods.velocity, periods.current})) {
    nc.fault(
        "the common period of position, velocity and current loop is too long; make the periods "
        "multiples of each other");
    return {};
  }
  return periods;
}

model::NominalFilter read_filter(config::Reader& nc, const model::LoopPeriods& periods) {
  model::NominalFilter filter;
  const std::size_t kind = nc.choice_or("nominal_filter", 0, kFilters);
  const double length = nc.real_or("nominal_filter_ms", 0.0, config::kTime,
                                   {config::at_least(0.0), config::at_most(10.0)});
  if (kind == 0) return filter;
  filter.triangle = kind == 2;
  filter.length = static_cast<Tick>(std::lround(length / periods.seconds(periods.position)));
  if (filter.length < 1)
    nc.fault("nominal_filter", "needs nominal_filter_ms of at least one position period");
  if (filter.triangle && filter.length % 2 != 0) {
    nc.fault("nominal_filter_ms", "must be an even number of position periods for the triangle");
  }
  return filter;
}

}  // namespace servomill::sim::input
