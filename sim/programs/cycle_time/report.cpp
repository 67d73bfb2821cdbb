// Totals, unknown times and the lines that cost most.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/program_text.h"
#include "sim/programs/cycle_time/cycle_time.h"
#include "sim/system/counted.h"

namespace servomill::sim::programs {
namespace {

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

// Puts the text of each line in.
void add_texts(const std::string& file, std::vector<CostlyLine*> lines) {
  std::sort(lines.begin(), lines.end(), [](auto* a, auto* b) { return a->line < b->line; });
  controllers::ProgramText text = controllers::ProgramText::of_file(file);
  std::string_view line;
  auto next = lines.begin();
  while (next != lines.end() && text.next(line)) {
    for (; next != lines.end() && (*next)->line == text.number(); ++next) {
      (*next)->text = trimmed(line);
    }
  }
}

}  // namespace

double CycleTimeReport::known() const {
  return motion() + accounts.tool_changes * tool_change_time.value_or(0.0) +
         accounts.spindle_changes * spindle_time.value_or(0.0);
}

std::vector<std::string> CycleTimeReport::unknown() const {
  std::vector<std::string> out;
  const auto add = [&](int count, const char* what, const std::string& why) {
    if (count <= 0) return;
    out.push_back(system::counted(static_cast<std::size_t>(count), what) + why);
  };
  if (!tool_change_time) {
    add(accounts.tool_changes, "tool change", ": no nc.tool_change_time_s in the machine file");
  }
  if (!spindle_time) {
    add(accounts.spindle_changes, "change",
        " of spindle speed: no nc.spindle_time_s in the machine file");
  }
  if (!knows_spindle) {
    add(accounts.synchronised, "move",
        " of G33 or G33.1, planned as if the spindle were as quick as the axes: no nc.spindle in "
        "the machine file");
  }
  add(accounts.stops, "stop", " until the operator continues");
  add(accounts.probings, "probing move", ", planned to the programmed end");
  add(unknown_dwells, "dwell", " in a unit that controls do not agree on");
  add(static_cast<int>(left_out.size()), "move",
      fmt::format(" from unknown positions ({}); --start names the first",
                  system::line_numbers(left_out)));
  for (const auto& [whose, lines] : unknown_moves) {
    out.push_back(fmt::format("the moves of {} ({})", whose, system::line_numbers(lines)));
  }
  return out;
}

std::string duration_text(double seconds) {
  constexpr double kMinute = 60.0, kHour = 3600.0;
  if (seconds < 9.995) return fmt::format("{:.2f} s", seconds);
  if (seconds < kMinute - 0.05) return fmt::format("{:.1f} s", seconds);
  const double tenths = std::round(seconds * 10.0) / 10.0;
  const double hours = std::floor(tenths / kHour);
  const double minutes = std::floor((tenths - hours * kHour) / kMinute);
  const double rest = tenths - hours * kHour - minutes * kMinute;
  return hours > 0.0 ? fmt::format("{:.0f} h {:02.0f} min {:02.0f} s", hours, minutes, rest)
                     : fmt::format("{:.0f} min {:04.1f} s", minutes, rest);
}

std::vector<CostlyLine> costly_lines(const CycleTimeReport& report, std::size_t count) {
  std::vector<CostlyLine> out;
  if (count == 0) return out;
  const auto costs_more = [](const CostlyLine& a, const CostlyLine& b) {
    return a.time.time > b.time.time;
  };
  for (std::size_t file = 0; file < report.accounts.lines.size(); ++file) {
    const std::vector<LineTime>& lines = report.accounts.lines[file];
    for (std::size_t n = 0; n < lines.size(); ++n) {
      if (!(lines[n].time > 0.0)) continue;
      if (out.size() == count && !(lines[n].time > out.back().time.time)) continue;
      const CostlyLine line{file, static_cast<int>(n), lines[n], {}};
      out.insert(std::upper_bound(out.begin(), out.end(), line, costs_more), line);
      if (out.size() > count) out.pop_back();
    }
  }
  for (std::size_t file = 0; file < report.files.size(); ++file) {
    std::vector<CostlyLine*> of_file;
    for (CostlyLine& line : out) {
      if (line.file == file) of_file.push_back(&line);
    }
    if (!of_file.empty() && report.has_texts) add_texts(report.files[file], of_file);
  }
  return out;
}

}  // namespace servomill::sim::programs
