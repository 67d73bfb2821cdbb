#include "sim/programs/canonical_moves.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <span>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/cl_data.h"
#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/parameter_file.h"
#include "sim/config/document.h"
#include "sim/config/written_number.h"
#include "sim/input/implausible.h"
#include "sim/input/machine_description.h"
#include "sim/input/machine_document.h"
#include "sim/input/read_scenario.h"
#include "sim/input/subroutine_files.h"
#include "sim/model/scenario.h"
#include "sim/preparation/case_preparation.h"
#include "sim/preparation/case_program.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/prepared_case.h"
#include "sim/programs/compensate/work_knowledge.h"
#include "sim/programs/line_stage.h"
#include "sim/run/run.h"
#include "sim/sweep/sweep.h"
#include "sim/system/read_file.h"

namespace servomill::sim::programs {
namespace {

constexpr std::size_t kWrittenAtOnce = 1U << 16;  // bytes

void warn_of(const model::MachineSettings& machine, const std::string& path,
             std::vector<Fault>& warnings) {
  for (std::string& value : input::implausible_values(machine)) {
    warnings.push_back({{path}, std::move(value)});
  }
}

// The trial runs of a scenario, which take as long as the runs themselves.
std::string trial_runs_not_made(const model::Scenario& scenario, int number) {
  std::vector<std::string> cases;
  for (const model::CaseSpec& one : scenario.cases) {
    if (std::any_of(
            one.strategies.begin(), one.strategies.end(),
            [](const model::StrategySpec& strategy) { return strategy.entry->runs_program; })) {
      cases.push_back(one.name);
    }
  }
  return fmt::format(
      "{} trial run{} from which strategies learn in case{} {}: servomill run reports their errors "
      "before the first case",
      number, number == 1 ? "" : "s", cases.size() == 1 ? "" : "s", fmt::join(cases, ", "));
}

// Uses of rules beyond LinuxCNC's in the cases' programs; the cases mostly run the same one.
void add_program_warnings(const model::Scenario& scenario, std::vector<Fault>& warnings) {
  preparation::PreparationCache cache;
  for (const model::CaseSpec& spec : scenario.cases) {
    for (const Fault& one :
         preparation::CasePreparation(scenario, spec, cache).program()->warnings) {
      const bool is_known = std::any_of(warnings.begin(), warnings.end(), [&](const Fault& other) {
        return other.place == one.place && other.message == one.message;
      });
      if (!is_known) warnings.push_back(one);
    }
  }
}

void check_toml(const std::string& path, const std::vector<std::string>& changes,
                CheckedFile& out) {
  if (input::is_machine_file(path)) {
    const model::MachineSettings machine = input::read_machine_file(path);
    warn_of(machine, path, out.warnings);
    run::check_machine(machine);
    return;
  }
  const model::Scenario scenario = input::read_scenario(path, changes);
  warn_of(scenario.machine, path, out.warnings);
  const int trial_runs = run::check_scenario(scenario).trial_runs;
  if (trial_runs > 0) out.not_run = trial_runs_not_made(scenario, trial_runs);
  add_program_warnings(scenario, out.warnings);
  if (!scenario.sweep.empty()) sweep::Sweep(path, changes).check();
}

bool holds_cutter_locations(std::string_view path) {
  return path.ends_with(".cls") || path.ends_with(".apt") || path.ends_with(".csv");
}

// Index of a name among those of an option.
std::size_t chosen(const std::string& option, const std::string& name,
                   std::span<const std::string_view> names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  throw InputError({option + " " + name}, fmt::format("must be one of {}{}", fmt::join(names, ", "),
                                                      did_you_mean(name, names)));
}

// "P3:X=10,Y=5"
void add_additional_offset(const std::string& text, controllers::ProgramSetup& setup) {
  const std::string option = "--additional-offset";
  const std::size_t colon = text.find(':');
  const double P = text.starts_with('P') && colon != std::string::npos
                       ? config::number_of(text.substr(1, colon - 1))
                       : std::nan("");
  if (!(P >= 1.0) || P != std::floor(P) || P > 300.0) {
    throw InputError({option + " " + text},
                     "must be P and a number, then positions in mm, such as "
                     "P3:X=10,Y=-5.5,Z=0");
  }
  setup.additional_offsets[static_cast<int>(P)] =
      axis_values(option, std::string_view(text).substr(colon + 1), nullptr, false).words;
}

}  // namespace

void choose_reader(const ProgramInputs& inputs, const model::NcSettings& nc,
                   controllers::ProgramSetup& setup) {
  using controllers::DecimalPoint;
  using controllers::Reader;
  setup.reader = nc.program_reader;
  setup.decimal_point = nc.decimal_point;
  setup.ignored_codes = nc.ignored_codes;
  if (inputs.reader) {
    setup.reader = static_cast<Reader>(chosen("--reader", *inputs.reader, controllers::kReaders));
  }
  setup.takes_five_axis_codes = setup.reader != Reader::linuxcnc;
  if (!inputs.decimal_point) return;
  setup.decimal_point = static_cast<DecimalPoint>(
      chosen("--decimal-point", *inputs.decimal_point, controllers::kDecimalPoints));
}

namespace {

// Bytes below the blank that no text has, and of UTF-8 none: the begin of the file is enough.
bool is_binary(const std::string& path) {
  constexpr std::size_t kExamined = 4096;
  std::array<char, kExamined> begin{};
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), begin.size());
  const std::string_view bytes(begin.data(), static_cast<std::size_t>(file.gcount()));
  const auto is_odd = [](char c) {  // tapes have NUL and DEL, files of CP/M end with 1a
    return c > 0 && c < ' ' && std::string_view("\t\n\r\f\x1a").find(c) == std::string_view::npos;
  };
  const auto odd = std::count_if(bytes.begin(), bytes.end(), is_odd);
  constexpr auto kRare = 50;  // one in so many
  return odd > static_cast<std::ptrdiff_t>(bytes.size() / kRare);
}

void refuse_no_program(const std::string& path) {
  if (path.ends_with(".toml")) {
    throw InputError({path}, "is a TOML file (scenario, machine, ...); a program is needed");
  }
  std::error_code ignored;  // a pipe is read once
  if (std::filesystem::is_regular_file(path, ignored) && is_binary(path))
    throw InputError({path}, "is a binary file; a program is a text");
}

}  // namespace

controllers::ProgramSetup program_setup(const ProgramInputs& inputs,
                                        const std::string& program_file) {
  refuse_no_program(program_file);
  controllers::ProgramSetup setup;
  model::NcSettings nc;
  if (!inputs.tool_table.empty()) {
    setup.tools = controllers::ToolTable::parse(
        system::read_file(inputs.tool_table, {}, "tool table"), inputs.tool_table);
  }
  if (!inputs.parameter_file.empty()) {
    setup.stored = controllers::parse_parameter_file(
        system::read_file(inputs.parameter_file, {}, "parameter file"), inputs.parameter_file);
    setup.work_system = controllers::work_system_of(setup.stored);
  }
  if (!inputs.machine.empty()) {
    const auto machine = input::read_machine_description(inputs.machine).machine;
    setup.machine = preparation::tool_centre_point(*machine);
    nc = machine->nc;
  }
  for (const std::string& parameter : inputs.parameters) {
    const std::size_t equals = parameter.find('=');
    const double value = equals == std::string::npos
                             ? std::nan("")
                             : config::number_of(parameter.substr(equals + 1));
    if (!std::isfinite(value)) {
      throw InputError({"--parameter " + parameter}, "must be #N=NUMBER, such as '#101=1394'");
    }
    setup.parameters[parameter.substr(0, equals)] = value;
  }
  choose_reader(inputs, nc, setup);
  setup.feed = inputs.feed;
  for (const std::string& text : inputs.additional_offsets) add_additional_offset(text, setup);
  for (const std::string& code : inputs.ignored_codes) {
    const controllers::IgnoredCode ignored = controllers::ignored_code(code);
    if (!ignored.fault.empty()) throw InputError({"--ignore-code " + code}, ignored.fault);
    setup.ignored_codes.insert(ignored.number);
  }
  setup.trials = inputs.trials;
  setup.block_delete = inputs.block_delete;
  setup.most_jumps = inputs.most_jumps;
  for (const std::string& folder : inputs.subroutine_folders) {
    if (!std::filesystem::is_directory(folder))
      throw InputError({"--subs " + folder}, "is not a folder");
  }
  setup.subroutine_file = input::subroutine_files(program_file, inputs.subroutine_folders);
  return setup;
}

std::vector<Fault> canon(const std::string& program_file, const ProgramInputs& inputs,
                         const std::function<void(std::string_view)>& write) {
  controllers::ProgramSetup setup = program_setup(inputs, program_file);
  setup.accepts_unknown_lengths = setup.accepts_unknown_dwells = true;
  setup.probed = std::make_shared<controllers::AssumedContact>();
  controllers::Interpreter interpreter(controllers::ProgramText::of_file(program_file),
                                       std::move(setup));
  std::string lines;
  LineStage stage(program_file);
  const auto flush = [&] {
    write(lines);
    lines.clear();
  };
  try {
    while (const Move* move = interpreter.next()) {
      stage.at(move->line);
      if (move->synchronised == Synchronised::tap_out) continue;  // of the record before
      controllers::add_canon_json(*move, lines);
      lines += '\n';
      if (lines.size() >= kWrittenAtOnce) flush();
    }
  } catch (const InputError& error) {
    write(lines);
    write(controllers::canon_error_json(error.what()) + '\n');
    throw;
  }
  flush();
  return interpreter.warnings();
}

bool is_program(std::string_view path) {
  return !path.ends_with(".toml") && !holds_cutter_locations(path);
}

CheckedFile check_file(const std::string& path, const std::vector<std::string>& changes,
                       const ProgramInputs& inputs) {
  CheckedFile out;
  try {
    if (path.ends_with(".toml")) {
      check_toml(path, changes, out);
      return out;
    }
    if (holds_cutter_locations(path)) {
      controllers::read_cl_data(system::read_file(path, {}, "cutter location file"), path);
      return out;
    }
    controllers::ProgramSetup setup = program_setup(inputs, path);
    if (setup.tools.empty()) setup.tools.take_any_number();  // the control has a table of its own
    setup.accepts_unknown_dwells = setup.accepts_unknown_positions = true;
    setup.accepts_unknown_feeds = true;
    setup.probed = std::make_shared<controllers::AssumedContact>();
    out.faults = controllers::check_program(controllers::ProgramText::of_file(path),
                                            std::move(setup), &out.warnings);
  } catch (const InputError& error) {
    out.faults = error.faults();
  }
  return out;
}

}  // namespace servomill::sim::programs
