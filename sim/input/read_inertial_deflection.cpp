#include "sim/input/read_inertial_deflection.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <optional>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"

namespace servomill::sim::input {
namespace {

constexpr std::string_view kTable = "inertial_deflection";

// Displacement per acceleration of a linear and of a rotary axis, and their change over a position.
constexpr config::Quantity kPerLinear{.s = 2}, kPerRotary{.m = 1, .s = 2, .rad = -1};
constexpr config::Quantity kSlopeLinear{.m = -1, .s = 2}, kSlopeRotary{.s = 2, .rad = -1};

// The structure is coupled to the drives where the loops are due: a mode needs so many of these
// steps in each of its periods.
constexpr double kStepsPerPeriod = 20.0;

double shortest_step(const model::LoopPeriods& p) {
  return p.seconds(std::min({p.position, p.velocity, p.current}));
}

std::optional<int> joint_of(const JointLayout& layout, char letter) {
  for (int j = 0; j < kJoints; ++j) {
    if (layout.has(j) && layout.letter_of(j) == letter) return j;
  }
  return std::nullopt;
}

// Axes that this machine has, "X, Y, Z".
std::string letters_of(const JointLayout& layout, int joints) {
  std::string out;
  for (int j = 0; j < joints; ++j) {
    if (layout.has(j)) out += fmt::format("{}{}", out.empty() ? "" : ", ", layout.letter_of(j));
  }
  return out;
}

// Direction and joint of a pair; the rule that its name breaks is noted.
bool read_directions(config::Reader& pairs, const std::string& name, const JointLayout& layout,
                     plant::InertialCompliance& pair) {
  const auto direction = name.size() == 2 ? joint_of(layout, name[0]) : std::nullopt;
  const auto joint = name.size() == 2 ? joint_of(layout, name[1]) : std::nullopt;
  if (direction && *direction < kLinearJoints && joint) {
    pair.direction = *direction;
    pair.joint = *joint;
    return true;
  }
  pairs.raw(name);
  pairs.fault(name, fmt::format("must be named after a direction ({}) and the axis that "
                                "accelerates ({}), such as YX",
                                letters_of(layout, kLinearJoints), letters_of(layout, kJoints)));
  return false;
}

void read_slope(config::Reader& table, const JointLayout& layout, bool linear,
                plant::InertialCompliance& pair) {
  const std::string_view key = linear ? "slope_um_per_m_s2_per_m" : "slope_um_per_rad_s2_per_m";
  const bool has_slope = table.has(key);
  if (!table.has("along")) {
    if (!has_slope) return;
    table.real(key, linear ? kSlopeLinear : kSlopeRotary);
    table.fault(key, "needs along, the linear axis on whose position it depends");
    return;
  }
  const std::string along = table.text("along");
  pair.gain_slope = table.real(key, linear ? kSlopeLinear : kSlopeRotary);
  const auto joint = along.size() == 1 ? joint_of(layout, along[0]) : std::nullopt;
  if (joint && *joint < kLinearJoints) {
    pair.along = *joint;
  } else if (!along.empty()) {
    table.fault("along", fmt::format("must be a linear axis of the machine: {}",
                                     letters_of(layout, kLinearJoints)));
  }
}

}  // namespace

void read_mode(config::Reader& table, double step, std::string_view name, plant::Mode& mode) {
  const bool has_damping = table.has("damping");
  if (!table.has("frequency_Hz")) {
    if (!has_damping) return;
    table.real("damping", config::kNumber);
    table.fault("damping", "needs frequency_Hz: without it the deflection is static");
    return;
  }
  const std::size_t before = table.faults();
  const double f = table.real("frequency_Hz", config::kRate, {config::above(0.0)});
  const double zeta =
      table.real("damping", config::kNumber, {config::above(0.0), config::below(1.0)});
  if (table.faults() > before) return;
  const double most = 1.0 / (kStepsPerPeriod * step);
  if (step > 0.0 && f > most) {
    table.fault("frequency_Hz",
                fmt::format("must be <= {:g} Hz: {:g} of the {} of {:g} us in each period of the "
                            "mode; without frequency_Hz it is static",
                            most, kStepsPerPeriod, name, step / us));
  }
  mode = {2.0 * std::numbers::pi * f, zeta};
}

std::vector<plant::InertialCompliance> read_inertial_deflection(
    config::Reader& machine_table, const model::MachineSettings& machine) {
  std::vector<plant::InertialCompliance> out;
  if (!machine_table.has(kTable)) return out;
  config::Reader pairs = machine_table.table(kTable);
  for (const std::string& name : pairs.keys()) {
    plant::InertialCompliance pair;
    if (!pairs.has(name) || !read_directions(pairs, name, machine.chain.layout, pair)) continue;
    const bool linear = pair.joint < kLinearJoints;
    config::Reader table = pairs.table(name);
    pair.gain = linear ? table.real("gain_um_per_m_s2", kPerLinear)
                       : table.real("gain_um_per_rad_s2", kPerRotary);
    read_slope(table, machine.chain.layout, linear, pair);
    read_mode(table, shortest_step(machine.nc.periods), "shortest loop period", pair.mode);
    out.push_back(pair);
  }
  return out;
}

}  // namespace servomill::sim::input
