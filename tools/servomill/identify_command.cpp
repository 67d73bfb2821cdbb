#include <fmt/format.h>

#include <numeric>

#include "plant/vocabulary/input_error.h"
#include "sim/identification/experiment.h"
#include "sim/identification/identified_machine.h"
#include "sim/identification/identify.h"
#include "sim/identification/make_up.h"
#include "sim/identification/report.h"
#include "sim/identification/store_identification.h"
#include "sim/input/write_identified.h"
#include "sim/run/result_file.h"
#include "tools/servomill/command.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {

namespace {

namespace po = boost::program_options;

void add_identify_options(Options& options) {
  options.add()("output,o", po::value<std::string>()->value_name("OUT.toml"),
                "writes the identified machine: the initial machine overridden by the identified "
                "values, with their uncertainty and covariance");
  options.add()("recording", po::value<std::vector<std::string>>()->value_name("FILE"),
                "file of the first recording, instead of the one in the experiment; repeat for the "
                "second, ...");
  options.add()("validation", po::value<std::vector<std::string>>()->value_name("FILE"),
                "a further recording that is excluded from the fit, with the channels of the "
                "first; can be repeated");
  options.add()("signals", po::value<std::string>()->value_name("OUT.h5"),
                "writes measured and simulated signals, residuals and parameters");
  options.add()(
      "make-up", po::value<std::string>()->value_name("RECORDING.csv|.h5"),
      "writes synthetic recordings of the machine of the experiment, one per axis (that of its "
      "first recording), with the disturbances of the table [noise]; identifies nothing");
  options.add()("compare-laws", "compares friction laws, regardless of compare_laws");
  options.add()("bootstrap", po::value<int>()->value_name("N"),
                "block bootstrap of the residual with N replicas (100 or more), next to the "
                "intervals from its spectrum");
  options.add()("profile", po::value<std::vector<std::string>>()->value_name("KEY|all"),
                "profile interval of an estimate, can be repeated: how far it can change, with all "
                "others refitted, before the misfit rises significantly; may be asymmetric");
  options.add()("force,f", "replaces outputs that exist");
  options.add()("threads,j", po::value<int>()->default_value(0)->value_name("N"),
                "threads (default: one per core); results do not depend on it");
  options.add()("json", "prints the report as one JSON object");
  options.add()("quiet,q", "prints only faults");
}

// Number of the estimate with that key.
std::size_t estimate_of(const sim::identification::Experiment& experiment, const std::string& key) {
  std::vector<std::string_view> names = {"all"};
  for (std::size_t k = 0; k < experiment.estimates.size(); ++k) {
    for (const std::string& one : experiment.estimates[k].keys) {
      if (one == key) return k;
      names.push_back(one);
    }
  }
  throw InputError({"--profile"}, fmt::format("{} is not estimated in {}{}", key, experiment.path,
                                              did_you_mean(key, names)));
}

sim::identification::IntervalSettings intervals_of(
    const Options& options, const sim::identification::Experiment& experiment) {
  sim::identification::IntervalSettings out;
  if (options.has("bootstrap")) {
    const int count = options.get<int>("bootstrap");
    if (count < sim::identification::kFewestReplicas) {
      throw InputError({"--bootstrap"},
                       fmt::format("{} replicas are too few for 2.5 % quantiles; must be >= {}",
                                   count, sim::identification::kFewestReplicas));
    }
    out.bootstrap.replicas = static_cast<std::size_t>(count);
  }
  if (!options.has("profile")) return out;
  for (const auto& key : options.get<std::vector<std::string>>("profile")) {
    if (key == "all") {
      out.profiles.resize(experiment.estimates.size());
      std::iota(out.profiles.begin(), out.profiles.end(), std::size_t{0});
      return out;
    }
    out.profiles.push_back(estimate_of(experiment, key));
  }
  return out;
}

}  // namespace

int identify_command(const Arguments& arguments) {
  Options options(
      "identify", "EXPERIMENT.toml [-o identified.toml] [--signals OUT.h5]",
      "Finds parameters of drives from recordings of real axes: simulates the recorded control\n"
      "with the modelled drives, varies the parameters of the experiment until the simulated\n"
      "feedback fits the recorded one best, and reports the uncertainty of each value, the\n"
      "parameters that the recordings do not determine, and the prediction error for recordings\n"
      "excluded from the fit.\n"
      "\n"
      "Exit status 1: a value is at its bound, the fit has not converged, or its simulation\n"
      "explains none of the motion. In the last two cases -o is refused (exit status 2).",
      "EXPERIMENT.toml");
  add_identify_options(options);
  if (!options.parse(arguments)) return kDone;
  const std::string out = output_of(options, "output", ".toml");
  const std::string signals = output_of(options, "signals", ".h5");
  const std::string made_up = output_of(options, "make-up", "");
  const auto files = [&](const char* option) {
    return options.has(option) ? options.get<std::vector<std::string>>(option)
                               : std::vector<std::string>();
  };
  ProgressLine line(options);
  sim::identification::Experiment experiment = sim::identification::read_experiment(
      options.word(), {files("recording"), files("validation")});
  for (const std::string& one : {out, made_up}) refuse_unwritable(options, one);
  if (!signals.empty()) sim::run::writable_name(signals, options.has("force"));
  if (options.has("compare-laws")) experiment.compares_laws = true;
  if (!made_up.empty()) {
    sim::identification::make_up(experiment, made_up, options.has("force"));
    line.end();
    if (!options.has("quiet")) fmt::print("written to {}\n", made_up);
    return kDone;
  }
  const auto found = sim::identification::shared_identification(experiment, thread_count(options),
                                                                intervals_of(options, experiment));
  const sim::identification::Identification& result = *found;
  line.end();
  const bool prints = !options.has("quiet") && !options.has("json");
  if (options.has("json")) {
    fmt::print("{}\n", sim::identification::report_json(result));
  } else if (prints) {
    fmt::print("{}", sim::identification::report(experiment, result));
  }
  if (!signals.empty()) {
    sim::identification::store_identification(experiment, result, signals, options.has("force"));
    if (prints) fmt::print("written to {}\n", signals);
  }
  if (!out.empty()) {
    sim::input::write_identified_file(
        out, sim::identification::identified_machine(experiment, result, out),
        options.has("force"));
    if (prints) fmt::print("written to {}\n", out);
  }
  const bool is_known = sim::identification::faults(result).empty() &&
                        !sim::identification::has_value_at_bound(result);
  return is_known ? kDone : kMachineStopped;
}

}  // namespace servomill::tools
