#include "sim/input/subroutine_files.h"

#include <filesystem>
#include <utility>

namespace servomill::sim {

std::string subroutine_file(const std::string& program_file, const std::string& name) {
  return (std::filesystem::path(program_file).parent_path() / (name + ".ngc")).string();
}

std::function<std::optional<controllers::ProgramText>(const std::string& name)> subroutine_files(
    const std::string& program_file, const std::vector<std::string>& folders) {
  std::vector<std::filesystem::path> places = {std::filesystem::path(program_file).parent_path()};
  places.insert(places.end(), folders.begin(), folders.end());
  return [places = std::move(places)](
             const std::string& name) -> std::optional<controllers::ProgramText> {
    for (const std::filesystem::path& place : places) {
      const std::filesystem::path file = place / (name + ".ngc");
      if (std::filesystem::is_regular_file(file)) {
        return controllers::ProgramText::of_file(file.string());
      }
    }
    return std::nullopt;
  };
}

}  // namespace servomill::sim
