/// The line on a terminal that shows how far a long command is.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "plant/vocabulary/progress.h"

namespace servomill::tools {

class Options;

/// Shows the stages of this thread on standard error, from two seconds on, and erases them at the
/// end. Nothing is shown with --quiet or --json, if standard error is not a terminal, or if
/// standard output is a pipe, whose reader may use the same terminal.
class ProgressLine {
 public:
  explicit ProgressLine(const Options& options);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Erases the line; it does not come back before what is returned has gone: for what a command
  /// prints meanwhile.
  [[nodiscard]] std::unique_lock<std::mutex> hidden();
  /// Erases the line for good.
  void end();

 private:
  void draw(const std::stop_token& stop);

  ProgressWatch watch_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::jthread thread_;  // none where nothing is shown
};

/// Text of the line: a bar with the share and the time left where steps are alike, otherwise what
/// is counted and the time since the beginning.
/// @param stages   the outermost first
/// @param seconds  since the command began
std::string progress_text(std::vector<StageState> stages, double seconds);

/// Erases the line of a process that is about to end. For any thread, whatever others hold.
void erase_progress_line();

}  // namespace servomill::tools
