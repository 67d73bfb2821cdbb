/// SIGINT and SIGTERM end a command within half a second, whatever it does.
///
/// The handler sets a flag (plant/vocabulary/interrupt.h), which all long loops see: the command
/// then tells what it keeps and ends. Should it not get there in time - in a library, or writing to
/// a slow disk - a thread of its own removes temporary files, tells what is kept, and ends the
/// process. What is on the disk is then as after a kill: complete.
#pragma once

#include <atomic>
#include <functional>
#include <string>

namespace servomill::tools {

/// Installs the handlers and returns the flag that they set. A second signal ends the process.
const std::atomic<bool>& stop_on_interrupt();

/// Names what the command keeps if it ends early; asked for when it does, from another thread;
/// nothing before the first call. Ends with the object.
class KeptWhenInterrupted {
 public:
  explicit KeptWhenInterrupted(std::function<std::string()> what_is_kept);
  KeptWhenInterrupted(const KeptWhenInterrupted&) = delete;
  KeptWhenInterrupted& operator=(const KeptWhenInterrupted&) = delete;
  ~KeptWhenInterrupted();
};

/// Says on standard error that the command was interrupted by an exception, with what was kept when
/// that was thrown.
void print_interrupted();

/// Prints "interrupted" and what is kept, once in a process: whoever comes first.
void print_interrupted(const std::string& kept);

/// "kept in PATH: details" if the file is there, otherwise nothing.
std::string kept_in(const std::string& partial_path, const std::string& details);

}  // namespace servomill::tools
