// The survey of a program as one JSON object.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/programs/program_survey.h"
#include "sim/system/json.h"

namespace servomill::sim::programs {
namespace {

// A number in the unit of its key, or null.
std::string number_or_null(const std::optional<double>& value, double unit) {
  return value ? system::json_number(*value / unit) : "null";
}

// null for line 0, which is none.
std::string line_or_null(int line) { return line > 0 ? std::to_string(line) : "null"; }

// Line 0 in a list means that the control starts with the word.
std::string uses_json(const std::vector<FirstUse>& uses) {
  std::vector<std::string> out;
  for (const FirstUse& use : uses) {
    out.push_back(
        system::JsonObject().text("word", use.word).raw("line", line_or_null(use.line)).line());
  }
  return system::json_list(out);
}

// Less than a picometre is rounding.
double rounded(double position) { return std::round(position * 1e9) / 1e9 + 0.0; }

std::string ranges_json(const AxisRanges& ranges) {
  system::JsonObject out;
  for (const Axis axis : kAllAxes) {
    const AxisRange& range = ranges[static_cast<std::size_t>(index_of(axis))];
    if (!range.is_known()) continue;
    const std::string ends[] = {system::json_number(rounded(range.lower / unit_of(axis))),
                                system::json_number(rounded(range.upper / unit_of(axis)))};
    out.raw(std::string(1, letter(axis)), system::json_list(ends));
  }
  return out.line();
}

std::string tools_json(const ProgramSurvey& survey) {
  std::vector<std::string> out;
  for (const auto& [number, tool] : survey.tools) {
    out.push_back(system::JsonObject()
                      .integer("number", number)
                      .integer("line", tool.first_line)
                      .boolean("in_table", tool.is_in_table)
                      .raw("length_mm", number_or_null(tool.length, mm))
                      .raw("diameter_mm", number_or_null(tool.diameter, mm))
                      .boolean("loaded", tool.is_loaded)
                      .boolean("uses_length", tool.uses_length)
                      .boolean("uses_diameter", tool.uses_diameter)
                      .line());
  }
  return system::json_list(out);
}

std::string extent_json(const ProgramSurvey& survey) {
  system::JsonObject work, unknown;
  for (const auto& [system, ranges] : survey.extent.work()) {
    work.raw(system_name(survey, system), system::JsonObject()
                                              .raw("motion", ranges_json(ranges.motion))
                                              .raw("feed", ranges_json(ranges.feed))
                                              .line());
  }
  for (const Axis axis : kAllAxes) {
    const auto i = static_cast<std::size_t>(index_of(axis));
    const int line = survey.extent.unknown_work(i), machine = survey.extent.unknown_machine(i);
    if (line == 0 && machine == 0) continue;
    unknown.raw(std::string(1, letter(axis)), system::JsonObject()
                                                  .raw("work", line_or_null(line))
                                                  .raw("machine", line_or_null(machine))
                                                  .line());
  }
  return system::JsonObject()
      .raw("work", work.line())
      .raw("machine", ranges_json(survey.extent.machine()))
      .raw("unknown_from_line", unknown.line())
      .raw("unknown_additional_offsets",
           fmt::format("[{}]", fmt::join(survey.unknown_systems, ", ")))
      .raw("tcp_controlled_from_line", line_or_null(survey.tcp_controlled))
      .line();
}

std::string unknown_moves_json(const CycleTime& time) {
  std::vector<std::string> out;
  for (const auto& [whose, lines] : time.unknown_moves) {
    out.push_back(system::JsonObject()
                      .text("of", whose)
                      .raw("lines", fmt::format("[{}]", fmt::join(lines, ", ")))
                      .line());
  }
  return system::json_list(out);
}

// A time without the moves that are not known is a lower bound.
std::string cycle_time_json(const ProgramSurvey& survey) {
  if (!survey.cycle_time) return "null";
  const CycleTime& time = *survey.cycle_time;
  const bool is_counted = time.why_unknown.empty();
  const bool is_known = is_counted && time.unknown_moves.empty();
  return system::JsonObject()
      .text("machine", time.machine)
      .raw("s", is_known ? system::json_number(time.duration) : "null")
      .raw("at_least_s", is_counted ? system::json_number(time.duration) : "null")
      .text_or_null("why_unknown", time.why_unknown)
      .raw("unknown_moves", unknown_moves_json(time))
      .raw("left_out_lines", fmt::format("[{}]", fmt::join(time.left_out, ", ")))
      .integer("unknown_dwells", time.unknown_dwells)
      .line();
}

std::string readers_json(const ProgramSurvey& survey) {
  system::JsonObject out;
  for (const ReaderVerdict& one : survey.readers) {
    system::JsonObject verdict;
    verdict.boolean("reads", !one.stop);
    if (one.stop) {
      const Place& place = one.stop->place;
      verdict.text("file", place.file)
          .integer("line", place.line)
          .integer("column", place.column)
          .text("why", one.stop->message);
    }
    out.raw(one.reader, verdict.line());
  }
  return out.line();
}

}  // namespace

std::string to_json(const ProgramSurvey& survey) {
  return system::JsonObject()
      .text("file", survey.file)
      .raw("units", uses_json(survey.units))
      .raw("work_offsets", uses_json(survey.work_systems))
      .raw("offsets_changed_by", uses_json(survey.shifts))
      .raw("tools", tools_json(survey))
      .raw("extent", extent_json(survey))
      .raw("cycle_time", cycle_time_json(survey))
      .integer("tool_changes", survey.tool_changes)
      .integer("stops", survey.stops)
      .raw("readers", readers_json(survey))
      .raw("first_fault_line", line_or_null(survey.read_to))
      .line();
}

}  // namespace servomill::sim::programs
