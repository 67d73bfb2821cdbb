#include "sim/input/test_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "plant/vocabulary/units.h"
#include "sim/metrology/r_test.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input {
namespace {

using Eigen::Vector3d;
using model::MachineTest;
using model::TestStandard;

double unit_of(Axis axis) { return is_linear(axis) ? mm : deg; }
const char* unit_name_of(Axis axis) { return is_linear(axis) ? "mm" : "deg"; }

struct Range {
  double from = std::numeric_limits<double>::infinity();  // m, rad
  double to = -std::numeric_limits<double>::infinity();
  void add(double q) {
    from = std::min(from, q);
    to = std::max(to, q);
  }
};

// A test on its machine.
class TestOnMachine {
 public:
  TestOnMachine(const MachineTest& test, const model::MachineSettings& machine,
                const model::ProgramSpec& program)
      : test_(test), machine_(machine), offset_(program.work_offset) {
    const controllers::ToolEntry* tool = program.tools.find(test.tool);
    if (tool != nullptr) tool_ = tool->offset;
    feed_ = test.feed * program.feed_override;
  }

  void add_faults(std::vector<Fault>& out) const {
    const std::size_t before = out.size();
    if (!test_.has_lines() && test_.is_rotary()) add_fault_of_ball(out);
    if (out.size() > before) return;  // positions of the other axes follow from it
    for (const Axis axis : kAllAxes) {
      if (!machine_.chain.layout.joint_of(axis)) continue;
      add_fault_of_travel(axis, out);
      add_fault_of_feed(axis, out);
    }
  }

 private:
  bool has_ball() const { return test_.standard == TestStandard::ball; }

  // With the axis under test at q.
  Joints joints_at(double q) const {
    AxisWords words = test_.at + offset_ + tool_;
    const int axis = index_of(test_.axes.front());
    words[axis] = q + offset_[axis];
    return machine_.chain.layout.joints(words);
  }

  // TCP at the first reading, in the workpiece.
  Vector3d ball() const {
    if (has_ball()) return (test_.at + offset_).head<3>();
    return plant::forward(machine_.chain, joints_at(test_.begin), -tool_.head<3>()).p_WT;
  }

  // Linear axes follow the ball under TCP control.
  Range range_about_ball(int joint) const {
    constexpr double kStep = 1.0 * deg;
    Range out;
    const double from = test_.begin - test_.cycle.overrun, to = test_.end + test_.cycle.overrun;
    const int steps = static_cast<int>(std::ceil((to - from) / kStep));
    for (int i = 0; i <= steps; ++i) {
      const auto Q = plant::inverse_fixed_rotary(
          machine_.chain, ball(), joints_at(from + (to - from) * i / steps), -tool_.head<3>());
      if (Q) out.add((*Q)[joint]);
    }
    return out;
  }

  // Positions of an axis in machine coordinates.
  Range range_of(Axis axis) const {
    const int i = index_of(axis), joint = machine_.chain.layout.joint_of(axis).value();
    if (has_ball() && is_linear(axis)) return range_about_ball(joint);
    const double offset = offset_[i] + tool_[i];
    Range out;
    if (std::find(test_.axes.begin(), test_.axes.end(), axis) == test_.axes.end()) {
      out.add(test_.at[i] + offset);
    } else if (test_.standard == TestStandard::circles) {
      out.add(test_.at[i] + offset - test_.radius);
      out.add(test_.at[i] + offset + test_.radius);
    } else {
      for (const model::TestStop& stop : model::stops(test_)) out.add(stop.position[i] + offset);
    }
    return out;
  }

  std::string travel_text(Axis axis, const Range& at) const {
    const double unit = unit_of(axis);
    if (at.from == at.to) {
      return fmt::format("test {} is run at {} = {:g} {}", test_.name, letter(axis), at.from / unit,
                         unit_name_of(axis));
    }
    const bool has_overrun = test_.standard != TestStandard::circles;
    return fmt::format("test {} moves {} from {:g} to {:g} {}{}", test_.name, letter(axis),
                       at.from / unit, at.to / unit, unit_name_of(axis),
                       has_overrun ? " with its overrun" : "");
  }

  void add_fault_of_travel(Axis axis, std::vector<Fault>& out) const {
    const int joint = machine_.chain.layout.joint_of(axis).value();
    const double lower = machine_.nc.lower[joint], upper = machine_.nc.upper[joint];
    const Range at = range_of(axis);
    if (at.from >= lower && at.to <= upper) return;
    out.push_back(
        {test_.place, fmt::format("{}, in machine coordinates; the travel is {:g} to {:g} {}",
                                  travel_text(axis, at), lower / unit_of(axis),
                                  upper / unit_of(axis), unit_name_of(axis))});
  }

  // Share of the feed that an axis makes, the largest of the test.
  double share_of(Axis axis) const {
    if (std::find(test_.axes.begin(), test_.axes.end(), axis) == test_.axes.end()) return 0.0;
    double share = test_.lines.empty() ? 1.0 : 0.0;
    for (const model::TestLine& line : test_.lines) {
      share = std::max(share, std::abs(line.direction[index_of(axis)]));
    }
    return share;
  }

  void add_fault_of_feed(Axis axis, std::vector<Fault>& out) const {
    constexpr double kSlack = 1.0 + 1e-9;
    const double needed = feed_ * share_of(axis);
    const double v_max = machine_.nc.v_max[machine_.chain.layout.joint_of(axis).value()];
    if (needed <= v_max * kSlack) return;
    const double unit = unit_of(axis) / minute;
    out.push_back(
        {test_.place, fmt::format("test {} moves {} at {:g} {}/min; its v_max is {:g} {}/min",
                                  test_.name, letter(axis), needed / unit, unit_name_of(axis),
                                  v_max / unit, unit_name_of(axis))});
  }

  // An artefact of an error motion is on the axis, the ball about which an axis turns is not.
  void add_fault_of_ball(std::vector<Fault>& out) const {
    constexpr double kCentred = 0.1 * mm, kMinArm = 1.0 * mm;
    const Axis axis = test_.axes.front();
    const auto refuse = [&](const std::string& text) {
      out.push_back({test_.place, fmt::format("test {}: {}", test_.name, text)});
    };
    if (!has_ball() && machine_.chain.at(axis).side == plant::Side::tool) {
      return refuse(
          fmt::format("{} carries the tool; iso230-7 is simulated of rotary tables", letter(axis)));
    }
    const Joints Q = joints_at(test_.begin);
    const metrology::AxisLine line = metrology::axis_in_workpiece(machine_.chain, axis, Q);
    const Vector3d arm = line.arm(ball());
    if (has_ball() ? arm.norm() >= kMinArm : arm.norm() <= kCentred) return;
    if (has_ball()) {
      return refuse(
          fmt::format("the ball is on the axis of {}: radial and tangential directions "
                      "need a distance of {:g} mm at least",
                      letter(axis), kMinArm / mm));
    }
    // moved by the linear axes, along the bed
    const Vector3d there = test_.at.head<3>() - plant::R_WM(machine_.chain, Q).transpose() * arm;
    refuse(
        fmt::format("the ball is {:.4g} mm off the axis of {}, which is at X = {:.4g}, Y = "
                    "{:.4g}, Z = {:.4g} mm; at must be on it",
                    arm.norm() / mm, letter(axis), there[0] / mm + 0.0, there[1] / mm + 0.0,
                    there[2] / mm + 0.0));
  }

  const MachineTest& test_;
  const model::MachineSettings& machine_;
  AxisWords offset_, tool_ = AxisWords::Zero();
  double feed_ = 0.0;  // m/s, rad/s, with its override
};

}  // namespace

std::vector<Fault> faults_of_tests(const model::MachineTests& tests,
                                   const model::MachineSettings& machine,
                                   const model::ProgramSpec& program) {
  std::vector<Fault> out;
  for (const auto& test : tests) {
    if (test->moves()) TestOnMachine(*test, machine, program).add_faults(out);
  }
  return out;
}

}  // namespace servomill::sim::input
