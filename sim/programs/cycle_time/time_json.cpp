// A cycle time as JSON and as CSV.
#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/programs/cycle_time/cycle_time.h"
#include "sim/system/json.h"

namespace servomill::sim::programs {
namespace {

using controllers::LimitKind;
using system::JsonObject;

constexpr int kDigits = 6;  // of seconds: microseconds

std::string limits_json(const LimitTimes& times, const JointLayout& layout) {
  JsonObject out;
  for (std::size_t k = 0; k < controllers::kLimitKinds; ++k) {
    const auto kind = static_cast<LimitKind>(k);
    const std::string name(controllers::kLimitNames[k]);
    if (!is_of_joint(kind)) {
      out.fixed(name, times.of(kind), kDigits);
      continue;
    }
    JsonObject axes;
    for (int j = 0; j < kJoints; ++j) {
      if (!layout.has(j)) continue;
      axes.fixed(std::string(1, layout.letter_of(j)), times.of(kind, j), kDigits);
    }
    out.raw(name, axes.line());
  }
  return out.line();
}

JsonObject& add_share(JsonObject& out, const TimeShare& share, const JointLayout& layout) {
  return out.fixed("time_s", share.time(), kDigits)
      .fixed("feed_s", share.feed, kDigits)
      .fixed("rapid_s", share.rapid, kDigits)
      .fixed("dwell_s", share.dwell, kDigits)
      .fixed("feed_travel_mm", share.feed_travel / mm, 3)
      .fixed("rapid_travel_mm", share.rapid_travel / mm, 3)
      .fixed("at_programmed_feed_s", share.at_feed, kDigits)
      .raw("limits_s", limits_json(share.limits, layout));
}

std::string axis_text(int joint, const JointLayout& layout) {
  return joint < 0 ? "" : std::string(1, layout.letter_of(joint));
}

std::string lines_json(const CycleTimeReport& report, std::size_t count) {
  std::vector<std::string> out;
  for (const CostlyLine& line : costly_lines(report, count)) {
    out.push_back(
        JsonObject()
            .text("file", report.files[line.file])
            .integer("line", line.line)
            .fixed("time_s", line.time.time, kDigits)
            .fixed("travel_mm", line.time.travel / mm, 3)
            .fixed("at_programmed_feed_s", line.time.at_feed, kDigits)
            .text("limit", controllers::kLimitNames[static_cast<std::size_t>(line.time.limit)])
            .text_or_null("axis", axis_text(line.time.joint, report.layout))
            .text("block", line.text)
            .line());
  }
  return system::json_list(out);
}

// Time of events of which each takes the same, if that is known.
std::string events_json(int count, const std::optional<double>& each) {
  return JsonObject()
      .integer("count", count)
      .raw("time_s", each ? system::json_number(count * *each) : (count == 0 ? "0" : "null"))
      .line();
}

std::string raised_json(const CycleTimeReport& report) {
  std::vector<std::string> out;
  for (const RaisedLimit& one : report.raised) {
    out.push_back(JsonObject().text("limit", one.what).fixed("saved_s", one.saved, kDigits).line());
  }
  return system::json_list(out);
}

std::string csv_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

constexpr std::string_view kShareColumns =
    "time_s,feed_s,rapid_s,dwell_s,feed_travel_mm,rapid_travel_mm,at_programmed_feed_s\n";

std::string share_row(const TimeShare& share) {
  return fmt::format("{:.6f},{:.6f},{:.6f},{:.6f},{:.3f},{:.3f},{:.6f}\n", share.time(), share.feed,
                     share.rapid, share.dwell, share.feed_travel / mm, share.rapid_travel / mm,
                     share.at_feed);
}

std::string lines_csv(const CycleTimeReport& report) {
  std::string out =
      "file,line,tool,section,time_s,feed_s,travel_mm,at_programmed_feed_s,limit,axis,limit_s\n";
  const TimeAccounts& accounts = report.accounts;
  for (std::size_t file = 0; file < accounts.lines.size(); ++file) {
    const std::string name = csv_text(report.files[file]);
    for (std::size_t n = 0; n < accounts.lines[file].size(); ++n) {
      const LineTime& line = accounts.lines[file][n];
      if (!(line.time > 0.0)) continue;
      fmt::format_to(std::back_inserter(out),
                     "{},{},{},{},{:.6f},{:.6f},{:.4f},{:.6f},{},{},{:.6f}\n", name, n, line.tool,
                     csv_text(accounts.sections[line.section].first), line.time, line.feed_time,
                     line.travel / mm, line.at_feed,
                     controllers::kLimitNames[static_cast<std::size_t>(line.limit)],
                     axis_text(line.joint, report.layout), line.limit_time);
    }
  }
  return out;
}

}  // namespace

std::string to_json(const CycleTimeReport& report, const TimeReportForm& form) {
  const TimeAccounts& accounts = report.accounts;
  const bool is_known = report.unknown().empty();
  std::vector<std::string> tools, sections;
  for (const auto& [number, share] : accounts.tools) {
    if (!(share.time() > 0.0)) continue;
    JsonObject one;
    one.raw("tool", number == TimeAccounts::kNoTool ? "null" : std::to_string(number));
    tools.push_back(add_share(one, share, report.layout).line());
  }
  for (const auto& [name, share] : accounts.sections) {
    if (!(share.time() > 0.0)) continue;
    JsonObject one;
    one.text_or_null("section", name);
    sections.push_back(add_share(one, share, report.layout).line());
  }
  JsonObject out;
  out.text("program", report.program).text("machine", report.machine);
  if (!report.cases.empty()) out.raw("cases", system::json_texts(report.cases));
  out.raw("total_s", is_known ? fmt::format("{:.6f}", report.known()) : "null")
      .fixed("at_least_s", report.known(), kDigits)
      .raw("unknown", system::json_texts(report.unknown()));
  add_share(out, accounts.total, report.layout)
      .raw("tool_changes", events_json(accounts.tool_changes, report.tool_change_time))
      .raw("spindle_changes", events_json(accounts.spindle_changes, report.spindle_time))
      .integer("stops", accounts.stops)
      .raw("tools", system::json_list(tools))
      .raw("sections", system::json_list(sections))
      .raw("lines", lines_json(report, form.top));
  if (!report.raised.empty()) {
    out.number("raised_percent", 100.0 * report.raise).raw("raised", raised_json(report));
  }
  return out.line();
}

std::string to_csv(const CycleTimeReport& report, TimeTable table) {
  if (table == TimeTable::line) return lines_csv(report);
  const bool is_tool = table == TimeTable::tool;
  std::string out =
      fmt::format("{},{}", kTimeTables[static_cast<std::size_t>(table)], kShareColumns);
  if (is_tool) {
    for (const auto& [number, share] : report.accounts.tools) {
      if (!(share.time() > 0.0)) continue;
      const std::string name =
          number == TimeAccounts::kNoTool ? std::string() : std::to_string(number);
      out += name + ',' + share_row(share);
    }
    return out;
  }
  for (const auto& [name, share] : report.accounts.sections) {
    if (share.time() > 0.0) out += csv_text(name) + ',' + share_row(share);
  }
  return out;
}

}  // namespace servomill::sim::programs
