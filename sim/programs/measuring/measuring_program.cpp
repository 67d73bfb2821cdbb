#include "sim/programs/measuring/measuring_program.h"

#include <fmt/format.h>

#include <cmath>

#include "controllers/gcode/number_text.h"
#include "controllers/gcode/probing.h"
#include "controllers/gcode/program_setup.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/programs/verification/linuxcnc_replay.h"
#include "sim/programs/verification/readings.h"
#include "sim/system/write_file.h"

namespace servomill::sim::programs {
namespace {

using controllers::ActionKind;
using controllers::fixed_text;
using controllers::MachineAction;

constexpr int kProgramNumber = 7001;  // Fanuc: O
constexpr double kResolution = 1e-6;  // m
constexpr int kDecimals = 3;
constexpr std::string_view kFile = "written";

std::vector<std::string> header(const MeasuringMoves& moves, const ProbingSettings& settings,
                                double length) {
  return {fmt::format("{} touches of spheres of {:g} mm with a stylus of {:g} mm", moves.touches,
                      settings.sphere / mm, settings.stylus / mm),
          fmt::format("T1: the probe, {:g} mm from the spindle nose to the centre of its ball",
                      length / mm),
          "G54: the zero of the machine; positions are those of the centre of the ball",
          fmt::format("readings.toml of kind touch: Z as put out here plus {:g} mm", length / mm)};
}

double unit_of(int axis) { return axis < kLinearJoints ? mm : deg; }

// LinuxCNC, with a log of the touches: X Y Z as #5061 to #5063. The message before the first touch
// of a sphere names the touches of a simulated run, too.
class LinuxCncText {
 public:
  explicit LinuxCncText(const model::MachineSettings& machine)
      : retract_("G53 G0 Z" + fixed_text(machine.nc.upper[2] / mm, kDecimals)) {}

  std::string print(const MeasuringMoves& moves, const ProbingSettings& settings, double length) {
    for (const std::string& line : header(moves, settings, length))
      put("(" + plain(line, false) + ")");
    put("(LOGOPEN,touches.txt)");
    put("G17 G21 G40 G49 G54 G61.1 G80 G90 G94");
    put(retract_);
    put("T1 M6");
    put("G43 H1");
    put("M5");
    put("F" + fixed_text(settings.feed / mm_per_min, kDecimals));
    for (const MeasuringStep& step : moves.steps) put_step(step);
    put(retract_);
    put("(LOGCLOSE)");
    put("M2");
    return std::move(text_);
  }

 private:
  void put(const std::string& line) { text_ += line + "\n"; }

  void put_step(const MeasuringStep& step) {
    if (step.is_probe && step.sphere != sphere_) {
      sphere_ = step.sphere;
      put(fmt::format("(MSG,{})", plain(sphere_, false)));
    }
    std::string line = step.is_probe ? "G38.2" : "G0";
    for (int axis = 0; axis < kAxisWords; ++axis) {
      const auto& to = step.to[std::size_t(axis)];
      if (to)
        line += fmt::format(" {}{}", "XYZABC"[axis], fixed_text(*to / unit_of(axis), kDecimals));
    }
    put(line);
    if (step.is_probe) put(fmt::format("(LOG,#5061 #5062 #5063 {})", plain(step.sphere, false)));
  }

  std::string retract_, text_, sphere_;
};

DialectSettings settings_of(const model::MachineSettings& machine, Dialect dialect) {
  DialectSettings out;
  out.dialect = dialect;
  out.name = "MEASURE";
  out.program_number = kProgramNumber;
  out.resolution = kResolution;
  out.work_offset.fill(AxisWords::Zero());
  out.retract_Z = machine.nc.upper[2];
  out.has_rotary_axes = true;
  out.axes.clear();
  for (const Axis axis : kAllAxes) {
    const auto joint = machine.chain.layout.joint_of(axis);
    if (!joint) continue;
    out.axes.push_back(axis);
    if (is_linear(axis)) continue;
    out.is_endless[std::size_t(index_of(axis) - kLinearJoints)] = machine.nc.is_endless(*joint);
  }
  return out;
}

DialectMotion motion_of(const MeasuringStep& step, const ProbingSettings& settings) {
  DialectMotion out;
  out.is_rapid = !step.is_probe;
  for (int axis = 0; axis < kAxisWords; ++axis) {
    const auto& to = step.to[std::size_t(axis)];
    if (to) out.words.emplace_back(kAllAxes[std::size_t(axis)], *to / unit_of(axis));
  }
  out.feed = settings.feed / mm_per_min;
  out.length = out.tool = 1;
  return out;
}

MeasuringProgram other_dialect(const MeasuringMoves& moves, const DialectSettings& dialect,
                               const ProbingSettings& settings, double length) {
  std::vector<std::string> lines;
  const auto printer = make_dialect(dialect, lines);
  printer->begin_report();
  printer->begin(header(moves, settings, length));
  printer->tool(1, 0.0, 1);
  printer->spindle(0, 0.0, true);
  if (dialect.dialect != Dialect::heidenhain) printer->path_mode(PathMode::exact_stop, 0.0);
  DialectMotion now;  // X, Y and Z
  now.words = {{Axis::X, 0.0}, {Axis::Y, 0.0}, {Axis::Z, 0.0}};
  for (const MeasuringStep& step : moves.steps) {
    const DialectMotion motion = motion_of(step, settings);
    if (step.is_probe) {
      printer->probe(motion, now);
      printer->report_touch();
      continue;
    }
    printer->motion(motion);
    for (const auto& [axis, value] : motion.words) {
      if (is_linear(axis)) now.words[std::size_t(index_of(axis))].second = value;
    }
  }
  printer->retract();
  printer->end_report();
  printer->end();
  return {printer->text(), printer->assumptions()};
}

// The moves as a control has read them, beside those that were meant.
class MeasuringComparison {
 public:
  MeasuringComparison(const MeasuringMoves& moves, const ProbingSettings& settings, double length,
                      bool feeds_by_table)
      : moves_(moves), settings_(settings), length_(length), feeds_by_table_(feeds_by_table) {}

  void compare(const std::vector<MachineAction>& actions, const std::string& settings) {
    reading_ = settings;
    at_ = 0;
    now_ = {};
    bool has_ended = false;
    for (const MachineAction& action : actions) {
      if (action.kind == ActionKind::spindle && action.direction != 0) {
        fail(action, "rotates the spindle, which holds the probe");
      }
      has_ended = has_ended || action.kind == ActionKind::end;
      if (is_motion(action.kind)) take(action);
    }
    if (at_ != moves_.steps.size()) {
      throw InputError({std::string(kFile)},
                       fmt::format("{}: {} of {} moves are missing", reading_,
                                   moves_.steps.size() - at_, moves_.steps.size()));
    }
    if (!has_ended) throw InputError({std::string(kFile)}, reading_ + ": has no end");
  }

 private:
  static bool is_motion(ActionKind kind) {
    return kind == ActionKind::rapid || kind == ActionKind::feed || kind == ActionKind::arc ||
           kind == ActionKind::probe;
  }

  [[noreturn]] void fail(const MachineAction& action, const std::string& message) const {
    throw InputError({std::string(kFile), action.line, 0}, reading_ + ": " + message);
  }

  // Machine coordinate of a step's word.
  double machine(int axis, double to) const { return axis == 2 ? to + length_ : to; }
  bool is_at(const std::optional<double>& end, int axis, double to) const {
    const double grid = axis < kLinearJoints ? kResolution : 1e-3 * deg;
    return end && std::abs(*end - machine(axis, to)) <= 0.51 * grid;
  }

  void take(const MachineAction& action) {
    if (action.is_machine_position || action.is_to_reference) return retract(action);
    if (at_ == moves_.steps.size()) fail(action, "moves after the last move");
    const MeasuringStep& step = moves_.steps[at_];
    if (feeds_by_table_ && step.is_probe && action.kind == ActionKind::rapid) return stay(action);
    ++at_;
    if (action.kind != (step.is_probe ? ActionKind::probe : ActionKind::rapid)) {
      fail(action, step.is_probe ? "moves without the probe armed" : "is no rapid");
    }
    for (int axis = 0; axis < kAxisWords; ++axis) compare_axis(action, step, axis);
    if (step.is_probe) return compare_feed(action);
    if (step.to[2] && action.tool_offset == 0) fail(action, "moves Z without the tool length");
  }

  void compare_axis(const MachineAction& action, const MeasuringStep& step, int axis) {
    const auto i = static_cast<std::size_t>(axis);
    if (action.is_commanded[i] != step.to[i].has_value()) {
      fail(action, fmt::format("{} {}", step.to[i] ? "does not move" : "moves", "XYZABC"[axis]));
    }
    if (!step.to[i]) return;
    if (!step.is_probe) {
      if (!is_at(action.end[i], axis, *step.to[i])) {
        fail(action, fmt::format("moves {} to another place", "XYZABC"[axis]));
      }
      now_[i] = step.to[i];
      return;
    }
    if (!feeds_by_table_) {
      if (is_at(action.end[i], axis, *step.to[i])) return;
      fail(action, fmt::format("probes along {} to another place", "XYZABC"[axis]));
    }
    if (!now_[i] || action.direction != (*step.to[i] > *now_[i] ? 1 : -1)) {
      fail(action, fmt::format("probes along {} in the other direction", "XYZABC"[axis]));
    }
  }

  void compare_feed(const MachineAction& action) const {
    if (feeds_by_table_) return;
    if (std::abs(action.feed - settings_.feed) > 1e-6 * settings_.feed) {
      fail(action, "probes at another feed");
    }
  }

  // Retracts Z in machine coordinates, nothing else.
  void retract(const MachineAction& action) const {
    for (int axis = 0; axis < kAxisWords; ++axis) {
      if (action.is_commanded[std::size_t(axis)] == (axis == 2)) continue;
      fail(action, "moves another axis than Z in machine coordinates");
    }
    if (action.kind != ActionKind::rapid) fail(action, "is no rapid");
  }

  // The control's move to where the probing begins, at which it stands already.
  void stay(const MachineAction& action) const {
    for (int axis = 0; axis < kLinearJoints; ++axis) {
      const auto& now = now_[std::size_t(axis)];
      if (now && is_at(action.end[std::size_t(axis)], axis, *now)) continue;
      fail(action, fmt::format("begins to probe at another {}", "XYZ"[axis]));
    }
  }

  const MeasuringMoves& moves_;
  const ProbingSettings& settings_;
  double length_;
  bool feeds_by_table_;
  std::string reading_;
  std::size_t at_ = 0;
  std::array<std::optional<double>, kAxisWords> now_;
};

std::vector<MachineAction> read_linuxcnc(const std::string& text,
                                         const model::MachineSettings& machine, double length) {
  controllers::ProgramSetup setup;
  controllers::ToolEntry probe;
  probe.number = 1;
  probe.offset[2] = length;
  setup.tools.add(probe);
  setup.probed = std::make_shared<controllers::AssumedContact>();
  for (int j = 0; j < kLinearJoints; ++j) setup.start[j] = machine.nc.upper[j];
  OriginalOptions options;
  options.layout = machine.chain.layout;
  return replay_linuxcnc(text, std::string(kFile), setup, options);
}

}  // namespace

MeasuringProgram measuring_program(const MeasuringMoves& moves,
                                   const model::MachineSettings& machine,
                                   const ProbingSettings& settings, double length,
                                   Dialect dialect) {
  if (dialect == Dialect::linuxcnc) {
    return {LinuxCncText(machine).print(moves, settings, length),
            {"the probe is wired to motion.probe-input"}};
  }
  return other_dialect(moves, settings_of(machine, dialect), settings, length);
}

void verify_measuring_program(const MeasuringProgram& program, const MeasuringMoves& moves,
                              const model::MachineSettings& machine,
                              const ProbingSettings& settings, double length, Dialect dialect) {
  MeasuringComparison comparison(moves, settings, length, dialect == Dialect::heidenhain);
  if (dialect == Dialect::linuxcnc) {
    comparison.compare(read_linuxcnc(program.text, machine, length), "LinuxCNC");
    return;
  }
  const DialectSettings own = settings_of(machine, dialect);
  controllers::ControlSetup setup;
  for (auto& offset : setup.work_offset) offset = AxisWords(AxisWords::Zero());
  setup.tool_length[1] = length;
  ReadingOptions options;
  options.resolution = kResolution;
  options.has_rotary_axes = true;
  options.is_endless = own.is_endless;
  for (const Reading& reading : readings_of(program.text, dialect, setup, options)) {
    comparison.compare(reading.read(), reading.settings);
  }
}

std::vector<std::string> write_measuring_program(const std::string& path,
                                                 const MeasuringMoves& moves,
                                                 const model::MachineSettings& machine,
                                                 const ProbingSettings& settings, double length,
                                                 Dialect dialect, bool force) {
  system::refuse_unwritable_text(path, force);
  MeasuringProgram program;
  try {
    program = measuring_program(moves, machine, settings, length, dialect);
  } catch (const Unsayable& unsayable) {
    throw InputError({path}, "cannot be written for this control: it " + unsayable.why);
  }
  verify_measuring_program(program, moves, machine, settings, length, dialect);
  system::write_text_file(path, program.text, force);
  return program.assumptions;
}

void write_touches(const std::string& folder, const MeasuringMoves& moves,
                   const model::MachineSettings& machine, const ProbingSettings& settings,
                   double length, bool force) {
  std::string names = "X_mm,Y_mm,Z_mm", rows;
  for (int j = kLinearJoints; j < kJoints; ++j) {
    if (machine.chain.layout.has(j))
      names += fmt::format(",{}_deg", machine.chain.layout.letter_of(j));
  }
  for (const MeasuringStep& step : moves.steps) {
    if (!step.is_probe) continue;
    rows += ",,";
    for (int j = kLinearJoints; j < kJoints; ++j) {
      if (machine.chain.layout.has(j)) rows += fmt::format(",{:g}", step.joints[j] / deg);
    }
    rows += "," + step.sphere + "\n";
  }
  const std::string name = fmt::format("{}/touches_{:g}", folder, length / mm);
  system::write_text_file(
      name + ".csv",
      fmt::format("# X, Y and Z of each touch as put out, Z plus {:g} mm\n{},sphere\n{}",
                  length / mm, names, rows),
      force);
  system::write_text_file(
      name + ".toml",
      fmt::format("# for readings.toml, in place of its groups of kind sphere\n[[group]]\nname = "
                  "\"touches, {0:g} mm\"\nkind = \"touch\"\nreadings = \"touches_{0:g}.csv\"\n"
                  "sphere_mm = {1:g}\nstylus_mm = {2:g}\npretravel = {{ waves = 3, size_um = 2 }}\n"
                  "point_mm = [0, 0, -{0:g}]\nuncertainty_um = 0.8\n",
                  length / mm, settings.sphere / mm, settings.stylus / mm),
      force);
}

std::string measuring_file(Dialect dialect, double length) {
  constexpr std::array<std::string_view, 4> kEnds = {"ngc", "h", "nc", "mpf"};
  return fmt::format("measure_{:g}.{}", length / mm, kEnds[static_cast<std::size_t>(dialect)]);
}

}  // namespace servomill::sim::programs
