// Faults of axes: the functions of ServoAxes that tell why the NC stops a machine.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "plant/vocabulary/units.h"
#include "sim/engine/servo_axes.h"

namespace servomill::sim::engine {
namespace {

std::string_view name_of(controllers::AxisFaultKind fault) {
  switch (fault) {
    case controllers::AxisFaultKind::following_error:
      return "following error";
    case controllers::AxisFaultKind::standstill:
      return "position at standstill";
    case controllers::AxisFaultKind::encoder_difference:
      break;
  }
  return "difference of scale and motor encoder";
}

std::string overspeed(std::string_view name, const plant::Encoder& encoder, double velocity) {
  constexpr double kHzPerkHz = 1e3;
  return fmt::format("signals of the {} at {:.4g} kHz, beyond the {:.4g} kHz of the input", name,
                     encoder.signal_frequency(velocity) / kHzPerkHz,
                     encoder.frequency_limit() / kHzPerkHz);
}

}  // namespace

bool ServoAxes::within_limits() const {
  if (always_checked_ || beyond_limits_) return false;
  return std::none_of(in_sub_steps_.begin(), in_sub_steps_.end(), [this](std::size_t l) {
    return plant::DriveBank::unresolved(state_, l) > 0;
  });
}

std::optional<ServoAxes::Fault> ServoAxes::supervise(std::size_t run) {
  for (const int j : joints_) {
    const std::size_t l = lane(run, j);
    if (!always_checked_lanes_[l] && at(&ServoState::beyond_limits, l) == 0.0 &&
        plant::DriveBank::unresolved(state_, l) == 0) {
      continue;
    }
    if (auto reason = fault_of(l)) return Fault{j, std::move(*reason)};
  }
  return std::nullopt;
}

std::optional<std::string> ServoAxes::fault_of(std::size_t l) {
  const model::MachineSettings& machine = machine_of(l);
  const auto j = static_cast<std::size_t>(axes_[l].joint);
  const bool linear = axes_[l].joint < kLinearJoints;
  const double unit = linear ? mm : deg;
  const std::string_view unit_name = linear ? "mm" : "deg";
  Functions& own = functions_[l];
  const auto fault = controllers::supervise(
      machine.nc.functions[j].supervision, own.supervision,
      {at(&ServoInputs::Q_cmd, l), at(&ServoInputs::dQ_ff, l), at(&ServoState::Q_fb, l),
       at(&ServoState::y_motor, l), at(&ServoState::y_scale, l)});
  if (fault) {
    return fmt::format("{} beyond {:g} {}", name_of(fault->fault), fault->limit / unit, unit_name);
  }
  if (own.mark_fault) {
    const plant::MarkFault& mark = *own.mark_fault;
    if (mark.from == mark.to) {
      return fmt::format("counted {} signal periods until the reference mark at {:.3f} {} recurred",
                         mark.counted, mark.from / unit, unit_name);
    }
    return fmt::format(
        "counted {} signal periods instead of {} between the reference marks at {:.3f} and {:.3f} "
        "{}",
        mark.counted, mark.expected, mark.from / unit, mark.to / unit, unit_name);
  }
  if (plant::DriveBank::unresolved(state_, l) > 0) {
    return "friction too stiff for the exact integrator; use integrator = \"cvode\"";
  }
  const plant::DriveBlock& state = state_.blocks[block(l)];
  const double v = state.v[place(l)];
  const double w = params_[l].is_rigid() ? v / params_[l].r : state.w[place(l)];
  if (machine.scale[j].too_fast(v)) return overspeed("scale", machine.scale[j], v);
  if (machine.motor[j].too_fast(w)) return overspeed("motor encoder", machine.motor[j], w);
  return std::nullopt;
}

}  // namespace servomill::sim::engine
