#include "sim/run/demanded_motion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "sim/engine/setpoint.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"

namespace servomill::sim::run {
namespace {

constexpr std::array<const char*, engine::AxisDemands::kOrders> kNames = {"velocity",
                                                                          "acceleration", "jerk"};
constexpr std::array<const char*, engine::AxisDemands::kOrders> kPer = {"/s", "/s2", "/s3"};

// Share of a limit from which an excess is reported: geometric errors change the speed of an axis
// at its limit by parts per thousand.
constexpr double kReported = 0.01;

std::string excess_of(const evaluation::AxisDemand& axis, std::size_t order) {
  const evaluation::DemandedValue& value = axis.motion[order];
  const double excess = 100.0 * (value.share() - 1.0);
  return fmt::format("{} of {} by {:.{}f} % of {:g} {}{} (line {}, {:.4g} s)", kNames[order],
                     axis.axis, excess, excess < 10.0 ? 1 : 0, value.limit,
                     axis.is_linear ? "m" : "rad", kPer[order], value.line, value.time);
}

}  // namespace

std::vector<evaluation::AxisDemand> demands_of(const preparation::PreparedParts& one,
                                               const engine::AxisDemands& demands) {
  const model::MachineSettings& machine = one.scenario.machine_of(one.spec);
  const controllers::Trajectory& path = one.motion.trajectory;
  const double delay = engine::Setpoint(machine.nc, path, {}).delay();
  const std::array<const Joints*, engine::AxisDemands::kOrders> limits = {
      &machine.nc.v_max, &machine.nc.a_max, &machine.nc.j_max};
  std::vector<evaluation::AxisDemand> out;
  for (const int j : machine.joints()) {
    const auto joint = static_cast<std::size_t>(j);
    evaluation::AxisDemand axis{
        machine.chain.layout.letter_of(j), j < kLinearJoints, demands.offset[joint].size, {}};
    for (std::size_t order = 0; order < limits.size(); ++order) {
      const engine::Peak& peak = demands.motion[order][joint];
      controllers::Trajectory::Cursor cursor{};
      const int line = path.at(std::max(0.0, peak.time - delay), cursor).line;
      axis.motion[order] = {peak.size, (*limits[order])[j], peak.time, line};
    }
    out.push_back(axis);
  }
  return out;
}

std::optional<std::string> note_of_demands(const preparation::PreparedParts& one,
                                           const std::vector<evaluation::AxisDemand>& demands) {
  std::vector<std::string> beyond;
  bool is_offset = false;
  for (const evaluation::AxisDemand& axis : demands) {
    is_offset |= axis.offset > 0.0;
    for (std::size_t order = 0; order < axis.motion.size(); ++order) {
      if (axis.motion[order].share() - 1.0 <= kReported) continue;
      beyond.push_back(excess_of(axis, order));
    }
  }
  if (beyond.empty()) return std::nullopt;
  return fmt::format(
      "{}: warning: case {}: {} limits: {}", one.scenario.program.file, one.spec.name,
      is_offset ? "path and offset together exceed" : "the path exceeds", fmt::join(beyond, ", "));
}

}  // namespace servomill::sim::run
