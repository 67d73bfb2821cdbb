// The survey of a program as text.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/reader.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/programs/compensate/work_knowledge.h"
#include "sim/programs/program_survey.h"
#include "sim/system/counted.h"

namespace servomill::sim::programs {
namespace {

using controllers::translation::Language;

constexpr std::size_t kLabel = 15;  // columns

std::string_view unit_name(Axis axis) { return is_linear(axis) ? "mm" : "deg"; }

// "-1.000 ... 5.000 mm", or "5.000 mm" of an axis that stays there.
std::string in_units(const AxisRange& range, Axis axis) {
  const auto number = [&](double x) {
    const double scaled = x / unit_of(axis);
    return fmt::format("{:.3f}", std::abs(scaled) < 0.0005 ? 0.0 : scaled);
  };
  const std::string lower = number(range.lower), upper = number(range.upper);
  return lower == upper ? fmt::format("{} {}", lower, unit_name(axis))
                        : fmt::format("{} ... {} {}", lower, upper, unit_name(axis));
}

std::string in_time(double seconds) {
  constexpr double kMinute = 60.0, kHour = 3600.0;
  if (seconds < kMinute) return fmt::format("{:.1f} s", seconds);
  const double tenths = std::round(seconds * 10.0) / 10.0;
  const double hours = std::floor(tenths / kHour);
  const double minutes = std::floor((tenths - hours * kHour) / kMinute);
  const std::string rest =
      fmt::format("{:.0f} min {:.1f} s", minutes, tenths - hours * kHour - minutes * kMinute);
  return hours > 0.0 ? fmt::format("{:.0f} h {}", hours, rest) : rest;
}

std::string use_text(const FirstUse& use) {
  return use.line > 0 ? fmt::format("{} (line {})", use.word, use.line)
                      : fmt::format("{} (active at the start)", use.word);
}

class Text {
 public:
  void add(std::string_view label, const std::string& text) {
    out_ += fmt::format("  {:<{}}{}\n", label == last_ ? "" : label, kLabel, text);
    last_ = label;
  }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
  std::string last_;
};

std::string unit_sentence(const FirstUse& use) {
  const bool is_inch = use.word == "G20" || use.word == "BEGIN PGM INCH";
  return fmt::format("{}, {}", is_inch ? "inch" : "mm", use_text(use));
}

void add_units(const ProgramSurvey& survey, Text& text) {
  if (survey.language == Language::siemens) {
    return text.add("units", "those of its G70, G71, G700 and G710");
  }
  if (survey.units.empty()) {
    text.add("units", "no G20 or G21: unit of the control; mm is assumed");
  }
  for (const FirstUse& use : survey.units) text.add("units", unit_sentence(use));
  if (survey.units.size() > 1) text.add("units", "the program changes units");
}

void add_work_offsets(const ProgramSurvey& survey, Text& text) {
  std::vector<std::string> words;
  for (const FirstUse& use : survey.work_systems) words.push_back(use_text(use));
  text.add("work offsets", words.empty() ? "none" : fmt::format("{}", fmt::join(words, ", ")));
  for (const FirstUse& use : survey.shifts) {
    text.add("work offsets", fmt::format("changed by {}", use_text(use)));
  }
}

std::string tool_text(const SurveyedTool& tool, const ProgramSurvey& survey) {
  std::vector<std::string> parts;
  if (tool.length) parts.push_back(fmt::format("length {:g} mm", *tool.length / mm));
  if (tool.diameter) parts.push_back(fmt::format("diameter {:g} mm", *tool.diameter / mm));
  if (!tool.is_in_table) {
    parts.push_back(survey.has_tool_table ? "unknown: not in the tool table"
                                          : "unknown: no tool table given");
  }
  std::vector<std::string> uses;
  if (tool.is_loaded)
    uses.emplace_back(survey.language == Language::conversational ? "TOOL CALL" : "M6");
  if (tool.uses_length) uses.emplace_back("length");
  if (tool.uses_diameter) uses.emplace_back("diameter");
  const std::string needs = uses.empty() ? "" : fmt::format("; used: {}", fmt::join(uses, ", "));
  return fmt::format("{}{}", fmt::join(parts, ", "), needs);
}

void add_tools(const ProgramSurvey& survey, Text& text) {
  if (survey.tools.empty()) text.add("tools", "none");
  for (const auto& [number, tool] : survey.tools) {
    text.add("tools",
             fmt::format("T{} (line {}): {}", number, tool.first_line, tool_text(tool, survey)));
  }
}

void add_work_extent(const ProgramSurvey& survey, Text& text) {
  const ProgramExtent& extent = survey.extent;
  for (const auto& [system, ranges] : extent.work()) {
    const std::string label = survey.language == Language::conversational
                                  ? system_name(survey, system)
                                  : fmt::format("extent {}", system_name(survey, system));
    for (const Axis axis : kAllAxes) {
      const auto i = static_cast<std::size_t>(index_of(axis));
      if (!ranges.motion[i].is_known()) continue;
      const std::string feeds = ranges.feed[i].is_known()
                                    ? fmt::format("; feeds {}", in_units(ranges.feed[i], axis))
                                    : "";
      text.add(label,
               fmt::format("{} {}{}", letter(axis), in_units(ranges.motion[i], axis), feeds));
    }
  }
  for (const Axis axis : kAllAxes) {
    const auto i = static_cast<std::size_t>(index_of(axis));
    if (extent.unknown_work(i) == 0) continue;
    text.add("not in it", fmt::format("{} moves to an unknown position (line {})", letter(axis),
                                      extent.unknown_work(i)));
  }
  if (extent.tilted() > 0) {
    text.add("not in it", fmt::format("moves in a tilted work plane (line {})", extent.tilted()));
  }
}

// Options that give the machine coordinates of an axis.
std::string needed_options(const ProgramSurvey& survey, Axis axis) {
  std::vector<std::string> options;
  const auto is_ordinary = [](const auto& of_system) {
    return of_system.first < kAdditionalSystem;
  };
  const auto& systems = survey.extent.work();
  const bool has_ordinary =
      systems.empty() || std::any_of(systems.begin(), systems.end(), is_ordinary);
  if (has_ordinary || survey.unknown_systems.empty()) options.emplace_back("--work-offset");
  for (const int P : survey.unknown_systems) {
    if (is_linear(axis)) options.push_back(fmt::format("--additional-offset P{}", P));
  }
  if (axis == Axis::Z && survey.unknown_retract > 0) options.emplace_back("--machine");
  if (axis == Axis::Z) options.emplace_back("the tool lengths");
  if (survey.unknown_radius > 0 && is_linear(axis)) options.emplace_back("--tools");
  std::string text = options.front();
  for (std::size_t i = 1; i < options.size(); ++i) {
    text += (i + 1 == options.size() ? " and " : ", ") + options[i];
  }
  return text;
}

void add_machine_extent(const ProgramSurvey& survey, Text& text) {
  const ProgramExtent& extent = survey.extent;
  for (const Axis axis : kAllAxes) {
    const auto i = static_cast<std::size_t>(index_of(axis));
    if (extent.moved(i) == 0) continue;
    const AxisRange& range = extent.machine()[i];
    const std::string unknown =
        extent.unknown_machine(i) > 0
            ? fmt::format("{}unknown from line {} on: needs {}", range.is_known() ? "; " : "",
                          extent.unknown_machine(i), needed_options(survey, axis))
            : "";
    text.add("machine", fmt::format("{} {}{}", letter(axis),
                                    range.is_known() ? in_units(range, axis) : "", unknown));
  }
  if (survey.tcp_controlled == 0) return;
  text.add("machine", fmt::format("X, Y and Z unknown under TCP control and in a tilted plane "
                                  "(line {}): simulate them with a scenario",
                                  survey.tcp_controlled));
}

void add_cycle_time(const ProgramSurvey& survey, Text& text) {
  if (!survey.cycle_time) {
    text.add("cycle time", "unknown: needs --machine");
    return;
  }
  const CycleTime& time = *survey.cycle_time;
  if (!time.why_unknown.empty()) {
    text.add("cycle time", "unknown: " + time.why_unknown);
    return;
  }
  const char* least = time.unknown_moves.empty() ? "" : "unknown: at least ";
  text.add("cycle time", fmt::format("{}{} on {}", least, in_time(time.duration), time.machine));
  for (const auto& [whose, lines] : time.unknown_moves) {
    text.add("cycle time",
             fmt::format("the moves of {} are not known ({})", whose, system::line_numbers(lines)));
  }
  std::vector<std::string> without;
  if (!time.left_out.empty()) {
    without.push_back(fmt::format("{} from unknown positions ({})",
                                  system::counted(time.left_out.size(), "move"),
                                  system::line_numbers(time.left_out)));
  }
  if (time.unknown_dwells > 0) {
    without.push_back(system::counted(static_cast<std::size_t>(time.unknown_dwells), "dwell") +
                      " in an unknown unit");
  }
  if (survey.tool_changes > 0) {
    without.push_back(
        system::counted(static_cast<std::size_t>(survey.tool_changes), "tool change"));
  }
  if (survey.stops > 0) {
    without.push_back(system::counted(static_cast<std::size_t>(survey.stops), "stop"));
  }
  if (!without.empty()) {
    text.add("cycle time", fmt::format("without {}", fmt::join(without, ", ")));
  }
}

// Every control has a tool table of its own.
std::string tools_needed(const ProgramSurvey& survey) {
  if (survey.has_tool_table || survey.tools.empty()) return "";
  std::vector<std::string> names;
  for (const auto& [number, tool] : survey.tools) names.push_back(fmt::format("T{}", number));
  return fmt::format(" (with {} in its tool table)", fmt::join(names, ", "));
}

// The reader of programs in another language than G-code; nullopt: G-code.
std::optional<controllers::Reader> reader_of(Language language) {
  if (language == Language::conversational) return controllers::Reader::heidenhain;
  if (language == Language::siemens) return controllers::Reader::siemens;
  return std::nullopt;
}

void add_readers(const ProgramSurvey& survey, Text& text) {
  std::vector<std::string_view> names;
  for (const ReaderVerdict& one : survey.readers) {
    if (!one.stop) names.push_back(one.reader);
  }
  text.add("read by", names.empty()
                          ? "none of the controls"
                          : fmt::format("{}{}", fmt::join(names, ", "), tools_needed(survey)));
  for (const ReaderVerdict& one : survey.readers) {
    if (!one.stop) continue;
    const auto own = reader_of(survey.language);
    if (own && one.reader != controllers::kReaders[static_cast<std::size_t>(*own)]) continue;
    text.add("not read by",
             fmt::format("{}: {}: {}", one.reader, to_string(one.stop->place), one.stop->message));
  }
  if (survey.language == Language::gcode) return;
  text.add("not read by",
           fmt::format("controls for G-code: this is {}", survey.language == Language::siemens
                                                              ? "a Siemens program"
                                                              : "Heidenhain conversational"));
}

}  // namespace

std::string to_text(const ProgramSurvey& survey) {
  Text text;
  if (survey.read_to > 0) {
    text.add("read", fmt::format("up to line {}, which has the first fault", survey.read_to));
  }
  add_units(survey, text);
  add_work_offsets(survey, text);
  add_tools(survey, text);
  add_work_extent(survey, text);
  add_machine_extent(survey, text);
  add_cycle_time(survey, text);
  add_readers(survey, text);
  return text.take();
}

}  // namespace servomill::sim::programs
