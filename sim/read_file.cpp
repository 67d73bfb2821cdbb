#include "sim/read_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace servomill::sim {

std::string read_file(const std::string& path, const Place& at, std::string_view what) {
  const auto fail = [&](std::string_view why) {
    if (at.file.empty()) throw InputError({path}, fmt::format("cannot be read: {}", why));
    throw InputError(at, fmt::format("{} '{}' cannot be read: {}", what, path, why));
  };
  if (std::filesystem::is_directory(path)) fail("is a folder");
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(std::strerror(errno));
  std::ostringstream text;
  if (file.peek() != std::ifstream::traits_type::eof()) text << file.rdbuf();
  return text.str();
}

}  // namespace servomill::sim
