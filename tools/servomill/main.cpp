/// servomill: the program. One command a file; this one chooses and turns exceptions into messages.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <system_error>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/simd.h"
#include "plant/vocabulary/user_file.h"
#include "sim/run/build_identity.h"
#include "sim/system/memory_limit.h"
#include "sim/system/system_error.h"
#include "sim/version.h"
#include "tools/servomill/command.h"
#include "tools/servomill/command_pages.h"
#include "tools/servomill/interrupt.h"

namespace servomill::tools {
namespace {

constexpr std::array<Command, 28> kCommands = {{
    {"run", "SCENARIO.toml [-o OUT.h5] [--set KEY=VALUE]...", "runs every case of a scenario",
     run_command},
    {"compare", "OUT.h5...", "prints the comparison of runs again", compare_command},
    {"view", "OUT.h5... [--no-browser]", "shows results in the browser", view_command},
    {"sweep", "SCENARIO.toml [-o OUT.h5] [--set KEY=VALUE]...",
     "runs a scenario at the points of its [sweep] table", sweep_command},
    {"merge", "SHARD.h5... -o OUT.h5 [--partial]", "joins the shards of a sweep", merge_command},
    {"budget", "SCENARIO.toml [--case NAME]... [-o OUT.h5]",
     "splits residuals into the contributions of their causes", budget_command},
    {"converge", "SCENARIO.toml [--halve STEP]...",
     "halves periods, blocks and tolerances, prints stable digits", converge_command},
    {"bode", "SCENARIO.toml --axis Y [--loop LOOP] [-o OUT.h5]",
     "frequency responses of an axis, exact and measured", bode_command},
    {"step", "SCENARIO.toml --axis Y [-o OUT.h5]", "step responses of an axis", step_command},
    {"tune", "SCENARIO.toml --axis Y|all", "gains of an axis for given margins", tune_command},
    {"fmu", "SCENARIO.toml --axis Y [--fmi 2|3] -o DRIVE.fmu",
     "exports an axis with its loops for other simulators (FMI co-simulation)", fmu_command},
    {"lobes", "[MACHINE.toml|SCENARIO.toml] [--teeth N] [--material NAME]",
     "stability lobes: depth of cut at which a cutter begins to chatter, over spindle speed",
     lobes_command},
    {"table", "SCENARIO.toml --format FORMAT -o FOLDER", "writes compensation tables for a real NC",
     table_command},
    {"compensate", "PROGRAM --machine M.toml [-o OUT]",
     "writes a program corrected for the errors of a machine", compensate_command},
    {"check", "FILE...", "checks scenarios, machines, cutter locations and programs",
     check_command},
    {"time", "PROGRAM --machine M.toml", "cycle time of a program, and how it is spent",
     time_command},
    {"canon", "PROGRAM", "prints the canonical moves of a program, one JSON object per line",
     canon_command},
    {"post", "PART.cls --machine M.toml [-o OUT.ngc]", "post-processes cutter locations to G-code",
     post_command},
    {"machine", "from SETTINGS [-o MACHINE.toml]",
     "writes a machine file from settings of LinuxCNC, grbl, FluidNC or RepRapFirmware",
     machine_command},
    {"recording", "FILE... [-o OUT.h5|OUT.csv]", "prints and converts recordings of real axes",
     recording_command},
    {"limits", "LOG --machine M.toml",
     "checks a recorded motion against velocity, acceleration and jerk limits of a machine",
     limits_command},
    {"calibrate", "READINGS.toml [--machine MACHINE.toml] [-o identified.toml]",
     "finds the geometric errors of a machine from readings of instruments", calibrate_command},
    {"plan-calibration", "[READINGS.toml] --machine MACHINE.toml [-o FOLDER]",
     "plans which measurements reduce the uncertainty of a machine most in the available time",
     plan_calibration_command},
    {"identify", "EXPERIMENT.toml [-o identified.toml]",
     "finds parameters of drives from recordings of real axes", identify_command},
    {"identify-heat", "READINGS.csv|DAY.h5 --machine M.toml [-o OUT.toml]",
     "finds errors per kelvin of temperature sensors from the drift of the tip",
     identify_heat_command},
    {"response", "RECORDING --input CHANNEL --output CHANNEL --period S",
     "frequency response of a real axis from a recording", response_command},
    {"evaluate", "READINGS... --standard iso230-2",
     "prints the parameters of a test as its standard defines them", evaluate_command},
    {"list", "strategies|machines|scenarios|quantities|keys",
     "prints strategies, machines, scenarios, quantities, rules or keys", list_command},
}};

constexpr std::string_view kAbout = "five-axis milling machine and servo loop simulator";

void print_usage(std::FILE* to) {
  fmt::print(to,
             "servomill {}: {}\n\n"
             "Usage: servomill COMMAND [...]\n\n",
             sim::kVersion, kAbout);
  for (const Command& command : kCommands) {
    fmt::print(to, "  {:<10} {:<50} {}\n", command.name, command.synopsis, command.summary);
  }
  fmt::print(to, "\n`servomill COMMAND --help` explains a command.\n{}\n", exit_status_line());
}

// Manual page of the program: its commands, each with a page of its own.
void print_manual_page() {
  std::string text(kAbout);
  for (const Command& command : kCommands) {
    text += fmt::format("\n\nservomill {} {}\n    {}; see servomill-{}(1)", command.name,
                        command.synopsis, command.summary, command.name);
  }
  const boost::program_options::options_description none;
  fmt::print("{}", manual_page({"", "COMMAND [...]", text, "", none}, kAbout));
}

const Command* command_of(const std::string& name) {
  const auto command = std::find_if(kCommands.begin(), kCommands.end(),
                                    [&](const Command& one) { return one.name == name; });
  return command == kCommands.end() ? nullptr : &*command;
}

// Candidates for the last of the words behind "servomill": for the completion of shells.
int complete(const Arguments& words) {
  if (words.size() > 1) {
    const Command* command = command_of(words.front());
    if (command == nullptr) return kDone;
    Arguments line = words;
    line.front() = kComplete;
    return command->run(line);
  }
  for (const Command& command : kCommands) {
    fmt::print("{}", candidate(command.name, command.summary));
  }
  for (const char* option : {"--help", "--version"}) fmt::print("{}", candidate(option, ""));
  return kDone;
}

int dispatch(const Arguments& arguments) {
  if (arguments.empty()) {
    print_usage(stderr);
    return kInputWrong;
  }
  const std::string& name = arguments.front();
  if (name == "--help" || name == "-h" || name == "help") {
    print_usage(stdout);
    return kDone;
  }
  if (name == "--version") {
    fmt::print("servomill {}\n", sim::run::build_identity());
    return kDone;
  }
  if (name == kManualPage) {
    print_manual_page();
    return kDone;
  }
  if (name == kComplete) return complete({arguments.begin() + 1, arguments.end()});
  const Command* command = command_of(name);
  if (command == nullptr) {
    std::array<std::string_view, kCommands.size()> names;
    std::transform(kCommands.begin(), kCommands.end(), names.begin(),
                   [](const Command& one) { return one.name; });
    throw InputError({"servomill"}, fmt::format("unknown command '{}'{}; see servomill --help",
                                                name, did_you_mean(name, names)));
  }
  stop_on_interrupt();
  const InputRecord inputs;
  simd_level();  // refuses what SERVOMILL_SIMD must not be
  if (arguments.size() > 1 && arguments[1] == kManualPage) {
    return command->run({std::string(kManualPage), std::string(command->summary)});
  }
  return command->run({arguments.begin() + 1, arguments.end()});
}

}  // namespace
}  // namespace servomill::tools

namespace {

int guarded(const servomill::tools::Arguments& arguments) {
  using namespace servomill;
  try {
    return tools::dispatch(arguments);
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return tools::kInputWrong;
  } catch (const sim::system::SystemError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return tools::kSystemFailed;
  } catch (const Interrupted&) {
    std::fflush(stdout);
    tools::print_interrupted();
    return tools::kInterrupted;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "servomill: not enough memory\n");
    return tools::kSystemFailed;
  } catch (const std::length_error&) {  // more than any memory could hold
    fmt::print(stderr, "servomill: not enough memory\n");
    return tools::kSystemFailed;
  } catch (const std::system_error& error) {  // threads; of standard output main() tells
    if (std::ferror(stdout) == 0) fmt::print(stderr, "servomill: {}\n", error.what());
    return tools::kSystemFailed;
  } catch (const std::exception& error) {
    fmt::print(stderr, "servomill: internal error: {}\n", error.what());
    return tools::kSystemFailed;
  }
}

}  // namespace

int main(int argc, char** argv) {
  servomill::sim::system::return_large_blocks();
  const int status = guarded({argv + 1, argv + argc});
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
  fmt::print(stderr, "standard output: cannot be written: {}\n", std::strerror(errno));
  return servomill::tools::kSystemFailed;
}
