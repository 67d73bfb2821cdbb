#include "sim/input/subroutine_files.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <utility>

namespace servomill::sim::input {
namespace {

bool is_number(const std::string& name) {
  return !name.empty() && name.find_first_not_of("0123456789") == name.npos;
}

// LinuxCNC calls *.ngc, conversational programs call their like. Of controls with O numbers the
// file of O15 is called O0015.nc, or as its number.
std::vector<std::string> file_names(const std::string& program_file, const std::string& name) {
  const std::string extension = std::filesystem::path(program_file).extension().string();
  if (extension == ".h") return {name + ".h", name + ".H"};
  if (extension == ".H") return {name + ".H", name + ".h"};
  std::vector<std::string> names = {name + ".ngc"};
  if (!is_number(name)) return names;
  constexpr std::size_t kDigits = 4, kDigitsOfHaas = 5;
  for (const std::size_t digits : {kDigits, kDigitsOfHaas}) {
    const std::string zeros(digits - std::min(name.size(), digits), '0');
    names.push_back("O" + zeros + name + extension);
  }
  names.push_back(name + extension);
  return names;
}

}  // namespace

std::string subroutine_file(const std::string& program_file, const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(program_file).parent_path();
  const std::vector<std::string> names = file_names(program_file, name);
  for (const std::string& one : names) {
    if (std::filesystem::is_regular_file(folder / one)) return (folder / one).string();
  }
  return (folder / names.front()).string();
}

std::function<std::optional<controllers::ProgramText>(const std::string& name)> subroutine_files(
    const std::string& program_file, const std::vector<std::string>& folders) {
  std::vector<std::filesystem::path> places = {std::filesystem::path(program_file).parent_path()};
  places.insert(places.end(), folders.begin(), folders.end());
  return [places = std::move(places),
          program_file](const std::string& name) -> std::optional<controllers::ProgramText> {
    for (const std::filesystem::path& place : places) {
      for (const std::string& one : file_names(program_file, name)) {
        const std::filesystem::path file = place / one;
        if (!std::filesystem::is_regular_file(file)) continue;
        return controllers::ProgramText::of_file(file.string());
      }
    }
    return std::nullopt;
  };
}

}  // namespace servomill::sim::input
