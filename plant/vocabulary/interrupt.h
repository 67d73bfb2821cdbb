/// The user's wish to end a command, seen by every loop that may be long.
#pragma once

#include <atomic>
#include <exception>

namespace servomill {

/// Thrown by a loop that has seen the wish. No fault of anybody's: it passes through all that turns
/// faults into results.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// Set by a signal handler, or by another thread; never reset by the loops.
inline std::atomic<bool> interrupt_wanted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch such");

/// To be called in every loop that may take longer than a tenth of a second.
inline void throw_if_interrupted() {
  if (interrupt_wanted.load(std::memory_order_relaxed)) throw Interrupted();
}

}  // namespace servomill
