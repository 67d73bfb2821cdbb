#include "sim/system/program_folder.h"

#include <system_error>

namespace servomill::sim::system {

std::filesystem::path program_folder() {
  std::error_code unknown;
  return std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
}

std::filesystem::path installed_share() {
  const std::filesystem::path program = program_folder();
  return program.empty() ? program : (program / SERVOMILL_SHARE).lexically_normal();
}

}  // namespace servomill::sim::system
