/// Cycle time of a program: planned as for a run, without its servo loops.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/programs/cycle_time/time_account.h"
#include "sim/programs/program_placement.h"

namespace servomill::sim::programs {

struct CycleTimeRequest {
  ProgramPlacement placement;
  double feed_override = 1.0;
  double raise = 0.0;  // share by which each limit is raised for comparison; 0: none is
  unsigned threads = 1;
};

/// One limit and what it costs.
struct RaisedLimit {
  std::string what;    // "acceleration of X"
  double saved = 0.0;  // s, of the cycle time with the limit raised
};

struct CycleTimeReport {
  std::string program, machine;
  std::vector<std::string> cases = {};  // of a scenario: those that move so
  JointLayout layout;
  TimeAccounts accounts;
  std::vector<std::string> files;          // whose lines the accounts have
  bool has_texts = true;                   // the files are there to be read
  std::optional<double> tool_change_time;  // s, each; none: unknown
  std::optional<double> spindle_time;      // s, each start, stop and change of speed
  bool knows_spindle = false;              // its acceleration, under G33
  std::vector<int> left_out = {};          // lines of moves from positions that are not known
  int unknown_dwells = 0;                  // in a unit that controls do not agree on
  /// Lines of moves that are not known, by cycle ("CYCL DEF 251").
  std::map<std::string, std::vector<int>, std::less<>> unknown_moves = {};
  double raise = 0.0;
  std::vector<RaisedLimit> raised = {};  // the largest saving first
  std::vector<Fault> warnings = {};

  /// Motion and dwells, s.
  double motion() const { return accounts.total.time(); }
  /// The same with all other times that are known, s.
  double known() const;
  /// Tells why the cycle takes longer than `known`, one reason each.
  std::vector<std::string> unknown() const;
};

/// @throws InputError with all faults of the program, or if limits of axes are missing
CycleTimeReport cycle_time(const CycleTimeRequest& request);

/// Each motion of a scenario's cases once, with strategies that rewrite programs or learn.
/// @param changes  of keys of the scenario
/// @param cases    names; empty: all
/// @throws InputError
std::vector<CycleTimeReport> scenario_cycle_times(const std::string& path,
                                                  const std::vector<std::string>& changes,
                                                  const std::vector<std::string>& cases,
                                                  double raise, unsigned threads);

enum class TimeTable : std::uint8_t { line, tool, section };
inline constexpr std::array<std::string_view, 3> kTimeTables = {"line", "tool", "section"};

/// Parts of a report to print.
struct TimeReportForm {
  std::optional<TimeTable> table = {};  // none: tools and sections if there are several, lines
  std::size_t top = 10;                 // lines that cost most
};

std::string to_text(const CycleTimeReport& report, const TimeReportForm& form);
/// One JSON object; null for what is unknown.
std::string to_json(const CycleTimeReport& report, const TimeReportForm& form);
/// Every row of a table, lines in the order of the program.
std::string to_csv(const CycleTimeReport& report, TimeTable table);

/// "12 min 04.5 s"
std::string duration_text(double seconds);

/// The lines that cost most, the longest first.
struct CostlyLine {
  std::size_t file = 0;
  int line = 0;
  LineTime time;
  std::string text;  // as it stands in the file; empty if that is not at hand
};
std::vector<CostlyLine> costly_lines(const CycleTimeReport& report, std::size_t count);

}  // namespace servomill::sim::programs
