#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/frequency/bode.h"
#include "sim/model/machine_parts.h"
#include "sim/model/scenario_parts.h"
#include "sim/run/servo_store.h"
#include "sim/system/json.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/bode_options.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

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
    fmt::print("-: below the resolution of the encoders; raise --amplitude\n");
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

void add_json(const sim::frequency::BodeResult& result, char axis, JsonList& list) {
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
      list.add(point.line());
    }
  }
  const sim::frequency::Margins& m = result.margins;
  const sim::frequency::ClosedLoop& c = result.closed;
  sim::system::JsonObject loop;
  loop.text("axis", letter)
      .text("loop", sim::run::name_of(result.loop))
      .boolean("stable", result.stable);
  loop.number("slowest_time_constant_s", result.time_constant);
  // what a loop lacks has no frequency, and an unstable one has no margins
  const auto known = [&](bool is_there, double value) {
    return result.stable && is_there ? value : std::nan("");
  };
  if (result.loop != sim::frequency::BodeLoop::compliance) {
    const bool has_gain = std::isfinite(m.gain), has_phase = std::isfinite(m.phase);
    loop.number("gain_margin", known(has_gain, m.gain));
    loop.number("gain_margin_Hz", known(has_gain, m.gain_frequency));
    loop.number("phase_margin_deg", known(has_phase, m.phase / deg));
    loop.number("crossover_Hz", known(has_phase, m.crossover));
    loop.number("sensitivity_peak", known(true, m.sensitivity));
    loop.number("bandwidth_Hz", known(true, c.bandwidth));
  }
  loop.number("peak", known(true, c.peak));
  list.add(loop.number("peak_Hz", known(c.peak_frequency > 0.0, c.peak_frequency)).line());
}

void print_result(const sim::frequency::BodeResult& result,
                  const sim::model::MachineSettings& machine, int joint, const Options& options,
                  JsonList& list) {
  const char axis = sim::model::layout_of(machine).letter_of(joint);
  if (result.fault) {
    fmt::print(stderr, "axis {}, {} loop: {}; nothing is measured\n", axis,
               sim::run::name_of(result.loop), *result.fault);
  }
  if (options.has("json")) {
    add_json(result, axis, list);
    return;
  }
  if (options.has("quiet")) return;
  for (const sim::frequency::BodeCurve& curve : result.curves) print_curve(result, curve, joint);
  print_summary(result, joint, sim::model::current_limit_of(machine, joint));
}

}  // namespace

int bode_command(const Arguments& arguments) {
  Options options(
      "bode", "SCENARIO.toml --axis Y [--loop position|velocity|compliance|all] [-o OUT.h5]",
      "Prints frequency responses of an axis with its sampled loops: open and closed position\n"
      "loop, open and closed velocity loop, compliance (slide per force). 'Exact' is the\n"
      "fundamental of the linear multirate model; 'measured' is the result of simulating the\n"
      "whole axis, with friction, backlash, quantisation and limits, excited by sinusoids. The\n"
      "open position loop is position feedback over following error, the open velocity loop\n"
      "measured speed over speed error. Margins are those of the exact model.",
      "SCENARIO.toml");
  add_bode_options(options);
  if (!options.parse(arguments)) return kDone;

  ProgressLine line(options);
  const auto scenario = scenario_for_axes(options);
  const sim::model::MachineSettings& machine = sim::model::machine_of(*scenario);
  const std::vector<BodeTask> tasks = bode_tasks(options, machine);
  std::optional<sim::run::BodeStore> store;
  if (options.has("output")) {
    store.emplace(options.get<std::string>("output"), options.has("force"), *scenario);
  }
  const bool is_table = !options.has("quiet") && !options.has("json");
  const Tick delay = sim::frequency::reading_delay_of(*scenario);
  JsonList list;
  bool stable = true;
  int headed = -1;
  Stage loops("loops", static_cast<double>(tasks.size()), Steps::unlike);
  for (const auto& [joint, settings] : tasks) {
    const sim::frequency::BodeResult result = sim::frequency::bode(machine, joint, delay, settings);
    stable &= result.stable && !result.fault;
    if (store) store->add(sim::model::layout_of(machine).letter_of(joint), result);
    loops.advance();
    const auto hidden = line.hidden();
    if (is_table && joint != headed) fmt::print("{}\n", axis_headline(machine, joint, delay));
    headed = joint;
    print_result(result, machine, joint, options, list);
  }
  line.end();
  if (options.has("json")) list.end();
  if (store) {
    store->commit();
    if (is_table) fmt::print("\nwritten to {}\n", options.get<std::string>("output"));
  }
  return stable ? kDone : kMachineStopped;
}

}  // namespace servomill::tools
