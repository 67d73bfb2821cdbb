#include "sim/preparation/tooth_step.h"

#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"

namespace servomill::sim::preparation {

namespace {

constexpr double kStepsPerPeriod = 20.0;  // of a mode

}  // namespace

Tick tooth_step(const model::CuttingSpec& cutting, double passing_frequency, double highest_mode,
                const model::LoopPeriods& periods, model::ServoModel servo) {
  const double of_teeth = 1.0 / (passing_frequency * cutting.steps_per_tooth);
  const double of_mode = highest_mode > 0.0 ? 1.0 / (kStepsPerPeriod * highest_mode) : of_teeth;
  const double longest = std::min(of_teeth, of_mode);
  constexpr double kRounding = 1e-9;  // of a period
  const auto fits = [&](Tick period) {
    return periods.seconds(period) <= longest * (1.0 + kRounding);
  };
  const auto refuse = [&](std::string_view what, Tick period) {
    const std::string needed = fmt::format("need {} of at most {:.4g} us; it is {:.4g} us", what,
                                           longest / us, periods.seconds(period) / us);
    if (of_mode < of_teeth) {
      throw InputError(cutting.place,
                       fmt::format("{:g} steps in each period of the mode of {:.4g} Hz {}",
                                   kStepsPerPeriod, highest_mode, needed));
    }
    throw InputError(
        cutting.place,
        fmt::format("teeth pass every {:.4g} us; {} steps of force for each {} (lower the speed or "
                    "steps_per_tooth)",
                    1.0 / passing_frequency / us, cutting.steps_per_tooth, needed));
  };
  if (servo == model::ServoModel::ideal) {
    if (!fits(periods.position)) refuse("a position period", periods.position);
    return periods.position;
  }
  for (Tick parts = 1; parts <= periods.velocity; ++parts) {
    if (periods.velocity % parts == 0 && fits(periods.velocity / parts)) {
      return periods.velocity / parts;
    }
  }
  refuse("a base period", 1);
  return 0;
}

}  // namespace servomill::sim::preparation
