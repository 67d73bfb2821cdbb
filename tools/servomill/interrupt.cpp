#include "tools/servomill/interrupt.h"

#include <fmt/format.h>
#include <semaphore.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <mutex>
#include <thread>
#include <utility>

#include "plant/vocabulary/interrupt.h"
#include "sim/input/plugins.h"
#include "sim/system/output_name.h"
#include "tools/servomill/command.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

// Half a second less what the system needs to end a large process.
constexpr auto kPatience = std::chrono::milliseconds(200);

sem_t wanted;
std::atomic<bool> reported = false;
std::mutex kept_mutex;
std::function<std::string()> what_is_kept;
std::string kept_when_thrown;  // what an interrupt that went through as an exception has left

// Not through stdio, whose lock a thread that was stopped might hold.
void write_to_stderr(const std::string& text) {
  for (std::size_t from = 0; from < text.size();) {
    const ssize_t written = ::write(STDERR_FILENO, text.data() + from, text.size() - from);
    if (written <= 0) return;
    from += static_cast<std::size_t>(written);
  }
}

void on_signal(int signal) {
  interrupt_wanted = true;
  std::signal(signal, SIG_DFL);
  sem_post(&wanted);
}

// Neither closes nor flushes: the main thread may hold locks, and what it writes is incomplete.
[[noreturn]] void end_process() {
  sim::system::TemporaryFile::remove_all();
  const std::scoped_lock lock(kept_mutex);
  print_interrupted(what_is_kept ? what_is_kept() : "");
  ::_exit(kInterrupted);
}

// The same for a plug-in that does not return or has crashed.
[[noreturn]] void end_after_plugin(const std::string& why) {
  sim::system::TemporaryFile::remove_all();
  const std::scoped_lock lock(kept_mutex);
  const std::string kept = what_is_kept ? what_is_kept() : "";
  erase_progress_line();
  write_to_stderr(why + (kept.empty() ? "\n" : "\n" + kept + "\n"));
  ::_exit(kSystemFailed);
}

void watch() {
  while (sem_wait(&wanted) != 0) {
  }
  std::this_thread::sleep_for(kPatience);
  end_process();
}

}  // namespace

const std::atomic<bool>& stop_on_interrupt() {
  static const bool installed = [] {
    sem_init(&wanted, 0, 0);
    sim::input::on_plugin_failure(end_after_plugin);
    std::thread(watch).detach();
    // system calls go on: a full pipe is no fault
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
    return true;
  }();
  static_cast<void>(installed);
  return interrupt_wanted;
}

KeptWhenInterrupted::KeptWhenInterrupted(std::function<std::string()> what) {
  const std::scoped_lock lock(kept_mutex);
  what_is_kept = std::move(what);
}

KeptWhenInterrupted::~KeptWhenInterrupted() {
  const std::scoped_lock lock(kept_mutex);
  if (std::uncaught_exceptions() > 0) kept_when_thrown = what_is_kept();
  what_is_kept = nullptr;
}

void print_interrupted() {
  std::string kept;
  {
    const std::scoped_lock lock(kept_mutex);
    kept = kept_when_thrown;
  }
  print_interrupted(kept);
}

void print_interrupted(const std::string& kept) {
  if (reported.exchange(true)) return;
  erase_progress_line();
  write_to_stderr(kept.empty() ? "interrupted\n" : "interrupted; " + kept + "\n");
}

std::string kept_in(const std::string& partial_path, const std::string& details) {
  std::error_code ignored;
  if (!std::filesystem::exists(partial_path, ignored)) return {};
  return fmt::format("saved in {}: {}", partial_path, details);
}

}  // namespace servomill::tools
