/// Small scenarios on the HSM 600U for tests: a program and a few lines of TOML, without files.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepare_cases.h"
#include "sim/records/series.h"
#include "sim/run/run.h"
#include "sim/run/run_case.h"

namespace servomill::sim {

/// @param program  G-code; its axes start at machine zero
/// @param toml     what the scenario says beside machine and program; keys of the root first
inline model::Scenario small_scenario(const std::string& program, const std::string& toml) {
  return input::read_resolved_scenario("machine = \"machines/hsm600u.toml\"\n" + toml +
                                           "\n[program]\nfile = \"small.ngc\"\ntext = '''\n" +
                                           program + "'''\n",
                                       SERVOMILL_SOURCE_DIR "/scenarios/small.toml");
}

/// Refusal of the cases of a scenario on a short line, files named from scenarios/ on; or
/// "accepted".
inline std::string refusal_of(const std::string& toml,
                              const std::string& program = "G21 G90 G94\nG1 X10 F3000\nM30\n") {
  try {
    const model::Scenario scenario = small_scenario(program, toml);
    preparation::prepare_cases(scenario);
  } catch (const InputError& error) {
    const std::string folder = SERVOMILL_SOURCE_DIR "/scenarios/", text = error.what();
    return text.starts_with(folder) ? text.substr(folder.size()) : text;
  }
  return "accepted";
}

/// Runs one case alone, in this thread; that it ends is taken for granted.
inline run::CaseOutput run_named_case(const model::Scenario& scenario, const std::string& name) {
  static const engine::StopFlag kNever = false;
  std::atomic<float> progress = 0.0F;
  const model::CaseSpec* spec = scenario.find_case(name);
  if (spec == nullptr) throw std::logic_error("no case " + name);
  preparation::PreparedCase prepared(scenario, *spec);
  prepared.teach();
  run::CaseOutput output = run::run_case(prepared, kNever, progress);
  EXPECT_TRUE(output.result.outcome.finished) << name << ": " << output.result.outcome.reason;
  return output;
}

/// Rows of feed motion at whose reference the axis X stands within [from, to] (mm).
inline std::vector<std::size_t> rows_within(const records::Series& series, double from, double to) {
  const std::size_t x = *series.column("ref_linear", 'X'), rapid = *series.column("rapid");
  std::vector<std::size_t> rows;
  for (std::size_t n = 0; n < series.rows(); ++n) {
    const double at = series.at(n, x);
    if (series.at(n, rapid) == 0.0 && at >= from && at <= to) rows.push_back(n);
  }
  return rows;
}

/// Mean of a column over some rows. @pre there are rows
inline double mean_of(const records::Series& series, const std::string& name, char label,
                      const std::vector<std::size_t>& rows) {
  const std::size_t column = series.column(name, label).value();
  EXPECT_FALSE(rows.empty());
  double sum = 0.0;
  for (const std::size_t n : rows) sum += series.at(n, column);
  return sum / static_cast<double>(rows.size());
}

/// Largest magnitude of a column over some rows.
inline double largest_of(const records::Series& series, const std::string& name, char label,
                         const std::vector<std::size_t>& rows) {
  const std::size_t column = series.column(name, label).value();
  EXPECT_FALSE(rows.empty());
  double largest = 0.0;
  for (const std::size_t n : rows) largest = std::max(largest, std::abs(series.at(n, column)));
  return largest;
}

}  // namespace servomill::sim
