#include "strategies/plugin_watch.h"

#include <fmt/format.h>
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

Watch& watch() {
  static Watch* const one = new Watch;
  return *one;
}

std::atomic<const char*> crashed = nullptr;
std::atomic<int> crash_signal = 0;
static_assert(std::atomic<const char*>::is_always_lock_free);

// On the thread that crashed: it waits for the process to end, which the watching thread does.
void note_crash(int signal) {
  const char* const who = watched_thread().inside.load(std::memory_order_relaxed);
  if (who == nullptr) {  // of our own: as if nobody watched
    std::signal(signal, SIG_DFL);
    std::raise(signal);
    return;
  }
  crash_signal = signal;
  crashed = who;
  for (;;) pause();
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
  if (const char* who = crashed) {
    end(fmt::format("{}: the plug-in crashed (signal {})", who, crash_signal.load()));
  }
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
  static thread_local WatchedThread* const mine = [] {
    const std::scoped_lock lock(watch().mutex);
    return &watch().threads.emplace_back();
  }();
  return *mine;
}

PluginRescue::PluginRescue() { ++rescues; }
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

void watch_plugins() {
  static std::once_flag begun;
  std::call_once(begun, [] {
    struct sigaction action = {};
    action.sa_handler = note_crash;
    for (const int signal : kCrashes) sigaction(signal, &action, nullptr);
    std::thread(keep_watching).detach();
  });
}

}  // namespace servomill::strategies
