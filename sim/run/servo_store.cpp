#include "sim/run/servo_store.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/run/store.h"

namespace servomill::sim::run {
namespace {

bool is_linear_axis(char axis) { return axis == 'X' || axis == 'Y' || axis == 'Z'; }

double travel_per_radian(const model::MachineSettings& machine, char letter) {
  const auto joint = machine.chain.layout.joint_of(*axis_of(letter));
  return machine.drives[static_cast<std::size_t>(*joint)].r;
}

std::vector<double> magnitudes(const std::vector<frequency::Complex>& y, double unit) {
  std::vector<double> out;
  for (const frequency::Complex& one : y) out.push_back(std::abs(one) / unit);
  return out;
}

// Continuous along the frequency.
std::vector<double> phases(const std::vector<frequency::Complex>& y) {
  std::vector<double> out;
  double last = std::numeric_limits<double>::quiet_NaN();
  for (const frequency::Complex& one : y) {
    double phase = std::arg(one);
    if (std::isfinite(last)) phase = last + std::remainder(phase - last, 2.0 * std::numbers::pi);
    if (std::isfinite(phase)) last = phase;
    out.push_back(phase / deg);
  }
  return out;
}

void write_curve(records::Hdf5Group group, const frequency::BodeCurve& curve,
                 const records::Meaning& magnitude, double unit) {
  group.attribute("long_name", curve.long_name);
  group.list("frequency", curve.exact.f, {"Hz", "frequency"});
  group.list("magnitude", magnitudes(curve.exact.y, unit), magnitude, "frequency");
  group.list("phase", phases(curve.exact.y), {"deg", "phase, exact"}, "frequency");
  records::make_nexus_data(group, {"magnitude", {"frequency"}, {}, true});
  if (curve.measured.empty()) return;
  group.list("measured_frequency", curve.f, {"Hz", "measured frequency"});
  group.list("measured_magnitude", magnitudes(curve.measured, unit), magnitude,
             "measured_frequency");
  group.list("measured_phase", phases(curve.measured), {"deg", "phase, measured"},
             "measured_frequency");
}

}  // namespace

std::string name_of(frequency::BodeLoop loop) {
  switch (loop) {
    case frequency::BodeLoop::position:
      return "position";
    case frequency::BodeLoop::velocity:
      return "velocity";
    case frequency::BodeLoop::compliance:
      break;
  }
  return "compliance";
}

std::string name_of(frequency::StepKind kind) {
  switch (kind) {
    case frequency::StepKind::position:
      return "position";
    case frequency::StepKind::velocity:
      return "velocity";
    case frequency::StepKind::load:
      break;
  }
  return "load";
}

namespace {

// Group of an axis. The first one has the default plot.
records::Hdf5Group group_of(records::OutputFile& file, const std::string& kind, char axis) {
  records::Hdf5Group all = file.root().group(kind);
  if (!all.has_attribute("default")) {
    records::make_nexus_group(all, "NXentry", std::string(1, axis));
  }
  return all.group(std::string(1, axis));
}

}  // namespace

BodeStore::BodeStore(const std::string& path, bool force, const model::Scenario& scenario)
    : file_(writable_name(path, force), force) {
  file_.remove_unless_committed();
  records::Hdf5Group root = file_.root();
  write_inputs(root, scenario, "bode", "bode");
}

void BodeStore::add(char axis, const frequency::BodeResult& result) {
  records::Hdf5Group of_axis = group_of(file_, "bode", axis);
  records::make_nexus_group(of_axis, "NXcollection", result.curves.front().name);
  const bool compliance = result.loop == frequency::BodeLoop::compliance;
  const bool linear = is_linear_axis(axis);
  const records::Meaning magnitude = {compliance ? (linear ? "um N-1" : "urad N-1 m-1") : "1",
                                      "magnitude"};
  for (const frequency::BodeCurve& curve : result.curves) {
    write_curve(of_axis.group(curve.name), curve, magnitude, compliance ? um : 1.0);
  }
  records::Hdf5Group loop = of_axis.group(name_of(result.loop) + "_loop");
  records::make_nexus_group(loop, "NXcollection");
  loop.attribute("stable", result.stable ? 1 : 0);
  loop.attribute("slowest_time_constant_s", result.time_constant);
  loop.attribute("nyquist_Hz", result.nyquist);
  if (compliance) {
    loop.attribute("peak", result.closed.peak / um);
    loop.attribute("peak_Hz", result.closed.peak_frequency);
  } else {
    loop.attribute("gain_margin", result.margins.gain);
    loop.attribute("gain_margin_Hz", result.margins.gain_frequency);
    loop.attribute("phase_margin_deg", result.margins.phase / deg);
    loop.attribute("crossover_Hz", result.margins.crossover);
    loop.attribute("sensitivity_peak", result.margins.sensitivity);
    loop.attribute("bandwidth_Hz", result.closed.bandwidth);
    loop.attribute("resonance_peak", result.closed.peak);
    loop.attribute("resonance_Hz", result.closed.peak_frequency);
  }
  if (result.measured) {
    loop.attribute("method", result.method == frequency::Method::sine ? "sine" : "multisine");
    loop.attribute("amplitude_SI", result.amplitude);
    loop.attribute("velocity_SI", result.velocity);
    loop.attribute("crest_factor", result.crest_factor);
    loop.attribute("peak_current_A", result.peak_current);
  }
}

StepStore::StepStore(const std::string& path, bool force, const model::Scenario& scenario)
    : machine_(std::make_shared<const model::MachineSettings>(scenario.machine)),
      file_(writable_name(path, force), force) {
  file_.remove_unless_committed();
  records::Hdf5Group root = file_.root();
  write_inputs(root, scenario, "step", "step");
}

void StepStore::add(char axis, const frequency::StepSettings& settings,
                    const frequency::StepResponse& response) {
  records::Hdf5Group of_axis = group_of(file_, "step", axis);
  if (!of_axis.has_attribute("default")) {
    records::make_nexus_group(of_axis, "NXcollection", name_of(settings.kind));
  }
  records::Hdf5Group group = of_axis.group(name_of(settings.kind));
  const bool linear = is_linear_axis(axis);
  const std::string length = linear ? "mm" : "deg";
  const double unit = linear ? mm : deg;
  of_axis.attribute("travel_per_radian", travel_per_radian(*machine_, axis) / unit);
  struct Column {
    const char* name;
    frequency::AxisSignal signal;
    std::string units;
    const char* long_name;
    double unit;
  };
  const Column columns[] = {
      {"position", frequency::AxisSignal::position, length, "position of the slide or table", unit},
      {"velocity", frequency::AxisSignal::velocity, length + " s-1",
       "velocity of the slide or table", unit},
      {"motor_speed", frequency::AxisSignal::motor_speed, "rad s-1", "motor speed", 1.0},
      {"current", frequency::AxisSignal::current, "A", "torque-forming current", 1.0},
      {"reading", frequency::AxisSignal::reading, length, "position feedback of the position loop",
       unit},
  };
  group.list("time", response.time, {"s", "time since the step"});
  for (const Column& column : columns) {
    std::vector<double> values;
    for (const frequency::AxisSignals& row : response.signals) {
      values.push_back(row[frequency::index_of(column.signal)] / column.unit);
    }
    group.list(column.name, values, {column.units, column.long_name}, "time");
  }
  // the default plot is what was stepped; under load, the position
  const bool is_velocity = settings.kind == frequency::StepKind::velocity;
  records::make_nexus_data(group, is_velocity ? records::Plot{"velocity", {"time"}, {}}
                                              : records::Plot{"position", {"time"}, {"reading"}});
  const bool load = settings.kind == frequency::StepKind::load;
  const frequency::StepFigures& f = response.figures;
  group.attribute("amplitude", settings.amplitude / (load ? 1.0 : unit));
  group.attribute("amplitude_units",
                  load ? (linear ? "N" : "N m")
                       : length + (settings.kind == frequency::StepKind::velocity ? " s-1" : ""));
  group.attribute("band", settings.band);
  group.attribute("overshoot", f.overshoot);
  group.attribute("rise_time_s", f.rise_time);
  group.attribute("settling_time_s", f.settling_time);
  group.attribute("steady_error", f.steady_error / unit);
  group.attribute("peak", f.peak / unit);
  group.attribute("peak_time_s", f.peak_time);
  group.attribute("peak_current_A", response.peak_current);
}

}  // namespace servomill::sim::run
