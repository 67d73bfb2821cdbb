#include "sim/input/subroutine_files.h"

#include <filesystem>
#include <utility>

namespace servomill::sim::input {
namespace {

// LinuxCNC calls *.ngc, conversational programs call their like.
std::vector<std::string> file_names(const std::string& program_file, const std::string& name) {
  const std::string extension = std::filesystem::path(program_file).extension().string();
  if (extension == ".h") return {name + ".h", name + ".H"};
  if (extension == ".H") return {name + ".H", name + ".h"};
  return {name + ".ngc"};
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
