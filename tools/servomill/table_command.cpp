#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/config/option_value.h"
#include "sim/input/machine_description.h"
#include "sim/input/read_errors.h"
#include "sim/input/read_scenario.h"
#include "sim/input/uncertain_errors.h"
#include "sim/model/machine_parts.h"
#include "sim/model/scenario_parts.h"
#include "sim/model/undetermined_errors.h"
#include "sim/system/output_name.h"
#include "sim/system/system_error.h"
#include "sim/system/write_file.h"
#include "sim/tables/table_request.h"
#include "sim/tables/verify_tables.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/import_errors.h"
#include "tools/servomill/progress_line.h"
#include "tools/servomill/table_json.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;
namespace fs = std::filesystem;

// Machine and error models: a scenario's, or those of --machine and of a file of error models, by
// default the machine's own.
struct Inputs {
  std::shared_ptr<const sim::model::MachineSettings> machine;
  std::map<std::string, plant::ErrorModel> models;
  std::shared_ptr<const sim::model::UncertainErrors> uncertain;  // of a scenario's machine; or none
};

Inputs read_inputs(const Options& options) {
  if (!options.has("machine")) {
    const auto scenario = sim::input::shared_scenario(options.word(), options.list("set"));
    return {{scenario, &sim::model::machine_of(*scenario)},
            sim::model::errors_of(*scenario),
            sim::model::uncertain_errors_of(*scenario)};
  }
  sim::input::MachineDescription described = sim::input::read_machine_description(
      options.get<std::string>("machine"), options.list("set"));
  Inputs inputs{described.machine, std::move(described.errors), nullptr};
  if (!options.words().empty()) {
    inputs.models =
        sim::input::read_error_file(options.word(), sim::input::MachineAxes(*inputs.machine));
  }
  return inputs;
}

std::string error_file(const Options& options) {
  return options.words().empty() ? options.get<std::string>("machine") : options.word();
}

// The error model that --model names; without it the only one there is.
const plant::ErrorModel& model_of(const Inputs& inputs, const Options& options, std::string& name) {
  std::vector<std::string_view> names;
  for (const auto& [key, model] : inputs.models) names.push_back(key);
  if (names.empty()) {
    throw InputError({error_file(options)}, "has no error model; add one as [errors.NAME]");
  }
  const std::string there_are = fmt::format("known are {}", fmt::join(names, ", "));
  if (!options.has("model") && names.size() > 1) {
    throw InputError({"--model"}, fmt::format("is missing; {}", there_are));
  }
  name = options.has("model") ? options.get<std::string>("model") : std::string(names.front());
  const auto found = inputs.models.find(name);
  if (found != inputs.models.end()) return found->second;
  throw InputError({"--model"}, fmt::format("no error model '{}'{}; {}", name,
                                            did_you_mean(name, names), there_are));
}

// Numbers that a calibration has identified; none: nobody has calibrated the machine.
std::shared_ptr<const sim::model::UncertainErrors> identified_of(const Inputs& inputs,
                                                                 const Options& options,
                                                                 const std::string& model) {
  const JointLayout& layout = sim::model::layout_of(*inputs.machine);
  if (options.has("machine")) {
    return sim::input::uncertain_errors_of_file(error_file(options), model, layout);
  }
  return sim::model::is_of_model(inputs.uncertain, model) ? inputs.uncertain : nullptr;
}

// "X=..." of an option that may come once for each axis.
struct AxisWord {
  int joint;
  std::string_view value;
};

AxisWord axis_word(const std::string& option, std::string_view text, std::string_view form,
                   const sim::model::MachineSettings& machine) {
  const bool named = text.size() > 2 && text[1] == '=';
  const auto axis = named ? axis_of(text.front()) : std::nullopt;
  const auto joint = axis ? sim::model::layout_of(machine).joint_of(*axis) : std::nullopt;
  if (joint) return {*joint, text.substr(2)};
  std::string letters;
  for (const int j : sim::model::joints_of(machine)) {
    letters += fmt::format("{}{}", letters.empty() ? "" : ", ",
                           sim::model::layout_of(machine).letter_of(j));
  }
  throw InputError(
      {"--" + option},
      fmt::format("'{}'; must be {}, in mm or deg; the machine has {}", text, form, letters));
}

// "200" or "200 mm" of an option's value, in SI.
double position_of(const char* option, const std::string& text, std::string_view position,
                   int joint) {
  const bool linear = joint < kLinearJoints;
  const sim::config::ScaledText value = sim::config::scale_option(
      position, linear ? sim::config::kLength : sim::config::kAngle, linear ? "mm" : "deg");
  if (value.complaint.empty()) return value.si;
  throw InputError({option}, fmt::format("'{}': '{}' {}", text, position, value.complaint));
}

void read_axes(const Options& options, const sim::model::MachineSettings& machine,
               sim::tables::TableRequest& request) {
  const auto place_of = [&](int joint) -> auto& {
    return request.axes[static_cast<std::size_t>(joint)];
  };
  for (auto& axis : request.axes) axis.wanted = false;
  for (const int j : chosen_joints(options, machine)) place_of(j).wanted = true;
  constexpr std::string_view kTravelForm = "AXIS=FROM:TO", kAtForm = "AXIS=POSITION";
  for (const std::string& text : options.list("travel")) {
    const auto [joint, range] = axis_word("travel", text, kTravelForm, machine);
    const auto colon = range.find(':');
    const bool split = colon != std::string_view::npos;
    if (!split) throw InputError({"--travel"}, fmt::format("'{}'; must be {}", text, kTravelForm));
    const double from = position_of("--travel", text, range.substr(0, colon), joint);
    const double to = position_of("--travel", text, range.substr(colon + 1), joint);
    if (!(from < to)) {
      throw InputError({"--travel"},
                       fmt::format("'{}'; must be {} with FROM < TO", text, kTravelForm));
    }
    place_of(joint).from = from;
    place_of(joint).to = to;
  }
  for (const std::string& text : options.list("at")) {
    const auto [joint, value] = axis_word("at", text, kAtForm, machine);
    place_of(joint).reference = position_of("--at", text, value, joint);
  }
}

// Options that would do nothing.
void refuse_idle_options(const Options& options, const sim::model::MachineSettings& machine,
                         sim::tables::TableFormat format) {
  if (sim::tables::rules_of(format).components) {
    for (const char* name : {"at", "tool-length"}) {
      if (!options.has(name)) continue;
      throw InputError({std::string("--") + name},
                       fmt::format("has no effect with {}, which contains the errors themselves",
                                   sim::tables::name_of(format)));
    }
  }
  if (sim::tables::rules_of(format).skew) {
    for (const char* name : {"at", "spacing", "rotary-spacing", "max-points"}) {
      if (!options.has(name) || (name == std::string_view("at") && options.has("bed-mesh")))
        continue;
      throw InputError({std::string("--") + name},
                       fmt::format("has no effect with {}, which contains three angles only",
                                   sim::tables::name_of(format)));
    }
  }
  if (format != sim::tables::TableFormat::linuxcnc && options.has("comp-file-type")) {
    throw InputError({"--comp-file-type"},
                     fmt::format("has no effect with {}", sim::tables::name_of(format)));
  }
  const auto joints = sim::model::joints_of(machine);
  if (options.has("rotary-spacing") && joints.back() < kLinearJoints) {
    throw InputError({"--rotary-spacing"}, "the machine has no rotary axis");
  }
}

// Formats that are wanted but not documented well enough to write for a real machine.
void refuse_undocumented(const std::string& format) {
  struct Refusal {
    std::string_view name, reason;
  };
  constexpr std::array<Refusal, 2> kRefusals = {{
      {"fanuc",
       "is not supported: the documents found describe the parameters of pitch error compensation "
       "(3620 to 3627), but neither the sign of its values nor the file format"},
      {"vcs",
       "is not supported: no document describing the files of Siemens VCS was found; siemens "
       "writes EEC and CEC"},
  }};
  for (const Refusal& refusal : kRefusals) {
    if (format != refusal.name) continue;
    throw InputError({"--format"}, fmt::format("{} {}", refusal.name, refusal.reason));
  }
}

// "7x5": points along X and Y.
std::array<int, 2> mesh_of(const Options& options, sim::tables::TableFormat format) {
  const auto& text = options.get<std::string>("bed-mesh");
  if (!sim::tables::rules_of(format).skew) {
    throw InputError(
        {"--bed-mesh"},
        fmt::format("has no effect with {}; marlin, klipper and reprapfirmware take one",
                    sim::tables::name_of(format)));
  }
  constexpr int kMax = 100;
  std::array<int, 2> out{};
  int read = 0;
  const bool is_read = std::sscanf(text.c_str(), "%4dx%4d%n", out.data(), &out[1], &read) == 2 &&
                       read == static_cast<int>(text.size());
  if (is_read && std::min(out[0], out[1]) >= 3 && std::max(out[0], out[1]) <= kMax) return out;
  throw InputError(
      {"--bed-mesh"},
      fmt::format("'{}'; must be points along X and Y, such as 7x5, 3 to {} each", text, kMax));
}

sim::tables::TableRequest request_of(const Options& options,
                                     const sim::model::MachineSettings& machine) {
  sim::tables::TableRequest request;
  if (!options.has("format")) {
    throw InputError({"--format"}, fmt::format("is missing; must be one of {}",
                                               fmt::join(sim::tables::kTableFormats, ", ")));
  }
  refuse_undocumented(options.get<std::string>("format"));
  request.format = static_cast<sim::tables::TableFormat>(
      choice_option(options, "format", sim::tables::kTableFormats));
  refuse_idle_options(options, machine, request.format);
  request.tool_length =
      quantity_option(options, "tool-length", sim::config::kLength, "mm").value_or(0.0);
  if (request.tool_length < 0.0) {
    throw InputError({"--tool-length"},
                     fmt::format("'{}' must be >= 0", options.get<std::string>("tool-length")));
  }
  request.spacing = positive_option(options, "spacing", sim::config::kLength, "mm");
  request.rotary_spacing = positive_option(options, "rotary-spacing", sim::config::kAngle, "deg");
  if (options.has("max-points")) {
    const int points = options.get<int>("max-points");
    const std::size_t most = sim::tables::rules_of(request.format).most_points;
    const bool may_be_more = request.format == sim::tables::TableFormat::siemens;
    constexpr int kMax = 10000;
    const int limit = may_be_more ? kMax : static_cast<int>(most);
    if (points < 2 || points > limit) {
      throw InputError({"--max-points"}, fmt::format("{}; must be >= 2 and <= {} for {}", points,
                                                     limit, sim::tables::name_of(request.format)));
    }
    request.most_points = static_cast<std::size_t>(points);
  }
  if (options.has("comp-file-type")) {
    request.comp_file_type = options.get<int>("comp-file-type");
    if (request.comp_file_type != 0 && request.comp_file_type != 1) {
      throw InputError({"--comp-file-type"},
                       fmt::format("{}; must be 0 or 1", request.comp_file_type));
    }
  }
  if (options.has("bed-mesh")) request.mesh = mesh_of(options, request.format);
  read_axes(options, machine, request);
  return request;
}

// All or none: nothing is written before every name is known to be free.
void write(const std::vector<sim::tables::TextFile>& files, const std::string& folder, bool force) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw InputError({folder}, "is not a folder; specify a folder for the tables");
  }
  for (const sim::tables::TextFile& file : files) {
    const std::string path = (fs::path(folder) / file.name).string();
    if (fs::exists(fs::symlink_status(path, error))) {
      sim::system::output_target(path, sim::system::existing_of(force));
    }
  }
  fs::create_directories(folder, error);
  if (error) throw sim::system::SystemError(folder, "cannot be created", error.message());
  for (const sim::tables::TextFile& file : files) {
    sim::system::write_text_file((fs::path(folder) / file.name).string(), file.text, force);
  }
}

void add_table_options(Options& options) {
  options.add()(
      "format", po::value<std::string>()->value_name("FORMAT"),
      "linuxcnc, heidenhain, siemens, csv, isg, etalon, marlin, klipper or reprapfirmware");
  options.add()("output,o", po::value<std::string>()->value_name("FOLDER"),
                "folder for the files; with --import the file of the error model");
  options.add()("import", po::value<std::vector<std::string>>()->value_name("FILE"),
                "reads a parameter file in the format csv, isg or etalon and writes it as "
                "[errors.NAME] for the machine of --machine; NAME is given by --model (default: "
                "measured); csv: once for each file");
  options.add()("machine", po::value<std::string>()->value_name("M.toml"),
                "machine file; it needs only structure, travel and errors. The scenario is then "
                "omitted, and the error models are those of the machine, or it is replaced by a "
                "file of error models [errors.NAME]");
  options.add()("model", po::value<std::string>()->value_name("NAME"),
                "error model; required if there are several");
  options.add()("axis,a", po::value<std::string>()->default_value("all")->value_name("X,Y"),
                "base axes of the tables");
  options.add()(
      "spacing", po::value<std::string>()->value_name("\"5 mm\""),
      "spacing of the points of linear axes, bare numbers in mm; default: 1, 2 or 5 x 10^n mm, "
      "heidenhain 2^n x 0.1 um, the smallest that gives 256 points or fewer (siemens: 200)");
  options.add()("rotary-spacing", po::value<std::string>()->value_name("\"5 deg\""),
                "spacing of the points of rotary axes, bare numbers in deg");
  options.add()("max-points", po::value<int>()->value_name("N"),
                "maximum number of points per table: siemens as set by MD38000 and MD18342 "
                "(default 200), linuxcnc and heidenhain at most 256, csv 10000");
  options.add()("travel", po::value<std::vector<std::string>>()->value_name("X=FROM:TO"),
                "range of an axis in mm or deg; default: its travel");
  options.add()("at", po::value<std::vector<std::string>>()->value_name("Z=POSITION"),
                "position of an axis for which the tables of the other axes are computed, in mm or "
                "deg; default: the middle of travel (linear) or 0 (rotary)");
  options.add()("tool-length", po::value<std::string>()->value_name("\"110 mm\""),
                "distance from the spindle nose to the TCP; default 0; bare numbers in mm");
  options.add()("bed-mesh", po::value<std::string>()->value_name("7x5"),
                "marlin, klipper and reprapfirmware: also writes a bed mesh with that many points "
                "along X and Y, at the reference of Z (--at)");
  options.add()("comp-file-type", po::value<int>()->value_name("0|1"),
                "linuxcnc: COMP_FILE_TYPE; 0: actual positions (default), 1: trims");
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the scenario or of the machine file, as for servomill run");
  options.add()("force,f", "replaces files of the same names");
  options.add()("json", "prints the report as one JSON object; excludes --import");
  options.add()("quiet,q", "prints only faults");
  add_plugin_option(options);
}

}  // namespace

int table_command(const Arguments& arguments) {
  Options options(
      "table", "SCENARIO.toml|--machine M.toml --format FORMAT -o FOLDER",
      "Writes an error model as compensation tables for a real NC: corrections of each axis over\n"
      "its own position, for heidenhain and siemens also over the positions of the two other\n"
      "linear axes. A table contains the errors on one line along its axis; its value at the\n"
      "reference is 0. Errors that a table cannot represent are listed by their ISO 230-1 names,\n"
      "with their residual at the TCP. csv, isg (ISG CSV, for Beckhoff TF5280) and etalon\n"
      "(exchange format, as TF5280 reads it) contain the errors themselves and can be read by\n"
      "--import. marlin, klipper and reprapfirmware represent the squareness of X, Y and Z as a\n"
      "skew correction. Every file cites the document of its format. Files are read back by the\n"
      "rules of that document and compared with the error model before they are written.",
      "SCENARIO.toml");
  add_table_options(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  if (!options.has("output") || options.get<std::string>("output").empty()) {
    throw InputError({"servomill table"}, "needs the name of a folder: -o FOLDER");
  }

  if (options.has("import")) {
    if (options.has("json")) throw InputError({"--json"}, "excludes --import");
    return import_errors(options);
  }

  ProgressLine line(options);
  const Inputs inputs = read_inputs(options);
  sim::tables::TableRequest request = request_of(options, *inputs.machine);
  const plant::ErrorModel& errors = model_of(inputs, options, request.model);
  request.identified = identified_of(inputs, options, request.model);
  if (request.identified) {
    request.unknown = sim::model::undetermined_errors(errors, *request.identified,
                                                      sim::model::layout_of(*inputs.machine));
  }
  const auto exported = [&] {
    try {
      return sim::tables::shared_export(*inputs.machine, errors, request);
    } catch (const InputError& error) {  // knows what is wrong, not where
      throw InputError({error_file(options)}, error.faults().front().message);
    }
  }();
  const sim::tables::TableExport& tables = *exported;
  const auto folder = options.get<std::string>("output");
  const auto files = sim::tables::table_files(tables);
  const sim::tables::TableVerification verified = sim::tables::verify_tables(tables, files);
  line.end();
  write(files, folder, options.has("force"));
  std::vector<std::string> names;
  for (const sim::tables::TextFile& file : files) {
    names.push_back((fs::path(folder) / file.name).string());
  }
  if (options.has("json")) {
    fmt::print("{}\n", tables_json(tables, verified, names));
    return kDone;
  }
  if (options.has("quiet")) return kDone;
  for (const std::string& text : sim::tables::report(tables)) fmt::print("{}\n", text);
  fmt::print("{}\nwritten: {}\n", sim::tables::to_string(verified), fmt::join(names, " "));
  return kDone;
}

}  // namespace servomill::tools
