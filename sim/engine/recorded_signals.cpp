#include "sim/engine/recorded_signals.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "plant/drives/feed_drive.h"
#include "plant/vocabulary/units.h"
#include "sim/model/heat.h"
#include "sim/model/machine.h"

namespace servomill::sim::engine {
namespace {

using records::Signal;

constexpr const char* kLinear = "axis_linear";
constexpr const char* kRotary = "axis_rotary";
constexpr const char* kXyz = "xyz";
constexpr const char* kIjk = "ijk";

// Letters of the joints from one to before another that the machine has.
std::string letters(const model::MachineSettings& machine, int from, int to) {
  std::string out;
  for (int joint = from; joint < to; ++joint) {
    if (machine.chain.layout.has(joint)) out += machine.chain.layout.letter_of(joint);
  }
  return out;
}

// Signals of the axes and their loops, one for the linear and one for the rotary ones.
struct AxisSignal {
  const char *name, *unit_linear, *unit_rotary, *about;
};
constexpr AxisSignal kAxisSignals[] = {
    {"ref", "mm", "deg", "interpolated position"},
    {"cmd", "mm", "deg", "setpoint after corrections"},
    {"fb", "mm", "deg", "position feedback, virtual displacement included"},
    {"meas", "mm", "deg", "reading of the scale"},
    {"true", "mm", "deg", "position of the slide or table"},
    {"following_error", "um", "deg", "setpoint minus position feedback"},
    {"velocity", "mm/s", "deg/s", "velocity of the slide or table"},
    {"current", "A", "A", "torque-forming current"},
    {"torque", "N m", "N m", "motor torque"},
};

const Signal kToolSignals[] = {
    {"tool_position_nominal", "mm",
     "tool centre point of the ideal machine on the programmed path, in the workpiece", "XYZ",
     kXyz},
    {"tool_position_true", "mm", "tool centre point, in the workpiece", "XYZ", kXyz},
    {"tool_deviation", "um", "true minus nominal tool centre point at equal s", "XYZ", kXyz},
    {"tool_axis_nominal", "1", "unit tool axis of the ideal machine", "IJK", kIjk},
    {"tool_axis_true", "1", "unit tool axis, in the workpiece", "IJK", kIjk},
    {"contour_error", "um", "distance of the true tool centre point to the nominal path", "", ""},
};

// A resolution of one metre in the unit of a signal; 0: the signal is never rounded.
double per_metre(const Signal& signal) {
  const std::string& unit = signal.units;
  constexpr double kArm = 1.0;  // m
  constexpr double kTime = 10 * ms;
  constexpr double kStrength = 0.1 / (1 * um);   // A/m and N
  constexpr double kStiffness = 1.0 / (1 * um);  // N/m
  if (unit == "mm") return 1.0 / mm;
  if (unit == "um") return 1.0 / um;
  if (unit == "deg") return 1.0 / (kArm * deg);
  if (unit == "mm/s") return 1.0 / (mm * kTime);
  if (unit == "deg/s") return 1.0 / (kArm * deg * kTime);
  if (unit == "A" || unit == "N m") return kStrength;
  if (unit == "N") return kStiffness;
  return signal.scale == kIjk ? 1.0 / kArm : 0.0;
}

Signal whole_numbers(const char* name, const char* about) {
  return {.name = name,
          .units = "1",
          .long_name = about,
          .labels = "",
          .scale = "",
          .storage = records::Storage::int32};
}

// Signals of the cut: those of single teeth have an angle.
void add_cut(bool teeth, const std::string& linear, std::vector<Signal>& all) {
  all.push_back({"cutting_force", "N",
                 teeth ? "force of the workpiece on the teeth of the cutter, mean over the tooth "
                         "step that starts here, in the workpiece"
                       : "mean force of the workpiece on the cutter, in the workpiece",
                 "XYZ", kXyz});
  all.push_back({"structural_deflection", "um",
                 "deflection of the structure downstream of the scales by cutting forces, part "
                 "of tool_position_true",
                 linear, kLinear});
  if (teeth) {
    all.push_back(
        {"spindle_angle", "deg",
         "angle of tooth 0 of the cutter since the start, clockwise seen from the spindle, "
         "from the workpiece's Y",
         "", ""});
  }
}

// Deflections by acceleration, and temperatures.
void add_states(const model::MachineSettings& machine, const std::string& linear,
                std::vector<Signal>& all) {
  if (!machine.inertial_compliances.empty()) {
    all.push_back({"inertial_deflection", "um",
                   "deflection of the structure downstream of the scales by acceleration of the "
                   "axes, part of tool_position_true",
                   linear, kLinear});
  }
  if (stands_on_bed(machine)) {
    all.push_back({"bed_displacement", "um",
                   "displacement of the machine bed under the reaction of the drives, which all "
                   "scales see",
                   linear, kLinear});
  }
  if (machine.heat) {
    for (const plant::ThermalBody& body : machine.heat->network.bodies) {
      all.push_back({"temperature_" + body.name, "degC", "temperature of " + body.name, "", ""});
    }
    for (const model::HeatSensor& sensor : machine.heat->sensors) {
      all.push_back({"sensor_" + sensor.name, "degC",
                     "reading of temperature sensor " + sensor.name, "", ""});
    }
  }
}

// Signals of the tool that not every case has.
void add_tool_signals(SignalParts parts, std::vector<Signal>& all) {
  all.insert(all.end(), std::begin(kToolSignals), std::end(kToolSignals));
  if (parts.oriented) {
    all.push_back({"tool_side_true", "1",
                   "unit vector along X of the spindle, across the tool axis, in the workpiece",
                   "IJK", kIjk});
  }
  if (!parts.uncorrectable) return;
  all.push_back({"uncorrectable_tcp", "um",
                 "TCP deviation that the axes cannot compensate, identified", "", ""});
  all.push_back({"uncorrectable_axis", "urad",
                 "tool axis deviation that the axes cannot compensate, identified", "", ""});
}

}  // namespace

bool wants_axis_signals(const RunOutputs& outputs) {
  return std::any_of(std::begin(kAxisSignals), std::end(kAxisSignals), [&](const auto& signal) {
    return outputs.wants(signal.name + std::string("_linear")) ||
           outputs.wants(signal.name + std::string("_rotary"));
  });
}

std::size_t axis_signals() { return std::size(kAxisSignals); }

bool stands_on_bed(const model::MachineSettings& machine) {
  return std::any_of(machine.drives.begin(), machine.drives.end(),
                     [](const plant::FeedDriveParams& drive) { return drive.on_bed(); });
}

std::vector<Signal> recorded_signals(const model::MachineSettings& machine, SignalParts parts) {
  const std::string linear = letters(machine, 0, kLinearJoints);
  const std::string rotary = letters(machine, kLinearJoints, kJoints);
  std::vector<Signal> all = {
      {"time", "s", "time since the start of the program", "", ""},
      {"s", "mm", "arc length on the path of the original program", "", ""},
      whole_numbers("line", "line of the original program"),
      whole_numbers("section", "section of the original program, index into attribute sections"),
      whole_numbers("rapid", "1 while a rapid move is interpolated"),
  };
  for (const auto& [name, unit_linear, unit_rotary, about] : kAxisSignals) {
    const std::string signal = name, what = about;
    if (!linear.empty()) {
      all.push_back({signal + "_linear", unit_linear, what + ", linear axes", linear, kLinear});
    }
    if (!rotary.empty()) {
      all.push_back({signal + "_rotary", unit_rotary, what + ", rotary axes", rotary, kRotary});
    }
  }
  if (parts.imposed) {
    all.push_back({"imposed_linear", "um",
                   "displacement required by the imposed errors at the programmed position", linear,
                   kLinear});
  }
  add_tool_signals(parts, all);
  if (parts.cut) add_cut(parts.teeth, linear, all);
  add_states(machine, linear, all);
  if (parts.programmed && !linear.empty()) {
    all.push_back({"programmed_linear", "mm",
                   "position of the ideal machine on the programmed path, linear axes", linear,
                   kLinear});
  }
  if (parts.windows) {
    all.push_back(
        whole_numbers("window", "number of the window; rows between windows are not recorded"));
    all.push_back(
        whole_numbers("in_window", "1 in a window, 0 in the row before and the row after it"));
  }
  return all;
}

void round_to(const model::RecordFormat& format, std::vector<Signal>& signals) {
  for (Signal& signal : signals) {
    const double most = format.resolution * per_metre(signal);
    if (most > 0.0) signal.quantum = std::exp2(std::floor(std::log2(most)));
    if (per_metre(signal) > 0.0 && signal.name != "s" && signal.name != "spindle_angle") {
      signal.storage = format.storage;
    }
  }
}

}  // namespace servomill::sim::engine
