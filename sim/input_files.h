/// The files that a scenario names.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "plant/vocabulary/input_error.h"
#include "sim/config/document.h"
#include "sim/memo.h"

namespace servomill::sim {

/// Reads every file once and keeps it, however often it is asked for: what happens to a file
/// during a sweep does not matter. For any number of threads.
class InputFiles {
 public:
  InputFiles();

  /// @param at    where the file was named; without a file: the complaint stands in `path`
  /// @param what  "program", "machine": for the message
  /// @throws InputError if it cannot be read
  std::shared_ptr<const std::string> text(const std::string& path, const Place& at,
                                          std::string_view what);

  /// A scenario.
  /// @throws InputError if it cannot be read or is not TOML
  std::shared_ptr<const Document> document(const std::string& path);

  /// The document that the text of a file is.
  /// @throws InputError if it is not TOML
  std::shared_ptr<const Document> document(const std::string& path, const std::string& text);

 private:
  Memo<std::string> texts_;
  Memo<Document> documents_;
};

}  // namespace servomill::sim
