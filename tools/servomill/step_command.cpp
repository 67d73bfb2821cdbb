#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/frequency/axis_dynamics.h"
#include "sim/frequency/stability.h"
#include "sim/model/machine_parts.h"
#include "sim/model/scenario_parts.h"
#include "sim/run/servo_store.h"
#include "sim/system/json.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

constexpr std::array<std::string_view, 4> kKinds = {"position", "velocity", "load", "all"};
constexpr double kDefaultDecay = 12.0;      // time constants that are simulated
constexpr Tick kMaxRows = 20'000;           // of a response, about
constexpr double kMinOvershoot = 5e-5;      // less is none
constexpr double kLongestDuration = 100.0;  // s

std::vector<sim::frequency::StepKind> kinds_of(const Options& options) {
  const std::size_t chosen = choice_option(options, "kind", kKinds);
  if (chosen < 3) return {static_cast<sim::frequency::StepKind>(chosen)};
  return {sim::frequency::StepKind::position, sim::frequency::StepKind::velocity,
          sim::frequency::StepKind::load};
}

struct Units {
  const char *amplitude, *value;  // of what steps, of what answers
  double amplitude_unit, value_unit;
  sim::config::Quantity quantity;
  double default_amplitude;
};

Units units_of(sim::frequency::StepKind kind, int joint) {
  const bool linear = joint < kLinearJoints;
  switch (kind) {
    case sim::frequency::StepKind::position:
      return linear ? Units{"mm", "um", mm, um, sim::config::kLength, 0.1 * mm}
                    : Units{"deg", "urad", deg, urad, sim::config::kAngle, 0.02 * deg};
    case sim::frequency::StepKind::velocity:
      return linear ? Units{"mm/s", "mm/s", mm, mm, sim::config::kVelocity, 10.0 * mm}
                    : Units{"deg/s", "deg/s", deg, deg, sim::config::kAngularVelocity, 1.0 * deg};
    case sim::frequency::StepKind::load:
      break;
  }
  return linear ? Units{"N", "um", 1.0, um, sim::config::kForce, 500.0}
                : Units{"Nm", "urad", 1.0, urad, sim::config::kTorque, 50.0};
}

sim::frequency::StepSettings settings_of(const Options& options, sim::frequency::StepKind kind,
                                         int joint) {
  sim::frequency::StepSettings settings;
  settings.kind = kind;
  const Units units = units_of(kind, joint);
  settings.amplitude =
      quantity_option(options, "amplitude", units.quantity, bare_unit(units.quantity))
          .value_or(units.default_amplitude);
  if (settings.amplitude == 0.0) {
    throw InputError({"--amplitude"},
                     fmt::format("'{}' must not be 0", options.get<std::string>("amplitude")));
  }
  settings.band = *positive_option(options, "band", sim::config::kNumber, "%");
  if (settings.band >= 1.0) {
    throw InputError({"--band"},
                     fmt::format("'{}' must be < 100 %", options.get<std::string>("band")));
  }
  settings.duration = positive_option(options, "duration", sim::config::kTime, "s").value_or(0.0);
  if (settings.duration > kLongestDuration) {
    throw InputError({"--duration"},
                     fmt::format("'{}' must be <= {:g} s", options.get<std::string>("duration"),
                                 kLongestDuration));
  }
  return settings;
}

std::string milliseconds(double seconds) {
  return std::isfinite(seconds) ? fmt::format("{:.2f} ms", seconds / ms) : "never";
}

void print_figures(const sim::frequency::StepSettings& settings,
                   const sim::frequency::StepResponse& response, int joint, double i_max) {
  const Units u = units_of(settings.kind, joint);
  const sim::frequency::StepFigures& f = response.figures;
  fmt::print("\n{} step of {:g} {}, {:.3g} s\n", sim::run::name_of(settings.kind),
             settings.amplitude / u.amplitude_unit, u.amplitude, response.time.back());
  if (settings.kind == sim::frequency::StepKind::load && f.peak == 0.0) {
    fmt::print("  at rest: friction carries the force\n");
  } else if (settings.kind == sim::frequency::StepKind::load) {
    fmt::print("  peak deviation  {:.4g} {} after {}\n", f.peak / u.value_unit, u.value,
               milliseconds(f.peak_time));
    fmt::print("  back within     {:g} % of it: {}\n", 100.0 * settings.band,
               std::isfinite(f.settling_time) ? "after " + milliseconds(f.settling_time)
                                              : "not in this time");
    fmt::print("  residual at the end  {:.4g} {}\n", f.steady_error / u.value_unit, u.value);
  } else {
    fmt::print("  overshoot       {}\n", f.overshoot > kMinOvershoot
                                             ? fmt::format("{:.2f} % after {}", 100.0 * f.overshoot,
                                                           milliseconds(f.peak_time))
                                             : "none");
    fmt::print("  rise time       {} from 10 % to 90 %\n", milliseconds(f.rise_time));
    fmt::print("  settled         within {:g} %: {}\n", 100.0 * settings.band,
               std::isfinite(f.settling_time) ? "after " + milliseconds(f.settling_time)
                                              : "not in this time");
    fmt::print("  steady error    {:.4g} {}\n", f.steady_error / u.value_unit, u.value);
  }
  fmt::print("  largest current {:.3g} A of {:g} A\n", response.peak_current, i_max);
}

std::string to_json(const sim::frequency::StepSettings& settings,
                    const sim::frequency::StepResponse& response, char axis) {
  const sim::frequency::StepFigures& f = response.figures;
  const bool is_load = settings.kind == sim::frequency::StepKind::load;
  const double overshoot = is_load ? std::nan("") : f.overshoot;  // of the amplitude: a force
  sim::system::JsonObject out;
  out.text("axis", std::string(1, axis)).text("step", sim::run::name_of(settings.kind));
  out.number("amplitude_SI", settings.amplitude).number("overshoot", overshoot);
  out.number("rise_time_s", f.rise_time).number("settling_time_s", f.settling_time);
  out.number("band", settings.band).number("steady_error_SI", f.steady_error);
  out.number("peak_SI", f.peak).number("peak_time_s", f.peak_time);
  return out.number("peak_current_A", response.peak_current).line();
}

// A step of an axis. Gives the settings a duration where they have none; where no step can be
// shown, says why and returns nothing.
std::optional<sim::frequency::StepResponse> simulated(const sim::model::MachineSettings& machine,
                                                      int joint, Tick delay,
                                                      sim::frequency::StepSettings& settings,
                                                      ProgressLine& line) {
  const char axis = sim::model::layout_of(machine).letter_of(joint);
  const bool is_velocity = settings.kind == sim::frequency::StepKind::velocity;
  const double slowest = sim::frequency::slowest_time_constant(
      machine, joint, delay,
      is_velocity ? sim::frequency::PositionLoop::open : sim::frequency::PositionLoop::closed);
  if (!std::isfinite(slowest)) {
    const auto hidden = line.hidden();
    fmt::print(stderr, "axis {}: the {} loop is unstable; no step is simulated\n", axis,
               is_velocity ? "velocity" : "position");
    return std::nullopt;
  }
  if (settings.duration == 0.0) {
    settings.duration = std::min(kLongestDuration, kDefaultDecay * slowest);
  }
  const auto ticks = static_cast<Tick>(settings.duration / sim::model::base_period_of(machine));
  sim::frequency::StepResponse response = sim::frequency::step_response(
      machine, joint, delay, settings, std::max<Tick>(1, ticks / kMaxRows));
  if (response.fault) {
    const auto hidden = line.hidden();
    fmt::print(stderr, "axis {}, {} step: {}\n", axis, sim::run::name_of(settings.kind),
               *response.fault);
    return std::nullopt;
  }
  return response;
}

// All of them before the first step is simulated.
void refuse_wrong_settings(const Options& options, const std::vector<int>& joints,
                           const std::vector<sim::frequency::StepKind>& kinds) {
  if (kinds.size() > 1 && options.has("amplitude")) {
    throw InputError({"--amplitude"}, "needs one --kind: its unit depends on the kind");
  }
  for (const int joint : joints) {
    for (const sim::frequency::StepKind kind : kinds) settings_of(options, kind, joint);
  }
}

void add_step_options(Options& options) {
  add_axis_options(options);
  options.add()("kind,k", po::value<std::string>()->default_value("all")->value_name("KIND"),
                "position, velocity, load or all");
  options.add()("amplitude", po::value<std::string>()->value_name("\"0.1 mm\""),
                "amplitude of the step, with --kind (default: 0.1 mm, 10 mm/s, 500 N; 0.02 deg, 1 "
                "deg/s, 50 Nm); bare numbers are in these units");
  options.add()("band", po::value<std::string>()->default_value("2 %")->value_name("\"2 %\""),
                "settling band as a fraction of the amplitude (load step: of the peak); a bare "
                "number is in %");
  options.add()("duration", po::value<std::string>()->value_name("\"0.5 s\""),
                "simulated time after the step, bare numbers in s (default: 12 times the slowest "
                "time constant)");
  options.add()("linear", "disables friction, backlash, gravity load, quantisation and limits");
  options.add()("output,o", po::value<std::string>()->value_name("OUT.h5"),
                "writes the signals to a result file, for tools/plot.py");
  options.add()("force,f", "replaces the result file if it exists");
  options.add()("json", "prints a JSON list, one object per step");
  options.add()("quiet,q", "prints only faults");
}

// The machine of the scenario, --linear without what is not linear.
std::shared_ptr<const sim::model::MachineSettings> stepped_machine(
    const Options& options, const std::shared_ptr<const sim::model::Scenario>& scenario) {
  const sim::model::MachineSettings& machine = sim::model::machine_of(*scenario);
  if (options.has("linear")) return sim::frequency::shared_linearised(machine);
  return {scenario, &machine};
}

}  // namespace

int step_command(const Arguments& arguments) {
  Options options(
      "step", "SCENARIO.toml --axis Y [--kind position|velocity|load|all] [-o OUT.h5]",
      "Simulates step responses of an axis with the friction, backlash, quantisation and limits\n"
      "of the scenario, and prints figures of merit. The step is one of the setpoint (without\n"
      "feed-forward), of the velocity command (position loop open; motor speed as slide\n"
      "velocity), or of a force on the slide.",
      "SCENARIO.toml");
  add_step_options(options);
  if (!options.parse(arguments)) return kDone;

  ProgressLine line(options);
  const auto scenario = scenario_for_axes(options);
  const auto stepped = stepped_machine(options, scenario);
  const sim::model::MachineSettings& machine = *stepped;
  const auto joints = chosen_joints(options, machine);
  const auto kinds = kinds_of(options);
  refuse_wrong_settings(options, joints, kinds);
  std::optional<sim::run::StepStore> store;
  if (options.has("output")) {
    store.emplace(options.get<std::string>("output"), options.has("force"), *scenario);
  }
  const bool json = options.has("json"), silent = options.has("quiet") && !json;
  JsonList list;
  Stage steps("steps", static_cast<double>(joints.size() * kinds.size()), Steps::unlike);
  const Tick delay = sim::frequency::reading_delay_of(*scenario);
  bool stable = true;
  const auto print = [&](const sim::frequency::StepSettings& settings,
                         const sim::frequency::StepResponse& response, int joint) {
    const auto hidden = line.hidden();
    if (json) {
      list.add(to_json(settings, response, sim::model::layout_of(machine).letter_of(joint)));
    } else if (!silent) {
      const sim::model::MachineSettings& limited = sim::model::machine_of(*scenario);
      print_figures(settings, response, joint, sim::model::current_limit_of(limited, joint));
    }
  };
  for (const int joint : joints) {
    if (!silent && !json) {
      const auto hidden = line.hidden();
      fmt::print("{}\n", axis_headline(machine, joint, delay));
    }
    for (const sim::frequency::StepKind kind : kinds) {
      sim::frequency::StepSettings settings = settings_of(options, kind, joint);
      const auto found = simulated(machine, joint, delay, settings, line);
      steps.advance();
      stable &= found.has_value();
      if (!found) continue;
      if (store) store->add(sim::model::layout_of(machine).letter_of(joint), settings, *found);
      print(settings, *found, joint);
    }
  }
  line.end();
  if (json) list.end();
  if (store) {
    store->commit();
    if (!silent && !json) fmt::print("\nwritten to {}\n", options.get<std::string>("output"));
  }
  return stable ? kDone : kMachineStopped;
}

}  // namespace servomill::tools
