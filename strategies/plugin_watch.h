/// Watches plug-ins from outside: one that does not return, or crashes, must not take along what
/// other cases have computed.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace servomill::strategies {

/// Time in which a function of a plug-in must return, s.
inline constexpr int kPluginPatience = 10;

/// From now on, a plug-in that does not return in time, crashes or calls exit() ends the process: a
/// thread of its own says so, and what on_plugin_failure adds. Any further call does nothing.
void watch_plugins();

/// Called by that thread with a sentence before the process ends with status 3. The other threads
/// go on meanwhile.
using PluginFailure = std::function<void(const std::string& why)>;
/// @param then  empty: prints the sentence
void on_plugin_failure(PluginFailure then);

/// In a child process, first: watches anew, as threads of the parent do not go on there.
void watch_plugins_in_child(PluginFailure then);

/// A thread that has results to keep while this is alive: where a plug-in has failed, the end of
/// the process waits until they are kept, for some time.
class PluginRescue {
 public:
  PluginRescue();
  PluginRescue(const PluginRescue&) = delete;
  PluginRescue& operator=(const PluginRescue&) = delete;
  ~PluginRescue();
  /// Tells if a plug-in has failed: to be asked now and then.
  static bool is_wanted();
  /// All is kept; the process may end. Does not return.
  [[noreturn]] static void done();
};

/// The functions of plug-ins that one thread is in.
struct WatchedThread {
  std::atomic<const char*> inside = nullptr;  // "strategy ramp (libramp.so)"; nullptr: in none
  std::atomic<std::uint64_t> calls = 0;       // that have begun
};
WatchedThread& watched_thread();

/// A call of a plug-in while it is alive.
class PluginCall {
 public:
  /// @param who  must outlive the process
  explicit PluginCall(const char* who) : thread_(watched_thread()) {
    thread_.calls.fetch_add(1, std::memory_order_relaxed);
    thread_.inside.store(who, std::memory_order_relaxed);
  }
  PluginCall(const PluginCall&) = delete;
  PluginCall& operator=(const PluginCall&) = delete;
  ~PluginCall() { thread_.inside.store(nullptr, std::memory_order_relaxed); }

 private:
  WatchedThread& thread_;
};

}  // namespace servomill::strategies
