/// Life of one instance of an FMU: one axis, several of one machine, or the whole machine.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/fmu/axis_instance.h"
#include "sim/fmu/machine_constants.h"
#include "sim/fmu/tool.h"

namespace servomill::sim::fmu {

/// Axes that are stepped together. They do not act on one another, but the NC stops all of them in
/// the position period in which it stops the first. A variable of axis number n has the value
/// reference n kAxisStride + that of the axis; time is that of the first. A whole machine has the
/// variables of its tool, too.
class MachineInstance {
 public:
  using Log = AxisInstance::Log;

  /// @pre machine has an axis
  MachineInstance(const MachineConstants& machine, const Log& log);

  bool set_up(double start_time);
  bool enter_initialization();
  bool exit_initialization();
  bool terminate();
  void reset();

  bool get(std::uint32_t reference, double& value);
  bool set(std::uint32_t reference, double value);

  /// As AxisInstance::step. In an instance with events that may return early, the step ends at the
  /// next tick of a clock.
  Step step(double current, double step);
  double time() const { return axes_.front()->time(); }
  bool is_stopped() const;

  /// FMI 3: clocks are read in event mode, which follows initialization and then whatever step ends
  /// where a clock ticks.
  /// @param early_return  steps end where the next clock ticks
  void use_events(bool early_return);
  bool enter_event_mode();
  bool enter_step_mode();
  bool is_in_event_mode() const { return in_event_mode_; }
  /// True for a clock that ticks now; only in event mode.
  bool ticks(std::uint32_t reference, bool& value);
  bool event_is_due() const;
  double next_event_time() const;

  struct Memory {
    bool in_event_mode = false;
    std::vector<AxisInstance::Memory> axes;
    Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();
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
  bool is_of_tool(std::uint32_t reference) const;
  bool get_of_tool(std::uint32_t n, double& value);
  bool set_of_tool(std::uint32_t n, double value);
  bool refuse(const std::string& why) const;
  Step step_all(double current, double step);
  void stop_at(double current, double end, const Memory& before);

  Log log_;
  std::vector<std::unique_ptr<AxisInstance>> axes_;
  std::vector<int> joints_;   // of the axes
  std::optional<Tool> tool_;  // of a whole machine
  Eigen::Vector3d default_p_ST_ = Eigen::Vector3d::Zero(), p_ST_ = default_p_ST_;
  // Outputs of the tool at these positions: they are asked for one after the other.
  struct ToolOutputs {
    Joints Q;
    Eigen::Vector3d p_ST;
    ToolValues values;
  };
  std::optional<ToolOutputs> tool_outputs_;
  // why axes were stopped in the step that is tried: it counts for the first of them alone
  std::shared_ptr<std::vector<std::string>> stops_ = std::make_shared<std::vector<std::string>>();
  bool events_used_ = false, early_return_ = false;
  bool in_event_mode_ = false;
};

}  // namespace servomill::sim::fmu
