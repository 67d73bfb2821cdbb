#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "plant/vocabulary/input_error.h"
#include "sim/run/converge.h"
#include "tools/servomill/command.h"
#include "tools/servomill/interrupt.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

std::string summary() {
  std::string out =
      "Runs a scenario unchanged, then once with each of these steps halved, and prints how\n"
      "each line of its comparison changes:\n";
  for (std::size_t n = 0; n < sim::run::kRefinements; ++n) {
    const sim::run::RefinementInfo& info = sim::run::info_of(static_cast<sim::run::Refinement>(n));
    out += fmt::format("  {:<11}{}\n", info.name, info.help);
  }
  out +=
      "The last columns give the number of certain digits of the value, and the value with these\n"
      "digits. The error is taken as twice the sum of all changes (an error that halves with its\n"
      "step is twice the change), but at least half the resolution of the recording or of the\n"
      "scales; an r after the digits means that the resolution limits them. A block length or\n"
      "tolerance that the scenario sets to a value other than the default, such as an identified\n"
      "one, is an input: it is not halved, and is listed below the table. Steps without effect\n"
      "(no drive to be solved, no strategy that writes blocks) change nothing.";
  return out;
}

std::set<sim::run::Refinement> chosen(const Options& options) {
  std::array<std::string_view, sim::run::kRefinements> names;
  std::set<sim::run::Refinement> all, out;
  for (std::size_t n = 0; n < sim::run::kRefinements; ++n) {
    names[n] = sim::run::info_of(static_cast<sim::run::Refinement>(n)).name;
    all.insert(static_cast<sim::run::Refinement>(n));
  }
  for (const std::string& name : options.list("halve")) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      const std::string near = did_you_mean(name, names);
      throw InputError({"--halve"}, fmt::format("no step '{}'{}", name,
                                                near.empty() ? fmt::format("; known are: {}",
                                                                           fmt::join(names, ", "))
                                                             : near));
    }
    out.insert(static_cast<sim::run::Refinement>(found - names.begin()));
  }
  return out.empty() ? all : out;
}

}  // namespace

int converge_command(const Arguments& arguments) {
  const std::string text = summary();
  Options options("converge", "SCENARIO.toml [--halve STEP]... [--set KEY=VALUE]...", text,
                  "SCENARIO.toml");
  options.add()("halve", po::value<std::vector<std::string>>()->value_name("STEP"),
                "only this step (default: all)");
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the scenario, as in run");
  options.add()("threads,j", po::value<int>()->default_value(0)->value_name("N"),
                "threads (default: one per core); results do not depend on it");
  options.add()("json", "prints a JSON list, one object per line of the comparison");
  options.add()("quiet,q", "no progress bar");
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);

  const std::set<sim::run::Refinement> refinements = chosen(options);
  ProgressLine line(options);
  const sim::input::ScenarioSource source(options.word(), options.list("set"));
  const bool json = options.has("json");
  const auto& stop = stop_on_interrupt();
  sim::run::ConvergeControl control;
  control.threads = thread_count(options);
  control.stop = &stop;
  const auto found = sim::run::find_convergence(source, refinements, control);
  line.end();
  if (!found) {
    print_interrupted("");
    return kInterrupted;
  }
  if (found->note) fmt::print(stderr, "note: {}\n", *found->note);
  for (const std::string& stopped : found->stopped) fmt::print(stderr, "stopped: {}\n", stopped);
  if (json) {
    JsonList list;
    for (const sim::run::ConvergedRow& row : found->rows) list.add(sim::run::to_json(row));
    list.end();
  } else {
    fmt::print("{}", sim::run::format_table(*found));
  }
  return found->stopped.empty() ? kDone : kMachineStopped;
}

}  // namespace servomill::tools
