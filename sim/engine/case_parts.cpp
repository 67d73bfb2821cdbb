#include "sim/engine/case_parts.h"

#include <fmt/format.h>

#include <cmath>

namespace servomill::sim::engine {

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

std::string why_implausible(const PositionLoopTerm& term, const Joints& velocity,
                            const model::MachineSettings& machine) {
  constexpr double kMaxFactor = 10.0;
  const JointLayout& layout = machine.chain.layout;
  for (int j = 0; j < kJoints; ++j) {
    const double most = kMaxFactor * machine.nc.v_max[j];
    if (!layout.has(j) || std::abs(velocity[j]) <= most) continue;
    if (!std::isfinite(velocity[j])) {
      return fmt::format("strategy {}: position_loop returned a value that is not finite",
                         term.strategy);
    }
    return fmt::format(
        "strategy {}: position_loop adds {:.4g} {} to axis {}, beyond {:g} times its v_max",
        term.strategy, velocity[j], j < kLinearJoints ? "m/s" : "rad/s", layout.letter_of(j),
        kMaxFactor);
  }
  return {};
}

Outcome stopped_at_begin(const std::string& why) { return {false, false, why, '-', 0.0}; }

}  // namespace servomill::sim::engine
