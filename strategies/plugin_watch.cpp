#include "strategies/plugin_watch.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

namespace servomill::strategies {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kLookPeriod = std::chrono::milliseconds(100);
constexpr auto kRescueTime = std::chrono::seconds(30);  // some GB are written
constexpr int kSystemFailed = 3;                        // status of the process
constexpr std::array kCrashes = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

// Lives as long as the process: the watching thread goes on while others end it.
struct Watch {
  std::mutex mutex;
  std::deque<WatchedThread> threads;
  PluginFailure then;
};

Watch*& current_watch() {
  static Watch* one = new Watch;
  return one;
}

Watch& watch() { return *current_watch(); }

// Handlers of signals read it: no initialisation at its first use.
thread_local WatchedThread* this_thread = nullptr;

// Stack for the handler of a thread whose own stack is full: a plug-in that recurses without end.
class HandlerStack {
 public:
  HandlerStack()
      : begin_(mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)) {
    if (begin_ == MAP_FAILED) return;
    const stack_t here = {.ss_sp = begin_, .ss_flags = 0, .ss_size = kBytes};
    sigaltstack(&here, nullptr);
  }
  HandlerStack(const HandlerStack&) = delete;
  HandlerStack& operator=(const HandlerStack&) = delete;
  ~HandlerStack() {
    if (begin_ == MAP_FAILED) return;
    const stack_t none = {.ss_sp = nullptr, .ss_flags = SS_DISABLE, .ss_size = 0};
    sigaltstack(&none, nullptr);
    munmap(begin_, kBytes);
  }

 private:
  static constexpr std::size_t kBytes = std::size_t{1} << 16;
  void* begin_;
};

constexpr int kExit = 0;  // in place of the signal: the plug-in has called exit()
std::atomic<const char*> crashed = nullptr;
std::atomic<int> crash_signal = kExit;
static_assert(std::atomic<const char*>::is_always_lock_free);

// On the thread that failed: it waits for the process to end, which the watching thread does.
[[noreturn]] void wait_for_the_end(const char* who, int signal) {
  crash_signal = signal;
  crashed = who;
  for (;;) pause();
}

const char* inside_now() {
  return this_thread == nullptr ? nullptr : this_thread->inside.load(std::memory_order_relaxed);
}

void note_crash(int signal) {
  if (const char* const who = inside_now()) wait_for_the_end(who, signal);
  std::signal(signal, SIG_DFL);  // of our own: as if nobody watched
  std::raise(signal);
}

// Among the functions that exit() calls.
void note_exit() {
  if (const char* const who = inside_now()) wait_for_the_end(who, kExit);
}

std::atomic<bool> has_failed = false, is_rescued = false;
std::atomic<int> rescues = 0;

void wait_for_rescue() {
  const auto latest = Clock::now() + kRescueTime;
  while (rescues > 0 && !is_rescued && Clock::now() < latest) {
    std::this_thread::sleep_for(kLookPeriod);
  }
}

[[noreturn]] void end(const std::string& why) {
  has_failed = true;
  wait_for_rescue();
  PluginFailure then;
  {
    const std::scoped_lock lock(watch().mutex);
    then = watch().then;
  }
  if (then) {
    then(why);
  } else {
    fmt::print(stderr, "{}\n", why);
  }
  std::fflush(stderr);
  std::_Exit(kSystemFailed);
}

// A call that was seen before, and since when.
struct Seen {
  const WatchedThread* thread;
  std::uint64_t calls;
  Clock::time_point since;
};

void look_for_crashes() {
  const char* const who = crashed;
  if (who == nullptr) return;
  const int signal = crash_signal;
  end(signal == kExit ? fmt::format("{}: the plug-in called exit()", who)
                      : fmt::format("{}: the plug-in crashed (signal {})", who, signal));
}

void look_at(const WatchedThread& thread, std::vector<Seen>& all, Clock::time_point now) {
  const char* const who = thread.inside.load(std::memory_order_relaxed);
  const std::uint64_t calls = thread.calls.load(std::memory_order_relaxed);
  for (Seen& seen : all) {
    if (seen.thread != &thread) continue;
    if (who == nullptr || seen.calls != calls) {
      seen = {&thread, calls, now};
    } else if (now - seen.since > std::chrono::seconds(kPluginPatience)) {
      end(fmt::format("{}: the plug-in did not return within {} s", who, kPluginPatience));
    }
    return;
  }
  all.push_back({&thread, calls, now});
}

[[noreturn]] void keep_watching() {
  std::vector<Seen> seen;
  for (;;) {
    std::this_thread::sleep_for(kLookPeriod);
    look_for_crashes();
    std::vector<const WatchedThread*> threads;
    {
      const std::scoped_lock lock(watch().mutex);
      for (const WatchedThread& one : watch().threads) threads.push_back(&one);
    }
    for (const WatchedThread* one : threads) look_at(*one, seen, Clock::now());
  }
}

}  // namespace

WatchedThread& watched_thread() {
  if (this_thread == nullptr) {
    static thread_local const HandlerStack stack;
    const std::scoped_lock lock(watch().mutex);
    this_thread = &watch().threads.emplace_back();
  }
  return *this_thread;
}

// exit() calls the latest first: ours comes before the destruction of what was made until here.
PluginRescue::PluginRescue() {
  ++rescues;
  std::atexit(note_exit);
}
PluginRescue::~PluginRescue() { --rescues; }
bool PluginRescue::is_wanted() { return has_failed; }
void PluginRescue::done() {
  is_rescued = true;
  for (;;) pause();
}

void on_plugin_failure(PluginFailure then) {
  const std::scoped_lock lock(watch().mutex);
  watch().then = std::move(then);
}

void watch_plugins_in_child(PluginFailure then) {
  current_watch() =
      new Watch;  // the lock of the other one may be held, by a thread that is no more
  watch().then = std::move(then);
  this_thread = nullptr;
  rescues = 0;
  std::thread(keep_watching).detach();
}

void watch_plugins() {
  static std::once_flag begun;
  std::call_once(begun, [] {
    struct sigaction action = {};
    action.sa_handler = note_crash;
    action.sa_flags = SA_ONSTACK;
    for (const int signal : kCrashes) sigaction(signal, &action, nullptr);
    std::atexit(note_exit);
    std::at_quick_exit(note_exit);
    std::thread(keep_watching).detach();
  });
}

}  // namespace servomill::strategies
