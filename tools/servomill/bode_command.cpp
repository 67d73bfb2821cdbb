#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/frequency/bode.h"
#include "sim/run/servo_store.h"
#include "sim/system/json.h"
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

double shown(sim::frequency::BodeLoop loop, double magnitude) {
  return loop == sim::frequency::BodeLoop::compliance ? magnitude / um : decibel(magnitude);
}

bool is_known(sim::frequency::Complex measured) { return std::isfinite(measured.real()); }

// Without a sign where it rounds to zero.
double rounded(double value, double unit) { return std::round(value / unit) * unit + 0.0; }

void print_curve(const sim::frequency::BodeResult& result, const sim::frequency::BodeCurve& curve,
                 int joint) {
  const bool compliance = result.loop == sim::frequency::BodeLoop::compliance;
  const std::string unit =
      compliance ? fmt::format("{}/{}", small_unit(joint), joint < kLinearJoints ? "N" : "Nm")
                 : "dB";
  fmt::print("\n{}\n{:>10}  {:>12} {:>9}", curve.long_name, "f, Hz", unit, "deg");
  if (!curve.measured.empty())
    fmt::print("  {:>12} {:>9}  {:>8} {:>8}", "measured", "deg", "diff dB", "diff deg");
  fmt::print("\n");
  for (std::size_t i = 0; i < curve.f.size(); ++i) {
    const auto number = [&](sim::frequency::Complex y) {
      return fmt::format("{:12.{}f} {:9.2f}", shown(result.loop, std::abs(y)), compliance ? 6 : 3,
                         std::arg(y) / deg);
    };
    fmt::print("{:10.3f}  {}", curve.f[i], number(curve.exact_at[i]));
    if (!curve.measured.empty() && !is_known(curve.measured[i])) {
      fmt::print("  {:>12} {:>9}", "-", "-");
    } else if (!curve.measured.empty()) {
      const sim::frequency::Complex q = curve.measured[i] / curve.exact_at[i];
      fmt::print("  {}  {:8.3f} {:8.2f}", number(curve.measured[i]),
                 rounded(decibel(std::abs(q)), 1e-3), rounded(std::arg(q) / deg, 1e-2));
    }
    fmt::print("\n");
  }
  if (!std::all_of(curve.measured.begin(), curve.measured.end(), is_known)) {
    fmt::print("-: below what the encoders resolve; raise --amplitude\n");
  }
}

std::string or_none(double value, const std::string& text) {
  return std::isfinite(value) ? text : "none up to the Nyquist frequency";
}

void print_margins(const sim::frequency::BodeResult& result) {
  const sim::frequency::Margins& m = result.margins;
  const sim::frequency::ClosedLoop& c = result.closed;
  if (!result.stable) {  // distances to oscillation mean nothing
    if (result.loop == sim::frequency::BodeLoop::position && !result.has_stable_velocity_loop) {
      fmt::print(
          "  the velocity loop inside is unstable: no Kv stabilises it, lower "
          "velocity_bandwidth\n");
    } else if (std::isfinite(m.reduction)) {
      fmt::print("  the gain must fall   by {:.2f} dB or more\n", decibel(m.reduction));
    }
    return;
  }
  fmt::print("  gain margin          {}\n",
             or_none(m.gain, fmt::format("{:.2f} dB (factor {:.3f}) at {:.4g} Hz", decibel(m.gain),
                                         m.gain, m.gain_frequency)));
  if (std::isfinite(m.reduction)) {
    fmt::print("  gain reduction       {:.2f} dB until it oscillates\n", decibel(m.reduction));
  }
  fmt::print("  phase margin         {}\n",
             or_none(m.phase, fmt::format("{:.2f} deg at the crossover of {:.4g} Hz", m.phase / deg,
                                          m.crossover)));
  fmt::print("  largest sensitivity  {:.3f} ({:.2f} dB) at {:.4g} Hz\n", m.sensitivity,
             decibel(m.sensitivity), m.sensitivity_frequency);
  fmt::print("  bandwidth (-3 dB)    {}\n",
             or_none(c.bandwidth, fmt::format("{:.4g} Hz", c.bandwidth)));
  fmt::print("  resonance peak       {}\n",
             c.peak > 1.0 + 1e-6
                 ? fmt::format("{:.2f} dB at {:.4g} Hz", decibel(c.peak), c.peak_frequency)
                 : "none");
}

void print_summary(const sim::frequency::BodeResult& result, int joint, double i_max) {
  const sim::frequency::ClosedLoop& c = result.closed;
  fmt::print("\n{}: {}\n",
             result.loop == sim::frequency::BodeLoop::compliance
                 ? "compliance, position loop"
                 : sim::run::name_of(result.loop) + " loop",
             result.stable
                 ? fmt::format("stable, slowest time constant {:.3g} ms", result.time_constant / ms)
                 : "UNSTABLE; nothing is measured");
  if (result.loop == sim::frequency::BodeLoop::compliance) {
    fmt::print("  largest compliance   {:.4g} {}/{} at {:.4g} Hz\n", c.peak / um, small_unit(joint),
               joint < kLinearJoints ? "N" : "Nm", c.peak_frequency);
  } else {
    print_margins(result);
  }
  if (!result.measured) return;
  fmt::print(
      "  measured with        {} of {}{}, crest factor {:.2f}; current up to {:.3g} A; "
      "{:.3g} s simulated\n",
      result.method == sim::frequency::Method::sine ? "single sinusoids" : "a multi-sine",
      in_words(result.loop, joint, result.amplitude),
      result.velocity != 0.0 ? fmt::format(" at {}", in_words(sim::frequency::BodeLoop::velocity,
                                                              joint, result.velocity))
                             : "",
      result.crest_factor, result.peak_current, result.simulated_time);
  if (result.current_limited) {
    fmt::print("  the current limit of {:g} A was reached: measured values are not linear\n",
               i_max);
  }
}

void print_json(const sim::frequency::BodeResult& result, char axis) {
  const std::string letter(1, axis);
  const auto number = [](sim::frequency::Complex y) {
    return sim::system::JsonObject()
        .number("magnitude", std::abs(y))
        .number("phase_deg", std::arg(y) / deg)
        .line();
  };
  for (const sim::frequency::BodeCurve& curve : result.curves) {
    for (std::size_t i = 0; i < curve.f.size(); ++i) {
      const bool known = !curve.measured.empty() && is_known(curve.measured[i]);
      sim::system::JsonObject point;
      point.text("axis", letter).text("curve", curve.name).number("frequency_Hz", curve.f[i]);
      point.raw("exact", number(curve.exact_at[i]));
      point.raw("measured", known ? number(curve.measured[i]) : "null");
      fmt::print("{}\n", point.line());
    }
  }
  const sim::frequency::Margins& m = result.margins;
  const sim::frequency::ClosedLoop& c = result.closed;
  sim::system::JsonObject loop;
  loop.text("axis", letter)
      .text("loop", sim::run::name_of(result.loop))
      .boolean("stable", result.stable);
  loop.number("slowest_time_constant_s", result.time_constant);
  if (result.loop != sim::frequency::BodeLoop::compliance) {
    loop.number("gain_margin", m.gain).number("gain_margin_Hz", m.gain_frequency);
    loop.number("phase_margin_deg", m.phase / deg).number("crossover_Hz", m.crossover);
    loop.number("sensitivity_peak", m.sensitivity).number("bandwidth_Hz", c.bandwidth);
  }
  fmt::print("{}\n", loop.number("peak", c.peak).number("peak_Hz", c.peak_frequency).line());
}

void add_options(Options& options) {
  add_axis_options(options);
  options.add()("loop,l", po::value<std::string>()->default_value("position")->value_name("LOOP"),
                "position, velocity, compliance or all");
  options.add()("f-min", po::value<std::string>()->default_value("1 Hz")->value_name("\"1 Hz\""),
                "lowest frequency; a bare number is in Hz");
  options.add()("f-max", po::value<std::string>()->value_name("\"100 Hz\""),
                "highest frequency, bare numbers in Hz, up to half the rate of the loop (default: "
                "0.4 times its rate)");
  options.add()("points", po::value<int>()->default_value(30)->value_name("N"),
                "frequencies, evenly spaced in the logarithm");
  options.add()("method", po::value<std::string>()->default_value("sine")->value_name("METHOD"),
                "sine (one frequency after the other), multisine (all at once, Schroeder phases) "
                "or none (exact only)");
  options.add()("amplitude", po::value<std::string>()->value_name("\"20 um\""),
                "peak of the excitation: a length (position), a velocity (velocity), a force "
                "(compliance), angles and torques for a rotary axis; bare numbers in mm, mm/s, N, "
                "deg, deg/s, Nm (default: the velocity loop takes 2 % of the current limit)");
  options.add()(
      "velocity", po::value<std::string>()->value_name("\"300 mm/min\""),
      "superimposed constant velocity, so that the axis does not stick; bare numbers in mm/min "
      "or deg/min (default: 0 without "
      "friction and backlash, else four times the velocity of the amplitude)");
  options.add()("output,o", po::value<std::string>()->value_name("OUT.h5"),
                "writes the curves to a result file, for tools/plot.py");
  options.add()("force,f", "replaces the result file if it exists");
  options.add()("json", "prints one JSON object per frequency and curve, and one per loop");
  options.add()("quiet,q", "prints only faults");
}

// All loops are checked before the first is measured.
std::vector<sim::frequency::BodeLoop> checked_loops(const Options& options,
                                                    const sim::model::MachineSettings& machine,
                                                    const std::vector<int>& joints) {
  std::vector<sim::frequency::BodeLoop> loops = loops_of(options);
  if (loops.size() > 1 && options.has("amplitude")) {
    throw InputError({"--amplitude"}, "needs one --loop: its unit depends on the loop");
  }
  for (const int joint : joints) {
    for (const sim::frequency::BodeLoop loop : loops) {
      check_range(settings_of(options, machine, loop, joint), machine.nc.periods);
    }
  }
  return loops;
}

void print_result(const sim::frequency::BodeResult& result,
                  const sim::model::MachineSettings& machine, int joint, const Options& options) {
  const char axis = machine.chain.layout.letter_of(joint);
  if (result.fault) {
    fmt::print(stderr, "axis {}, {} loop: {}; nothing is measured\n", axis,
               sim::run::name_of(result.loop), *result.fault);
  }
  if (options.has("quiet")) return;
  if (options.has("json")) {
    print_json(result, axis);
    return;
  }
  for (const sim::frequency::BodeCurve& curve : result.curves) print_curve(result, curve, joint);
  print_summary(result, joint, machine.nc.cascade[static_cast<std::size_t>(joint)].i_max);
}

}  // namespace

int bode_command(const Arguments& arguments) {
  Options options(
      "bode", "SCENARIO.toml --axis Y [--loop position|velocity|compliance|all] [-o OUT.h5]",
      "Prints frequency responses of an axis with its sampled loops: open and closed position\n"
      "loop, open and closed velocity loop, compliance (slide per force). 'Exact' is the\n"
      "fundamental of the linear multirate model; 'measured' is what a simulation of the whole\n"
      "axis with friction, backlash, quantisation and limits shows when it is fed with sinusoids.\n"
      "The open position loop is reading over position error, the open velocity loop measured\n"
      "speed over speed error. Margins are those of the exact model.",
      "SCENARIO.toml");
  add_options(options);
  if (!options.parse(arguments)) return kDone;

  const sim::model::Scenario scenario = scenario_for_axes(options);
  const sim::model::MachineSettings& machine = scenario.machine;
  const auto joints = chosen_joints(options, machine);
  const auto loops = checked_loops(options, machine, joints);
  std::optional<sim::run::BodeStore> store;
  if (options.has("output")) {
    store.emplace(options.get<std::string>("output"), options.has("force"), scenario);
  }
  const bool is_table = !options.has("quiet") && !options.has("json");
  const Tick delay = sim::frequency::reading_delay_of(scenario);
  bool stable = true;
  for (const int joint : joints) {
    if (is_table) fmt::print("{}\n", axis_headline(machine, joint, delay));
    for (const sim::frequency::BodeLoop loop : loops) {
      const sim::frequency::BodeResult result =
          sim::frequency::bode(machine, joint, delay, settings_of(options, machine, loop, joint));
      stable &= result.stable && !result.fault;
      if (store) store->add(machine.chain.layout.letter_of(joint), result);
      print_result(result, machine, joint, options);
    }
  }
  if (store) {
    store->commit();
    if (is_table) fmt::print("\nwritten to {}\n", options.get<std::string>("output"));
  }
  return stable ? kDone : kMachineStopped;
}

}  // namespace servomill::tools
