/// A file of readings in tests, in a folder that goes with it.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::standards {

class ReadingFile {
 public:
  explicit ReadingFile(const std::string& text, const std::string& name = "readings.csv") {
    std::string folder = (std::filesystem::temp_directory_path() / "standards_XXXXXX").string();
    folder_ = mkdtemp(folder.data());
    path_ = folder_ + "/" + name;
    std::ofstream(path_) << text;
  }
  ~ReadingFile() { std::filesystem::remove_all(folder_); }
  ReadingFile(const ReadingFile&) = delete;
  ReadingFile& operator=(const ReadingFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string folder_, path_;
};

/// The message of the reading of a file with this text, without its folder; "" if there is none.
template <typename Read>
std::string message_of(const std::string& text, Read read) {
  const ReadingFile file(text);
  try {
    read(file.path());
  } catch (const InputError& error) {
    std::string message = error.what();
    const std::string folder = std::filesystem::path(file.path()).parent_path().string() + "/";
    for (auto at = message.find(folder); at != std::string::npos; at = message.find(folder)) {
      message.erase(at, folder.size());
    }
    return message;
  }
  return "";
}

}  // namespace servomill::sim::standards
