#include "tools/servomill/run_reports.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "sim/model/machine_test.h"
#include "sim/model/scenario.h"
#include "sim/run/day_course.h"
#include "sim/run/day_report.h"
#include "sim/run/machine_tests.h"
#include "sim/run/run_output.h"
#include "sim/run/test_sheet.h"
#include "sim/run/touch_record.h"
#include "sim/system/write_file.h"
#include "tools/servomill/command.h"
#include "tools/servomill/json_list.h"

namespace servomill::tools {

namespace {

// Notes on what the NC corrected or could not do as programmed, once for all cases.
void print_notes(const sim::run::RunOutput& output) {
  std::set<std::string> said;
  for (const sim::run::CaseOutput& one : output.cases) {
    for (const std::string& note : one.notes) {
      if (said.insert(note).second) fmt::print(stderr, "{}\n", note);
    }
  }
}

void print_outcomes(const sim::run::RunOutput& output) {
  for (const sim::run::CaseOutput& one : output.cases) {
    const sim::engine::CaseResult& result = one.result;
    if (result.outcome.finished) {
      fmt::print("{:<12} {:8.2f} s of motion in {:6.2f} s ({:.0f} x real time), {:.0f} blocks\n",
                 one.name, result.simulated_time, result.wall_time,
                 result.simulated_time / result.wall_time, one.blocks);
    } else {
      fmt::print("{:<12} stopped: {}\n", one.name, result.outcome.reason);
    }
  }
}

void write_touches(const sim::run::RunOutput& output, const Options& options) {
  const std::filesystem::path folder = options.get<std::string>("touches");
  std::filesystem::create_directories(folder);
  for (const sim::run::CaseOutput& one : output.cases) {
    sim::system::write_text_file((folder / (one.name + ".csv")).string(),
                                 sim::run::touches_csv(one.touches, one.chain.layout),
                                 options.has("force"));
  }
}

void write_readings(const sim::run::RunOutput& output, const Options& options) {
  for (const sim::run::CaseOutput& one : output.cases) {
    const auto folder = std::filesystem::path(options.get<std::string>("readings")) / one.name;
    for (const auto& test : one.tests) {
      for (const sim::run::ReadingsFile& file : sim::run::readings_files(*test)) {
        const std::filesystem::path path = folder / file.name;
        std::filesystem::create_directories(path.parent_path());
        sim::system::write_text_file(path.string(), file.text, options.has("force"));
      }
    }
  }
}

void print_tests(const sim::run::RunOutput& output, const sim::model::Scenario& scenario) {
  for (std::size_t k = 0; k < scenario.tests.size(); ++k) {
    std::vector<std::string> names;
    std::vector<const sim::run::TestResult*> results;
    for (const sim::run::CaseOutput& one : output.cases) {
      if (one.tests.empty()) continue;
      names.push_back(one.name);
      results.push_back(one.tests[k].get());
    }
    if (results.empty()) return;
    const sim::standards::Report& report = results.front()->report;
    fmt::print("\n{}, {}: {}\n{}", report.standard, results.front()->name, report.headline,
               sim::run::side_by_side(names, results));
    for (const std::string& remark : sim::run::remarks_of(names, results)) {
      fmt::print("{}\n", remark);
    }
  }
}

void add_report_json(const sim::run::RunOutput& output, JsonList& list) {
  for (const sim::run::CaseOutput& one : output.cases) {
    for (const auto& test : one.tests) list.add(sim::standards::json(test->report));
    if (one.day) list.add(sim::run::day_json(one.name, *one.day));
  }
}

void print_days(const sim::run::RunOutput& output) {
  for (const sim::run::CaseOutput& one : output.cases) {
    if (one.day) fmt::print("\nday of {}\n{}", one.name, sim::run::day_table(*one.day));
  }
}

bool all_days_ended(const sim::run::RunOutput& output) {
  return std::all_of(output.cases.begin(), output.cases.end(), [](const auto& one) {
    return one.day == nullptr || one.day->stopped.empty();
  });
}

}  // namespace

int print_output(const sim::run::RunOutput& output, const Options& options,
                 const sim::model::Scenario& scenario, const std::string& path) {
  const bool json = options.has("json"), quiet = options.has("quiet");
  if (options.has("touches")) write_touches(output, options);
  if (options.has("readings")) write_readings(output, options);
  bool finished = all_days_ended(output);
  for (const sim::run::CaseOutput& one : output.cases) finished &= one.result.outcome.finished;
  print_notes(output);
  if (json) {
    JsonList list;
    for (const auto& row : output.comparison) list.add(sim::evaluation::to_json(row));
    add_report_json(output, list);
    list.end();
  } else if (!quiet) {
    fmt::print("{}\n\n", scenario.title);
    print_outcomes(output);
    if (!output.comparison.empty() || scenario.tests.empty()) {
      fmt::print("\n{}", sim::evaluation::format_table(output.comparison));
    }
    print_tests(output, scenario);
    print_days(output);
    fmt::print("\nwritten to {}\n", path);
  }
  if (!finished && (json || quiet)) {
    for (const sim::run::CaseOutput& one : output.cases) {
      if (one.result.outcome.finished) continue;
      fmt::print(stderr, "case {} stopped: {}\n", one.name, one.result.outcome.reason);
    }
  }
  return finished ? kDone : kMachineStopped;
}

}  // namespace servomill::tools
