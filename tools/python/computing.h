/// Long computations behind calls from Python: without the GIL, with progress, and with an end
/// within half a second after Ctrl-C.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <optional>
#include <utility>

namespace servomill::python {

/// A computation that goes on, as the thread of Python sees it that waits for it.
struct Watch {
  std::atomic<double> share = 0.0;  // done, 0 to 1

  std::function<void(double)> progress() {
    return [this](double now) { share = now; };
  }
};

/// Calls `work` on a thread of its own and waits for it without the GIL. Meanwhile the calling
/// thread looks twenty times a second whether Python has an exception waiting (Ctrl-C), and calls
/// `progress` with the share done, unless that is None. An exception of either ends the work
/// through `interrupt_wanted`, and is thrown when it has ended. One computation at a time: others
/// wait for its end.
/// @throws what work throws; RuntimeError where a strategy or a progress function asks for it
void compute(const pybind11::object& progress, const std::function<void(Watch&)>& work);

/// The same for work that has a result.
template <class Work>
auto computed(const pybind11::object& progress, Work work) {
  std::optional<decltype(work(std::declval<Watch&>()))> out;
  compute(progress, [&](Watch& watch) { out.emplace(work(watch)); });
  return *std::move(out);
}

/// Tells that this thread runs code of a user for a computation, which must not begin another one.
class InsideComputation {
 public:
  InsideComputation();
  InsideComputation(const InsideComputation&) = delete;
  InsideComputation& operator=(const InsideComputation&) = delete;
  ~InsideComputation();
};

/// Calls `change` while nothing computes.
/// @throws RuntimeError if something does
void while_idle(const std::function<void()>& change);

}  // namespace servomill::python
