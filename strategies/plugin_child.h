/// Plug-ins in processes of their own: one that crashes there, calls exit() or does not return ends
/// only what that process computes.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace servomill::strategies {

/// From now on plug-ins compute in child processes where that is possible (--isolate). Results do
/// not depend on it.
void isolate_plugins();
bool plugins_are_isolated();

/// A plug-in did not bring its work to an end; what() says which, and why.
class PluginFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The end of a connection between two processes. Numbers go through it byte by byte.
class ProcessPipe {
 public:
  explicit ProcessPipe(int descriptor) : descriptor_(descriptor) {}
  /// False if the other process has gone.
  bool write(const void* from, std::size_t bytes);
  bool read(void* to, std::size_t bytes);
  /// Waits until something can be read, or the other process has gone.
  bool can_be_read(std::chrono::milliseconds patience) const;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// A copy of this process, which does one piece of work and writes the result. It ends with this
/// process, too.
class PluginChild {
 public:
  /// Work in the child, once begin() was called: returns what writes the result. What it throws
  /// ends the work.
  using Result = std::function<void(ProcessPipe& to)>;
  using Work = std::function<Result()>;

  /// @param who   "strategy ramp (libramp.so)", for messages
  /// @pre no thread of this process holds a lock that the work needs: best before there are others
  /// @throws std::runtime_error if the system allows no further process
  PluginChild(std::string who, const Work& work);
  PluginChild(const PluginChild&) = delete;
  PluginChild& operator=(const PluginChild&) = delete;
  /// Ends the process, if it has not ended.
  ~PluginChild();

  /// Lets the child begin.
  void begin();
  /// Waits for the result; false if there is none yet.
  /// @throws PluginFailed if there will be none; std::runtime_error with what the work has thrown
  bool wait(std::chrono::milliseconds patience);
  /// Reads from the result. @pre wait() was true
  /// @throws PluginFailed if the child has ended in between
  void read(void* to, std::size_t bytes);
  template <class Value>
  requires std::is_trivially_copyable_v<Value> Value read() {
    Value value;
    read(&value, sizeof value);
    return value;
  }

 private:
  [[noreturn]] static void run(int descriptor, const Work& work);
  [[noreturn]] void fail();
  std::string rest_as_text();

  std::string who_;
  ProcessPipe pipe_{-1};
  pid_t process_ = -1;  // -1: has been waited for
};

}  // namespace servomill::strategies
