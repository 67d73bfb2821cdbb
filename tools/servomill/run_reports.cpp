#include "tools/servomill/run_reports.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/model/machine_test.h"
#include "sim/model/scenario.h"
#include "sim/run/day_course.h"
#include "sim/run/day_report.h"
#include "sim/run/machine_tests.h"
#include "sim/run/run.h"
#include "sim/run/test_sheet.h"
#include "sim/system/write_file.h"
#include "tools/servomill/command.h"
#include "tools/servomill/json_list.h"

namespace servomill::tools {

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

}  // namespace servomill::tools
