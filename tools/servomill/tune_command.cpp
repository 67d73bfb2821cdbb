#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/frequency/axis_dynamics.h"
#include "sim/frequency/bode.h"
#include "sim/frequency/measured_response.h"
#include "sim/frequency/tuning.h"
#include "sim/model/machine_parts.h"
#include "sim/model/scenario_parts.h"
#include "sim/system/json.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

sim::frequency::TuneSettings settings_of(const Options& options) {
  sim::frequency::TuneSettings settings;
  const auto refuse = [&](const char* name, std::string_view rule) {
    throw InputError({std::string("--") + name},
                     fmt::format("'{}' must be {}", options.get<std::string>(name), rule));
  };
  constexpr double kRight = 90.0 * deg;
  settings.phase_margin = *positive_option(options, "phase-margin", sim::config::kAngle, "deg");
  if (settings.phase_margin >= kRight) refuse("phase-margin", "< 90 deg");
  settings.gain_margin = std::pow(10.0, decibel_option(options, "gain-margin") / 20.0);
  const double overshoot = *quantity_option(options, "overshoot", sim::config::kNumber, "%");
  if (!(overshoot >= 0.0 && overshoot < 1.0)) refuse("overshoot", ">= 0 and < 100 %");
  constexpr double kNone = 1e-4;
  settings.overshoot = std::max(overshoot, kNone);
  if (const auto bandwidth = positive_option(options, "bandwidth", sim::config::kRate, "Hz"))
    settings.bandwidth = *bandwidth;
  settings.wv_most =
      positive_option(options, "velocity-bandwidth", sim::config::kAngularVelocity, "rad/s");
  settings.reset_ratio = positive_number(options, "reset-ratio");
  return settings;
}

std::string place(double frequency, const plant::FeedDriveParams& drive) {
  const double resonance = sim::frequency::resonance_frequency(drive);
  const bool near = resonance > 0.0 && std::abs(std::log(frequency / resonance)) < 0.3;
  return fmt::format("{:.4g} Hz{}", frequency,
                     near ? fmt::format(", near the resonance of {:.4g} Hz", resonance) : "");
}

std::string reason(const sim::frequency::Limit& limit, const sim::frequency::TuneSettings& wanted,
                   const plant::FeedDriveParams& drive, std::string_view loop) {
  switch (limit.kind) {
    case sim::frequency::Limit::Kind::phase_margin:
      return fmt::format("the {} loop's phase margin of {:g} deg at the crossover of {}", loop,
                         wanted.phase_margin / deg, place(limit.frequency, drive));
    case sim::frequency::Limit::Kind::gain_margin:
      return fmt::format("the {} loop's gain margin of {:g} dB at {}", loop,
                         std::round(1e3 * decibel(wanted.gain_margin)) / 1e3,
                         place(limit.frequency, drive));
    case sim::frequency::Limit::Kind::overshoot:
      return fmt::format("the overshoot of {:g} % after a step of the setpoint",
                         100.0 * wanted.overshoot);
    case sim::frequency::Limit::Kind::bandwidth:
      return fmt::format("the requested bandwidth of {:g} Hz", limit.frequency);
    case sim::frequency::Limit::Kind::most:
      return "--velocity-bandwidth";
    case sim::frequency::Limit::Kind::range:
      break;
  }
  return "the range of gains that is searched";
}

void print_row(std::string_view name, const std::string& before, const std::string& after) {
  fmt::print("  {:<34} {:>22} {:>22}\n", name, before, after);
}

void print_table(const sim::frequency::Tuning& t, int joint) {
  const auto row = [&](std::string_view name, auto of) {
    print_row(name, of(t.before), of(t.after));
  };
  using A = sim::frequency::Assessment;
  const auto gain = [](const sim::frequency::Margins& m) {
    return std::isfinite(m.gain)
               ? fmt::format("{:.1f} dB, {:.4g} Hz", decibel(m.gain), m.gain_frequency)
               : std::string("none below Nyquist");
  };
  const auto phase = [](const sim::frequency::Margins& m) {
    return std::isfinite(m.phase) ? fmt::format("{:.1f} deg, {:.4g} Hz", m.phase / deg, m.crossover)
                                  : std::string("no crossover");
  };
  print_row("", "before", "after");
  row("velocity bandwidth wv, rad/s", [](const A& a) { return fmt::format("{:.4g}", a.gains.wv); });
  row("reset time Tn, ms", [](const A& a) { return fmt::format("{:.4g}", a.gains.Tn / ms); });
  row("Kv, 1/s (m/min/mm)", [](const A& a) {
    return fmt::format("{:.4g} ({:.3g})", a.gains.Kv, a.gains.Kv * 60.0 / 1000.0);
  });
  row("stable", [](const A& a) { return std::string(a.stable ? "yes" : "NO"); });
  row("velocity loop, gain margin", [&](const A& a) { return a.stable ? gain(a.velocity) : "-"; });
  row("velocity loop, phase margin",
      [&](const A& a) { return a.stable ? phase(a.velocity) : "-"; });
  row("position loop, gain margin", [&](const A& a) { return a.stable ? gain(a.position) : "-"; });
  row("position loop, phase margin",
      [&](const A& a) { return a.stable ? phase(a.position) : "-"; });
  row("position bandwidth (-3 dB), Hz",
      [](const A& a) { return fmt::format("{:.4g}", a.closed.bandwidth); });
  row("overshoot of a position step, %", [](const A& a) {
    return a.stable ? fmt::format("{:.2f}", 100.0 * a.overshoot) : std::string("-");
  });
  const bool linear = joint < kLinearJoints;
  row(linear ? "peak after a load step, um per kN" : "peak after a load step, urad per kNm",
      [](const A& a) {
        return a.stable ? fmt::format("{:.4g}", a.load_peak * 1e9) : std::string("-");
      });
}

// The margins as the whole axis shows them in the simulation, one sinusoid at each crossover.
// Says why not and returns false if the simulation cannot be trusted.
bool confirm(const sim::model::MachineSettings& machine, int joint, Tick delay,
             const sim::frequency::Assessment& a, ProgressLine& line) {
  struct Loop {
    const char* name;
    sim::frequency::PositionLoop loop;
    sim::frequency::Entry entry;
    sim::frequency::AxisSignal output, input;
    const sim::frequency::Margins& margins;
  };
  const Loop loops[] = {
      {"velocity", sim::frequency::PositionLoop::open, sim::frequency::Entry::velocity_command,
       sim::frequency::AxisSignal::measured_speed, sim::frequency::AxisSignal::speed_error,
       a.velocity},
      {"position", sim::frequency::PositionLoop::closed, sim::frequency::Entry::setpoint,
       sim::frequency::AxisSignal::reading, sim::frequency::AxisSignal::position_error, a.position},
  };
  for (const Loop& one : loops) {
    if (!std::isfinite(one.margins.phase)) continue;
    sim::frequency::Measurement how;
    how.entry = one.entry;
    how.amplitude = sim::frequency::default_amplitude(machine, joint, one.entry);
    how.velocity = sim::frequency::default_velocity(machine, joint, one.entry, how.amplitude);
    const auto measured =
        sim::frequency::measure(machine, joint, delay, one.loop, how, {one.margins.crossover});
    const auto hidden = line.hidden();
    if (measured.fault) {
      fmt::print(stderr, "axis {}, {} loop: {}; nothing is measured\n",
                 sim::model::layout_of(machine).letter_of(joint), one.name, *measured.fault);
      return false;
    }
    const sim::frequency::Complex L =
        sim::frequency::ratio(measured.points.front().response, one.output, one.input);
    fmt::print(
        "  measured in the simulation: {} loop at {:.4g} Hz has |L| = {:.3f} and a phase "
        "margin of {:.1f} deg\n",
        one.name, measured.points.front().f, std::abs(L),
        std::remainder(std::arg(L) / deg + 180.0, 360.0));
    if (measured.current_limited) {
      fmt::print("  the current limit of {:g} A was reached: measured values are not linear\n",
                 sim::model::current_limit_of(machine, joint));
    }
  }
  return true;
}

void print_toml(char axis, const sim::frequency::Gains& gains) {
  fmt::print("\n[machine_override.axis.{}]\n", axis);
  fmt::print("Kv = \"{:.4g} 1/s\"\n", gains.Kv);
  fmt::print("velocity_bandwidth = \"{:.4g} rad/s\"\n", gains.wv);
  fmt::print("velocity_reset_time_ms = {:.4g}\n", gains.Tn / ms);
}

std::string to_json(const sim::frequency::Assessment& a) {
  sim::system::JsonObject out;
  out.number("velocity_bandwidth_rad_per_s", a.gains.wv).number("reset_time_s", a.gains.Tn);
  out.number("Kv_per_s", a.gains.Kv).boolean("stable", a.stable);
  // an unstable axis has no margins and no step
  const auto known = [&](double value) { return a.stable ? value : std::nan(""); };
  out.number("velocity_gain_margin", known(a.velocity.gain));
  out.number("velocity_phase_margin_deg", known(a.velocity.phase / deg));
  out.number("position_gain_margin", known(a.position.gain));
  out.number("position_phase_margin_deg", known(a.position.phase / deg));
  out.number("bandwidth_Hz", known(a.closed.bandwidth));
  out.number("overshoot", known(a.overshoot));
  return out.number("load_peak_SI", known(a.load_peak)).line();
}

std::string to_json(char axis, const sim::frequency::Tuning& t, double common_Kv) {
  sim::system::JsonObject out;
  out.text("axis", std::string(1, axis));
  out.raw("before", to_json(t.before)).raw("after", to_json(t.after));
  out.number("Kv_limit_per_s", t.Kv_limit).number("common_Kv_per_s", common_Kv);
  return out.line();
}

// The velocity gain of all axes, and the axis that asks for it.
struct CommonKv {
  double value = 0.0;  // 1/s
  char axis = 0;
};

struct TunedAxis {
  const sim::model::MachineSettings& machine;
  int joint;
  Tick delay;  // of the reading
  const sim::frequency::Tuning& tuning;
  double own_Kv;  // 1/s, before the common one
};

// Prints by what the gains of an axis are limited.
void print_limits(const TunedAxis& axis, const sim::frequency::TuneSettings& wanted,
                  const CommonKv& common) {
  const sim::frequency::Tuning& t = axis.tuning;
  const plant::FeedDriveParams& drive = sim::model::drive_of(axis.machine, axis.joint);
  fmt::print("{}\n\n", axis_headline(axis.machine, axis.joint, axis.delay));
  fmt::print("  wv = {:.4g} rad/s: limited by {}\n", t.after.gains.wv,
             reason(t.velocity, wanted, drive, "velocity"));
  fmt::print("  Tn = {:.4g} ms: {:g} / wv, which costs {:.0f} deg of phase at wv\n",
             t.after.gains.Tn / ms, wanted.reset_ratio, std::atan(1.0 / wanted.reset_ratio) / deg);
  fmt::print("  Kv = {:.4g} 1/s: limited by {}\n", axis.own_Kv,
             reason(t.position, wanted, drive, "position"));
  if (t.wv_lowered > 0.0 || t.Kv_lowered > 0.0) {
    fmt::print(
        "  Both are {:.2g} % and {:.2g} % lower than first found, to keep the requested margins\n",
        100.0 * t.wv_lowered, 100.0 * t.Kv_lowered);
  }
  if (t.calmer_wv > 0.0) {
    fmt::print(
        "  A lower bandwidth allows more: at wv = {:.3g} rad/s the margins of the position loop "
        "allow "
        "Kv = {:.3g} 1/s; see --velocity-bandwidth\n",
        t.calmer_wv, t.calmer_Kv);
  }
  if (wanted.bandwidth && t.position.kind != sim::frequency::Limit::Kind::bandwidth) {
    fmt::print("  The bandwidth of {:g} Hz is not reached.\n", *wanted.bandwidth);
  }
  if (axis.own_Kv > common.value) {
    fmt::print("  Kv = {:.4g} 1/s, equal for interpolating axes: that of axis {}\n", common.value,
               common.axis);
  }
  if (!sim::frequency::keeps(t.after, wanted)) {
    fmt::print(
        "  With the common Kv the axis does NOT keep the requested margins: see the table.\n");
  }
  fmt::print("\n");
}

struct TunedAxes {
  std::vector<sim::frequency::Tuning> tunings;
  std::vector<double> own_Kv;  // 1/s, before the common one
  CommonKv common;
};

TunedAxes tuned_axes(const sim::model::MachineSettings& machine, const std::vector<int>& joints,
                     Tick delay, const sim::frequency::TuneSettings& wanted) {
  TunedAxes out;
  Stage axes("axes", static_cast<double>(joints.size()));
  for (const int joint : joints) {
    out.tunings.push_back(sim::frequency::tune(machine, joint, delay, wanted));
    out.own_Kv.push_back(out.tunings.back().after.gains.Kv);
    axes.advance();
  }
  const auto slowest = std::min_element(out.own_Kv.begin(), out.own_Kv.end());
  out.common = {*slowest, sim::model::layout_of(machine).letter_of(
                              joints[static_cast<std::size_t>(slowest - out.own_Kv.begin())])};
  for (std::size_t k = 0; k < joints.size(); ++k) {
    sim::frequency::Tuning& one = out.tunings[k];
    if (joints.size() > 1) {
      one = sim::frequency::with_common_Kv(machine, joints[k], delay, one, out.common.value);
    }
    if (!one.after.stable) throw std::logic_error("tuned gains are not stable");
  }
  return out;
}

void add_tune_options(Options& options) {
  add_axis_options(options);
  const auto text = [] { return po::value<std::string>(); };
  options.add()("phase-margin", text()->default_value("60 deg")->value_name("\"60 deg\""),
                "minimum for both loops; a bare number is in deg");
  options.add()("gain-margin", text()->default_value("8 dB")->value_name("\"8 dB\""),
                "minimum for both loops; a bare number is in dB");
  options.add()("overshoot", text()->default_value("5 %")->value_name("\"5 %\""),
                "maximum after a step of the setpoint without feed-forward; a bare number is in %");
  options.add()(
      "bandwidth", text()->value_name("\"50 Hz\""),
      "bandwidth of the closed position loop (-3 dB), which limits Kv; a bare number is in Hz");
  options.add()("velocity-bandwidth", po::value<std::string>()->value_name("\"300 rad/s\""),
                "upper limit; a bare number is in rad/s");
  options.add()("reset-ratio", po::value<double>()->default_value(4.0)->value_name("N"),
                "reset time times velocity bandwidth");
  options.add()("json", "prints a JSON list, one object per axis");
}

}  // namespace

int tune_command(const Arguments& arguments) {
  Options options(
      "tune", "SCENARIO.toml --axis Y|all [--phase-margin 60] [--gain-margin 8]",
      "Finds gains for an axis on the exact multirate model: first the largest velocity bandwidth\n"
      "that keeps the phase and gain margins of the velocity loop (its reset time follows from\n"
      "it), then the largest Kv that keeps the margins of the position loop and the overshoot.\n"
      "Reports the limiting criterion, the changes and the result of a simulation of the whole\n"
      "axis, and prints the lines for the scenario. Several axes get a common Kv, the smallest,\n"
      "as interpolation requires.",
      "SCENARIO.toml");
  add_tune_options(options);
  if (!options.parse(arguments)) return kDone;

  ProgressLine line(options);
  const sim::frequency::TuneSettings wanted = settings_of(options);
  const auto scenario = scenario_for_axes(options);
  const sim::model::MachineSettings& machine = sim::model::machine_of(*scenario);
  const auto joints = chosen_joints(options, machine);
  const Tick delay = sim::frequency::reading_delay_of(*scenario);
  const TunedAxes tuned = tuned_axes(machine, joints, delay, wanted);
  if (options.has("json")) {
    JsonList list;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      list.add(to_json(sim::model::layout_of(machine).letter_of(joints[k]), tuned.tunings[k],
                       tuned.common.value));
    }
    list.end();
    return kDone;
  }
  bool confirmed = true;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const TunedAxis axis = {machine, joints[k], delay, tuned.tunings[k], tuned.own_Kv[k]};
    {
      const auto hidden = line.hidden();
      if (k > 0) fmt::print("\n");
      print_limits(axis, wanted, tuned.common);
      print_table(axis.tuning, axis.joint);
      fmt::print("\n");
    }
    confirmed &=
        confirm(*sim::frequency::shared_with_gains(machine, axis.joint, axis.tuning.after.gains),
                axis.joint, delay, axis.tuning.after, line);
  }
  line.end();
  for (std::size_t k = 0; k < joints.size(); ++k) {
    print_toml(sim::model::layout_of(machine).letter_of(joints[k]), tuned.tunings[k].after.gains);
  }
  if (joints.size() == 1) {
    fmt::print("\nInterpolating axes need equal Kv: --axis all finds the common one.\n");
  }
  return confirmed ? kDone : kMachineStopped;
}

}  // namespace servomill::tools
