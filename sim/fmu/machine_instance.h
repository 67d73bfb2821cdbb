/// Life of one instance of an FMU: one axis, or several of one machine.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/fmu/axis_instance.h"

namespace servomill::sim::fmu {

/// Axes that are stepped together. They do not act on one another, but the NC stops all of them in
/// the position period in which it stops the first. A variable of axis number n has the value
/// reference n kAxisStride + that of the axis; time is that of the first.
class MachineInstance {
 public:
  using Log = AxisInstance::Log;

  MachineInstance(const std::vector<AxisConstants>& axes, const Log& log);

  bool set_up(double start_time);
  bool enter_initialization();
  bool exit_initialization();
  bool terminate();
  void reset();

  bool get(std::uint32_t reference, double& value);
  bool set(std::uint32_t reference, double value);

  /// As AxisInstance::step.
  Step step(double current, double step);
  double time() const { return axes_.front()->time(); }
  bool is_stopped() const { return stopped_; }

  struct Memory {
    bool stopped = false;
    std::vector<AxisInstance::Memory> axes;
  };
  Memory memory() const;
  bool restore(const Memory& memory);
  std::string bytes_of(const Memory& memory) const;
  /// nullopt if they are of other axes or damaged; the reason is logged.
  std::optional<Memory> memory_from(std::string_view bytes);

 private:
  template <class Do>
  bool all(Do what);
  AxisInstance* axis_of(std::uint32_t reference);
  bool refuse(const std::string& why) const;
  Step stop_at(double current, double end, const Memory& before);

  Log log_;
  std::vector<std::unique_ptr<AxisInstance>> axes_;
  bool stopped_ = false;
};

}  // namespace servomill::sim::fmu
