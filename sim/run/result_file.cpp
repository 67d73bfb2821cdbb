#include "sim/run/result_file.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "plant/vocabulary/input_error.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"
#include "sim/run/build_identity.h"
#include "sim/system/output_name.h"
#include "sim/version.h"

namespace servomill::sim::run {

std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char c : text) {
    if (c == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += c;
    }
  }
  return lines;
}

void write_build(records::Hdf5Group& root) {
  root.attribute("servomill_version", kVersion);
  root.attribute("servomill_build", result_identity());
}

std::string build_of(const records::InputFile& file) {
  const char* name =
      file.has_attribute("/", "servomill_build") ? "servomill_build" : "servomill_version";
  return file.text("/", name);
}

bool is_hdf5(const std::string& path) {
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
  std::array<char, kSignature.size()> begin{};
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), begin.size());
  return file && std::string_view(begin.data(), begin.size()) == kSignature;
}

std::string writable_name(const std::string& path, bool force) {
  namespace fs = std::filesystem;
  if (path.empty()) throw InputError({"--output"}, "the name of the result file is empty");
  std::string target = system::output_target(path, system::existing_of(force));
  std::error_code ignored;
  const std::string partial = target + ".partial";
  if (!force) system::refuse_partial(partial);
  for (const std::string& name : {target, partial}) {
    if (!fs::exists(name, ignored) || fs::is_empty(name, ignored) || is_hdf5(name)) continue;
    throw InputError({name},
                     "exists and is not a result file; --force does not overwrite other files");
  }
  return target;
}

}  // namespace servomill::sim::run
