/// Files that the user names as inputs: opened within bounds, and remembered.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace servomill {

/// Remembers the inputs of a command while it is alive, so that no output replaces one of them.
/// At most one in a process.
class InputRecord {
 public:
  InputRecord();
  InputRecord(const InputRecord&) = delete;
  InputRecord& operator=(const InputRecord&) = delete;
  ~InputRecord();
};

/// Counts the file behind a name as an input. Without a record, and without a file, nothing
/// happens.
void remember_input(const std::string& path);

/// True if the file behind a name is an input, under whatever name it was read: symbolic and hard
/// links are the file that they lead to.
bool is_input(const std::string& path);

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using OpenFile = std::unique_ptr<std::FILE, FileCloser>;

/// Limit of what is read of one file at once, bytes.
inline constexpr std::uintmax_t kMaxBytesOfFile = 2'000'000'000;
/// Limit of a document of keys and values (TOML), which takes many times its size in memory.
inline constexpr std::uintmax_t kMaxBytesOfDocument = 100'000'000;

/// Opens a file for reading and remembers it. Devices, pipes and sockets have no end that could be
/// known before, and are refused.
/// @param why  set if nothing is returned: "No such file or directory", "is a folder", ...
OpenFile open_input(const std::string& path, std::string& why);

/// Why a file cannot be opened for reading, with a library of its own; empty if it can. It is not
/// remembered.
std::string why_unreadable(const std::string& path);

/// The bytes of a file, one piece after the other; refused beyond `most`, before anything is read
/// where its size is known. It is remembered.
class InputPieces {
 public:
  InputPieces(const std::string& path, std::uintmax_t most);

  /// Bytes of the file when it was opened.
  std::size_t size() const { return size_; }
  /// The next piece, valid until the next call; empty after the last one, and where why() says
  /// that the file cannot be read.
  std::string_view next();
  /// Empty while the file can be read.
  const std::string& why() const { return why_; }

 private:
  OpenFile file_;
  std::uintmax_t most_;
  std::size_t size_ = 0, read_ = 0;
  std::string why_;
  std::string piece_;
};

/// All bytes of a file, as InputPieces has them.
/// @param why  empty if it was read
std::string read_input(const std::string& path, std::uintmax_t most, std::string& why);

/// Why a file is not one that can be read or replaced: a device, a pipe, a socket, a folder; empty
/// for a regular file and where nothing is.
std::string not_a_regular_file(const std::string& path);

}  // namespace servomill
