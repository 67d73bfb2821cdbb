#include "sim/input/subroutine_files.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <utility>

namespace servomill::sim::input {
namespace {

bool is_number(const std::string& name) {
  return !name.empty() && name.find_first_not_of("0123456789") == name.npos;
}

std::string with_case(std::string text, int (*to)(int)) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [to](char c) { return static_cast<char>(to(static_cast<unsigned char>(c))); });
  return text;
}

bool is_of_siemens(const std::string& extension) {
  const std::string capitals = with_case(extension, std::toupper);
  return capitals == ".MPF" || capitals == ".SPF";
}

// Names of programs are in capitals or not, subprograms come before main programs.
std::vector<std::string> siemens_names(const std::string& name) {
  std::vector<std::string> names;
  for (const char* const extension : {".SPF", ".spf", ".MPF", ".mpf"}) {
    for (const std::string& one :
         {name, with_case(name, std::toupper), with_case(name, std::tolower)}) {
      names.push_back(one + extension);
    }
  }
  return names;
}

// LinuxCNC calls *.ngc, conversational programs call their like. Of controls with O numbers the
// file of O15 is called O0015.nc, or as its number.
std::vector<std::string> file_names(const std::string& program_file, const std::string& name) {
  const std::string extension = std::filesystem::path(program_file).extension().string();
  if (extension == ".h") return {name + ".h", name + ".H"};
  if (extension == ".H") return {name + ".H", name + ".h"};
  if (is_of_siemens(extension)) return siemens_names(name);
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
