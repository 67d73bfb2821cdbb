// A cycle time as text.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/programs/cycle_time/cycle_time.h"
#include "sim/system/counted.h"
#include "sim/system/text_table.h"

namespace servomill::sim::programs {
namespace {

using controllers::LimitKind;
using Rows = std::vector<std::vector<std::string>>;

constexpr double kHardly = 0.005;  // s; less is printed as nothing

std::string seconds_text(double seconds) {
  return seconds < kHardly ? "" : fmt::format("{:.2f} s", seconds);
}

std::string share_text(double part, double whole) {
  if (!(whole > 0.0) || part < kHardly) return "";
  return fmt::format("{:.1f} %", 100.0 * part / whole);
}

std::string travel_text(double travel) {
  return travel > 0.0 ? fmt::format("{:.1f} mm", travel / mm) : "";
}

std::string feed_text(double travel, double time) {
  if (!(travel > 0.0) || !(time > 0.0)) return "";
  return fmt::format("{:.0f} mm/min", travel / time / (mm / minute));
}

// A table below its title, indented.
std::string titled(std::string_view title, Rows rows, const std::set<std::size_t>& right) {
  const std::string table = system::text_table(std::move(rows), 0, right);
  std::string out = fmt::format("\n{}\n", title);
  for (std::size_t from = 0; from < table.size();) {
    const std::size_t end = table.find('\n', from);
    out += "  " + table.substr(from, end - from) + '\n';
    from = end + 1;
  }
  return out;
}

std::string headline(const CycleTimeReport& report) {
  std::string out = fmt::format("{} on {}: ", report.program, report.machine);
  if (!report.cases.empty()) {
    out = fmt::format("{}, {} {} on {}: ", report.program,
                      report.cases.size() == 1 ? "case" : "cases", fmt::join(report.cases, ", "),
                      report.machine);
  }
  const std::vector<std::string> unknown = report.unknown();
  out += fmt::format("{}{}\n", unknown.empty() ? "" : "at least ", duration_text(report.known()));
  for (const std::string& reason : unknown) out += fmt::format("  not in it: {}\n", reason);
  return out;
}

std::string kinds(const CycleTimeReport& report) {
  const TimeShare& total = report.accounts.total;
  const double whole = report.known();
  Rows rows = {{"", "time", "share", "travel", "mean feed"}};
  const auto add = [&](std::string name, double time, double travel) {
    if (!(time > 0.0)) return;
    rows.push_back({std::move(name), duration_text(time), share_text(time, whole),
                    travel_text(travel), feed_text(travel, time)});
  };
  add("feed", total.feed, total.feed_travel);
  add("rapid", total.rapid, total.rapid_travel);
  add("dwell", total.dwell, 0.0);
  const TimeAccounts& accounts = report.accounts;
  add(system::counted(static_cast<std::size_t>(accounts.tool_changes), "tool change"),
      accounts.tool_changes * report.tool_change_time.value_or(0.0), 0.0);
  add(system::counted(static_cast<std::size_t>(accounts.spindle_changes), "change") +
          " of spindle speed",
      accounts.spindle_changes * report.spindle_time.value_or(0.0), 0.0);
  std::string out = titled("Time", std::move(rows), {1, 2, 3, 4});
  if (total.feed > 0.0) {
    out += fmt::format("  feed motion at the programmed feeds alone: {}\n",
                       duration_text(total.at_feed));
  }
  return out;
}

std::string_view limit_title(LimitKind kind) {
  constexpr std::array<std::string_view, controllers::kLimitKinds> kTitles = {
      "programmed feed",
      "block time of the NC",
      "velocity",
      "acceleration",
      "jerk",
      "corners within the tolerance",
      "no limit to 90 %"};
  return kTitles[static_cast<std::size_t>(kind)];
}

std::string limits(const CycleTimeReport& report) {
  const LimitTimes& times = report.accounts.total.limits;
  const double whole = report.accounts.total.feed + report.accounts.total.rapid;
  std::vector<int> joints;
  for (int j = 0; j < kJoints; ++j) {
    if (report.layout.has(j)) joints.push_back(j);
  }
  Rows rows = {{"", "time", "share"}};
  std::set<std::size_t> right = {1, 2};
  for (const int j : joints) {
    right.insert(rows[0].size());
    rows[0].emplace_back(1, report.layout.letter_of(j));
  }
  for (std::size_t k = 0; k < controllers::kLimitKinds; ++k) {
    const auto kind = static_cast<LimitKind>(k);
    if (times.of(kind) < kHardly) continue;
    std::vector<std::string> row = {std::string(limit_title(kind)), seconds_text(times.of(kind)),
                                    share_text(times.of(kind), whole)};
    for (const int j : joints) {
      row.push_back(is_of_joint(kind) ? seconds_text(times.of(kind, j)) : "");
    }
    rows.push_back(std::move(row));
  }
  return titled("What bounds the motion", std::move(rows), right);
}

std::string part_table(std::string_view title, const char* column,
                       const std::vector<std::pair<std::string, const TimeShare*>>& parts,
                       double whole) {
  Rows rows = {{column, "time", "share", "feed", "rapid", "dwell", "travel at feed", "mean feed"}};
  for (const auto& [name, share] : parts) {
    if (!(share->time() > 0.0)) continue;
    rows.push_back({name, duration_text(share->time()), share_text(share->time(), whole),
                    seconds_text(share->feed), seconds_text(share->rapid),
                    seconds_text(share->dwell), travel_text(share->feed_travel),
                    feed_text(share->feed_travel, share->feed)});
  }
  return titled(title, std::move(rows), {1, 2, 3, 4, 5, 6, 7});
}

std::string limit_text(const LineTime& line, const JointLayout& layout) {
  if (!(line.limit_time > 0.0F)) return "";
  const std::string name(limit_title(line.limit));
  return line.joint < 0 ? name : fmt::format("{}, {}", name, layout.letter_of(line.joint));
}

std::string lines(const CycleTimeReport& report, std::size_t count) {
  constexpr std::size_t kText = 44;  // columns of the program
  Rows rows = {{"line", "time", "share", "travel", "feed", "at feed alone", "bounded by", "block"}};
  for (const CostlyLine& line : costly_lines(report, count)) {
    const bool is_main = line.file == 0;
    rows.push_back({is_main ? std::to_string(line.line)
                            : fmt::format("{}:{}", report.files[line.file], line.line),
                    duration_text(line.time.time), share_text(line.time.time, report.motion()),
                    travel_text(line.time.travel), feed_text(line.time.travel, line.time.feed_time),
                    seconds_text(line.time.at_feed), limit_text(line.time, report.layout),
                    line.text.substr(0, kText)});
  }
  return titled("Lines that take longest", std::move(rows), {0, 1, 2, 3, 4, 5});
}

std::string raised(const CycleTimeReport& report) {
  Rows rows = {{"limit", "saves", "share"}};
  std::vector<std::string> useless;
  for (const RaisedLimit& one : report.raised) {
    if (std::abs(one.saved) < kHardly) {
      useless.push_back(one.what);
      continue;
    }
    const double percent = 100.0 * one.saved / report.known();
    rows.push_back({one.what, fmt::format("{:.2f} s", one.saved),
                    fmt::format("{:.1f} %", std::abs(percent) < 0.05 ? 0.0 : percent)});
  }
  std::string out =
      titled(fmt::format("What a limit that is {:g} % higher brings", 100.0 * report.raise),
             std::move(rows), {1, 2});
  if (!useless.empty()) out += fmt::format("  nothing: {}\n", fmt::join(useless, ", "));
  return out;
}

std::vector<std::pair<std::string, const TimeShare*>> tools_of(const TimeAccounts& accounts) {
  std::vector<std::pair<std::string, const TimeShare*>> out;
  for (const auto& [number, share] : accounts.tools) {
    out.emplace_back(number == TimeAccounts::kNoTool ? "before any" : fmt::format("T{}", number),
                     &share);
  }
  return out;
}

std::vector<std::pair<std::string, const TimeShare*>> sections_of(const TimeAccounts& accounts) {
  std::vector<std::pair<std::string, const TimeShare*>> out;
  for (const auto& [name, share] : accounts.sections) {
    out.emplace_back(name.empty() ? "before any" : name, &share);
  }
  return out;
}

}  // namespace

std::string to_text(const CycleTimeReport& report, const TimeReportForm& form) {
  const TimeAccounts& accounts = report.accounts;
  const auto wants = [&](TimeTable table, bool by_default) {
    return form.table ? *form.table == table : by_default;
  };
  std::string out = headline(report) + kinds(report) + limits(report);
  if (!report.raised.empty()) out += raised(report);
  if (wants(TimeTable::tool, accounts.tool_changes > 1)) {
    out += part_table("Tools", "tool", tools_of(accounts), report.motion());
  }
  if (wants(TimeTable::section, accounts.sections.size() > 1)) {
    out += part_table("Sections", "section", sections_of(accounts), report.motion());
  }
  if (wants(TimeTable::line, form.top > 0)) out += lines(report, form.top);
  return out;
}

}  // namespace servomill::sim::programs
