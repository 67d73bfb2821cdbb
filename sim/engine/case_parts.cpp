#include "sim/engine/case_parts.h"

#include <fmt/format.h>

namespace servomill::sim {

double model_period_of(const CaseInputs& in) {
  return in.machine.nc.periods.seconds(in.hardware.model_period);
}

Outcome interrupted(double time) {
  return {false, true, fmt::format("interrupted at {:.4f} s", time), '-', time};
}

Outcome failed(std::string_view why, double time, int line) {
  return {false, false, fmt::format("{} at {:.4f} s, line {} of the program", why, time, line), '-',
          time};
}

Outcome stopped_at_begin(const std::string& why) { return {false, false, why, '-', 0.0}; }

}  // namespace servomill::sim
