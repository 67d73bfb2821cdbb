#include "tools/servomill/bode_options.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/design.h"
#include "sim/model/machine.h"
#include "tools/servomill/axis_options.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

constexpr std::array<std::string_view, 4> kLoops = {"position", "velocity", "compliance", "all"};
constexpr std::array<std::string_view, 3> kMethods = {"sine", "multisine", "none"};
constexpr std::size_t kMaxPoints = 1000;

std::vector<sim::frequency::BodeLoop> loops_of(const Options& options) {
  const std::size_t chosen = choice_option(options, "loop", kLoops);
  if (chosen < 3) return {static_cast<sim::frequency::BodeLoop>(chosen)};
  return {sim::frequency::BodeLoop::position, sim::frequency::BodeLoop::velocity,
          sim::frequency::BodeLoop::compliance};
}

void check_range(const sim::frequency::BodeSettings& settings,
                 const sim::model::LoopPeriods& periods) {
  const double nyquist = sim::frequency::nyquist_frequency(periods, settings.loop);
  const auto fault = [&](const char* name, double value, const std::string& rule) {
    throw InputError({name}, fmt::format("{:g} Hz; must be {}", value, rule));
  };
  const std::string half =
      fmt::format("{:.6g} Hz, half the rate of the {} loop", nyquist,
                  settings.loop == sim::frequency::BodeLoop::velocity ? "velocity" : "position");
  if (settings.from >= nyquist) fault("--f-min", settings.from, "< " + half);
  if (settings.measure && settings.from < sim::frequency::kLowestMeasured) {
    fault("--f-min", settings.from,
          fmt::format(">= {:g} Hz to be measured; --method none goes lower",
                      sim::frequency::kLowestMeasured));
  }
  if (!settings.to) return;
  if (*settings.to > nyquist * (1.0 + 1e-12)) fault("--f-max", *settings.to, "<= " + half);
  if (*settings.to > settings.from) return;
  fault("--f-max", *settings.to, fmt::format("> --f-min, {:g} Hz", settings.from));
}

sim::config::Quantity quantity_of(sim::frequency::BodeLoop loop, int joint) {
  const bool linear = joint < kLinearJoints;
  switch (loop) {
    case sim::frequency::BodeLoop::position:
      return linear ? sim::config::kLength : sim::config::kAngle;
    case sim::frequency::BodeLoop::velocity:
      return linear ? sim::config::kVelocity : sim::config::kAngularVelocity;
    case sim::frequency::BodeLoop::compliance:
      break;
  }
  return linear ? sim::config::kForce : sim::config::kTorque;
}

sim::frequency::BodeSettings settings_of(const Options& options,
                                         const sim::model::MachineSettings& machine,
                                         sim::frequency::BodeLoop loop, int joint) {
  sim::frequency::BodeSettings settings;
  settings.loop = loop;
  settings.from = *positive_option(options, "f-min", sim::config::kRate, "Hz");
  if (const auto to = positive_option(options, "f-max", sim::config::kRate, "Hz"))
    settings.to = *to;
  const int points = options.get<int>("points");
  if (points < 2 || points > static_cast<int>(kMaxPoints)) {
    throw InputError({"--points"}, fmt::format("{}; must be >= 2 and <= {}", points, kMaxPoints));
  }
  settings.points = static_cast<std::size_t>(points);
  const std::size_t method = choice_option(options, "method", kMethods);
  settings.measure = method < 2;
  settings.method = method == 1 ? sim::frequency::Method::multi_sine : sim::frequency::Method::sine;
  const sim::config::Quantity fed_in = quantity_of(loop, joint);
  settings.amplitude = positive_option(options, "amplitude", fed_in, bare_unit(fed_in));
  settings.velocity = quantity_option(
      options, "velocity",
      joint < kLinearJoints ? sim::config::kVelocity : sim::config::kAngularVelocity,
      joint < kLinearJoints ? "mm/min" : "deg/min");
  const double v_max = machine.nc.v_max[joint];
  if (settings.velocity && v_max > 0.0 && std::abs(*settings.velocity) > v_max) {
    throw InputError(
        {"--velocity"},
        fmt::format("'{}' must be no faster than axis {}, which reaches {}",
                    options.get<std::string>("velocity"), machine.chain.layout.letter_of(joint),
                    in_words(sim::frequency::BodeLoop::velocity, joint, v_max)));
  }
  return settings;
}

}  // namespace

std::string in_words(sim::frequency::BodeLoop loop, int joint, double si) {
  const bool linear = joint < kLinearJoints;
  switch (loop) {
    case sim::frequency::BodeLoop::position:
      return sim::config::in_unit(si, linear ? "um" : "urad");
    case sim::frequency::BodeLoop::velocity:
      return sim::config::in_unit(si, linear ? "mm/s" : "rad/s");
    case sim::frequency::BodeLoop::compliance:
      break;
  }
  return sim::config::in_unit(si, linear ? "N" : "Nm");
}

void add_bode_options(Options& options) {
  add_axis_options(options);
  options.add()("loop,l", po::value<std::string>()->default_value("position")->value_name("LOOP"),
                "position, velocity, compliance or all");
  options.add()("f-min", po::value<std::string>()->default_value("1 Hz")->value_name("\"1 Hz\""),
                "lowest frequency; a bare number is in Hz");
  options.add()("f-max", po::value<std::string>()->value_name("\"100 Hz\""),
                "highest frequency, bare numbers in Hz, up to half the rate of the loop (default: "
                "0.4 times its rate)");
  options.add()("points", po::value<int>()->default_value(30)->value_name("N"),
                "number of frequencies, spaced logarithmically");
  options.add()("method", po::value<std::string>()->default_value("sine")->value_name("METHOD"),
                "sine (one frequency after the other), multisine (all at once, Schroeder phases) "
                "or none (exact only)");
  options.add()("amplitude", po::value<std::string>()->value_name("\"20 um\""),
                "peak of the excitation: a length (position), a velocity (velocity), a force "
                "(compliance), angles and torques for a rotary axis; bare numbers in mm, mm/s, N, "
                "deg, deg/s, Nm (default: the velocity loop takes 2 % of the current limit)");
  options.add()("velocity", po::value<std::string>()->value_name("\"300 mm/min\""),
                "superimposed constant velocity that keeps the axis from sticking; bare numbers in "
                "mm/min or deg/min (default: 0 without friction and backlash, else four times the "
                "velocity of the amplitude)");
  options.add()("output,o", po::value<std::string>()->value_name("OUT.h5"),
                "writes the curves to a result file, for tools/plot.py");
  options.add()("force,f", "replaces the result file if it exists");
  options.add()("json", "prints a JSON list, one object per frequency and curve, and one per loop");
  options.add()("quiet,q", "prints only faults");
}

std::vector<BodeTask> bode_tasks(const Options& options,
                                 const sim::model::MachineSettings& machine) {
  const std::vector<int> joints = chosen_joints(options, machine);
  const std::vector<sim::frequency::BodeLoop> loops = loops_of(options);
  if (loops.size() > 1 && options.has("amplitude")) {
    throw InputError({"--amplitude"}, "needs one --loop: its unit depends on the loop");
  }
  std::vector<BodeTask> out;
  for (const int joint : joints) {
    for (const sim::frequency::BodeLoop loop : loops) {
      out.push_back({joint, settings_of(options, machine, loop, joint)});
      check_range(out.back().settings, machine.nc.periods);
    }
  }
  return out;
}

}  // namespace servomill::tools
