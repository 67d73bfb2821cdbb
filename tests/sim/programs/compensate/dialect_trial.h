/// Programs written for other controls, as tests show them.
#pragma once

#include "tests/pattern.h"
#include "tests/sim/programs/compensate/trial.h"
#include "tests/text.h"

namespace servomill::sim::programs {

/// Unit, plane, tool and spindle, as most of the programs begin.
inline const std::string kDialectStart = "G21 G90 G17 G54\nT1 M6\nG43 H1\nS1000 M3\n";

/// A trial for another control: without errors, tools 1 and 2, G54 and G55 known.
inline Trial dialect_trial(Dialect dialect, const std::string& program) {
  Trial trial(program, "plate.ngc");
  trial.request.error_file = written("none.toml", "[errors.none]\nEXX = { constant_um = 0.0 }\n");
  trial.request.dialect = dialect;
  trial.request.program_name = "PLATE";
  trial.request.program_number = 1234;
  trial.request.retract_Z = -2 * mm;
  return trial;
}

/// Words that other controls read differently are LinuxCNC's.
inline Trial linuxcnc_trial(Dialect dialect, const std::string& program) {
  Trial trial = dialect_trial(dialect, program);
  trial.request.inputs.reader = "linuxcnc";
  return trial;
}

/// The text but for comments of the header, so that a test shows the dialect alone.
inline std::string said(const Trial& trial) {
  std::string out;
  for (const std::string& line : lines_of(trial.run().program)) {
    const auto has = [&](const char* word) { return line.find(word) != std::string::npos; };
    if (!has("POSITIONS ROUNDED") && !has("servomill") && !has("SERVOMILL") && !has("assumed") &&
        !has("ASSUMED") && !has("path within") && !has("PATH WITHIN") && !has("warning: ") &&
        !has("WARNING: ")) {
      out += line + "\n";
    }
  }
  return out;
}
inline std::string said(Dialect dialect, const std::string& program) {
  return said(dialect_trial(dialect, program));
}

/// Blocks between the retract of the header and the closing frame, without numbers, one line each.
inline std::string body(const Trial& trial) {
  static const Pattern kBlockNumber("^(N[0-9]+|[0-9]+) ");
  static const Pattern kRetract(
      "^(G90 G49 G53 G0 Z-2\\.|SUPA G0 Z-2 D0|L Z-2 R0 FMAX M91|G90 G49 G53 G0 Z-0\\.0787)$");
  std::vector<std::string> lines;
  for (const std::string& line : lines_of(said(trial))) {
    lines.push_back(kBlockNumber.replaced(line, ""));
  }
  std::size_t first = 0, last = lines.size();
  while (first < lines.size() && !kRetract.matches(lines[first])) ++first;
  while (last > 0 && !kRetract.matches(lines[last - 1])) --last;
  std::string out;
  for (std::size_t i = first + 1; i + 1 < last; ++i) out += lines[i] + "\n";
  return out;
}
inline std::string body(Dialect dialect, const std::string& program) {
  return body(dialect_trial(dialect, program));
}

inline std::string refusal(Dialect dialect, const std::string& program) {
  return refusal(dialect_trial(dialect, program));
}

}  // namespace servomill::sim::programs
