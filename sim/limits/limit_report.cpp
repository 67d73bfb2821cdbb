// Recorded motion against the limits of a machine, as text and as JSON.
#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/units.h"
#include "sim/limits/limit_check.h"
#include "sim/model/machine.h"
#include "sim/system/counted.h"
#include "sim/system/json.h"
#include "sim/system/text_table.h"

namespace servomill::sim::limits {
namespace {

using system::JsonObject;

// Unit in which a limit is printed.
struct PrintedUnit {
  const char* name;
  double factor;  // SI
};

PrintedUnit unit_of(const LimitResult& one) {
  const bool is_linear_joint = one.joint < kLinearJoints;
  constexpr std::array<PrintedUnit, 4> kLinear = {
      PrintedUnit{"", 1.0}, {"mm/min", mm / minute}, {"mm/s^2", mm}, {"mm/s^3", mm}};
  constexpr std::array<PrintedUnit, 4> kRotary = {
      PrintedUnit{"", 1.0}, {"deg/min", deg / minute}, {"deg/s^2", deg}, {"deg/s^3", deg}};
  return (is_linear_joint ? kLinear : kRotary)[static_cast<std::size_t>(one.order)];
}

std::string line_text(int line) { return line > 0 ? std::to_string(line) : ""; }

std::string beyond_text(const LimitResult& one) {
  if (!one.is_evaluated()) return "not evaluated";
  if (!one.is_resolved) return "not resolved";
  if (!one.excesses.empty()) {
    return fmt::format("{}, {:.4g} s", system::counted(one.excesses.size(), "time"),
                       one.time_beyond);
  }
  return one.largest > 1.001 * one.limit ? "not certain" : "never";
}

// A number of an evaluation; "-" where there was none.
std::string evaluated(const LimitResult& one, std::string text) {
  return one.is_evaluated() ? std::move(text) : "-";
}

std::string evaluated_json(const LimitResult& one, double value) {
  return one.is_evaluated() ? system::json_number(value) : "null";
}

std::string within_json(const LimitReport& report) {
  const std::optional<bool> is_within = report.is_within();
  if (!is_within) return "null";
  return *is_within ? "true" : "false";
}

}  // namespace

std::string to_text(const LimitReport& report, std::size_t top) {
  std::string out =
      fmt::format("{} on {}: {} in {:.6g} s, every {:.6g} ms\n", report.log, report.machine,
                  system::counted(report.samples, "sample"), report.duration, report.period / ms);
  for (const std::string& note : report.notes) out += fmt::format("  note: {}\n", note);
  std::vector<std::vector<std::string>> rows = {{"axis", "", "limit", "largest", "unit", "factor",
                                                 "at s", "line", "beyond the limit", "window",
                                                 "resolution"}};
  for (const LimitResult& one : report.results) {
    const PrintedUnit unit = unit_of(one);
    rows.push_back({std::string(1, report.layout.letter_of(one.joint)),
                    std::string(kLimited[static_cast<std::size_t>(one.order)]),
                    fmt::format("{:.6g}", one.limit / unit.factor),
                    evaluated(one, fmt::format("{:.6g}", one.largest / unit.factor)), unit.name,
                    evaluated(one, fmt::format("{:.3f}", one.factor())),
                    evaluated(one, fmt::format("{:.6g}", one.time)), line_text(one.line),
                    beyond_text(one), fmt::format("{:.4g} ms", one.window / ms),
                    evaluated(one, fmt::format("+-{:.2g} %", 100.0 * one.floor / one.limit))});
  }
  out += '\n' + system::text_table(std::move(rows), 1, {2, 3, 5, 6, 7, 9, 10});
  for (const LimitResult& one : report.results) {
    const std::size_t shown = std::min(one.excesses.size(), top);
    for (std::size_t k = 0; k < shown; ++k) {
      const Excess& excess = one.excesses[k];
      const std::string where =
          excess.line > 0 ? fmt::format(", line {}", excess.line) : std::string();
      out += fmt::format("{}{} of {}: {:.3f} times the limit from {:.6g} to {:.6g} s{}\n",
                         k == 0 ? "\n" : "", kLimited[static_cast<std::size_t>(one.order)],
                         report.layout.letter_of(one.joint), excess.factor, excess.from, excess.to,
                         where);
    }
    if (one.excesses.size() > shown && shown > 0) {
      out += fmt::format("  and {} more\n", one.excesses.size() - shown);
    }
  }
  return report.path ? out + to_text(*report.path, top) : out;
}

std::string to_json(const LimitReport& report, std::size_t top) {
  std::vector<std::string> results, notes;
  for (const std::string& note : report.notes) notes.push_back(system::json_text(note));
  for (const LimitResult& one : report.results) {
    const PrintedUnit unit = unit_of(one);
    std::vector<std::string> excesses;
    for (std::size_t k = 0; k < std::min(one.excesses.size(), top); ++k) {
      const Excess& excess = one.excesses[k];
      excesses.push_back(JsonObject()
                             .number("from_s", excess.from)
                             .number("to_s", excess.to)
                             .number("factor", excess.factor)
                             .raw("line", excess.line > 0 ? std::to_string(excess.line) : "null")
                             .line());
    }
    results.push_back(JsonObject()
                          .text("axis", std::string(1, report.layout.letter_of(one.joint)))
                          .text("quantity", kLimited[static_cast<std::size_t>(one.order)])
                          .text("channel", one.channel)
                          .text("unit", unit.name)
                          .number("limit", one.limit / unit.factor)
                          .raw("largest", evaluated_json(one, one.largest / unit.factor))
                          .raw("factor", evaluated_json(one, one.factor()))
                          .raw("time_s", evaluated_json(one, one.time))
                          .raw("line", one.line > 0 ? std::to_string(one.line) : "null")
                          .integer("excesses", one.excesses.size())
                          .raw("time_beyond_s", evaluated_json(one, one.time_beyond))
                          .number("window_s", one.window)
                          .raw("resolution", evaluated_json(one, one.floor / unit.factor))
                          .boolean("evaluated", one.is_evaluated())
                          .boolean("resolved", one.is_evaluated() && one.is_resolved)
                          .raw("largest_excesses", system::json_list(excesses))
                          .line());
  }
  return JsonObject()
      .text("log", report.log)
      .text("machine", report.machine)
      .integer("samples", report.samples)
      .number("duration_s", report.duration)
      .number("period_s", report.period)
      .raw("within_limits", within_json(report))
      .raw("results", system::json_list(results))
      .raw("notes", system::json_list(notes))
      .raw("path", report.path ? to_json(*report.path, top) : "null")
      .line();
}

}  // namespace servomill::sim::limits
