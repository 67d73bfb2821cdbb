#include "sim/input/implausible.h"

#include <fmt/format.h>

#include <limits>

namespace servomill::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

// A value in SI, and the range outside which it is not that of a machine tool.
struct Plausible {
  const char* key;
  double value, min, max;
  const char* unit;
  const char* meant;  // with a unit that is easily forgotten
};

std::vector<Plausible> values_of(const MachineSettings& machine, int joint) {
  const plant::FeedDriveParams& drive = machine.drives[static_cast<std::size_t>(joint)];
  const bool is_elastic = !drive.is_rigid();
  const double k = is_elastic ? drive.k : kNone;
  const NcSettings& nc = machine.nc;
  if (joint < kLinearJoints) {
    return {{"stiffness", k, 1e5, kNone, "N/m", "180 N/um"},
            {"backlash", drive.gap, 0.0, 1e-3, "m", "5 um"},
            {"load", drive.M, 0.0, 1e5, "kg", "500 kg"},
            {"v_max", nc.v_max[joint], 0.0, 100.0, "m/s", "60 m/min"},
            {"a_max", nc.a_max[joint], 0.0, 2000.0, "m/s^2", "5000 mm/s^2"},
            {"j_max", nc.j_max[joint], 0.0, 1e6, "m/s^3", "100000 mm/s^3"}};
  }
  return {{"stiffness", k, 10.0, kNone, "Nm/rad", "5 Nm/urad"},
          {"backlash", drive.gap, 0.0, 0.02, "rad", "20 urad"},
          {"v_max", nc.v_max[joint], 0.0, 1e3, "rad/s", "100 rpm"}};
}

}  // namespace

std::vector<std::string> implausible_values(const MachineSettings& machine, int joint) {
  std::vector<std::string> out;
  for (const Plausible& p : values_of(machine, joint)) {
    if (p.value >= p.min && p.value <= p.max) continue;
    out.push_back(fmt::format(
        "axis.{}.{} = {:g} {}, which no machine tool has; bare numbers are in {}, others need "
        "their "
        "unit, such as \"{}\"",
        machine.chain.layout.letter_of(joint), p.key, p.value, p.unit, p.unit, p.meant));
  }
  return out;
}

std::vector<std::string> implausible_values(const MachineSettings& machine) {
  std::vector<std::string> out;
  for (const int joint : machine.joints()) {
    for (std::string& value : implausible_values(machine, joint)) out.push_back(std::move(value));
  }
  return out;
}

}  // namespace servomill::sim
