#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

#include "plant/vocabulary/input_error.h"
#include "sim/input/controls/machine_draft.h"
#include "sim/model/machine.h"
#include "sim/system/read_file.h"
#include "sim/system/write_file.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/command.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;
using sim::input::ControlKind;
using sim::input::MachineDraft;

void declare_machine_options(Options& options) {
  const auto text = [](const char* name) { return po::value<std::string>()->value_name(name); };
  options.add()("output,o", text("MACHINE.toml"),
                "machine file (default: name of the settings with .toml, in this folder; - for "
                "standard output)");
  options.add()("control", text("NAME"),
                "linuxcnc, grbl, fluidnc or rrf; default: recognised by the contents of the file");
  options.add()("structure", text("\"[w C' A' b X Y Z (C1) t]\""),
                "structure of the machine, instead of the assumed one");
  options.add()("acceleration-time", text("\"20 ms\""),
                "rise time of the acceleration, which gives the jerk limits; bare numbers in ms; "
                "default: assumed for a control that plans with constant acceleration");
  options.add()("path-tolerance", text("\"10 um\""),
                "path tolerance for G64 without P, bare numbers in um");
  options.add()("force,f", "replaces MACHINE.toml if it exists");
  options.add()("quiet,q", "prints only faults");
}

ControlKind kind_of(const Options& options, const std::string& file, std::string_view text) {
  if (options.has("control")) {
    return static_cast<ControlKind>(choice_option(options, "control", sim::input::kControlKinds));
  }
  const auto kind = sim::input::kind_of_settings(text);
  if (kind) return *kind;
  throw InputError({file}, "is not known as settings of a control; name it with --control");
}

void print_draft(std::FILE* to, const MachineDraft& draft) {
  for (const std::string& axis : draft.axes) fmt::print(to, "  {}\n", axis);
  for (const std::string& assumption : draft.assumptions) {
    fmt::print(to, "  assumed: {}\n", assumption);
  }
  for (const std::string& note : draft.notes) fmt::print(to, "  note: {}\n", note);
}

}  // namespace

int machine_command(const Arguments& arguments) {
  Options options(
      "machine", "from SETTINGS [-o MACHINE.toml] [--control NAME]",
      "Writes a machine file from the settings of a real control: an INI file of LinuxCNC, the\n"
      "settings of grbl as listed by $$, config.yaml of FluidNC, config.g of RepRapFirmware. The\n"
      "file contains axes, travel, velocity, acceleration and path tolerance, each with its\n"
      "source line. It is sufficient for servomill time, check, limits and compensate; a run also\n"
      "needs drives.\n"
      "\n"
      "Values that the settings do not contain are left as comments. Where a machine file needs a\n"
      "value (jerk, structure), an assumption is made, which the file and this command state.",
      "from SETTINGS");
  declare_machine_options(options);
  if (!options.parse(arguments)) return kDone;
  const std::vector<std::string> words = options.words();
  if (words.size() != 2 || words.front() != "from") {
    throw InputError({"servomill machine"}, "needs `from SETTINGS`; see --help");
  }
  const std::string& file = words[1];
  const bool force = options.has("force");
  const std::string output = options.has("output")
                                 ? options.get<std::string>("output")
                                 : std::filesystem::path(file).stem().string() + ".toml";
  const bool to_stdout = output == "-";
  if (!to_stdout) sim::system::refuse_unwritable_text(output, force);
  sim::input::DraftChoices choices;
  if (options.has("structure")) choices.structure = options.get<std::string>("structure");
  choices.acceleration_time =
      positive_option(options, "acceleration-time", sim::config::kTime, "ms");
  choices.path_tolerance = positive_option(options, "path-tolerance", sim::config::kLength, "um");
  const std::string text = sim::system::read_file(file, {}, "settings file");
  const MachineDraft draft = sim::input::machine_draft(
      sim::input::read_control_settings(kind_of(options, file, text), text, file), choices);
  if (to_stdout) {
    std::fwrite(draft.text.data(), 1, draft.text.size(), stdout);
  } else {
    sim::system::write_text_file(output, draft.text, force);
  }
  if (options.has("quiet")) return kDone;
  std::FILE* to = to_stdout ? stderr : stdout;
  if (!to_stdout) fmt::print(to, "{}:\n", output);
  print_draft(to, draft);
  return kDone;
}

}  // namespace servomill::tools
