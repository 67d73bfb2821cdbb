// Scenario and machine files through their readers. A document with the key `structure` is a
// machine, all others are scenarios; lines `#--set KEY=VALUE` in it are changes as from the command
// line. Laws: faults of the document have their places; what was read and written again reads to
// the same.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "plant/vocabulary/stored_text.h"
#include "sim/config/reader.h"
#include "sim/input/machine_document.h"
#include "sim/input/read_machine.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/system/read_file.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {
namespace {

constexpr std::string_view kDocument = "fuzz.toml";
std::string_view document;  // that is being run

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  require(in.good(), "the files of scenarios are there", path);
  return {std::istreambuf_iterator<char>(in), {}};
}

// All the files that there are, by name without folder.
const std::map<std::string, std::string, std::less<>>& files() {
  static const std::string kScenarios = SERVOMILL_SOURCE_DIR "/scenarios/";
  static const std::map<std::string, std::string, std::less<>> kFiles = {
      {"hsm600u.toml", bytes_of(kScenarios + "machines/hsm600u.toml")},
      {"generic_trunnion_ac.toml", bytes_of(kScenarios + "machines/generic_trunnion_ac.toml")},
      {"square_part_side.ngc", bytes_of(kScenarios + "programs/square_part_side.ngc")},
      {"circular.ngc", bytes_of(kScenarios + "programs/circular.ngc")}};
  return kFiles;
}

std::vector<std::string> changes_in(std::string_view text) {
  constexpr std::string_view kMark = "#--set ";
  std::vector<std::string> changes;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (line.starts_with(kMark)) changes.emplace_back(line.substr(kMark.size()));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return changes;
}

// Faults of other files, of changes and of what they lay over the document are elsewhere.
void require_own_places(const InputError& error, std::string_view text) {
  require(!error.faults().empty(), "an InputError has a fault");
  for (const Fault& fault : error.faults()) {
    if (fault.place.file == kDocument) require_places(std::span(&fault, 1), text, kDocument);
    require(!fault.place.file.empty() && !fault.message.empty(), "a fault has file and message",
            to_string(fault));
  }
}

void read_machine(std::string_view text) {
  sim::input::InputFiles none;
  const auto parsed =
      sim::input::machine_document_of_text(std::string(text), std::string(kDocument), none)
          .document;
  sim::config::Reader root(parsed);
  sim::input::read_machine(root);
  root.finish();
  const std::string written = parsed.to_toml();
  require(sim::config::Document::from_text(written, "written.toml").to_toml() == written,
          "what was written reads to the same", written);
}

void read_scenario(std::string_view text) {
  const auto scenario = sim::input::read_scenario(std::string(kDocument), changes_in(text));
  std::string again;
  try {
    again = sim::input::read_resolved_scenario(scenario.resolved, "resolved.toml").resolved;
  } catch (const InputError& error) {
    require(false, "a resolved scenario is accepted", error.what() + ("\n" + scenario.resolved));
  }
  require(again == scenario.resolved, "a resolved scenario reads to the same",
          scenario.resolved + "\n----\n" + again);
}

bool is_machine(std::string_view text) {
  return sim::config::Document::from_text(text, std::string(kDocument)).root().find("structure") !=
         nullptr;
}

}  // namespace

void run(std::string_view text) {
  document = text;
  try {
    is_machine(text) ? read_machine(text) : read_scenario(text);
  } catch (const InputError& error) {
    require_own_places(error, text);
  }
}

}  // namespace servomill::fuzz

namespace servomill::sim::system {

// In place of those of sim/system/read_file.cpp: no file but those named above can be read.
std::string read_file(const std::string& path, const Place& at, std::string_view what,
                      std::uintmax_t /*most*/) {
  if (path == fuzz::kDocument) return std::string(fuzz::document);
  const auto found = fuzz::files().find(std::filesystem::path(path).filename().string());
  if (found != fuzz::files().end()) return found->second;
  throw InputError(at.file.empty() ? Place{path} : at,
                   fmt::format("{} '{}' cannot be read", what, path));
}

StoredText stored_file(const std::string& path, const Place& at, std::string_view what) {
  return StoredText(read_file(path, at, what, kMaxBytesOfFile));
}

}  // namespace servomill::sim::system
