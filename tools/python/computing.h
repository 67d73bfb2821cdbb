/// Long computations behind calls from Python: without the GIL, with progress, and with an end
/// within half a second after Ctrl-C.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>

namespace servomill::python {

/// Calls `work` on a thread of its own and waits for it without the GIL. Meanwhile the calling
/// thread looks twenty times a second whether Python has an exception waiting (Ctrl-C), and calls
/// `progress` with the share done, unless that is None. An exception of either ends the work
/// through `interrupt_wanted`, and is thrown when it has ended. One computation at a time: others
/// wait for its end.
/// @throws what work throws; RuntimeError where a strategy or a progress function asks for it
void compute(const pybind11::object& progress, const std::function<void()>& work);

/// The same for work that has a result.
template <class Work>
auto computed(const pybind11::object& progress, Work work) {
  std::optional<decltype(work())> out;
  compute(progress, [&] { out.emplace(work()); });
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
