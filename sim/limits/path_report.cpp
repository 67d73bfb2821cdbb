#include "sim/limits/path_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/units.h"
#include "sim/system/counted.h"
#include "sim/system/json.h"
#include "sim/system/text_table.h"

namespace servomill::sim::limits {
namespace {

using system::JsonObject;

// The lines that come nearest to their tolerance or leave it most, first.
std::vector<LineDeviation> worst_lines(const PathReport& report, std::size_t top) {
  std::vector<LineDeviation> out = report.lines;
  std::stable_sort(out.begin(), out.end(), [](const LineDeviation& a, const LineDeviation& b) {
    return a.factor() > b.factor();
  });
  out.resize(std::min(out.size(), top));
  return out;
}

double largest_of(const PathReport& report, double LineDeviation::*value) {
  double out = 0.0;
  for (const LineDeviation& one : report.lines) out = std::max(out, one.*value);
  return out;
}

std::string verdict(const PathReport& report) {
  const std::size_t beyond = report.lines_beyond();
  if (beyond == 0) return "within the tolerance";
  return fmt::format("beyond the tolerance in {}", system::counted(beyond, "line"));
}

std::string length_text(double x) { return fmt::format("{:.6f}", x / mm); }

}  // namespace

std::string to_text(const PathReport& report, std::size_t top) {
  std::string out =
      fmt::format("\nPath of {}: {}; {} passed, deviation {} mm at most (resolution +-{:.2g} mm)\n",
                  report.program, verdict(report), system::counted(report.corners, "corner"),
                  length_text(largest_of(report, &LineDeviation::deviation)), report.floor / mm);
  for (const std::string& note : report.notes) out += fmt::format("  note: {}\n", note);
  const std::vector<LineDeviation> shown = worst_lines(report, top);
  if (shown.empty()) return out;
  const bool has_rotary = std::any_of(
      shown.begin(), shown.end(), [](const LineDeviation& one) { return one.rotary.has_value(); });
  std::vector<std::vector<std::string>> rows = {
      {"line", "tolerance", "deviation", "at s", "corner at its end", "at s", "factor", ""}};
  if (has_rotary) rows.front().push_back("rotary deg");
  for (const LineDeviation& one : shown) {
    rows.push_back({std::to_string(one.line), length_text(one.tolerance) + " mm",
                    one.is_sampled() ? length_text(one.deviation) + " mm" : "",
                    one.is_sampled() ? fmt::format("{:.6g}", one.time) : "",
                    one.corner ? length_text(*one.corner) + " mm" : "",
                    one.corner ? fmt::format("{:.6g}", one.corner_time) : "",
                    fmt::format("{:.3f}", one.factor()), report.is_beyond(one) ? "beyond" : ""});
    if (has_rotary) rows.back().push_back(fmt::format("{:.6f}", one.rotary.value_or(0.0) / deg));
  }
  return out + '\n' + system::text_table(std::move(rows), 0, {0, 1, 2, 3, 4, 5, 6, 8});
}

std::string to_json(const PathReport& report, std::size_t top) {
  std::vector<std::string> lines, notes;
  for (const std::string& note : report.notes) notes.push_back(system::json_text(note));
  for (const LineDeviation& one : worst_lines(report, top)) {
    JsonObject line;
    line.integer("line", one.line)
        .number("tolerance_mm", one.tolerance / mm)
        .raw("deviation_mm", one.is_sampled() ? system::json_number(one.deviation / mm) : "null")
        .raw("time_s", one.is_sampled() ? system::json_number(one.time) : "null")
        .raw("corner_mm", one.corner ? system::json_number(*one.corner / mm) : "null")
        .raw("corner_time_s", one.corner ? system::json_number(one.corner_time) : "null")
        .raw("rotary_deg", one.rotary ? system::json_number(*one.rotary / deg) : "null")
        .number("factor", one.factor())
        .boolean("beyond", report.is_beyond(one));
    lines.push_back(line.line());
  }
  return JsonObject()
      .text("program", report.program)
      .boolean("within_tolerance", report.lines_beyond() == 0)
      .integer("lines_beyond", report.lines_beyond())
      .number("time_beyond_s", report.time_beyond)
      .number("deviation_mm", largest_of(report, &LineDeviation::deviation) / mm)
      .number("resolution_mm", report.floor / mm)
      .number("share_passed", report.passed)
      .integer("corners", report.corners)
      .raw("lines", system::json_list(lines))
      .raw("notes", system::json_list(notes))
      .line();
}

}  // namespace servomill::sim::limits
