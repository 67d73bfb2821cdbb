#include "tools/servomill/import_errors.h"

#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"
#include "sim/config/document.h"
#include "sim/input/machine_description.h"
#include "sim/input/read_errors.h"
#include "sim/model/machine.h"
#include "sim/system/read_file.h"
#include "sim/system/write_file.h"
#include "sim/tables/error_import.h"
#include "sim/tables/grid_import.h"
#include "tools/servomill/axis_options.h"

namespace servomill::tools {
namespace {

// Options that would do nothing.
void refuse_idle_options(const Options& options) {
  for (const char* name : {"spacing", "rotary-spacing", "max-points", "travel", "at", "tool-length",
                           "comp-file-type"}) {
    if (!options.has(name)) continue;
    throw InputError({std::string("--") + name}, "has no effect with --import");
  }
  if (options.get<std::string>("axis") != "all") {
    throw InputError({"--axis"}, "has no effect with --import");
  }
  if (!options.words().empty()) {
    throw InputError({options.words().front()},
                     "is not used with --import, which takes the machine from --machine");
  }
}

// A name that TOML takes bare, and that can be given to --model again.
std::string model_name(const Options& options) {
  const std::string name = options.has("model") ? options.get<std::string>("model") : "measured";
  constexpr std::string_view kBare =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  if (!name.empty() && name.find_first_not_of(kBare) == std::string::npos) return name;
  throw InputError({"--model"},
                   fmt::format("'{}'; must consist of letters, digits, _ and -", name));
}

sim::tables::ImportedColumns read_files(const Options& options) {
  if (!options.has("format")) {
    throw InputError({"--format"}, "is missing; --import reads csv, isg or etalon");
  }
  const auto format = static_cast<sim::tables::TableFormat>(
      choice_option(options, "format", sim::tables::kTableFormats));
  std::vector<controllers::TableText> files;
  for (const std::string& path : options.list("import")) {
    files.push_back({path, sim::system::read_file(path, {}, "parameter file")});
  }
  return sim::tables::read_columns(format, files);
}

plant::ErrorModel read_back(const std::string& text, const std::string& path,
                            const std::string& name, const sim::input::MachineAxes& machine) {
  const sim::config::Document document = sim::config::Document::from_text(text, path);
  sim::config::Reader root(document);
  sim::config::Reader models = root.table("errors");
  auto all = sim::input::read_error_models(models, machine);
  root.finish();
  return std::move(all.at(name));
}

}  // namespace

int import_errors(const Options& options) {
  refuse_idle_options(options);
  if (!options.has("machine")) {
    throw InputError({"--machine"}, "is missing; --import needs the structure of the machine");
  }
  const std::string name = model_name(options);
  const auto path = options.get<std::string>("output");
  sim::system::refuse_unwritable_text(path, options.has("force"));
  const auto described = sim::input::read_machine_description(options.get<std::string>("machine"),
                                                              options.list("set"));
  const plant::MachineChain& chain = described.machine->chain;

  sim::tables::ImportedColumns columns = read_files(options);
  std::vector<std::string> assumptions;
  sim::tables::cover_travel(columns, *described.machine, assumptions);
  const sim::tables::ErrorImport imported = sim::tables::import_errors(columns, chain);
  std::vector<std::string> comments = {
      fmt::format("errors of {} from {}", described.machine->name,
                  fmt::join(options.list("import"), ", ")),
      fmt::format("document: {}", sim::tables::rules_of(columns.format).document)};
  comments.insert(comments.end(), imported.notes.begin(), imported.notes.end());
  comments.insert(comments.end(), assumptions.begin(), assumptions.end());
  const std::string text = sim::tables::errors_toml(imported.errors, name, comments);
  const std::size_t positions = sim::tables::verify_import(
      columns, chain, read_back(text, path, name, sim::input::MachineAxes(*described.machine)));
  sim::system::write_text_file(path, text, options.has("force"));

  if (options.has("quiet")) return kDone;
  for (const std::string& comment : comments) fmt::print("{}\n", comment);
  fmt::print("verified: {} positions, to 2 nm and 2 nrad\nwritten: {}\n", positions, path);
  return kDone;
}

}  // namespace servomill::tools
