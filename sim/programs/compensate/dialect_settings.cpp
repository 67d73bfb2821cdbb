#include "sim/programs/compensate/dialect_settings.h"

#include <fmt/format.h>

#include <cmath>

#include "controllers/gcode/modal_state.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/compensate/work_knowledge.h"

namespace servomill::sim::programs {

std::optional<double> retract_of(const CompensateRequest& request,
                                 const input::MachineDescription& described) {
  return request.retract_Z ? request.retract_Z : described.retract_Z;
}

double resolution_of(const CompensateRequest& request) {
  if (request.resolution > 0.0) return request.resolution;
  return request.dialect == Dialect::siemens ? 10e-9 : 1e-6;
}

std::array<bool, 3> endless_axes(const input::MachineDescription& described) {
  const JointLayout& layout = described.machine->chain.layout;
  std::array<bool, 3> out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::optional<int> j = layout.joint_of(kAllAxes[kLinearJoints + i]);
    out[i] = j && described.machine->nc.is_endless(*j);
  }
  return out;
}

DialectSettings dialect_settings(const CompensateRequest& request,
                                 const input::MachineDescription& described,
                                 const controllers::ProgramSetup& setup) {
  if (request.corrects_rapids) {
    throw InputError({"--correct-rapids"},
                     "is for LinuxCNC; on other controls a rapid need not follow a line");
  }
  DialectSettings settings;
  settings.dialect = request.dialect;
  settings.name = request.program_name;
  settings.program_number = request.program_number;
  settings.resolution = resolution_of(request);
  settings.preset = request.preset;
  settings.without = request.without;
  if (!request.without.empty() && request.dialect != Dialect::fanuc) {
    throw InputError({"--without"}, "names functions of Fanuc controls; it is for --dialect fanuc");
  }
  for (int system = 1; system <= controllers::kWorkSystems; ++system) {
    settings.work_offset[static_cast<std::size_t>(system - 1)] = place_of(setup, system).offset;
  }
  settings.smoothing = request.smoothing;
  const std::optional<double> retract = retract_of(request, described);
  if (!retract) {
    throw InputError(
        {"--retract"},
        "is missing: programs for other controls retract before and after; set --retract Z=... in "
        "machine coordinates, or axis.Z.retract_mm in the machine file");
  }
  const model::NcSettings& nc = described.machine->nc;
  if (*retract < nc.lower[2] || *retract > nc.upper[2]) {
    throw InputError({fmt::format("--retract Z={:g}", *retract / mm)},
                     fmt::format("is outside the travel of Z, {:g} ... {:g} mm", nc.lower[2] / mm,
                                 nc.upper[2] / mm));
  }
  settings.retract_Z = *retract;
  if (request.dialect == Dialect::fanuc && request.program_number == 0) {
    throw InputError(
        {"--program-number"},
        "is missing: Fanuc programs need a number, 1 ... 9999, and the file name has none");
  }
  const JointLayout& layout = described.machine->chain.layout;
  settings.axes.clear();
  for (const Axis axis : kAllAxes) {
    if (layout.joint_of(axis)) settings.axes.push_back(axis);
  }
  settings.has_rotary_axes = layout.has(kLinearJoints) || layout.has(kLinearJoints + 1);
  settings.is_endless = endless_axes(described);
  return settings;
}

}  // namespace servomill::sim::programs
