#include "tools/servomill/progress_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>

#include "tools/servomill/command.h"

namespace servomill::tools {
namespace {

constexpr auto kDelay = std::chrono::seconds(2);          // shorter commands show nothing
constexpr auto kPeriod = std::chrono::milliseconds(200);  // between two drawings
constexpr double kForecastFrom = 0.005;  // share done from which on the time left can be forecast
constexpr std::size_t kBarWidth = 30;

std::atomic<std::size_t> drawn_width = 0;  // characters that are on the terminal

bool is_shown(const Options& options) {
  if (options.has("quiet") || options.has("json") || isatty(STDERR_FILENO) == 0) return false;
  struct stat out {};
  return fstat(STDOUT_FILENO, &out) == 0 && !S_ISFIFO(out.st_mode);
}

std::size_t terminal_width() {
  constexpr std::size_t kUsual = 80;
  winsize size{};
  const bool is_known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return is_known ? size.ws_col : kUsual;
}

// Not through stdio, whose lock a thread that was stopped might hold.
void write_line(const std::string& text) {
  if (write(STDERR_FILENO, text.data(), text.size()) < 0) return;  // a terminal that has gone
}

std::string time_of(double seconds) {
  constexpr double kMinute = 60.0, kHour = 3600.0;
  if (seconds < 2.0 * kMinute) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2.0 * kHour) return fmt::format("{:.0f} min", seconds / kMinute);
  return fmt::format("{:.1f} h", seconds / kHour);
}

// "12 of 40 points", "7 iterations"; a share where nothing is counted.
std::string count_of(const StageState& stage) {
  if (stage.total == 0.0) return fmt::format("{:.0f} {}", stage.done, stage.counted);
  if (stage.counted.empty()) return fmt::format("{:.0f} %", 100.0 * stage.done / stage.total);
  return fmt::format("{:.0f} of {:.0f} {}", std::floor(stage.done), stage.total, stage.counted);
}

}  // namespace

std::string progress_text(std::vector<StageState> stages, double seconds) {
  // a stage of one step is as far as what is within it
  while (stages.size() > 1 && stages.front().total == 1.0) stages.erase(stages.begin());
  std::string counts;
  for (const StageState& stage : stages) {
    if (stage.counted.empty() && &stage == &stages.front()) continue;
    counts += (counts.empty() ? "" : ", ") + count_of(stage);
  }
  const std::string behind = counts.empty() ? "" : ", " + counts;
  const bool has_forecast =
      !stages.empty() && stages.front().steps == Steps::alike && stages.front().total > 0.0;
  if (!has_forecast) {
    return fmt::format("{}, {} so far", counts.empty() ? "working" : counts, time_of(seconds));
  }
  const double share = share_done(stages);
  const auto full = static_cast<std::size_t>(share * static_cast<double>(kBarWidth));
  const std::string left =
      share < kForecastFrom
          ? ""
          : fmt::format(", {} left", time_of(stages.front().seconds * (1.0 - share) / share));
  return fmt::format("[{:<{}}] {:3.0f} %{}{}", std::string(full, '='), kBarWidth, 100.0 * share,
                     left, behind);
}

void erase_progress_line() {
  const std::size_t width = drawn_width.exchange(0);
  if (width > 0) write_line(fmt::format("\r{:<{}}\r", "", width));
}

ProgressLine::ProgressLine(const Options& options) {
  if (is_shown(options)) thread_ = std::jthread([this](const std::stop_token& s) { draw(s); });
}

ProgressLine::~ProgressLine() { end(); }

std::unique_lock<std::mutex> ProgressLine::hidden() {
  std::unique_lock<std::mutex> lock(mutex_);
  erase_progress_line();
  return lock;
}

void ProgressLine::end() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
  erase_progress_line();
}

void ProgressLine::draw(const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  const auto wait = [&](std::unique_lock<std::mutex>& lock, auto time) {
    changed_.wait_for(lock, stop, time, [&] { return stop.stop_requested(); });
    return !stop.stop_requested();
  };
  std::unique_lock<std::mutex> lock(mutex_);
  for (bool goes_on = wait(lock, kDelay); goes_on; goes_on = wait(lock, kPeriod)) {
    const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - begin;
    // a line that is wrapped could not be erased
    const std::string text =
        progress_text(watch_.stages(), gone.count()).substr(0, terminal_width() - 1);
    const std::size_t before = drawn_width.exchange(text.size());
    write_line(fmt::format("\r{:<{}}", text, before));
  }
}

}  // namespace servomill::tools
