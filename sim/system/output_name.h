/// Names of results: what may be written, and under which name. Every output of every command
/// passes here.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace servomill::sim::system {

/// A file that must not stay if the program ends before it has got its final name, by a signal,
/// too.
class TemporaryFile {
 public:
  /// A name beside `target` that no other process takes.
  explicit TemporaryFile(const std::string& target);
  static TemporaryFile existing(std::string name) { return {std::move(name), 0}; }
  TemporaryFile(TemporaryFile&& other) noexcept : name_(std::move(other.name_)) {
    other.name_.clear();
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();
  const std::string& name() const { return name_; }
  /// From here on the file stays.
  void release();

  /// Removes all that there are, where nothing destroys them any more.
  static void remove_all();

 private:
  TemporaryFile(std::string name, int);
  std::string name_;
};

/// Treatment of a file that exists already.
enum class Existing : std::uint8_t { refused, resumed, replaced };

inline Existing existing_of(bool force) { return force ? Existing::replaced : Existing::refused; }

/// The file that an output is written to: `path`, or the one behind it if it is a symbolic link.
/// @throws InputError if that file is an input of the command, no regular file, in no folder, or
///     there although it must not be; nothing is touched
std::string output_target(const std::string& path, Existing existing);

/// @param what  what each of them holds, such as "--record"
/// @throws InputError if two outputs are one file
void refuse_same_output(const std::string& path, const std::string& other, const std::string& what,
                        const std::string& other_what);

/// Gives a complete file its name, at once. With `Existing::refused` a file that has come there
/// meanwhile stays.
/// @throws InputError if it may not be replaced, SystemError
void give_name(const std::string& complete, const std::string& target, Existing existing);

/// @throws InputError if a partial file is there, and says what is known of its writer; SystemError
///     while another process writes it
void refuse_partial(const std::string& partial);

}  // namespace servomill::sim::system
