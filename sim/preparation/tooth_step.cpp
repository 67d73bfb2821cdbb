#include "sim/preparation/tooth_step.h"

#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::preparation {

Tick tooth_step(const model::CuttingSpec& cutting, double passing_frequency,
                const model::LoopPeriods& periods, model::ServoModel servo) {
  const double longest = 1.0 / (passing_frequency * cutting.steps_per_tooth);
  constexpr double kRounding = 1e-9;  // of a period
  const auto fits = [&](Tick period) {
    return periods.seconds(period) <= longest * (1.0 + kRounding);
  };
  const auto refuse = [&](std::string_view what, Tick period) {
    throw InputError(
        cutting.place,
        fmt::format("teeth pass every {:.4g} us; {} steps of force for each need {} of at most "
                    "{:.4g} us; it is {:.4g} us (lower the speed or steps_per_tooth)",
                    1.0 / passing_frequency / us, cutting.steps_per_tooth, what, longest / us,
                    periods.seconds(period) / us));
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
