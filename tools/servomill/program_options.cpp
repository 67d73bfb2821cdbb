#include "tools/servomill/program_options.h"

#include "sim/model/design.h"
#include "sim/model/machine.h"
#include "tools/servomill/axis_options.h"

namespace servomill::tools {

void add_program_options(Options& options) {
  namespace po = boost::program_options;
  const auto text = [](const char* name) { return po::value<std::string>()->value_name(name); };
  const auto texts = [](const char* name) {
    return po::value<std::vector<std::string>>()->value_name(name);
  };
  options.add()("tools", text("TABLE"), "tool table in LinuxCNC's format, mm");
  options.add()("parameter", texts("#N=NUMBER"),
                "sets a parameter before the program runs, such as '#101=1394', Q5=20 in a "
                "conversational program, or R5=20 and machine data in a Siemens program");
  options.add()("parameter-file", text("FILE"),
                "LinuxCNC's file of numbered parameters (\"var\" file), mm; it is never written");
  options.add()("subs", texts("FOLDER"),
                "folders of subroutine files, NAME.ngc for O<NAME> CALL, M98 and G65, NAME.H for "
                "CALL PGM, NAME.SPF of Siemens; the folder of the program is searched first");
  options.add()(
      "reader", text("NAME"),
      "control whose rules the program follows: any (default: LinuxCNC plus what other controls "
      "accept, with a warning), linuxcnc (strict), fanuc, haas, mach, grbl, heidenhain "
      "(conversational; any recognises it by BEGIN PGM or a file *.h), siemens (any recognises it "
      "by a file *.mpf or *.spf or by words that only Siemens has)");
  options.add()("decimal-point", text("NAME"),
                "meaning of lengths without a decimal point: calculator (X1000 = 1000 mm) or "
                "increments (X1000 = 1 mm); required with readers fanuc and haas");
  options.add()("feed", text("\"300 mm/min\""), "feed of G1, G2 and G3 before the first F");
  options.add()("additional-offset", texts("P3:X=10,Y=5,Z=0"),
                "additional work offset of G54.1 P3 or G154 P3, mm");
  options.add()("ignore-code", texts("M82"),
                "M code of the machine builder without effect on motion; otherwise the code is "
                "refused, because some of them mirror or move axes");
  options.add()("block-delete", "skips blocks that start with '/'");
  options.add()(
      "max-jumps", po::value<long>()->value_name("N"),
      "loop iterations and subroutine calls before a program is considered endless (1000000)");
}

void add_machine_option(Options& options) {
  namespace po = boost::program_options;
  options.add()("machine", po::value<std::string>()->value_name("M.toml"),
                "machine that runs the program: required by G43.5, G53.1, and G43.4 or G68.2 with "
                "rotated axes");
}

sim::programs::ProgramInputs program_inputs(const Options& options) {
  const auto text = [&](const char* name) {
    return options.has(name) ? options.get<std::string>(name) : std::string();
  };
  sim::programs::ProgramInputs inputs;
  inputs.tool_table = text("tools");
  inputs.parameters = options.list("parameter");
  inputs.machine = text("machine");
  inputs.parameter_file = text("parameter-file");
  inputs.subroutine_folders = options.list("subs");
  if (options.has("reader")) inputs.reader = text("reader");
  if (options.has("decimal-point")) inputs.decimal_point = text("decimal-point");
  if (options.has("feed")) {
    inputs.feed = *quantity_option(options, "feed", sim::config::kVelocity, "mm/min");
    if (!(*inputs.feed > 0.0)) throw InputError({"--feed"}, "must be > 0");
  }
  inputs.additional_offsets = options.list("additional-offset");
  inputs.ignored_codes = options.list("ignore-code");
  inputs.block_delete = options.has("block-delete");
  if (options.has("max-jumps")) inputs.most_jumps = options.get<long>("max-jumps");
  if (inputs.most_jumps < 1) throw InputError({"--max-jumps"}, "must be >= 1");
  return inputs;
}

void add_placement_options(Options& options) {
  namespace po = boost::program_options;
  const auto texts = [](const char* name) {
    return po::value<std::vector<std::string>>()->value_name(name);
  };
  options.add()("work-offset", texts("X=10,Y=-5"),
                "position of G54 in the machine, mm and deg; G55:X=10,R=30 for another work offset "
                "with a rotation");
  options.add()("tool-length", texts("1=50"),
                "length of tool 1 (in mm, or \"1=50 mm\"), overrides --tools");
  options.add()("start", po::value<std::string>()->value_name("X=0,Y=0,Z=50"),
                "machine position before the program, mm and deg; 0 for axes that are not given");
}

sim::programs::ProgramPlacement program_placement(const Options& options,
                                                  const std::string& program_file) {
  sim::programs::ProgramPlacement out{program_file, program_inputs(options)};
  out.changes = options.list("set");
  out.work_offsets = options.list("work-offset");
  out.tool_lengths = options.list("tool-length");
  if (options.has("start")) out.start = options.get<std::string>("start");
  return out;
}

}  // namespace servomill::tools
