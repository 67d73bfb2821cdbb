/// The files that a scenario names.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/stored_text.h"
#include "sim/config/document.h"
#include "sim/system/shared_cache.h"

namespace servomill::sim::input {

/// Reads every file once and keeps it, however often it is asked for, so that what happens to a
/// file during a sweep does not matter. Beyond some bytes those asked for least recently are
/// forgotten; they are read again, and refused if they have changed. For any number of threads.
class InputFiles {
 public:
  /// @param most_bytes  of texts that are kept beside the last one
  explicit InputFiles(std::size_t most_bytes = 200'000'000);

  /// Takes a text for the file of that name, which need not be on a disk. Before it is asked for.
  void provide(const std::string& path, std::string text);

  /// Takes the program of a result file, which is stored next to the resolved document.
  void provide_program(std::shared_ptr<const StoredText> program) {
    provided_program_ = std::move(program);
  }
  /// nullptr if there is none.
  const std::shared_ptr<const StoredText>& provided_program() const { return provided_program_; }

  /// @param at    where the file was named; without a file: the complaint stands in `path`
  /// @param what  "program", "machine": for the message
  /// @throws InputError if it cannot be read, or has changed since it was read before
  std::shared_ptr<const std::string> text(const std::string& path, const Place& at,
                                          std::string_view what);

  /// The same of a program or a subroutine, which may be long.
  std::shared_ptr<const StoredText> program(const std::string& path, const Place& at,
                                            std::string_view what);

  /// A number that other contents of a file do not have: CRC-64 of ECMA-182, as xz takes it.
  /// @throws InputError as text() does, unless the file was read before
  std::uint64_t checksum(const std::string& path, const Place& at, std::string_view what);

  /// A scenario.
  /// @throws InputError if it cannot be read or is not TOML
  std::shared_ptr<const config::Document> document(const std::string& path);

  /// The document that the text of a file is.
  /// @throws InputError if it is not TOML
  std::shared_ptr<const config::Document> document(const std::string& path,
                                                   const std::string& text);

 private:
  void refuse_changed(const std::string& path, std::uint64_t checksum);

  system::SharedCache<std::string> texts_;
  system::SharedCache<StoredText> programs_;
  system::SharedCache<config::Document> documents_;
  std::mutex mutex_;
  std::unordered_map<std::string, std::uint64_t> checksums_;  // by path, of all that was read
  // by path; constant once files are asked for
  std::unordered_map<std::string, std::shared_ptr<const std::string>> provided_;
  std::shared_ptr<const StoredText> provided_program_;
};

}  // namespace servomill::sim::input
