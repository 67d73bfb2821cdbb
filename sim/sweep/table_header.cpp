#include "sim/sweep/table_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <vector>

#include "sim/input/read_scenario.h"
#include "sim/records/input_file.h"
#include "sim/run/result_file.h"
#include "sim/sweep/table_columns.h"

namespace servomill::sim::sweep {
namespace {

// Returns true if a file begins with zeros: its beginning is written last.
bool begins_empty(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 8> begin{};
  file.read(begin.data(), begin.size());
  return std::all_of(begin.begin(), begin.end(), [](char c) { return c == '\0'; });
}

// A kill at the first writes leaves a file that ends within its first block.
bool ends_in_first_block(const std::string& path) {
  constexpr std::uintmax_t kFirstBlock = 2048;
  std::error_code ignored;
  return std::filesystem::file_size(path, ignored) < kFirstBlock;
}

bool is_table_without_rows(const records::InputFile& file) {
  return file.has_attribute("/", "kind") && file.text("/", "kind") == "sweep" &&
         (!file.has(kSweepGroup) || !file.has_attribute(kSweepGroup, "points"));
}

}  // namespace

bool is_unborn(const std::string& path) {
  if (begins_empty(path)) return true;
  if (!run::is_hdf5(path)) return false;
  try {
    return is_table_without_rows(records::InputFile(path));
  } catch (const InputError&) {
    if (ends_in_first_block(path)) return true;
    throw;
  }
}

std::string why_other(const SweepHeader& header, const model::Scenario& base,
                      const Selection& selection) {
  const std::string changed = changed_file(header.base.swept_files, base.swept_files);
  if (header.base.resolved != base.resolved && (changed.empty() || header.base.name != base.name)) {
    return header.base.name == base.name
               ? "contains a sweep of an earlier version of this scenario"
               : fmt::format("contains a sweep of the scenario '{}'", header.base.name);
  }
  if (!changed.empty()) {
    return fmt::format("contains a sweep of this scenario with an earlier version of its file '{}'",
                       changed);
  }
  if (!(header.selection == selection)) {
    const auto said = [](const Selection& s) {
      return fmt::format("points {} to {}, shard {} of {}", s.first + 1, s.last, s.shard, s.shards);
    };
    return fmt::format("contains {} of the sweep; requested are {}", said(header.selection),
                       said(selection));
  }
  return {};
}

std::string changed_file(const std::string& before, const std::string& after) {
  const auto name_of = [](const std::string& line) { return line.substr(line.find(' ') + 1); };
  const std::vector<std::string> others = run::split_lines(before);
  for (const std::string& line : run::split_lines(after)) {
    for (const std::string& other : others) {
      if (line != other && name_of(line) == name_of(other)) return name_of(line);
    }
  }
  return {};
}

SweepHeader read_sweep_header(const records::InputFile& file) {
  const std::string& path = file.path();
  if (!file.has_attribute("/", "schema_version")) {
    throw InputError({path}, "is not a result file of servomill");
  }
  if (file.text("/", "kind") != "sweep") {
    throw InputError({path}, fmt::format("contains a {}, not a sweep", file.text("/", "kind")));
  }
  const auto version = static_cast<int>(file.number("/", "schema_version"));
  if (version != kSweepSchemaVersion) {
    throw InputError({path},
                     fmt::format("contains a sweep of schema version {}; this program reads "
                                 "version {}",
                                 version, kSweepSchemaVersion));
  }
  if (!file.has(kSweepGroup) || !file.has_attribute(kSweepGroup, "points")) {
    throw InputError({path}, "has an incomplete table");
  }
  SweepHeader header;
  const std::string resolved = file.text("/inputs", "resolved");
  header.base = input::read_resolved_scenario(
      resolved, path + ":/inputs",
      std::make_shared<const StoredText>(file.stored_text("/inputs", "program")));
  header.base.name = file.text("/", "scenario");
  header.base.text = file.text("/inputs", "scenario");
  header.base.machine_text = file.text("/inputs", "machine");
  header.base.resolved = resolved;
  if (file.has_attribute("/inputs", "swept_files")) {
    header.base.swept_files = file.text("/inputs", "swept_files");
  }
  const auto number = [&](const std::string& name) {
    return static_cast<std::uint64_t>(file.number(kSweepGroup, name));
  };
  header.points = number("points");
  header.selection = {number("first") - 1, number("last"), number("shard"), number("shards")};
  return header;
}

}  // namespace servomill::sim::sweep
