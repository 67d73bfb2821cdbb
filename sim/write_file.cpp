#include "sim/write_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "plant/vocabulary/input_error.h"
#include "sim/hdf5/system_error.h"

namespace servomill::sim {
namespace {

void write_all(const std::string& path, std::string_view text) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"),
                                                             &std::fclose);
  if (file == nullptr) throw SystemError(path, "cannot be written", std::strerror(errno));
  if (std::fwrite(text.data(), 1, text.size(), file.get()) != text.size() ||
      std::fflush(file.get()) != 0) {
    throw SystemError(path, "cannot be written", std::strerror(errno));
  }
}

}  // namespace

void write_text_file(const std::string& path, std::string_view text, bool force) {
  std::error_code ignored;
  if (path.empty()) throw InputError({"--output"}, "the name of the file is empty");
  if (std::filesystem::is_directory(path, ignored))
    throw InputError({path}, "is a folder; name a file");
  if (!force && std::filesystem::exists(path, ignored)) {
    throw InputError({path}, "exists; use --force to overwrite");
  }
  const std::string partial = path + ".partial";
  try {
    write_all(partial, text);
  } catch (...) {
    std::filesystem::remove(partial, ignored);
    throw;
  }
  std::error_code failed;
  std::filesystem::rename(partial, path, failed);
  if (failed) throw SystemError(path, "cannot be written", failed.message());
}

}  // namespace servomill::sim
