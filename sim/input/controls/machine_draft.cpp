#include "sim/input/controls/machine_draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "sim/config/document.h"
#include "sim/input/machine_description.h"

namespace servomill::sim::input {
namespace {

constexpr double kPathTolerance = 10 * um;  // as of a machine file without one
constexpr std::size_t kComment = 38;        // column

// Keys in which each control has the largest velocity and acceleration of an axis.
std::string velocity_key(ControlKind kind, Axis axis) {
  const char small = static_cast<char>(letter(axis) - 'A' + 'a');
  switch (kind) {
    case ControlKind::linuxcnc:
      return fmt::format("[AXIS_{}] MAX_VELOCITY", letter(axis));
    case ControlKind::grbl:
      return fmt::format("$11{}", index_of(axis));
    case ControlKind::fluidnc:
      return fmt::format("axes/{}/max_rate_mm_per_min", small);
    case ControlKind::rrf:
      return fmt::format("M203 {}", letter(axis));
  }
  return {};
}

std::string acceleration_key(ControlKind kind, Axis axis) {
  const char small = static_cast<char>(letter(axis) - 'A' + 'a');
  switch (kind) {
    case ControlKind::linuxcnc:
      return fmt::format("[AXIS_{}] MAX_ACCELERATION", letter(axis));
    case ControlKind::grbl:
      return fmt::format("$12{}", index_of(axis));
    case ControlKind::fluidnc:
      return fmt::format("axes/{}/acceleration_mm_per_sec2", small);
    case ControlKind::rrf:
      return fmt::format("M201 {}", letter(axis));
  }
  return {};
}

// A basic string of TOML.
std::string toml_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + '"';
}

// Writes a machine file line by line.
class Draft {
 public:
  Draft(const ControlSettings& settings, const DraftChoices& choices)
      : settings_(settings), choices_(choices) {}

  MachineDraft write() {
    leave_out_axes();
    refuse_incomplete();
    out_.text = fmt::format("# From {} ({}), by servomill machine from.\n", settings_.file,
                            kControlKinds[static_cast<std::size_t>(settings_.kind)]);
    line("name = " + toml_text(settings_.name), "");
    line("source = " + toml_text(settings_.file), "");
    write_structure();
    write_nc();
    for (const auto& [axis, limits] : axes_) write_axis(axis, limits);
    for (const std::string& note : settings_.notes) out_.text += fmt::format("# {}\n", note);
    out_.notes.insert(out_.notes.end(), settings_.notes.begin(), settings_.notes.end());
    return std::move(out_);
  }

 private:
  // "line 12", of another file than that of the settings "inch_base.inc:12".
  std::string place_text(const Place& place) const {
    return place.file == settings_.file ? fmt::format("line {}", place.line)
                                        : fmt::format("{}:{}", place.file, place.line);
  }

  std::string cited(const CitedValue& value) const {
    return fmt::format("{}, {}", value.key, place_text(value.place));
  }

  void line(const std::string& text, const std::string& comment) {
    out_.text +=
        comment.empty() ? text + '\n' : fmt::format("{:<{}}  # {}\n", text, kComment, comment);
  }

  // A value that the settings do not give.
  void assumed(const std::string& text, const std::string& why) {
    line(text, "assumed: " + why);
    out_.assumptions.push_back(fmt::format("{}: {}", text, why));
  }

  // Leaves out those that a structure which is given lacks.
  void leave_out_axes() {
    axes_ = settings_.axes;
    if (choices_.structure.empty()) return;
    const JointLayout layout =
        plant::parse_structure(choices_.structure, {"--structure", 1, 1}).layout();
    for (const auto& [axis, limits] : settings_.axes) {
      if (layout.joint_of(axis)) continue;
      axes_.erase(axis);
      out_.notes.push_back(fmt::format("axis {} is omitted: not in the structure", letter(axis)));
    }
  }

  void refuse_incomplete() const {
    std::vector<Fault> faults;
    if (axes_.empty()) faults.push_back({{settings_.file}, "has no limits of an axis"});
    constexpr int kMaxRotary = 2;
    if (std::count_if(axes_.begin(), axes_.end(),
                      [](const auto& one) { return !is_linear(one.first); }) > kMaxRotary) {
      faults.push_back(
          {{settings_.file},
           "has three rotary axes, but at most two are supported: choose them with --structure"});
    }
    for (const auto& one : axes_) {
      const auto need = [&](const std::optional<CitedValue>& value, const char* what,
                            const std::string& key) {
        if (value) return;
        faults.push_back(
            {{settings_.file},
             fmt::format("does not give the {} of {}: {}", what, letter(one.first), key)});
      };
      need(one.second.v_max, "largest velocity", velocity_key(settings_.kind, one.first));
      need(one.second.a_max, "largest acceleration", acceleration_key(settings_.kind, one.first));
    }
    if (!faults.empty()) throw InputError(std::move(faults));
  }

  // Rotary axes in the table, one upon the other, where nothing names the kinematics.
  void write_structure() {
    const auto entry = [](const std::string& structure) {
      return fmt::format("structure = {}", toml_text(structure));
    };
    if (!choices_.structure.empty()) {
      line(entry(choices_.structure), "as given");
      return;
    }
    if (!settings_.structure.empty()) {
      line(entry(settings_.structure), settings_.structure_reason);
      return;
    }
    std::string table, tool;
    for (const auto& [axis, limits] : axes_) {
      if (is_linear(axis)) {
        tool += fmt::format(" {}", letter(axis));
      } else {
        table = fmt::format(" {}'{}", letter(axis), table);
      }
    }
    const bool has_rotary = !table.empty();
    assumed(entry(fmt::format("[w{} b{} (C1) t]", table, tool)),
            has_rotary ? "rotary axes in the table; it matters for TCP control and errors, not for "
                         "limits of axes"
                       : "the spindle moves; it does not matter for limits of axes");
  }

  void write_nc() {
    line("\n[nc]", "");
    switch (settings_.kind) {
      case ControlKind::linuxcnc:
        line("reader = \"linuxcnc\"", "");
        break;
      case ControlKind::grbl:
      case ControlKind::fluidnc:
        line("reader = \"grbl\"", "");
        break;
      case ControlKind::rrf:
        break;
    }
    line("decimal_point = \"calculator\"", "X10 is 10 mm");
    const auto tolerance = [](double value) {
      return fmt::format("path_tolerance_um = {:.6g}", value / um);
    };
    if (choices_.path_tolerance) {
      line(tolerance(*choices_.path_tolerance), "as given");
    } else if (settings_.path_tolerance) {
      line(tolerance(settings_.path_tolerance->value), cited(*settings_.path_tolerance));
    } else {
      assumed(tolerance(kPathTolerance), "deviation at corners, where the program has no G64 P");
    }
    if (settings_.spindle_time) {
      line(fmt::format("spindle_time_s = {:.6g}", settings_.spindle_time->value),
           cited(*settings_.spindle_time));
    }
    if (settings_.period) {
      out_.text +=
          fmt::format("# period of the setpoints: {:.6g} ms ({}); a simulation needs drives, too\n",
                      settings_.period->value / ms, cited(*settings_.period));
    }
  }

  void write_travel(Axis axis, const ControlAxis& limits) {
    const double unit = usual_unit(axis);
    const std::string key = is_linear(axis) ? "travel_mm" : "travel_deg";
    const bool is_empty =
        limits.lower && limits.upper && !(limits.lower->value < limits.upper->value);
    if (is_empty) {
      const std::string note =
          fmt::format("{} of {}: {:g} ... {:g} is no travel ({})", key, letter(axis),
                      limits.lower->value / unit, limits.upper->value / unit, cited(*limits.upper));
      out_.text += fmt::format("# {}\n", note);
      out_.notes.push_back(note);
      return;
    }
    if (limits.lower && limits.upper) {
      const bool is_same = limits.lower->key == limits.upper->key;
      line(fmt::format("{} = [{:.9g}, {:.9g}]", key, limits.lower->value / unit,
                       limits.upper->value / unit),
           is_same ? cited(*limits.upper)
                   : fmt::format("{}; {}", cited(*limits.lower), cited(*limits.upper)));
      return;
    }
    const std::string one = limits.lower   ? ", but the lower end (" + cited(*limits.lower) + ")"
                            : limits.upper ? ", but the upper end (" + cited(*limits.upper) + ")"
                                           : "";
    out_.text += fmt::format("# {}: not given{}\n", key, one);
    out_.notes.push_back(fmt::format("{}: travel not given{}", letter(axis), one));
  }

  void write_axis(Axis axis, const ControlAxis& limits) {
    out_.text += fmt::format("\n[axis.{}]\n", letter(axis));
    write_travel(axis, limits);
    const double unit = usual_unit(axis);
    const char* name = is_linear(axis) ? "mm" : "deg";
    const auto value = [&](const char* key, double si, const char* per) {
      return fmt::format("{} = \"{:.9g} {}/{}\"", key, si / unit, name, per);
    };
    const bool is_per_second = settings_.kind == ControlKind::linuxcnc;
    line(value("v_max", limits.v_max->value * (is_per_second ? 1.0 : minute),
               is_per_second ? "s" : "min"),
         cited(*limits.v_max));
    line(value("a_max", limits.a_max->value, "s^2"), cited(*limits.a_max));
    write_jerk(limits, value);
    const std::string travel = limits.lower && limits.upper
                                   ? fmt::format("{:g} ... {:g} {}, ", limits.lower->value / unit,
                                                 limits.upper->value / unit, name)
                                   : "";
    out_.axes.push_back(fmt::format("{}: {}{:g} {}/min, {:g} {}/s^2", letter(axis), travel,
                                    limits.v_max->value / unit * minute, name,
                                    limits.a_max->value / unit, name));
  }

  template <class Value>
  void write_jerk(const ControlAxis& limits, const Value& value) {
    if (limits.j_max) {
      line(value("j_max", limits.j_max->value, "s^3"), cited(*limits.j_max));
      return;
    }
    const double time = choices_.acceleration_time.value_or(settings_.acceleration_time);
    const std::string text = value("j_max", limits.a_max->value / time, "s^3");
    if (choices_.acceleration_time) {
      line(text, fmt::format("acceleration rises within {:g} ms, as given", time / ms));
      return;
    }
    line(text, fmt::format("assumed: acceleration rises within {:g} ms", time / ms));
    if (is_jerk_assumed_) return;
    is_jerk_assumed_ = true;
    out_.assumptions.push_back(fmt::format(
        "j_max: acceleration rises within {:g} ms, as {}; change it with --acceleration-time",
        time / ms, settings_.acceleration_reason));
  }

  const ControlSettings& settings_;
  const DraftChoices& choices_;
  std::map<Axis, ControlAxis> axes_;  // that are written
  MachineDraft out_;
  bool is_jerk_assumed_ = false;
};

}  // namespace

MachineDraft machine_draft(const ControlSettings& settings, const DraftChoices& choices) {
  MachineDraft out = Draft(settings, choices).write();
  described(config::Document::from_text(out.text, settings.file + ", as a machine"));
  return out;
}

}  // namespace servomill::sim::input
