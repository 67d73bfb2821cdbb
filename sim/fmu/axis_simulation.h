/// One axis with its loops, advanced from one communication point to the next.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/engine/servo_axes.h"
#include "sim/fmu/axis_constants.h"
#include "sim/model/schedule.h"

namespace servomill::sim::fmu {

/// Inputs of the axis, held from one communication point to the next (m, rad, N, N m).
struct AxisInputs {
  double setpoint = 0.0;               // that the position loop follows, corrections included
  double velocity = 0.0;               // fed forward, m/s
  double acceleration = 0.0;           // fed forward, m/s^2
  double load = 0.0;                   // force on the slide, towards +
  double feedback_displacement = 0.0;  // that a virtual encoder adds to the scale
  bool operator==(const AxisInputs&) const = default;
};

struct AxisOutputs {
  double position = 0.0;           // m, rad: of the slide
  double position_measured = 0.0;  // as the scale reads it now
  double velocity = 0.0;           // m/s: of the slide
  double current = 0.0;            // A
  double torque = 0.0;             // N m: of the motor
  double position_feedback = 0.0;  // as the position loop read it last
  double following_error = 0.0;    // setpoint less position feedback, in the last position period
};

/// Runs the loops at the instants at which servomill run has them, with the same steps of the
/// drive in between: the same inputs give the same bits, wherever the communication points are. At
/// a point between two instants the drive is moved up to there for the outputs; unless the load
/// changes there, it then goes on from the instant before, in one step.
///
/// An input acts from the communication point at which it is set, the loops of this tick included.
class AxisSimulation {
 public:
  /// @pre why_not_exported(axis) is empty
  explicit AxisSimulation(const AxisConstants& axis);
  AxisSimulation(const AxisSimulation&) = delete;
  AxisSimulation& operator=(const AxisSimulation&) = delete;

  /// At tick 0, in steady state where the position feedback agrees with the setpoint.
  void settle(const AxisInputs& in);

  Tick now() const { return state_.now; }
  double seconds(Tick ticks) const { return machine_.nc.periods.seconds(ticks); }

  /// Moves on to a tick. False if the NC stops the machine on the way: then `now` is the tick of
  /// that position period, and `fault` tells why.
  /// @pre to >= now(), there was no fault since settle or restore
  bool advance(Tick to, const AxisInputs& in);
  const std::string& fault() const { return fault_; }

  AxisOutputs outputs();

  /// Position in the schedule and in the step that is under way.
  struct Clock {
    Tick now = 0;             // communication point
    Tick last = 0;            // from which the drives move next
    Tick next = 0;            // next instant
    std::size_t instant = 0;  // its number in the schedule
    double load = 0.0;        // N, N m, of the step that is under way
    double setpoint = 0.0;    // of the last position period
    bool on_the_way = false;  // now is between two instants: `before` holds the axes at `last`
  };
  /// Everything that changes with time.
  struct Memory {
    Clock clock;
    engine::ServoAxes::Memory axes, before;
    /// Visits the parts as ServoAxes::Memory does.
    template <class Visit>
    void each_part(Visit visit) {
      for (Tick* tick : {&clock.now, &clock.last, &clock.next}) visit(std::span(tick, 1));
      visit(std::span(&clock.instant, 1));
      for (double* value : {&clock.load, &clock.setpoint}) visit(std::span(value, 1));
      visit(std::span(&clock.on_the_way, 1));
      axes.each_part(visit);
      if (clock.on_the_way) before.each_part(visit);
    }
  };
  Memory memory() const;
  void restore(const Memory& memory);

 private:
  bool run_loops(const AxisInputs& in);
  void load(double force);
  Joints only(double value) const;

  const model::MachineSettings machine_;
  int joint_;
  std::vector<model::Instant> schedule_;
  engine::ServoAxes axes_;
  Clock state_;
  const engine::ServoAxes::Memory initial_;  // at tick 0, not yet settled
  engine::ServoAxes::Memory before_;
  std::string fault_;
};

}  // namespace servomill::sim::fmu
