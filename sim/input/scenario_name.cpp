#include "sim/input/scenario_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "plant/vocabulary/input_error.h"
#include "sim/input/machine_document.h"

namespace servomill::sim::input {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".toml";
constexpr const char* kNoFolder =
    "no such file; names cannot be looked up, because there is no folder of scenarios here and "
    "none is installed";

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// Scenarios have cases, or those of another scenario; machines, experiments and readings have none.
bool has_cases(const fs::path& path) {
  std::ifstream file(path);
  bool has_base = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("[[case]]")) return true;
    has_base |= line.starts_with("based_on");
  }
  return has_base && !is_machine_file(path);
}

std::string without_suffix(const std::string& name) {
  return name.ends_with(kSuffix) ? name.substr(0, name.size() - kSuffix.size()) : name;
}

// Names with the same last part, as guevel2025/experiment1 to experiment1, else the nearest by
// letters; empty: none.
std::string nearest_of(const std::vector<std::string>& names, const std::string& plain) {
  std::vector<std::string> near;
  for (const std::string& name : names) {
    const bool is_same = fs::path(name).filename() == fs::path(plain).filename();
    if (is_same && std::find(near.begin(), near.end(), name) == near.end()) near.push_back(name);
  }
  const std::vector<std::string_view> views(names.begin(), names.end());
  return near.empty() ? did_you_mean(plain, views)
                      : fmt::format("; did you mean '{}'?", fmt::join(near, "' or '"));
}

}  // namespace

std::vector<std::string> scenario_folders(const fs::path& share) {
  constexpr const char* kFolder = "scenarios";
  std::vector<std::string> out;
  std::error_code fault;
  if (fs::is_directory(kFolder, fault)) out.emplace_back(kFolder);
  if (share.empty()) return out;
  const fs::path installed = (share / kFolder).lexically_normal();
  if (fs::is_directory(installed, fault)) out.push_back(installed.string());
  return out;
}

std::vector<std::string> scenario_names(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::recursive_directory_iterator(folder, ignored)) {
    if (entry.path().extension() != kSuffix || !has_cases(entry.path())) continue;
    names.push_back(without_suffix(entry.path().lexically_relative(folder).string()));
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string scenario_file(const std::string& word, const std::vector<std::string>& folders) {
  if (fs::exists(word)) return word;
  const std::string plain = without_suffix(word), file = plain + std::string(kSuffix);
  if (is_file(file)) return file;
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    const fs::path found = fs::path(folder) / file;
    if (is_file(found)) return found.string();
    const std::vector<std::string> here = scenario_names(folder);
    names.insert(names.end(), here.begin(), here.end());
  }
  const std::string nearest = nearest_of(names, plain);
  if (!nearest.empty()) throw InputError({word}, "is no file and no scenario" + nearest);
  if (folders.empty() && fs::path(word).extension().empty()) throw InputError({word}, kNoFolder);
  return word;
}

std::string machine_file(const std::string& word, const std::vector<std::string>& folders) {
  if (fs::exists(word)) return word;
  const std::string plain = without_suffix(word), file = plain + std::string(kSuffix);
  if (is_file(file)) return file;
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    const fs::path machines = fs::path(folder) / "machines";
    for (const fs::path& found : {machines / file, fs::path(folder) / file}) {
      if (is_file(found)) return found.string();
    }
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(machines, ignored)) {
      if (entry.path().extension() == kSuffix) names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  const std::string nearest = nearest_of(names, fs::path(plain).filename().string());
  if (!nearest.empty()) throw InputError({word}, "is no file and no machine" + nearest);
  if (folders.empty() && fs::path(word).extension().empty()) throw InputError({word}, kNoFolder);
  return word;
}

}  // namespace servomill::sim::input
